/* Tests the reduction of a scene by merging Gaussians: their number, the moments that a merge keeps, and errors. */
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include "scene_bytes.h"
#include "src/pack/weight.h"

enum { COUNT = 2000 };

static fxs_gaussian made[COUNT], got[COUNT];
static fxs_scene_file *file;

static long read_made(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    (void)argument;
    memcpy(out, made + first, capacity * sizeof *out);
    return (long)capacity;
}

/* Makes a scene of flat Gaussians so faint that no merged opacity saturates. */
static void make(void)
{
    uint32_t state = 7;
    memset(made, 0, sizeof made);
    for (int i = 0; i < COUNT; i++) {
        float *values = (float *)&made[i];
        for (size_t k = 0; k < sizeof made[i] / sizeof(float); k++)
            values[k] = (float)((state = state * 1664525 + 1013904223) >> 8) / 8388608 - 1;
        for (int k = 0; k < 3; k++) {
            made[i].position[k] *= 10;
            made[i].scale[k] -= (float)(k == 2 ? 5 : 2);
        }
        made[i].opacity -= 5;
    }
}

static int open_made(uint64_t count)
{
    const fxs_gaussian_source source = {count, 3, 0, read_made, NULL, {0}};
    return CHECK(fxs_scene_file_open_gaussians("made", &source, NULL, &file, &info, &message) == 0);
}

static long read_left(void)
{
    static fxs_gaussian again[COUNT];
    long total = 0;
    for (long n; (n = fxs_scene_file_read(file, got + total, 7, &message)) > 0;)
        total += n;
    CHECK(fxs_scene_file_rewind(file, &message) == 0);
    CHECK(fxs_scene_file_read(file, again, COUNT, &message) == total);
    CHECK(!memcmp(got, again, (size_t)total * sizeof *got));
    return total;
}

static void counts(void)
{
    static const uint64_t targets[] = {COUNT - 1, COUNT / 2, 257, 256, 255, 2, 1};
    make();
    for (size_t t = 0; t < sizeof targets / sizeof *targets; t++) {
        if (!open_made(COUNT))
            return;
        CHECK(fxs_scene_file_decimate(file, targets[t], &info, NULL, &message) == 0);
        CHECK(info.count == targets[t] && info.sh_degree == 3 && read_left() == (long)targets[t]);
        for (uint64_t i = 0; i < targets[t]; i++) {
            fxs_pack_dropped dropped = {0};
            CHECK(fxs_drawable(&got[i], 3, &dropped));
        }
        fxs_scene_file_close(file);
    }
}

static void all_stay(void)
{
    make();
    for (uint64_t target = COUNT; target <= COUNT + 1; target++) {
        if (!open_made(COUNT))
            return;
        CHECK(fxs_scene_file_decimate(file, target, &info, NULL, &message) == 0);
        CHECK(info.count == COUNT && read_left() == COUNT && !memcmp(got, made, sizeof made));
        fxs_scene_file_close(file);
    }
}

/* Weighted sums over the Gaussians of a scene, which merging keeps. They sum the weight, position, dc (base
   colour), SH, and second moments w (R S S R' + x x') about the origin. */
enum { SUMS = 1 + 3 + 3 + 45 + 6 };

static void add_moments(double sums[SUMS], const fxs_gaussian *g)
{
    static const int rows[6] = {0, 1, 2, 0, 0, 1}, columns[6] = {0, 1, 2, 1, 2, 2};
    const double weight = fxs_weight(g), w = g->rotation[0], x = g->rotation[1], y = g->rotation[2], z = g->rotation[3];
    const double s = 2 / (w * w + x * x + y * y + z * z);
    const double r[3][3] = {{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                            {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                            {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
    double *to = sums;
    *to++ += weight;
    for (int k = 0; k < 3; k++)
        *to++ += weight * g->position[k];
    for (int k = 0; k < 3; k++)
        *to++ += weight * g->dc[k];
    for (int k = 0; k < 45; k++)
        *to++ += weight * g->sh[k];
    for (int k = 0; k < 6; k++) {
        double covariance = (double)g->position[rows[k]] * g->position[columns[k]];
        for (int axis = 0; axis < 3; axis++)
            covariance += r[rows[k]][axis] * r[columns[k]][axis] * exp(2 * (double)g->scale[axis]);
        *to++ += weight * covariance;
    }
}

static void moments(void)
{
    double before[SUMS] = {0}, after[SUMS] = {0};
    make();
    for (int i = 0; i < COUNT; i++)
        add_moments(before, &made[i]);
    if (!open_made(COUNT))
        return;
    CHECK(fxs_scene_file_decimate(file, COUNT / 4, &info, NULL, &message) == 0);
    const long left = read_left();
    for (long i = 0; i < left; i++)
        add_moments(after, &got[i]);
    for (int k = 0; k < SUMS; k++)
        CHECK(fabs(after[k] - before[k]) <= 1e-4 * (fabs(before[k]) + before[0]));
    fxs_scene_file_close(file);
}

static void alike_first(void)
{
    make();
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            made[i].position[k] = (float)(i < 2 ? 0 : 3 * i);
    made[1] = made[0];
    if (!open_made(4))
        return;
    CHECK(fxs_scene_file_decimate(file, 3, &info, NULL, &message) == 0 && read_left() == 3);
    CHECK(!memcmp(&got[1], &made[2], 2 * sizeof *made));
    CHECK(is_near(opacity_of(&got[0]), 2 * opacity_of(&made[0]), 1e-5));
    for (int k = 0; k < 3; k++)
        CHECK(is_near((double)got[0].dc[k], (double)made[0].dc[k], 1e-6));
    fxs_scene_file_close(file);
}

/* Merges opaque Gaussians. A merged opacity is at most 0.99, or the largest source opacity if that is more. */
static void opaque(void)
{
    for (int clear = 0; clear < 2; clear++) {
        make();
        made[1] = made[0];
        made[0].opacity = 3;
        made[1].opacity = clear ? 4 : 20;
        if (!open_made(2))
            return;
        CHECK(fxs_scene_file_decimate(file, 1, &info, NULL, &message) == 0 && read_left() == 1);
        CHECK(fabs(opacity_of(&got[0]) - (clear ? 0.99 : 1)) < 1e-5);
        fxs_scene_file_close(file);
    }
}

static int stop_at_once(void *calls, double done)
{
    ++*(int *)calls;
    return done < 1;
}

static void faulty(void)
{
    int calls = 0;
    make();
    if (!open_made(COUNT))
        return;
    CHECK(fxs_scene_file_decimate(file, 0, &info, NULL, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_scene_file_decimate(file, 1, &info, &(fxs_progress){stop_at_once, &calls}, &message) == FXS_ERR_STOPPED &&
          calls == 1);
    fxs_scene_file_close(file);
}

int main(void)
{
    RUN(counts);
    RUN(all_stay);
    RUN(moments);
    RUN(alike_first);
    RUN(opaque);
    RUN(faulty);
    return check_report();
}
