/* Writes moving Gaussians to .splat4d, decodes the files by the words of FORMAT.md, and compares every frame with the
   formulas of scene.h. Reads them with the reader, too. */
#include "moving_bytes.h"

#ifdef FXS_WITH_ZSTD

#include <zstd.h>

enum { COUNT = 300, FRAMES_MOST = 100, MOST = 64 * COUNT };
enum { POSITION, ROTATION, COLOUR, OPACITY, SCALE, ATTRIBUTES };

static const int channels[ATTRIBUTES] = {3, 4, 3, 1, 3}, places[ATTRIBUTES] = {0, 3, 7, 10, 11};

static fxs_gaussian gaussians[COUNT], got[MOST];
static fxs_motion motions[COUNT], got_motions[MOST];
static fxs_time clip;
static double origin[3];
static uint32_t state;

/* ---- Gaussians --------------------------------------------------------------------------------------------------- */

static double uniform(double low, double high)
{
    state = state * 1664525 + 1013904223;
    return low + (high - low) * (state >> 8) / 16777216.0;
}

/* Gaussian i has a colour of its own. Bits of i tell whether it moves, turns, fades and has a window. */
static void make(double duration, double rate)
{
    clip = (fxs_time){.duration = duration, .rate = rate, .loops = 1, .degree = 3, .turns = 1, .fades = 1};
    state = 1;
    memset(gaussians, 0, sizeof gaussians);
    memset(motions, 0, sizeof motions);
    for (int i = 0; i < COUNT; i++) {
        fxs_gaussian *g = &gaussians[i];
        fxs_motion *m = &motions[i];
        const double from = uniform(-0.2, 0.8) * duration;
        for (int k = 0; k < 3; k++) {
            g->position[k] = (float)uniform(-2, 2);
            g->scale[k] = (float)uniform(-4, -2);
            g->dc[k] = (float)(((k == 0 ? i & 15 : k == 1 ? i >> 4 & 15 : i >> 8) * 16 / 255.0 - 0.5) /
                               0.28209479177387814);
            for (int n = 0; n < 3; n++)
                m->drift[n][k] = i & 1 ? (float)uniform(-1, 1) : 0;
        }
        for (int k = 0; k < 4; k++) {
            g->rotation[k] = (float)uniform(-1, 1);
            m->turn[k] = i & 2 ? (float)uniform(-0.5, 0.5) : 0;
        }
        g->opacity = (float)uniform(-1, 5);
        m->centre = (float)uniform(0, duration);
        m->fade = i & 4 ? (float)(duration * uniform(0.1, 2)) : INFINITY;
        m->from = i & 8 ? (float)from : -INFINITY;
        m->to = i & 8 ? (float)(from + uniform(0.1, 1) * duration) : INFINITY;
    }
}

static int write_to(const char *to, int count)
{
    fxs_scene_writer *w;
    fxs_scene_write_options o = {.size = sizeof o, .count = COUNT, .sh_degree = 1, .format = "splat4d", .time = clip};
    fxs_scene_write_report report;
    memcpy(o.origin, origin, sizeof origin);
    int error = fxs_scene_writer_open(to, &o, &w, &message);
    for (int i = 0; i < count && !error; i += 7)
        error = fxs_scene_writer_put_moving(w, gaussians + i, motions + i, (size_t)(count - i < 7 ? count - i : 7),
                                            &message);
    const int closed = error ? 0 : fxs_scene_writer_close(w, &report, NULL, &message);
    CHECK(error || closed || (report.lost_sh == 1 && !report.lost_antialiased));
    return error ? error : closed;
}

static int write_file(void)
{
    const int error = write_to(written, COUNT);
    take_written();
    return error;
}

/* ---- Decoder ----------------------------------------------------------------------------------------------------- */

typedef struct decoded {
    int count, frames, is_still[ATTRIBUTES][COUNT];
    double rate, steps[ATTRIBUTES], base_steps[ATTRIBUTES];
    int base[COUNT][14];
    int frame[FRAMES_MOST][COUNT][14];
} decoded;

static decoded file;

static double number_after(const char *text, const char *name)
{
    const char *at = strstr(text, name);
    return CHECK(at != NULL) ? strtod(at + strlen(name), NULL) : 0;
}

