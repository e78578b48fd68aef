/* Sequences of frames: tracks against the frames that they were made from, in order and shuffled, and numbered files.
 */
#include <math.h>
#include <string.h>

#include <fixsplat/scene.h>
#include "check.h"
#include "folder.h"
#include "uniform.h"
#include "src/scene/sequence.h"

enum { STILL = 300, MOVING = 100, COUNT = STILL + MOVING, FRAMES = 75 };

static const double rate = 25;
/* Gaussian i in a frame. Those from STILL on move on ellipses and roll; number COUNT - 1 jumps in the middle. */
static fxs_gaussian gaussian_of(uint32_t i, uint32_t frame)
{
    fxs_gaussian g;
    memset(&g, 0, sizeof g);
    state = i + 1;
    for (int k = 0; k < 3; k++) {
        g.position[k] = (float)uniform(-2, 2);
        g.scale[k] = (float)(k == 0 ? uniform(-2, -1.5) : uniform(-3, -2));
        g.dc[k] = (float)uniform(-1, 1);
    }
    g.opacity = (float)uniform(0, 3);
    g.rotation[0] = 1;
    if (i < STILL)
        return g;
    const double t = frame / rate, a = uniform(1, 3) * t, roll = uniform(-2, 2) * t;
    g.position[0] += (float)(0.7 * cos(a));
    g.position[1] += (float)(0.4 * sin(a));
    g.rotation[0] = (float)cos(roll / 2);
    g.rotation[3] = (float)sin(roll / 2);
    if (i == COUNT - 1 && frame >= FRAMES / 2)
        g.position[2] += 5;
    return g;
}

static fxs_sequence *make_sequence(int shuffled, fxs_time *time)
{
    fxs_sequence *s = fxs_sequence_create(FRAMES, rate, 0, 0);
    int error = 0;
    for (uint32_t f = 0; f < FRAMES; f++) {
        for (uint32_t i = 0; i < COUNT; i++) {
            const fxs_gaussian g = gaussian_of(shuffled ? (i * 7 + f * 131) % COUNT : i, f);
            error |= fxs_sequence_put(s, &g);
        }
        error |= fxs_sequence_next(s);
    }
    CHECK(!error && !fxs_sequence_finish(s, time));
    return s;
}

static double distance(const fxs_gaussian *a, const fxs_gaussian *b)
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += ((double)a->position[k] - b->position[k]) * ((double)a->position[k] - b->position[k]);
    return sqrt(sum);
}

static double angle_between(const fxs_gaussian *a, const fxs_gaussian *b)
{
    double dot = 0, aa = 0, bb = 0;
    for (int k = 0; k < 4; k++) {
        dot += (double)a->rotation[k] * b->rotation[k];
        aa += (double)a->rotation[k] * a->rotation[k];
        bb += (double)b->rotation[k] * b->rotation[k];
    }
    return 2 * acos(fmin(1, fabs(dot) / sqrt(aa * bb)));
}

/* Finds the nearest Gaussian of the true frame, and checks that every one is found once. */
static void check_frame(const fxs_gaussian *now, uint32_t count, uint32_t f, double far, double angle)
{
    uint8_t seen[COUNT] = {0};
    if (!CHECK(count == COUNT))
        return;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t nearest = 0;
        fxs_gaussian truth, best = gaussian_of(0, f);
        for (uint32_t k = 1; k < COUNT; k++) {
            truth = gaussian_of(k, f);
            if (distance(&truth, &now[i]) < distance(&best, &now[i])) {
                best = truth;
                nearest = k;
            }
        }
        if (!CHECK(!seen[nearest]++ && distance(&best, &now[i]) <= far && angle_between(&best, &now[i]) <= angle))
            return;
    }
}

