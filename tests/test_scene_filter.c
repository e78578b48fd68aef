/* Tests filtered scene files: the remaining Gaussians, their count before reading, and packing through a filter. */
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include "scene_writer.h"
#include "scene_bytes.h"

enum { COUNT = 1000 };

static fxs_gaussian made[COUNT];
static fxs_scene_filter filter;
static fxs_scene_filter_report report;
static fxs_scene_file *file;

static int write_made(int sh_degree)
{
    fxs_scene_writer *writer;
    if (open_writer("ply", written, COUNT, sh_degree, 0, &writer, &message) ||
        fxs_scene_writer_put(writer, made, COUNT, &message) || close_writer(writer, &message))
        return 0;
    take_written();
    return 1;
}

/* Makes test Gaussians. Gaussian i lies at (i, i % 10, -i). The logit of its opacity is (i % 20) - 10. */
static void make(void)
{
    memset(made, 0, sizeof made);
    for (int i = 0; i < COUNT; i++) {
        fxs_gaussian *g = &made[i];
        g->position[0] = (float)i;
        g->position[1] = (float)(i % 10);
        g->position[2] = (float)-i;
        g->rotation[0] = 1;
        g->opacity = (float)(i % 20 - 10);
        for (int k = 0; k < 45; k++)
            g->sh[k] = (float)(i + k) / 2000;
    }
    fxs_scene_filter_init(&filter);
    CHECK(write_made(3));
}

static int open_filtered(void)
{
    if (!CHECK(fxs_scene_file_open_memory(path, bytes, file_size, NULL, &file, &info, &message) == 0))
        return -1;
    int result = fxs_scene_file_filter(file, &filter, &info, &report, NULL, &message);
    if (result)
        fxs_scene_file_close(file);
    return result;
}

/* Reads the filtered scene file twice, `step` Gaussians in each call. Returns the number of Gaussians. */
static long read_left(fxs_gaussian *out, long step)
{
    long total = 0, n = step;
    for (int again = 0; again < 2; again++) {
        for (total = 0; n == step; total += n) {
            n = fxs_scene_file_read(file, out + total, (size_t)step, &message);
            if (!CHECK(n >= 0 && (uint64_t)(total + n) <= info.count))
                return -1;
        }
        CHECK(fxs_scene_file_read(file, out, 1, &message) == 0);
        CHECK(fxs_scene_file_rewind(file, &message) == 0);
        n = step;
    }
    return total;
}

static void check_left(int (*left)(int i))
{
    static fxs_gaussian out[COUNT + COUNT];
    for (long step = 1; step <= COUNT; step = 7 * step + 1) {
        uint64_t expected = 0;
        if (!CHECK(open_filtered() == 0))
            return;
        CHECK((uint64_t)read_left(out, step) == info.count);
        for (int i = 0; i < COUNT; i++)
            if (left(i))
                CHECK(memcmp(&out[expected++], &made[i], sizeof *made) == 0);
        CHECK(expected == info.count && report.kept == expected && report.read == COUNT);
        fxs_scene_file_close(file);
    }
}

static int any(int i)
{
    return i >= 0;
}

static void all_pass(void)
{
    make();
    check_left(any);
    CHECK(info.sh_degree == 3 && report.outside == 0 && report.faint == 0);
}

static int in_box(int i)
{
    return i >= 100 && i <= 300 && i % 10 >= 3;
}

static void box(void)
{
    make();
    const double low[3] = {100, 3, -300}, high[3] = {500, 9, 0};
    memcpy(filter.low, low, sizeof low);
    memcpy(filter.high, high, sizeof high);
    check_left(in_box);
    CHECK(report.outside == COUNT - 140 && report.faint == 0);
}

static int in_sphere(int i)
{
    const int y = i % 10 - 4;
    return (i - 200) * (i - 200) + y * y + (i - 200) * (i - 200) <= 50 * 50;
}

static void sphere(void)
{
    make();
    const double middle[3] = {200, 4, -200};
    memcpy(filter.middle, middle, sizeof middle);
    filter.radius = 50;
    check_left(in_sphere);
    filter.high[0] = 100;
    CHECK(open_filtered() == FXS_ERR_FILE && report.outside == COUNT);
}

static int level(int i)
{
    const float *s = made[i].scale;
    return (int)ceil(fmax(fmax(s[0], s[1]), s[2]) / log(2) + 2);
}

