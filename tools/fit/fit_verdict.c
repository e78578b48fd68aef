/* The verdict of `fixsplat fit`. Three tables decide which lines are printed: `grades` by PSNR, `findings` (faults of
   the scene, and options that make the next fit better), and `nexts` (commands to type). */
#include "fit_verdict.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/fit_more.h>
#include "src/base/os_calls.h"
#include "fit_result.h"

enum { LINES_MOST = 6, FINDINGS_MOST = 2, NONE = -1 };

/* Differences of PSNR in dB above which a finding holds. */
enum { OVERFITTED = 5, EXPOSED = 2, FAR_BELOW = 5 };

#define LEAST_OF_EXPOSED 22     /* exposure is the cause only above this PSNR in dB after an affine map of colours */
#define LEAST_TO_COMPARE 3      /* with fewer photographs, none counts as far worse than the others */
#define FAR_AWAY 2              /* a camera farther from the fitted ones than this times the median distance is apart */

enum { SHARP, SOFT, BLURRED, BROKEN };

/* `least`: lowest mean PSNR in dB of the grade. */
static const struct {
    double least;
    const char *word, *sentence;
} grades[] = {
    [SHARP] = {30, "sharp", "Sharp: from new places it is hard to tell from a photograph"},
    [SOFT] = {25, "soft", "A little soft: from new places it looks like a photograph with less detail"},
    [BLURRED] = {20, "blurred", "Blurred or spotted: from new places all is there, but without detail"},
    [BROKEN] = {-INFINITY, "broken", "Broken: from new places it does not look like the photographs"}
};

static int grade_of(double psnr)
{
    int i = 0;
    while (psnr < grades[i].least)
        i++;
    return i;
}

/* ---- Findings ---------------------------------------------------------------------------------------------------- */

/* Returns the quality with more steps than the fit had; NONE: no quality has more. */
static int next_quality(const fit_verdict *v)
{
    int i = v->steps ? QUALITY_GOOD : QUALITY_BEST + 1;
    while (i <= QUALITY_BEST && v->steps >= fit_presets[i].steps)
        i++;
    return i <= QUALITY_BEST ? i : NONE;
}

static int lacks_places(const fit_verdict *v)
{
    const reconstruction *r = &v->c->found;
    return 4 * r->unplaced > r->placed + r->unplaced;
}

static int differs_in_exposure(const fit_verdict *v)
{
    return !v->is_corrected && v->affine_psnr - v->psnr > EXPOSED && v->affine_psnr > LEAST_OF_EXPOSED;
}

static int has_worst(const fit_verdict *v)
{
    return v->worst != 0;
}

static int has_gaps(const fit_verdict *v)
{
    return !differs_in_exposure(v) && grade_of(v->psnr) > SHARP && v->fitted - v->psnr > OVERFITTED;
}

static int is_quick(const fit_verdict *v)
{
    return next_quality(v) == QUALITY_GOOD;
}

/* True if nothing but the photographs or the number of steps explains a grade of at least `grade`. */
static int is_plain(const fit_verdict *v, int grade)
{
    return v->fitted > 0 && !differs_in_exposure(v) && !has_gaps(v) && !is_quick(v) && grade_of(v->psnr) >= grade;
}

static int is_unsharp(const fit_verdict *v)
{
    return is_plain(v, BLURRED);
}

static int may_be_best(const fit_verdict *v)
{
    return is_plain(v, SOFT) && grade_of(v->psnr) < BROKEN && next_quality(v) == QUALITY_BEST;
}

static void say_places(const fit_verdict *v)
{
    const reconstruction *r = &v->c->found;
    printf("No place was found for %zu of %zu photographs: take more, a step apart, that join them to the others.\n",
           r->unplaced, r->placed + r->unplaced);
}

static void say_exposure(const fit_verdict *v)
{
    (void)v;
    puts("The photographs differ in brightness or tint, which leaves haze: --exposure gain evens them out.");
}

