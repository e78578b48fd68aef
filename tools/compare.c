/* fixsplat compare */
#include <math.h>
#include <stdlib.h>

#include "../port/image/image_file.h"
#include "command.h"
#include "metrics.h"

static const char help[] =
    "Usage: fixsplat compare A.png B.png [--diff D.png] [--json]\n\n"
    "Prints PSNR, SSIM (Wang et al. 2004) and the largest difference of two pictures of one size, over red,\n"
    "green and blue.\n\n"
    "  --diff D.png        write 8 times the absolute difference\n"
    "  --json              print a JSON object (psnr is null where the pictures are equal)\n\n"
    "Examples:\n"
    "  fixsplat compare a.png b.png\n"
    "  fixsplat compare a.png b.png --diff difference.png --json\n";

static int write_difference(const char *path, const uint8_t *a, const uint8_t *b, int width, int height)
{
    fxs_message message;
    uint8_t *rgba = malloc((size_t)width * (size_t)height * 4);
    if (!rgba)
        return fail(EXIT_FAILED, "out of memory");
    fxs_metrics_difference(a, b, width, height, rgba);
    int result = fxs_image_file_write(path, rgba, width, height, &message);
    free(rgba);
    return result ? fail(EXIT_FAILED, "%s", message.text) : 0;
}

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

static int compare(const char *const path[2], const char *difference, int json)
{
    uint8_t *image[2] = {0, 0};
    int width[2], height[2], status = 0;
    fxs_message message;
    struct fxs_metrics metrics;
    for (int i = 0; i < 2 && !status; i++)
        if (fxs_image_file_read(path[i], &image[i], &width[i], &height[i], &message))
            status = fail(EXIT_FAILED, "%s", message.text);
    if (!status && (width[0] != width[1] || height[0] != height[1]))
        status = fail(EXIT_FAILED, "%s is %dx%d, %s is %dx%d", path[0], width[0], height[0], path[1], width[1],
                      height[1]);
    if (!status && fxs_metrics_compare(image[0], image[1], width[0], height[0], &metrics))
        status = fail(EXIT_FAILED, "out of memory");
    if (!status && difference)
        status = write_difference(difference, image[0], image[1], width[0], height[0]);
    if (!status)
        print(&metrics, json);
    free(image[0]);
    free(image[1]);
    return status;
}

int command_compare(int argc, char **argv)
{
    enum { OPT_DIFF = OPT_OWN, OPT_JSON };
    static const struct option table[] = {{"diff", required_argument, 0, OPT_DIFF}, {"json", no_argument, 0, OPT_JSON},
                                          {"help", no_argument, 0, OPT_HELP}, {0, 0, 0, 0}};
    const char *difference = 0;
    int json = 0;
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;)
        switch (c) {
        case OPT_DIFF: difference = optarg; break;
        case OPT_JSON: json = 1; break;
        case OPT_HELP: fputs(help, stdout); return EXIT_OK;
        default: return wrong_option(argv);
        }
    if (optind != argc - 2)
        return fail(EXIT_USAGE, "compare takes two pictures; see: fixsplat compare --help");
    if (difference && !fxs_image_file_known(difference))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", difference);
    const char *const path[2] = {argv[optind], argv[optind + 1]};
    return compare(path, difference, json);
}