static int compare_levels(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* True if Gaussian i is no floater: it has enough neighbours near the point `sigmas` times sigma along its
   longest axis. */
static int has_neighbours(int i, double width, int sigmas)
{
    const float *s = made[i].scale;
    const int longest = s[0] >= s[1] && s[0] >= s[2] ? 0 : s[1] >= s[2] ? 1 : 2;
    const int along = i % 2 && longest < 2 ? 1 - longest : longest;
    int near = 0;
    for (int k = 0; k < COUNT; k++) {
        int beside = 1;
        for (int a = 0; a < 3; a++) {
            const double x = made[i].position[a] + (a == along ? sigmas * exp(s[longest]) : 0);
            beside &= fabs(floor(made[k].position[a] / width) - floor(x / width)) <= 1;
        }
        near += beside;
    }
    return near > FXS_FLOATER_NEIGHBOURS;
}

static int stays(int i)
{
    static int levels[COUNT], known = 0;
    const int is_opaque = made[i].opacity > 2.1972246;
    if (!known)
        for (int k = 0; k < COUNT; k++)
            levels[k] = level(k);
    if (!known++)
        qsort(levels, COUNT, sizeof *levels, compare_levels);
    const int median = levels[COUNT / 2], own = level(i) > median ? level(i) : median;
    const int most = filter.floaters == 1 || (filter.floaters < 4 && is_opaque) ? own : median + (filter.floaters == 2);
    const double width = ldexp(1, own < most ? own : most);
    return has_neighbours(i, width, 0) &&
           (filter.floaters < 5 || (has_neighbours(i, width, 1) && has_neighbours(i, width, -1)));
}

static void floaters(void)
{
    uint32_t state = 3;
    int before = COUNT;
    make();
    for (int i = 0; i < COUNT; i++) {
        made[i].rotation[0] = made[i].rotation[3] = 2;
        made[i].rotation[3] *= (float)(i % 2);
        for (int k = 0; k < 3; k++) {
            state = state * 1664525 + 1013904223;
            const double t = (double)(state >> 8) / 16777216 - 0.5;
            made[i].position[k] = (float)(400 * t * t * t);
            const double u = (double)((state = state * 1664525 + 1013904223) >> 8) / 16777216;
            made[i].scale[k] = (float)(7 * u * u * u - 4);
        }
    }
    CHECK(write_made(3));
    for (filter.floaters = 1; filter.floaters <= FXS_FLOATER_STRENGTHS; filter.floaters++) {
        int left = 0;
        check_left(stays);
        for (int i = 0; i < COUNT; i++)
            left += stays(i);
        CHECK(report.floaters == (uint64_t)(COUNT - left));
        CHECK(left > COUNT / 10 && left < before);
        before = left;
    }
    for (int i = 0; i < 2; i++) {
        filter.floaters = i ? -1 : FXS_FLOATER_STRENGTHS + 1;
        CHECK(open_filtered() == FXS_ERR_ARGUMENT && strstr(message.text, "strength"));
    }
}

/* Tests the floater filter. In a heap of 8 Gaussians each has 7 neighbours, in a heap of 9 each has 8. A
   Gaussian with NaN is no floater. */
static void floaters_of_what_is_left(void)
{
    for (int count = 8; count <= 9; count++) {
        make();
        for (int i = 0; i < count; i++)
            memset(made[i].position, 0, sizeof made[i].position);
        made[0].position[1] = NAN;
        CHECK(write_made(3));
        filter.floaters = filter.drawable = 1;
        filter.high[0] = 0.5;
        const int result = open_filtered();
        CHECK(result == FXS_ERR_FILE && report.floaters == (uint64_t)count - 1);
        CHECK(strstr(message.text, "none of the 1000 Gaussians"));
        made[0].position[1] = 0;
        CHECK(write_made(3));
        CHECK(open_filtered() == (count == 9 ? 0 : FXS_ERR_FILE));
        if (count == 9) {
            CHECK(info.count == 9 && report.floaters == 0);
            fxs_scene_file_close(file);
        }
    }
}

static int is_first_or_last(int i)
{
    return i < 2 || i >= COUNT - 5;
}

static void shapes(void)
{
    fxs_filter_shape of[] = {{FXS_FILTER_BOX, {0, 0, -1, 1, 1, 0}},
                             {FXS_FILTER_BOX, {COUNT - 5, 0, -COUNT, COUNT, 9, 0}}};
    make();
    filter.shapes = of;
    filter.shape_count = 2;
    check_left(is_first_or_last);
    filter.low[0] = COUNT - 5;
    CHECK(open_filtered() == 0 && info.count == 5);
    fxs_scene_file_close(file);
    of[1].kind = FXS_FILTER_KINDS;
    CHECK(open_filtered() == FXS_ERR_ARGUMENT && strstr(message.text, "shape 1"));
}

static int is_half(int i)
{
    return i % 20 >= 10;
}

static void opacity(void)
{
    make();
    filter.opacity = 0.5;
    check_left(is_half);
    CHECK(report.faint == COUNT / 2);
    filter.opacity = 0;
    check_left(any);
}

static void sh_degrees(void)
{
    fxs_gaussian out[2];
    make();
    for (int degree = 0; degree <= 3; degree++) {
        const int coefficients = 3 * degree * (degree + 2);
        filter.sh_degree = degree;
        if (!CHECK(open_filtered() == 0))
            return;
        CHECK(info.sh_degree == degree && info.count == COUNT);
        CHECK(fxs_scene_file_read(file, out, 2, &message) == 2);
        for (int k = 0; k < 45; k++)
            CHECK(out[1].sh[k] == (k < coefficients ? made[1].sh[k] : 0));
        fxs_scene_file_close(file);
    }
    for (filter.sh_degree = -1; filter.sh_degree <= 4; filter.sh_degree += 5)
        CHECK(open_filtered() == FXS_ERR_ARGUMENT && strstr(message.text, "not 0 to 3"));
    CHECK(write_made(1));
    filter.sh_degree = 2;
    CHECK(open_filtered() == 0 && info.sh_degree == 1);
    fxs_scene_file_close(file);
}

static int is_drawable(int i)
{
    return i > 6;
}

static void make_undrawable(void)
{
    make();
    made[0].position[1] = NAN;
    made[1].opacity = NAN;
    made[2].sh[2] = INFINITY;
    made[3].rotation[0] = 0;
    memset(made[4].rotation, 0, sizeof made[4].rotation);
    made[5].opacity = -INFINITY;
    made[6].position[0] = -INFINITY;
    made[7].opacity = INFINITY;
    CHECK(write_made(3));
    made[7].opacity = 20;                /* replaces the infinite logit by 20, which counts as opaque */
}

static void undrawable(void)
{
    make_undrawable();
    check_left(any);
    filter.drawable = 1;
    check_left(is_drawable);
    CHECK(report.dropped.not_finite == 4 && report.dropped.rotation == 2 && report.dropped.transparent == 1);
    filter.sh_degree = 0;   /* with SH degree 0, a Gaussian with an infinite SH coefficient is valid */
    CHECK(open_filtered() == 0 && info.count == COUNT - 6);
    fxs_scene_file_close(file);
}

static void undrawable_in_a_box(void)
{
    make_undrawable();
    filter.drawable = 1;
    filter.low[0] = 1;
    filter.high[0] = 99;
    filter.opacity = 0.5;
    CHECK(open_filtered() == 0);
    CHECK(report.outside == COUNT - 99 + 1 && report.dropped.not_finite == 1 && info.count == report.kept);
    CHECK(report.dropped.transparent == 0 && report.kept + report.outside + report.faint + 1 == COUNT);
    fxs_scene_file_close(file);
}

static void nothing_left(void)
{
    make();
    filter.low[0] = 2 * COUNT;
    CHECK(open_filtered() == FXS_ERR_FILE && strstr(message.text, "none of the 1000 Gaussians is left"));
    for (int i = 0; i < COUNT; i++)
        made[i].scale[0] = NAN;
    CHECK(write_made(3));
    fxs_scene_filter_init(&filter);
    filter.drawable = 1;
    CHECK(open_filtered() == FXS_ERR_FILE && strstr(message.text, "none of the 1000 Gaussians can be drawn"));
}

static void packed(void)
{
    static fxs_gaussian out[COUNT];
    fxs_packed_scene scenes[2];
    fxs_pack_report reports[2];
    make_undrawable();
    filter.opacity = 0.5;
    filter.high[0] = 700;
    filter.sh_degree = 2;
    for (int k = 0; k < 2; k++) {
        if (!CHECK(open_filtered() == 0))
            return;
        CHECK(fxs_pack(file, &info, &scenes[k], &reports[k], NULL, &message) == 0);
        if (k == 0) {
            fxs_scene_writer *writer;
            CHECK(fxs_scene_file_rewind(file, &message) == 0 && read_left(out, COUNT) == (long)info.count);
            CHECK(open_writer("ply", written, info.count, 2, 0, &writer, &message) == 0);
            CHECK(fxs_scene_writer_put(writer, out, info.count, &message) == 0);
            CHECK(close_writer(writer, &message) == 0);
            fxs_scene_filter_init(&filter);
        }
        fxs_scene_file_close(file);
        take_written();
    }
    CHECK(scenes[0].bytes == scenes[1].bytes && memcmp(scenes[0].data, scenes[1].data, scenes[0].bytes) == 0);
    CHECK(reports[0].read == reports[1].read && reports[0].packed == reports[1].packed);
    fxs_packed_scene_free(&scenes[0]);
    fxs_packed_scene_free(&scenes[1]);
}

static int stop_at_half(void *last, double done)
{
    CHECK(done > *(double *)last && done <= 1);
    *(double *)last = done;
    return done >= 0.5;
}

static void progress(void)
{
    double last = 0;
    make();
    filter.high[0] = 10;
    if (!CHECK(fxs_scene_file_open_memory(path, bytes, file_size, NULL, &file, &info, &message) == 0))
        return;
    CHECK(fxs_scene_file_filter(file, &filter, &info, &report, &(fxs_progress){stop_at_half, &last},
                                &message) == FXS_ERR_STOPPED);
    CHECK(last >= 0.5);
    fxs_scene_file_close(file);
}

static void damaged(void)
{
    size = 0;
    put("ply\nformat ascii 1.0\nelement vertex 600\n");
    for (int i = 0; i < 14; i++)
        put("property float %s\n", (const char *[]){"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
            "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}[i]);
    put("end_header\n");
    for (int i = 0; i < 600; i++)
        put("%s 0 0 0 0 0 0 0 0 0 1 0 0 0\n", i == 500 ? "x" : "1");
    put_file(size);
    fxs_scene_filter_init(&filter);
    CHECK(open_filtered() == FXS_ERR_FILE && strncmp(message.text, path, strlen(path)) == 0);
}

enum { BALL = 6000, GROUND = 6000, HAZE = 500 };

/* Makes a ball of radius 1 on a ground of flat discs, under large faint Gaussians. The ground is tilted: up is
   (0, -0.96, 0.28). */
static long read_ball(void *first, uint64_t at, fxs_gaussian *out, size_t capacity)
{
    uint64_t seed = 0;
    for (size_t k = 0; k < capacity; k++) {
        const uint64_t i = at + k + *(const uint64_t *)first;
        double place[3], square = 0;
        seed = (i + 1) * 0x9e3779b97f4a7c15u;
        for (int axis = 0; axis < 3; axis++) {
            seed = (seed ^ seed >> 29) * 0xbf58476d1ce4e5b9u;
            place[axis] = (double)(seed >> 11) / 0x1p52 - 1;
            square += place[axis] * place[axis];
        }
        const double reach = i < BALL ? 1 / sqrt(square) : 6;
        const double x = reach * place[0], z = reach * place[2];
        const double y = i < BALL ? reach * place[1] : i < BALL + GROUND ? 1 : -3 * fabs(place[1]);
        const float sigma = i < BALL ? -3.5f : i < BALL + GROUND ? -2 : 0;
        out[k] = (fxs_gaussian){.position = {(float)x, (float)(0.96 * y + 0.28 * z), (float)(0.96 * z - 0.28 * y)},
                                .scale = {sigma, i < BALL + GROUND && i >= BALL ? sigma - 3 : sigma, sigma},
                                .rotation = {0.98994949f, -0.14142136f, 0, 0},
                                .opacity = i < BALL + GROUND ? 3 : -3};
        seed = 0;
    }
    return (long)capacity;
}

static int open_ball(uint64_t first, int thing)
{
    static uint64_t begin;
    const fxs_gaussian_source source = {BALL + GROUND + HAZE - first, 0, 0, read_ball, &begin, {0}};
    begin = first;
    fxs_scene_filter_init(&filter);
    filter.thing = thing;
    if (!CHECK(fxs_scene_file_open_gaussians("ball", &source, NULL, &file, &info, &message) == 0))
        return -1;
    const int result = fxs_scene_file_filter(file, &filter, &info, &report, NULL, &message);
    if (result)
        fxs_scene_file_close(file);
    return result;
}

/* Tests that the thing is the ball without its foot, the ground and the haze. The ground corrects the up direction. */
static void thing(void)
{
    static fxs_gaussian out[BALL + GROUND + HAZE];
    for (int how = 1; how <= 2; how++) {
        if (!CHECK(open_ball(0, how) == 0))
            return;
        long n = 0, ball = 0;
        for (long got; (got = fxs_scene_file_read(file, out + n, 256, &message)) > 0;)
            n += got;
        for (long i = 0; i < n; i++)
            ball += out[i].scale[0] == -3.5f;
        CHECK(n == (long)info.count && n == 5726 && ball == n);
        const double *up = info.start.up;
        CHECK(how == 1 ? up[1] == 0 : fabs(up[0]) < 0.01 && fabs(up[1] + 0.96) < 0.01 && fabs(up[2] - 0.28) < 0.02);
        fxs_scene_file_close(file);
    }
    CHECK(open_ball(BALL + GROUND, 1) == FXS_ERR_ARGUMENT && strstr(message.text, "no thing stands out"));
}

int main(void)
{
    make_written();
    RUN(all_pass);
    RUN(box);
    RUN(sphere);
    RUN(floaters);
    RUN(shapes);
    RUN(floaters_of_what_is_left);
    RUN(thing);
    RUN(opacity);
    RUN(sh_degrees);
    RUN(undrawable);
    RUN(undrawable_in_a_box);
    RUN(nothing_left);
    RUN(packed);
    RUN(progress);
    RUN(damaged);
    unlink(written);
    return check_report();
}