static void say_worst(const fit_verdict *v)
{
    char psnr[32];
    printf("%s came out far worse than the others (%.4s dB): %s\n", v->worst->name,
           fxs_metrics_psnr(psnr, v->worst_psnr, "any"), v->worst_why);
}

static void say_gaps(const fit_verdict *v)
{
    (void)v;
    puts("Places between the photographs are much worse, with haze or floating spots: more photographs would help.");
}

static void say_quick(const fit_verdict *v)
{
    printf("This was a quick fit of %" PRIu32 " steps: --quality good makes %" PRIu32 ", which show finer detail.\n",
           v->steps, fit_presets[QUALITY_GOOD].steps);
}

static void say_unsharp(const fit_verdict *v)
{
    (void)v;
    puts("Where it was fitted it is not much better: sharper photographs of things that keep still would help.");
}

static void say_best(const fit_verdict *v)
{
    (void)v;
    puts("--quality best shows a little more detail, in about 8 times the time.");
}

/* The most important come first. */
static const struct finding {
    const char *name;
    int (*holds)(const fit_verdict *v);
    void (*say)(const fit_verdict *v);
    const char *left_out, *added;           /* options of the next fit, which drops some; null: as before */
    int compares;                           /* 1: suggests the pictures of --compare */
} findings[] = {
    {"places", lacks_places, say_places, 0, 0, 0},
    {"exposure", differs_in_exposure, say_exposure, " exposure", " --exposure gain", 0},
    {"worst", has_worst, say_worst, 0, 0, 1},
    {"gaps", has_gaps, say_gaps, 0, 0, 0},
    {"quick", is_quick, say_quick, " quality steps recipe", " --quality good", 0},
    {"unsharp", is_unsharp, say_unsharp, 0, 0, 0},
    {"best", may_be_best, say_best, " quality steps recipe", " --quality best", 0}
};

enum { FINDINGS = sizeof findings / sizeof *findings };

/* Lists the first FINDINGS_MOST findings that hold. Returns their number. */
static int first_findings(const fit_verdict *v, const struct finding *found[FINDINGS_MOST])
{
    int count = 0;
    for (int i = 0; i < FINDINGS && v->is_known && count < FINDINGS_MOST; i++)
        if (findings[i].holds(v))
            found[count++] = &findings[i];
    return count;
}

/* ---- The next commands ------------------------------------------------------------------------------------------- */

/* Joins the options that the printed findings drop from the next fit, and those that they add. */
static void join_options(const fit_verdict *v, char left_out[128], char added[128])
{
    const struct finding *found[FINDINGS_MOST];
    const int count = first_findings(v, found);
    snprintf(left_out, 128, "resume");
    *added = 0;
    for (int i = 0; i < count; i++)
        if (found[i]->added) {
            strcat(left_out, found[i]->left_out);
            strcat(added, found[i]->added);
        }
}

static int is_saved_fit(const fit_verdict *v)
{
    return ends_with(v->c->out, ".fit");
}

static int is_scene(const fit_verdict *v)
{
    return !is_saved_fit(v);
}

/* A resumed fit has options that its command line lacks, so no command repeats it. */
static int may_fit_again(const fit_verdict *v)
{
    char left_out[128], added[128];
    join_options(v, left_out, added);
    return *added && !v->c->resume;
}

static int may_compare(const fit_verdict *v)
{
    const struct finding *found[FINDINGS_MOST];
    int compares = 0;
    for (int i = first_findings(v, found); i-- > 0;)
        compares |= found[i]->compares;
    return compares && !v->c->compare && is_scene(v);
}

static int has_subject(const fit_verdict *v)
{
    return v->has_subject;
}

static void write_view(const fit_verdict *v)
{
    printf("fixsplat view");
    write_shell_word(stdout, v->c->out);
}

static void write_again(const fit_verdict *v)
{
    char left_out[128], added[128];
    join_options(v, left_out, added);
    fit_write_command(stdout, v->c->photographs, left_out);
    fputs(added, stdout);
}