static uint32_t u32_at(const uint8_t *from)
{
    return from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

/* Unpacks the stream of a head and returns its packed size. */
static size_t unpack(const uint8_t *head, const uint8_t *packed, int attribute, int kind, size_t count, uint32_t *to)
{
    static uint8_t planes[4 * FRAMES_MOST * COUNT * 4];
    const size_t width = head[2], length = u32_at(head + 7);
    CHECK(head[0] == attribute && head[1] == kind && (width == 1 || width == 2 || width == 4));
    CHECK(u32_at(head + 3) == count);
    CHECK(ZSTD_getFrameContentSize(packed, length) == count * width);
    CHECK(ZSTD_decompress(planes, sizeof planes, packed, length) == count * width);
    memset(to, 0, count * sizeof *to);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < width; k++)
            to[i] |= (uint32_t)planes[k * count + i] << 8 * k;
    return length;
}

static int unfolded(uint32_t number)
{
    return (int)(number >> 1 ^ (0 - (number & 1)));
}

static uint32_t stream[FRAMES_MOST * COUNT * 4];

static const uint8_t *decode_still(const uint8_t *at)
{
    static const int order[ATTRIBUTES] = {POSITION, SCALE, COLOUR, OPACITY, ROTATION};
    const size_t n = (size_t)file.count;
    for (int a = 0; a < ATTRIBUTES; a++) {
        at += 11 + unpack(at, at + 11, a, 2, (n + 7) / 8, stream);
        for (size_t i = 0; i < n; i++)
            file.is_still[a][i] = stream[i / 8] >> (7 - i % 8) & 1;
    }
    for (int s = 0; s < ATTRIBUTES; s++) {
        const int a = order[s], c = channels[a], sums = a == POSITION || a == SCALE;
        at += 11 + unpack(at, at + 11, a, 2, n * (size_t)c, stream);
        for (size_t i = 0; i < n; i++)
            for (int k = 0; k < c; k++) {
                const uint32_t number = stream[i * (size_t)c + (size_t)k];
                file.base[i][places[a] + k] = sums ? (i ? file.base[i - 1][places[a] + k] : 0) + unfolded(number)
                                                   : (int)number - (a == ROTATION ? 128 : 0);
            }
    }
    return at;
}

static void decode_group(const uint8_t *group, size_t length, int first, int end)
{
    const int streams = group[0] | group[1] << 8;
    const uint8_t *head = group + 2, *at = head + 11 * streams;
    for (int kind = 0; kind < 2; kind++)
        for (int a = 0; a < ATTRIBUTES; a++) {
            const int c = channels[a], from = kind ? first + 1 : first, to = kind ? end : first + 1;
            size_t changing = 0, next = 0;
            for (int i = 0; i < file.count; i++)
                changing += !file.is_still[a][i];
            if (!changing || from == to)
                continue;
            at += unpack(head, at, a, kind, changing * (size_t)c * (size_t)(to - from), stream);
            head += 11;
            for (int f = from; f < to; f++)
                for (int i = 0; i < file.count; i++)
                    for (int k = places[a]; k < places[a] + c && !file.is_still[a][i]; k++)
                        file.frame[f][i][k] = unfolded(stream[next++]) + (kind ? file.frame[f - 1][i][k] : 0);
        }
    CHECK(head == group + 2 + 11 * streams && at == group + length);
}

static void decode_header(const char *json)
{
    static const char *const names[ATTRIBUTES] = {"\"pos\":", "\"rot\":", "\"rgb\":", "\"alpha\":", "\"scale_log\":"};
    const char *steps = strstr(json, "\"steps\":");
    CHECK(steps != NULL);
    file.count = (int)number_after(json, "\"n\":");
    file.frames = (int)number_after(json, "\"t\":");
    file.rate = number_after(json, "\"fps\":");
    for (int a = 0; a < ATTRIBUTES && steps; a++) {
        file.steps[a] = number_after(steps, names[a]);
        file.base_steps[a] = 1;
    }
    file.base_steps[POSITION] = number_after(json, "\"base_pos\":");
    file.base_steps[SCALE] = number_after(json, "\"base_scale_log\":");
    CHECK(file.base_steps[SCALE] <= log(1.02) && file.steps[OPACITY] <= 9 && file.steps[ROTATION] == 1 &&
          file.steps[POSITION] == 2 * file.base_steps[POSITION]);
}

