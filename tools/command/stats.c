/* Computes statistics of a scene's attributes. Reads all Gaussians into columns, sorts each column, and counts a
   histogram. */
#include "stats.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/gaussian/attributes.h"
#include "command.h"


enum { OF_ALL = 10 };    /* number of attributes with SH of degree 0 only; each further degree adds one */

static const char *const names[STATS_MOST] = {"x", "y", "z", "scale_0", "scale_1", "scale_2", "opacity", "red", "green",
                                              "blue", "sh_1", "sh_2", "sh_3"};

static float size_of(const float *values, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += (double)values[i] * values[i];
    return (float)sqrt(sum / count);
}

static void take(float *const *columns, uint64_t row, const fxs_gaussian *g, int sh_degree)
{
    for (int i = 0; i < 3; i++) {
        columns[i][row] = g->position[i];
        columns[3 + i][row] = g->scale[i];
        columns[7 + i][row] = (float)(0.5 + FXS_SH_0 * g->dc[i]);
    }
    columns[6][row] = (float)(fxs_opacity_of_logit(g->opacity));
    for (int l = 1; l <= sh_degree; l++)
        columns[OF_ALL - 1 + l][row] = size_of(g->sh + 3 * (l * l - 1), 3 * (2 * l + 1));
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Computes statistics of an attribute's finite values, and sorts these values in place. */
static void measure(attribute_stats *a, float *values, uint64_t count)
{
    double sum = 0;
    for (uint64_t i = 0; i < count; i++)
        if (isfinite(values[i])) {
            sum += values[i];
            values[a->count++] = values[i];
        }
    a->not_finite = count - a->count;
    if (!a->count)
        return;
    qsort(values, (size_t)a->count, sizeof *values, compare_floats);
    a->least = values[0];
    a->most = values[a->count - 1];
    a->median = ((double)values[(a->count - 1) / 2] + values[a->count / 2]) / 2;
    a->mean = sum / (double)a->count;
    const double scale = a->most > a->least ? STATS_BINS / (a->most - a->least) : 0;
    for (uint64_t i = 0; i < a->count; i++) {
        const int bin = (int)((values[i] - a->least) * scale);
        a->bins[bin < STATS_BINS ? bin : STATS_BINS - 1]++;
    }
}

static void add_to(attribute_stats *a, double origin)
{
    a->least += origin;
    a->median += origin;
    a->mean += origin;
    a->most += origin;
}

static int read_columns(float *const *columns, fxs_scene_file *file, const fxs_scene_file_info *info,
                        fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    char label[] = "reading";
    uint64_t row = 0;
    for (long n; (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;) {
        if (n < 0)
            return (int)n;
        for (long i = 0; i < n && row < info->count; i++)
            take(columns, row++, &batch[i], info->sh_degree);
        progress_bar(label, (double)row / (double)info->count);
    }
    progress_end();
    return 0;
}

int stats_measure(scene_stats *s, fxs_scene_file *file, const fxs_scene_file_info *info, fxs_message *message)
{
    float *columns[STATS_MOST];
    memset(s, 0, sizeof *s);
    s->count = OF_ALL + info->sh_degree;
    const uint64_t all = info->count * (uint64_t)s->count;
    float *values = all < SIZE_MAX ? calloc((size_t)all + 1, sizeof *values) : NULL;
    if (!values)
        return fxs_fail_memory(message, NULL, all * sizeof *values);
    for (int i = 0; i < s->count; i++)
        columns[i] = values + (uint64_t)i * info->count;
    const int error = read_columns(columns, file, info, message);
    for (int i = 0; i < s->count && !error; i++) {
        s->attributes[i].name = names[i];
        measure(&s->attributes[i], columns[i], info->count);
        if (i < 3)
            add_to(&s->attributes[i], info->origin[i]);
    }
    free(values);
    return error;
}

/* Prints a histogram in one line, with denser characters for fuller bins. */
static void print_bins(const attribute_stats *a)
{
    static const char levels[] = " .:-=+*#%@";
    uint64_t most = 1;
    for (int i = 0; i < STATS_BINS; i++)
        most = a->bins[i] > most ? a->bins[i] : most;
    putchar('|');
    for (int i = 0; i < STATS_BINS; i++)
        putchar(levels[(a->bins[i] * 9 + most - 1) / most]);
    putchar('|');
}

void stats_print_text(const scene_stats *s)
{
    printf("%-9s %12s %12s %12s %12s  from min to max\n", "", "min", "median", "mean", "max");
    for (int i = 0; i < s->count; i++) {
        const attribute_stats *a = &s->attributes[i];
        const int digits = i < 3 ? place_digits(a->most, 6) : 6;
        printf("%-9s %12.*g %12.*g %12.*g %12.*g  ", a->name, digits, a->least, digits, a->median, digits, a->mean,
               digits, a->most);
        print_bins(a);
        if (a->not_finite)
            printf(" and %" PRIu64 " not finite", a->not_finite);
        putchar('\n');
    }
}

void stats_print_json(const scene_stats *s)
{
    for (int i = 0; i < s->count; i++) {
        const attribute_stats *a = &s->attributes[i];
        const int digits = i < 3 ? place_digits(a->most, 9) : 9;
        printf("%s{\"name\": \"%s\", \"min\": %.*g, \"median\": %.*g, \"mean\": %.*g, \"max\": %.*g, "
               "\"not_finite\": %" PRIu64 ", \"histogram\": [", i ? ", " : "[", a->name, digits, a->least, digits,
               a->median, digits, a->mean, digits, a->most, a->not_finite);
        for (int k = 0; k < STATS_BINS; k++)
            printf("%s%" PRIu64, k ? ", " : "", a->bins[k]);
        printf("]}");
    }
    printf("]");
}