/* The folder of cameras that were found has its own masks. */
static void write_compare(const fit_verdict *v)
{
    fit_write_command(stdout, v->c->in, v->c->found.folder ? FIT_NOT_MEASURED " port frames masks invert-masks"
                                                           : FIT_NOT_MEASURED " port");
    printf(" --measure");
    write_shell_word(stdout, v->c->out);
    printf(" --compare pictures");
}

static void write_publish(const fit_verdict *v)
{
    printf("fixsplat publish");
    write_shell_word(stdout, v->c->out);
    printf(" site");
}

/* Writes OUT with another ending, as a word for a shell. */
static void write_renamed(const fit_verdict *v, const char *ending)
{
    char name[4096];
    const char *out = v->c->out;
    snprintf(name, sizeof name, "%.*s%s", (int)(strrchr(out, '.') - out), out, ending);
    write_shell_word(stdout, name);
}

static void write_crop(const fit_verdict *v)
{
    char ending[32];
    const fxs_fit_subject *s = &v->subject;
    snprintf(ending, sizeof ending, "-cropped%s", strrchr(v->c->out, '.'));
    printf("fixsplat convert");
    write_shell_word(stdout, v->c->out);
    write_renamed(v, ending);
    printf(" --sphere ");
    for (int i = 0; i < 3; i++)
        printf("%.4g,", fabs(s->middle[i]) < 1e-4 * s->radius ? 0 : s->middle[i]);
    printf("%.4g", s->radius);
}

static void write_scene_of_fit(const fit_verdict *v)
{
    fit_write_command(stdout, v->c->photographs, "output resume");
    printf(" --resume");
    write_shell_word(stdout, v->c->out);
    printf(" -o");
    write_renamed(v, ".fxs");
}

/* Printed in this order, up to LINES_MOST lines in all. */
static const struct {
    const char *label;
    int (*holds)(const fit_verdict *v);
    void (*write)(const fit_verdict *v);
} nexts[] = {
    {"to look at it:", is_scene, write_view},
    {"its scene:", is_saved_fit, write_scene_of_fit},
    {"again, and better:", may_fit_again, write_again},
    {"the photographs beside it:", may_compare, write_compare},
    {"a folder for any web server:", is_scene, write_publish},
    {"the subject alone:", has_subject, write_crop}
};

/* ---- Facts ------------------------------------------------------------------------------------------------------- */

static double psnr_of(const quality_view *view, int is_affine)
{
    return is_affine ? view->affine_psnr : view->metrics.psnr;
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *numbers, long count)
{
    qsort(numbers, (size_t)count, sizeof *numbers, compare_numbers);
    return (numbers[(count - 1) / 2] + numbers[count / 2]) / 2;
}

static double median_psnr(const quality *q, int is_affine, double *numbers)
{
    for (long i = 0; i < q->count; i++)
        numbers[i] = psnr_of(&q->views[i], is_affine);
    return median(numbers, q->count);
}

/* Returns the distance from a camera to the nearest of the fitted ones. */
static double nearest(const fxs_photos *photos, const double position[3])
{
    double least = INFINITY;
    for (size_t i = 0; i < photos->fit_count; i++) {
        const double *other = photos->fit[i].view.position;
        least = fmin(least, hypot(hypot(other[0] - position[0], other[1] - position[1]), other[2] - position[2]));
    }
    return least;
}

/* True if held-out photograph i was taken far from all fitted ones, compared with the other held-out photographs. */
static int is_apart(const fxs_photos *photos, long i, double *numbers)
{
    const long count = (long)photos->held_out_count;
    for (long k = 0; k < count; k++)
        numbers[k] = nearest(photos, photos->held_out[k].view.position);
    const double own = count ? numbers[i] : 0;
    return count && own > FAR_AWAY * median(numbers, count);
}

