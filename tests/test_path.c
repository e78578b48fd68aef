/* Tests paths of a camera through random keys: even speed, gentle starts and ends, closed and returning paths. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "src/camera/path.h"
#include "check.h"

enum { KEYS = 12, FRAMES_MOST = 400 };
static const double up[3] = {0, -1, 0};
static fxs_message message;
static uint32_t state;

static double random_from(double low, double high)
{
    state = state * 1664525u + 1013904223u;
    return low + (high - low) * (double)(state >> 8) / 16777216.0;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Makes keys that lie near to and far from each other. */
static int make_keys(fxs_view keys[KEYS])
{
    double eye[3] = {0, 0, -6};
    for (int i = 0; i < KEYS; i++) {
        const double far = random_from(0, 1) < 0.5 ? 0.05 : 4;
        const double middle[3] = {random_from(-1, 1), random_from(-1, 1), random_from(-1, 1)};
        for (int k = 0; k < 3; k++)
            eye[k] += random_from(-far, far);
        if (fxs_view_look_at(&keys[i], eye, middle, up, &(fxs_picture){random_from(30, 60), 64, 48}, &message))
            return 0;
        keys[i].near = 0.2;
    }
    return 1;
}

/* Computes the steps between the frames of a path: the first, the last, the median and the largest. */
static int measure(const fxs_path *path, double unit, double *first, double *last, double *median, double *most)
{
    fxs_view before, view;
    double steps[FRAMES_MOST];
    for (long i = 0; i < path->frames; i++) {
        if (fxs_path_view(path, (double)i, &view, &message))
            return 0;
        if (i)
            steps[i - 1] = fxs_path_step(&before, &view, unit);
        before = view;
    }
    *first = steps[0];
    *last = steps[path->frames - 2];
    qsort(steps, (size_t)path->frames - 1, sizeof *steps, ascending);
    *median = steps[(path->frames - 1) / 2];
    *most = steps[path->frames - 2];
    return 1;
}

static void speed_is_even(void)
{
    for (state = 1; state < 2000000000; state += 40000003) {
        fxs_view keys[KEYS], view;
        fxs_path path;
        double first, last, median, most;
        const double unit = random_from(0.5, 20);
        const long frames = (long)random_from(60, FRAMES_MOST);
        const uint32_t before = state;
        if (!CHECK(make_keys(keys)) || !CHECK(!fxs_path_of_views(&path, keys, KEYS, &message)))
            return;
        path.timed = before % 2;                 /* the path of a camera whose keys have uneven times, or none */
        for (int i = 0; i < KEYS && path.timed; i++)
            path.end = path.keys[i].at = i * i + random_from(0, 0.9);
        path.keys[0].at = 0;
        if (CHECK(!fxs_path_even(&path, unit, frames, (double)frames / 30, &message)) &&
            CHECK(measure(&path, unit, &first, &last, &median, &most))) {
            CHECK(most <= 1.5 * median && first < median / 2 && last < median / 2);
            CHECK(!fxs_path_view(&path, 0, &view, &message) && fxs_path_step(&view, &keys[0], unit) < 1e-6);
            CHECK(!fxs_path_view(&path, (double)frames - 1, &view, &message));
            CHECK(fxs_path_step(&view, &keys[KEYS - 1], unit) < 1e-6);
        }
        fxs_path_free(&path);
        state = before;
    }
}

static int read_text(fxs_path *path, const char *name, const char *text)
{
    FILE *file = fopen(name, "w");
    if (!file || fputs(text, file) < 0 || fclose(file))
        return 0;
    const int read = fxs_path_read(path, name, NULL, up, &message);
    remove(name);
    path->frame.width = 64;
    path->frame.height = 48;
    return read == 1;
}

static void round_and_back(void)
{
    char folder[] = "/tmp/fixsplat-path-XXXXXX", name[64];
    double first, last, median, most;
    fxs_view a, b;
    fxs_path path;
    if (!mkdtemp(folder))
        SKIP("no temporary folder");
    snprintf(name, sizeof name, "%s/track.json", folder);
    const char *const loops[] = {"repeat", "pingpong"};
    for (int i = 0; i < 2; i++) {
        char text[600];
        snprintf(text, sizeof text, "{\"fixsplat\":1,\"tracks\":[{\"loop\":\"%s\",\"duration\":4,\"keys\":["
                 "{\"time\":0,\"eye\":[0,0,-6],\"look\":[0,0,0],\"fov\":40},"
                 "{\"time\":1,\"eye\":[5,0,0],\"look\":[0,0,0],\"fov\":40},"
                 "{\"time\":3,\"eye\":[-4,0,3],\"look\":[0,0,0],\"fov\":40}]}]}", loops[i]);
        if (!CHECK(read_text(&path, name, text)))
            continue;
        path.rate = 10;
        CHECK(!fxs_path_view(&path, i ? 70 : 10, &b, &message) && !fxs_path_view(&path, 10, &a, &message));
        CHECK(fxs_path_step(&a, &b, 1) < 1e-9);
        CHECK(!fxs_path_even(&path, 1, 200, 4, &message));
        CHECK(measure(&path, 1, &first, &last, &median, &most) && most <= 1.5 * median);
        CHECK(i ? first < median / 2 : first > median / 2);      /* only an open path starts gently */
        CHECK(!fxs_path_view(&path, 0, &a, &message) && !fxs_path_view(&path, i ? 199 : 200, &b, &message));
        CHECK(fxs_path_step(&a, &b, 1) < 1e-6);
        fxs_path_free(&path);
    }
    rmdir(folder);
}

int main(void)
{
    RUN(speed_is_even);
    RUN(round_and_back);
    return check_report();
}
