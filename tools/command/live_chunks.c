/* Counts what is drawn of a moving scene, from the times of its chunks (256 Gaussians each). */
#include "live_chunks.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/packed.h>
#include "command.h"

static int ascending(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Sorts the times at which chunks begin and end to be drawn, within 0 to the duration, Q16. Returns the number of
   chunks that are drawn at all. */
static size_t list_times(const fxs_scene *scene, int64_t duration_q16, int64_t *from_q16, int64_t *to_q16)
{
    size_t count = 0;
    for (uint32_t i = 0; i < scene->chunk_count; i++) {
        fxs_chunk_motion m;
        memcpy(&m, scene->motion + sizeof(fxs_motion_header) + (size_t)i * sizeof m, sizeof m);
        fxs_chunk_motion_turn(&m);
        const int64_t from = m.from_q16 > 0 ? m.from_q16 : 0, to = m.to_q16 < duration_q16 ? m.to_q16 : duration_q16;
        if (from < to) {
            from_q16[count] = from;
            to_q16[count++] = to;
        }
    }
    qsort(from_q16, count, sizeof *from_q16, ascending);
    qsort(to_q16, count, sizeof *to_q16, ascending);
    return count;
}

static uint64_t gaussians_of(const fxs_scene *scene, size_t chunks)
{
    const uint64_t slots = (uint64_t)chunks * FXS_CHUNK;
    return slots < scene->count ? slots : scene->count;
}

/* Finds the fewest and the most chunks at a time, and the mean. */
static void count_live(live_chunks *live, const fxs_scene *scene, int64_t duration_q16, const int64_t *from_q16,
                       const int64_t *to_q16, size_t count)
{
    size_t now = 0, least = count, most = 0;
    double sum = 0;
    for (size_t begun = 0, ended = 0; begun < count || ended < count;) {
        const int64_t time = begun < count && from_q16[begun] < to_q16[ended] ? from_q16[begun] : to_q16[ended];
        for (; begun < count && from_q16[begun] == time; begun++)
            now++;
        for (; ended < count && to_q16[ended] == time; ended++)
            now--;
        least = time < duration_q16 && now < least ? now : least;
        most = now > most ? now : most;
    }
    if (!count || from_q16[0] > 0)
        least = 0;
    for (size_t i = 0; i < count; i++)
        sum += (double)(to_q16[i] - from_q16[i]);
    live->least = gaussians_of(scene, least);
    live->most = gaussians_of(scene, most);
    live->mean = fmin(sum * FXS_CHUNK / (double)duration_q16, scene->count);
}

static void count_bytes(live_chunks *live, const fxs_scene *scene, const int64_t *from_q16, size_t count)
{
    size_t first = 0, most = 0;
    while (first < count && from_q16[first] <= 0)
        first++;
    live->at_start = (uint64_t)first * scene->chunk_bytes;
    live->per_second = (double)(count - first) * scene->chunk_bytes / live->duration;
    for (size_t i = first, begin = first; i < count; i++) {
        while (from_q16[begin] <= from_q16[i] - 65536)
            begin++;
        most = i + 1 - begin > most ? i + 1 - begin : most;
    }
    live->in_a_second = (uint64_t)most * scene->chunk_bytes;
}

int live_measure(live_chunks *live, const fxs_scene *scene)
{
    const fxs_motion_info info = fxs_scene_motion(scene);
    const int64_t duration_q16 = info.duration_q32 >> 16;
    *live = (live_chunks){.duration = ldexp((double)info.duration_q32, -32), .loops = info.loops,
                          .rate = ldexp((double)info.rate_q32, -32)};
    if (!info.duration_q32)
        return 0;
    int64_t *from_q16 = malloc(scene->chunk_count * sizeof *from_q16);
    int64_t *to_q16 = malloc(scene->chunk_count * sizeof *to_q16);
    const size_t count = from_q16 && to_q16 ? list_times(scene, duration_q16, from_q16, to_q16) : 0;
    const int status = from_q16 && to_q16 ? 0 : fail(EXIT_FAILED, "out of memory");
    if (!status) {
        count_live(live, scene, duration_q16, from_q16, to_q16, count);
        count_bytes(live, scene, from_q16, count);
    }
    free(from_q16);
    free(to_q16);
    return status;
}

void live_print_text(const live_chunks *l)
{
    if (!(l->duration > 0))
        return;
    printf("moves         %.6g seconds, %s", l->duration, l->loops ? "again and again" : "once");
    if (l->rate > 0)
        printf(", %.6g frames a second", l->rate);
    printf("\nlive          %" PRIu64 " Gaussians at the least, %.0f on average, %" PRIu64 " at most\n", l->least,
           l->mean, l->most);
    printf("stream        %" PRIu64 " bytes from the start on, then %.0f a second, at most %" PRIu64 " in a second\n",
           l->at_start, l->per_second, l->in_a_second);
}

void live_print_json(const live_chunks *l)
{
    if (!(l->duration > 0))
        return;
    printf("\"motion\": {\"duration\": %.9g, \"rate\": ", l->duration);
    if (l->rate > 0)
        printf("%.9g", l->rate);
    else
        printf("null");
    printf(", \"loops\": %s, \"live\": {\"least\": %" PRIu64 ", \"mean\": %.1f, \"most\": %" PRIu64 "}, "
           "\"start_bytes\": %" PRIu64 ", \"bytes_per_second\": %.0f, \"most_bytes_in_a_second\": %" PRIu64 "}, ",
           l->loops ? "true" : "false", l->least, l->mean, l->most, l->at_start, l->per_second, l->in_a_second);
}