/* Finds the worst photograph, if it is far below the others, and the cause. */
static int find_worst(fit_verdict *v, const fxs_photos *photos, const quality *q)
{
    double *numbers = malloc(((size_t)q->count + 1) * sizeof *numbers);
    const quality_view *worst = q->views;
    if (!numbers)
        return fail(EXIT_FAILED, "out of memory");
    for (long i = 1; i < q->count; i++)
        if (psnr_of(&q->views[i], v->is_corrected) < psnr_of(worst, v->is_corrected))
            worst = &q->views[i];
    v->worst_psnr = psnr_of(worst, v->is_corrected);
    if (q->count >= LEAST_TO_COMPARE && median_psnr(q, v->is_corrected, numbers) - v->worst_psnr > FAR_BELOW) {
        v->worst = worst;
        v->worst_why = median_psnr(q, 1, numbers) - worst->affine_psnr <= FAR_BELOW
                           ? "it is brighter, darker or of another tint."
                       : is_apart(photos, worst - q->views, numbers)
                           ? "no photograph was fitted near its place."
                           : "is it blurred, or does it show something that moved?";
    }
    free(numbers);
    return 0;
}

int fit_verdict_find(fit_verdict *v, const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, world *scene,
                     const quality *measured)
{
    fxs_message why;
    double fitted[2];
    memset(v, 0, sizeof *v);
    v->c = c;
    v->steps = fxs_fit_steps(fit);
    v->is_corrected = fxs_fit_options_of(fit)->exposure != FXS_FIT_EXPOSURE_NONE;
    v->is_known = !isinf(measured->psnr) || !isnan(measured->ssim);
    v->has_held_out = photos->held_out_count > 0;
    v->affine_psnr = measured->affine_psnr;
    v->psnr = v->is_corrected ? measured->affine_psnr : measured->psnr;
    v->has_subject = !c->crops && is_scene(v) && !fxs_fit_find_subject(fit, &v->subject, &why);
    const int status = result_measure_fitted(fitted, scene, photos, &c->frame);
    v->fitted = fitted[v->is_corrected];
    return status ? status : find_worst(v, photos, measured);
}

fit_verdict fit_verdict_of_moving(const fit_command *c, double psnr, int has_held_out)
{
    return (fit_verdict){.c = c, .is_known = 1, .has_held_out = has_held_out, .psnr = psnr, .affine_psnr = psnr};
}

/* ---- Printing ---------------------------------------------------------------------------------------------------- */

static void print_grade(const fit_verdict *v)
{
    char psnr[32], fitted[32];
    const char *how = v->is_corrected ? " with matched colours" : "";
    fxs_metrics_psnr(psnr, v->psnr, "any");
    if (!v->is_known)
        puts("No pixel of the photographs that were measured counts, so how it looks is not known.");
    else if (!v->has_held_out)
        printf("Nothing was held out, so how it looks from new places is not known (%.4s dB%s where it was fitted).\n",
               psnr, how);
    else if (v->fitted > 0)
        printf("%s (%.4s dB%s; %.4s where it was fitted).\n", grades[grade_of(v->psnr)].sentence, psnr, how,
               fxs_metrics_psnr(fitted, v->fitted, "any"));
    else
        printf("%s (%.4s dB).\n", grades[grade_of(v->psnr)].sentence, psnr);
}

void fit_verdict_print_text(const fit_verdict *v)
{
    const struct finding *found[FINDINGS_MOST];
    const int count = first_findings(v, found);
    int lines = 1 + count;
    print_grade(v);
    for (int i = 0; i < count; i++)
        found[i]->say(v);
    for (size_t i = 0; i < sizeof nexts / sizeof *nexts && lines < LINES_MOST; i++)
        if (nexts[i].holds(v)) {
            printf("%-29s ", nexts[i].label);
            nexts[i].write(v);
            putchar('\n');
            lines++;
        }
}

void fit_verdict_print_json(const fit_verdict *v)
{
    const char *between = "";
    if (v->is_known && v->has_held_out)
        printf(", \"verdict\": \"%s\", \"advice\": [", grades[grade_of(v->psnr)].word);
    else
        printf(", \"verdict\": null, \"advice\": [");
    for (int i = 0; i < FINDINGS && v->is_known; i++)
        if (findings[i].holds(v)) {
            printf("%s\"%s\"", between, findings[i].name);
            between = ", ";
        }
    printf("]");
}