static void frames_come_back(int shuffled, double far, double angle, uint64_t most_tracks)
{
    fxs_time time;
    fxs_sequence *s = make_sequence(shuffled, &time);
    const uint64_t count = fxs_sequence_count(s);
    fxs_gaussian *gaussians = calloc((size_t)count, sizeof *gaussians), *now = calloc((size_t)count, sizeof *now);
    fxs_motion *motions = calloc((size_t)count, sizeof *motions);
    fxs_sequence_get(s, 0, (size_t)count, gaussians, motions);
    printf("  %llu tracks of %d Gaussians in %d frames\n", (unsigned long long)count, COUNT, FRAMES);
    CHECK(count <= most_tracks && fabs(time.duration - FRAMES / rate) < 1e-9 && time.rate == rate);
    for (uint32_t f = 0; f < FRAMES; f += 6) {
        uint32_t alive = 0;
        for (uint64_t i = 0; i < count; i++) {
            now[alive] = gaussians[i];
            alive += (uint32_t)fxs_gaussian_at(&now[alive], &motions[i], &time, (f + 0.001) / rate);
        }
        check_frame(now, alive, f, far, angle);
    }
    free(gaussians);
    free(now);
    free(motions);
    fxs_sequence_free(s);
}

static void tracks_in_order(void)
{
    frames_come_back(0, 0.05, 0.16, STILL + 12 * MOVING);
}

/* Shuffled frames are exact: nothing is fitted. */
static void tracks_in_any_order(void)
{
    frames_come_back(1, 1e-6, 1e-3, STILL + (uint64_t)MOVING * FRAMES);
}

/* ---- Numbered files ---------------------------------------------------------------------------------------------- */

static fxs_message message;

static void write_file(const char *name, uint32_t frame, uint32_t count)
{
    char path[128];
    fxs_scene_write_options options = {.size = sizeof options, .count = count};
    fxs_scene_writer *writer;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (!CHECK(!fxs_scene_writer_open(path, &options, &writer, &message)))
        return;
    for (uint32_t i = 0; i < count; i++) {
        const fxs_gaussian g = gaussian_of(i, frame);
        fxs_scene_writer_put(writer, &g, 1, &message);
    }
    CHECK(!fxs_scene_writer_close(writer, 0, 0, &message));
}

/* Opens the folder, or a path in it. Returns an error, or the number of Gaussians. */
static long open_folder(const char *name, fxs_scene_file_info *info)
{
    char path[128];
    fxs_scene_file *file;
    snprintf(path, sizeof path, "%s%s", folder, name);
    const int error = fxs_scene_file_open(path, 0, &file, info, &message);
    fxs_scene_file_close(error ? 0 : file);
    return error ? error : (long)info->count;
}

static int says(long error, const char *words)
{
    const int right = error == FXS_ERR_FILE && strstr(message.text, words) != 0 && !strchr(message.text, '\n');
    if (!right)
        printf("  %s\n", message.text);
    return right;
}

static void numbered_files(void)
{
    fxs_scene_file_info info;
    for (uint32_t f = 8; f < 12; f++) {
        char name[32];
        snprintf(name, sizeof name, "f_%u.ply", f);      /* 8 to 11: sorted by number, not by name */
        write_file(name, f, COUNT);
    }
    CHECK(open_folder("", &info) > 0 && info.time.duration == 4 / 30.0 && info.time.rate == 30);
    CHECK(open_folder("/f_*.ply", &info) > 0 && info.time.duration == 4 / 30.0);
    write_file("f_13.ply", 13, COUNT);
    CHECK(says(open_folder("", &info), "no frame 12 between f_11.ply and f_13.ply"));
    write_file("f_12.ply", 12, COUNT / 2);               /* another count */
    CHECK(open_folder("", &info) > 0 && info.time.duration == 6 / 30.0);
    write_file("f_012.ply", 12, 10);
    CHECK(says(open_folder("", &info), "two frames have the number 12"));
    write_file("other1.ply", 1, 10);
    CHECK(says(open_folder("", &info), "several names or endings"));
    CHECK(says(open_folder("/g*.ply", &info), "no numbered scene files"));
    CHECK(says(open_folder("/f_*.splat", &info), "no numbered scene files"));
}

static void tests(void)
{
    RUN(tracks_in_order);
    RUN(tracks_in_any_order);
    RUN(numbered_files);
}

int main(void)
{
    return in_a_folder(tests);
}