/* Decodes the file in `bytes`. Its sections must follow each other without gaps. */
static int decode(void)
{
    CHECK(!memcmp(bytes, "SP4D\1\0\0\0", 8));
    const size_t length = u32_at(bytes + 8);
    static char json[1 << 16];
    if (!CHECK(length < sizeof json && length + 12 < file_size))
        return 0;
    memcpy(json, bytes + 12, length);
    json[length] = '\0';
    decode_header(json);
    if (!CHECK(file.count == COUNT && file.frames <= FRAMES_MOST))
        return 0;
    const char *still = strstr(json, "\"static_section\":"), *groups = strstr(json, "\"gops\":");
    const uint8_t *at = decode_still(bytes + (size_t)number_after(still, "\"offset\":"));
    CHECK(number_after(still, "\"offset\":") == 12 + (double)length);
    int end = 0;
    for (const char *g = groups; (g = strstr(g, "{\"offset\":")) != NULL; g++) {
        const size_t size_of_group = (size_t)number_after(g, "\"len\":");
        const int first = (int)number_after(g, "\"f0\":"), last = (int)number_after(g, "\"f1\":");
        if (!CHECK(bytes + (size_t)number_after(g, "\"offset\":") == at && first == end && last < file.frames))
            return 0;
        CHECK(fabs(number_after(g, "\"t0\":") - first / file.rate) < 1e-9);
        end = last + 1;
        CHECK(end - first == (int)number_after(json, "\"gop\":") || end == file.frames);
        decode_group(at, size_of_group, first, end);
        at += size_of_group;
    }
    return CHECK(end == file.frames && at == bytes + file_size);
}

/* ---- Comparison -------------------------------------------------------------------------------------------------- */

static double decoded_number(int f, int i, int a, int k)
{
    return file.is_still[a][i] ? file.base[i][places[a] + k] * file.base_steps[a]
                               : file.frame[f][i][places[a] + k] * file.steps[a];
}

static int index_of(int i)
{
    int colour[3];
    for (int k = 0; k < 3; k++)
        colour[k] = (int)decoded_number(0, i, COLOUR, k);
    CHECK(colour[0] % 16 == 0 && colour[1] % 16 == 0 && colour[2] % 16 == 0);
    return colour[0] / 16 + colour[1] + colour[2] * 16;
}

static void check_gaussian(int f, int i)
{
    const int index = index_of(i);
    const fxs_gaussian *g = &gaussians[index];
    const moment_gaussian want = at_moment(g, &motions[index], (double)(float)(f / file.rate));
    double norm = 0, straight = 0, turned = 0;
    CHECK(fabs(decoded_number(f, i, OPACITY, 0) - 255 * want.opacity) <= 2.501);
    CHECK(want.opacity > 0 || decoded_number(f, i, OPACITY, 0) == 0);
    for (int k = 0; k < 3; k++)
        CHECK(fabs(decoded_number(f, i, SCALE, k) - (double)g->scale[k]) <= file.base_steps[SCALE] / 2 + 1e-6);
    if (255 * want.opacity < 0.51)
        return;
    for (int k = 0; k < 3; k++)
        CHECK(fabs(decoded_number(f, i, POSITION, k) - want.position[k] - origin[k]) <=
              file.steps[POSITION] / 2 + 2e-6 + 1e-7 * fabs(origin[k]));
    for (int k = 0; k < 4; k++)
        norm += want.rotation[k] * want.rotation[k];
    for (int k = 0; k < 4; k++) {
        const double r = 128 * want.rotation[k] / sqrt(norm), is = decoded_number(f, i, ROTATION, k);
        straight = fmax(straight, fabs(is - r));
        turned = fmax(turned, fabs(is + r));
    }
    CHECK(fmin(straight, turned) <= 1.001);
}

/* Checks the file of `bytes`, which the writer made of the Gaussians. */
static void check_frames(int frames, double rate)
{
    int seen[COUNT] = {0};
    if (!decode() || !CHECK(file.frames == frames && file.rate == rate && file.base_steps[POSITION] <= 0.002))
        return;
    for (int i = 0; i < COUNT; i++) {
        const int index = index_of(i);
        if (!CHECK(index >= 0 && index < COUNT))
            return;
        seen[index]++;
        for (int f = 0; f < frames; f++)
            check_gaussian(f, i);
    }
    for (int i = 0; i < COUNT; i++)
        CHECK(seen[i] == 1);
}

static void every_frame(void)
{
    static const struct { double duration, rate; int frames; double written; } cases[] = {
        {2, 30, 60, 30}, {1, 0, 30, 30}, {3, 24, 72, 24}, {0.5, 60, 30, 60}, {1.02, 10, 10, 10}, {4, 0.5, 2, 0.5},
        {0.01, 0, 1, 30}, {1, 100, 100, 100}
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        make(cases[c].duration, cases[c].rate);
        CHECK(write_file() == 0);
        check_frames(cases[c].frames, cases[c].written);
    }
}

