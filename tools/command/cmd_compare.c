/* fixsplat compare: measures the difference of two pictures. */
#include <math.h>
#include <stdlib.h>

#include <fixsplat/image.h>
#include <fixsplat/scene.h>
#include "command.h"
#include "command_line.h"
#include "file_guard.h"
#include "metrics.h"

typedef struct compare_options {
    const char *path[2], *difference;
    double least_psnr, least_ssim;          /* least allowed PSNR and least allowed SSIM; 0: no minimum */
    int json;
} compare_options;

#define OPTIONS compare_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"diff", "D.png", OUTPUT(difference), .help = "write 8 times the absolute difference"},
    {"min-psnr", "DB", REAL(least_psnr, ABOVE_0, INFINITY, "decibels above 0"), .help =
     "exit 1 if the PSNR is below DB; equal pictures always pass"},
    {"min-ssim", "S", REAL(least_ssim, ABOVE_0, 1, "a number above 0, up to 1"), .help =
     "exit 1 if the SSIM is below S, above 0, up to 1"},
    {"json", 0, FLAG(json), .help = "print a JSON object; psnr is null for equal pictures"},
    {0}
};

static void print(const struct fxs_metrics *m, int json)
{
    char psnr[32];
    fxs_metrics_psnr(psnr, m->psnr, "null");
    if (json)
        printf("{\"psnr\": %s, \"ssim\": %.6f, \"largest\": %d}\n", psnr, m->ssim, m->largest);
    else if (isinf(m->psnr))
        puts("equal");
    else
        printf("PSNR %s dB, SSIM %.6f, largest difference %d\n", psnr, m->ssim, m->largest);
}

static int judge(const struct fxs_metrics *m, const compare_options *o)
{
    if (m->psnr < o->least_psnr)
        return fail(EXIT_FAILED, "%s and %s: a PSNR of %.4f dB is below %g", o->path[0], o->path[1], m->psnr,
                    o->least_psnr);
    if (m->ssim < o->least_ssim)
        return fail(EXIT_FAILED, "%s and %s: an SSIM of %.6f is below %g", o->path[0], o->path[1], m->ssim,
                    o->least_ssim);
    return 0;
}

static int compare(const compare_options *o)
{
    const char *const *path = o->path;
    uint8_t *image[2] = {0, 0};
    int width[2], height[2], status = 0;
    fxs_message message;
    struct fxs_metrics metrics;
    for (int i = 0; i < 2 && !status; i++)
        if (fxs_image_file_read(path[i], &image[i], &width[i], &height[i], &message))
            status = fail_for(&message);
    if (!status && (width[0] != width[1] || height[0] != height[1]))
        status = fail(EXIT_FAILED, "%s is %dx%d, %s is %dx%d", path[0], width[0], height[0], path[1], width[1],
                      height[1]);
    if (!status && fxs_metrics_compare(image[0], image[1], width[0], height[0], &metrics))
        status = fail(EXIT_FAILED, "out of memory");
    if (!status && o->difference &&
        fxs_metrics_difference(o->difference, image[0], image[1], width[0], height[0], &message))
        status = fail_for(&message);
    if (!status) {
        print(&metrics, o->json);
        status = judge(&metrics, o);
    }
    free(image[0]);
    free(image[1]);
    return status;
}

static int check(const compare_options *o)
{
    for (int i = 0; i < 2; i++)
        if (fxs_scene_format_of(o->path[i], 0))
            return fail(EXIT_USAGE, "compare takes two pictures, and %s is a scene; scenes are compared by: fixsplat "
                        "info A --compare B", o->path[i]);
    if (!o->difference)
        return 0;
    if (!fxs_image_file_known(o->difference))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", o->difference);
    files_read(o->path[0]);
    files_read(o->path[1]);
    files_write(o->difference);
    return files_check();
}

static int run(int argc, char **argv)
{
    compare_options o = {.difference = 0};
    if (take_options(&command_compare, &o, argc, argv))
        return EXIT_USAGE;
    if (optind != argc - 2)
        return fail(EXIT_USAGE, "compare takes two pictures; see: fixsplat compare --help");
    o.path[0] = argv[optind];
    o.path[1] = argv[optind + 1];
    const int status = check(&o);
    return status ? status : compare(&o);
}

const command command_compare = {
    "compare", "measures the difference of two pictures", run,
    "Usage: fixsplat compare A.png B.png [OPTION...]\n\n"
    "Prints PSNR, SSIM (Wang et al. 2004) and the largest difference of two pictures, over red, green and blue. Both\n"
    "pictures must have the same size.\n",
    0,
    "  $ fixsplat compare a.png b.png\n"
    "  $ fixsplat compare a.png b.png --diff difference.png --json\n"
    "  $ fixsplat compare golden.png got.png --min-psnr 45 --min-ssim 0.99 --diff diff.png\n",
    {{own_rows, 0}, COMMON_TABLE}
};