/* What does not change is stored once. */
static void stored_once(void)
{
    make(2, 30);
    CHECK(write_file() == 0 && decode());
    for (int i = 0; i < file.count; i++) {
        const int index = index_of(i), moves = index & 1, turns = index >> 1 & 1;
        CHECK(file.is_still[COLOUR][i] && file.is_still[SCALE][i]);
        CHECK(moves || file.is_still[POSITION][i]);
        CHECK(turns || file.is_still[ROTATION][i]);
        CHECK((index & 12) || file.is_still[OPACITY][i]);
    }
    const size_t whole = file_size;
    memset(motions, 0, sizeof motions);
    for (int i = 0; i < COUNT; i++)
        motions[i] = (fxs_motion){.fade = INFINITY, .from = -INFINITY, .to = INFINITY};
    CHECK(write_file() == 0);
    check_frames(60, 30);
    CHECK(file_size < whole / 2);
}

/* A group of Gaussians that changes the same attributes is one run, as the header tells. */
static void runs(void)
{
    make(1, 30);
    CHECK(write_file() == 0 && decode());
    const char *at = strstr((const char *)bytes + 12, "\"groups\":");
    int next = 0;
    for (; at && *at != ']'; at = strpbrk(at + 1, "{]")) {
        if (*at != '{')
            continue;
        const int mask = (int)number_after(at, "\"mask\":"), count = (int)number_after(at, "\"count\":");
        for (int i = next; i < next + count && i < COUNT; i++)
            for (int a = 0; a < ATTRIBUTES; a++)
                CHECK((mask >> a & 1) != file.is_still[a][i]);     /* the bits are in this order, too */
        next += count;
    }
    CHECK(next == COUNT);
}

static void same_bytes(void)
{
    static uint8_t before[MAX_FILE];
    make(1, 30);
    CHECK(write_file() == 0);
    const size_t length = file_size;
    memcpy(before, bytes, length);
    CHECK(write_file() == 0 && file_size == length && !memcmp(before, bytes, length));
}

static void far_from_0(void)
{
    make(1, 10);
    origin[0] = 3000;
    origin[2] = -50;
    CHECK(write_file() == 0);
    check_frames(10, 10);
    memset(origin, 0, sizeof origin);
}

/* A Gaussian so far out that its numbers would not fit the usual steps makes them larger. */
static void one_far_out(void)
{
    make(1, 10);
    gaussians[0].position[1] = 1e9f;
    CHECK(write_file() == 0 && decode());
    CHECK(file.base_steps[POSITION] == 0.25);
    for (int i = 0; i < COUNT; i++)
        CHECK(index_of(i) || fabs(decoded_number(0, i, POSITION, 1) - 0x1p27) <= 0.5);
}

static void still_scene(void)
{
    fxs_scene_writer *w;
    const fxs_scene_write_options o = {.size = sizeof o, .count = COUNT, .format = "splat4d"};
    make(1, 0);
    for (int i = 0; i < COUNT; i++)
        motions[i] = (fxs_motion){.fade = INFINITY, .from = -INFINITY, .to = INFINITY};
    CHECK(fxs_scene_writer_open(written, &o, &w, &message) == 0);
    CHECK(fxs_scene_writer_put(w, gaussians, COUNT, &message) == 0);
    CHECK(fxs_scene_writer_close(w, NULL, NULL, &message) == 0);
    take_written();
    check_frames(1, 30);
}

/* ---- The reader -------------------------------------------------------------------------------------------------- */

#ifdef FXS_WITH_CJSON

/* Returns 1 if a Gaussian read back is Gaussian i in a frame, up to the steps and the errors of a track. */
static int is_like(const fxs_gaussian *g, const moment_gaussian *now, int i, const moment_gaussian *want)
{
    const fxs_gaussian *other = &gaussians[i];
    const double sigma = exp((double)(other->scale[0] + other->scale[1] + other->scale[2]) / 3);
    int same = fabs(now->opacity - want->opacity) <= 0.013 + 2.5 / 255;
    for (int k = 0; k < 3; k++)
        same &= fabs(now->position[k] - want->position[k]) <= 0.21 * sigma + 0.002 &&
                fabs((double)(g->dc[k] - other->dc[k])) <= 0.02;
    return same;
}

static void read_back(void)
{
    static const double times[][2] = {{1, 30}, {2, 12}};
    for (int c = 0; c < 2; c++) {
        make(times[c][0], times[c][1]);
        CHECK(write_file() == 0);
        const long total = read_moving(got, got_motions, MOST);
        if (!CHECK(total >= COUNT)) {
            printf("  %s\n", message.text);
            continue;
        }
        CHECK(info.time.duration == times[c][0] && info.time.rate == times[c][1] && !strcmp(info.format, "splat4d"));
        for (int f = 0; f < (int)(times[c][0] * times[c][1]); f++)
            for (int i = 0; i < COUNT; i++) {
                const moment_gaussian want = at_moment(&gaussians[i], &motions[i], (double)(float)(f / times[c][1]));
                int found = 0;
                for (long n = 0; n < total; n++) {
                    const double inside = (f + 0.02) / times[c][1];
                    if (!(inside >= (double)got_motions[n].from && inside < (double)got_motions[n].to))
                        continue;
                    fxs_motion always = got_motions[n];
                    always.from = -INFINITY;
                    always.to = INFINITY;
                    const moment_gaussian now = at_moment(&got[n], &always, f / times[c][1]);
                    found += is_like(&got[n], &now, i, &want);
                }
                CHECK(found == 1 || 255 * want.opacity < 3);
            }
    }
}

#endif

/* ---- Faults ------------------------------------------------------------------------------------------------------ */

static void fails_to_open(const fxs_scene_write_options *o, const char *words)
{
    fxs_scene_writer *w;
    CHECK(fxs_scene_writer_open(written, o, &w, &message) == FXS_ERR_ARGUMENT && !w);
    if (!CHECK(strstr(message.text, words) != NULL))
        printf("  %s\n", message.text);
}

static void faults(void)
{
    fxs_scene_writer *w;
    fxs_scene_write_options o = {.size = sizeof o, .count = COUNT, .format = "ply", .time.duration = 1};
    make(1, 30);
    fails_to_open(&o, "this format does not keep motion");
    o.format = "splat4d";
    o.time.duration = 1e9;
    fails_to_open(&o, "a .splat4d of more than 1048576 frames");
    o.time.duration = NAN;
    fails_to_open(&o, "a .splat4d of more than 1048576 frames");
    o.time.duration = 1;
    o.count = UINT64_MAX;
    fails_to_open(&o, "more than ");
    o = (fxs_scene_write_options){.size = sizeof o, .count = COUNT, .format = "ply"};
    CHECK(fxs_scene_writer_open(written, &o, &w, &message) == 0);
    CHECK(fxs_scene_writer_put_moving(w, gaussians, motions, 1, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_scene_writer_close(w, NULL, NULL, &message) == FXS_ERR_ARGUMENT);
    CHECK(write_to(written, COUNT - 1) == FXS_ERR_ARGUMENT);
}

/* Motions without meaning make a file that can be decoded. */
static void strange_motions(void)
{
    static const float strange[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 0, -1};
    make(1, 30);
    for (int i = 0; i < COUNT; i++) {
        fxs_motion *m = &motions[i];
        float *const numbers[] = {&m->drift[i % 3][0], &m->turn[i % 4], &m->centre, &m->fade, &m->from, &m->to};
        *numbers[i % 6] = strange[i / 6 % 7];
    }
    CHECK(write_file() == 0 && decode());
}

static int stop(void *argument, double done)
{
    return done >= *(double *)argument;
}

static void stopped(void)
{
    fxs_scene_writer *w;
    double when = 0.5;
    const fxs_progress progress = {stop, &when};
    fxs_scene_write_options o = {.size = sizeof o, .count = COUNT, .format = "splat4d"};
    make(4, 10);
    o.time = clip;
    CHECK(fxs_scene_writer_open(written, &o, &w, &message) == 0);
    CHECK(fxs_scene_writer_put_moving(w, gaussians, motions, COUNT, &message) == 0);
    CHECK(fxs_scene_writer_close(w, NULL, &progress, &message) == FXS_ERR_STOPPED);
}

int main(void)
{
    make_written();
    RUN(every_frame);
    RUN(stored_once);
    RUN(runs);
    RUN(same_bytes);
    RUN(far_from_0);
    RUN(one_far_out);
    RUN(still_scene);
#ifdef FXS_WITH_CJSON
    RUN(read_back);
#endif
    RUN(faults);
    RUN(strange_motions);
    RUN(stopped);
    remove(written);
    return check_report();
}

#else

static void refused(void)
{
    const fxs_scene_write_options o = {.size = sizeof o, .count = 1, .format = "splat4d"};
    fxs_scene_writer *w;
    CHECK(fxs_scene_writer_open("a.splat4d", &o, &w, &message) == FXS_ERR_UNSUPPORTED && !w);
    CHECK(strstr(message.text, "a.splat4d: cannot write .splat4d: built without zstd") != NULL);
}

int main(void)
{
    RUN(refused);
    return check_report();
}

#endif
