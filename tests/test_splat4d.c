/* Reads .splat4d files made by the test: every frame has the Gaussians that were put in, and faults are refused. */
#include "moving_bytes.h"
#include "splat4d_bytes.h"

#ifdef WITH_SPLAT4D

enum { COUNT = 37, FRAMES = 11, GROUP = 4, MOST = COUNT * 64 };
enum { POSITION, ROTATION, COLOUR, OPACITY, SCALE };

#define EXTRA "\"fps\":12.5,\"steps\":{\"pos\":0.004,\"base_pos\":0.002,\"scale_log\":0.04,\"base_scale_log\":0.02," \
              "\"rgb\":9,\"alpha\":7,\"rot\":3}"

static splat4d_bytes made;
static fxs_gaussian gaussians[MOST + 1];
static fxs_motion motions[MOST + 1];
static int period = 3;             /* numbers change every `period` frames */
static int is_smooth;              /* 1: only positions change, by a polynomial of degree 3 in 64 frames */

/* Gaussian i has the still attributes of the bits of i; every eighth is still in all. */
static int is_still(int i, int attribute)
{
    return i % 8 == 7 || (i >> attribute & 1);
}

static unsigned mixed(int i, int attribute, int channel, int step)
{
    const unsigned h = 2654435761u * (unsigned)(i + 1) ^ 40503u * (unsigned)(attribute + 1) ^
                       7919u * (unsigned)(channel + 1) ^ 104729u * (unsigned)(step + 2);
    return (h ^ h >> 13) * 2246822519u >> 7;
}

static int number(int i, int attribute, int channel, int frame)
{
    const int step = frame < 0 ? -1 : is_smooth ? 0 : (frame + i) / period;
    const unsigned h = mixed(i, attribute, channel, step);
    if (is_smooth && frame >= 0 && attribute == POSITION) {
        const double x = frame / 32.0 - 1, n = (int)(h % 7) - 3;
        return (int)floor(100000 * i + 500 * (n * x + channel * x * x - n * x * x * x) + 0.5);
    }
    switch (attribute) {
    case POSITION: return (int)(h % (i % 3 ? 400 : 400000)) - (i % 3 ? 200 : 200000);
    case SCALE:    return (int)(h % 100) - 90;
    case ROTATION: return frame < 0 ? (int)(h % 256) - 128 : (int)(h % 90) - 45;
    case COLOUR:   return frame < 0 ? (int)(h % 256) : (int)(h % 40) - 5;
    default:       return frame < 0 ? (int)(h % 256) : (int)(h % 41);
    }
}

static double held(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* The Gaussian of a frame by the formulas of FORMAT.md. */
static void expect(double out[14], int i, int frame)
{
    for (int k = 0; k < 3; k++) {
        out[k] = is_still(i, POSITION) ? number(i, POSITION, k, -1) * 0.002 : number(i, POSITION, k, frame) * 0.004;
        out[3 + k] = is_still(i, SCALE) ? number(i, SCALE, k, -1) * 0.02 : number(i, SCALE, k, frame) * 0.04;
        out[6 + k] = is_still(i, COLOUR) ? number(i, COLOUR, k, -1) : held(9 * number(i, COLOUR, k, frame), 0, 255);
    }
    out[9] = is_still(i, OPACITY) ? number(i, OPACITY, 0, -1) : held(7 * number(i, OPACITY, 0, frame), 0, 255);
    for (int k = 0; k < 4; k++)
        out[10 + k] = is_still(i, ROTATION) ? number(i, ROTATION, k, -1)
                                            : held(3 * number(i, ROTATION, k, frame), -128, 127);
}

/* Returns 1 if a Gaussian at a moment is as expected, up to the errors of a track. */
static int is_expected(const fxs_gaussian *g, const moment_gaussian *now, const double want[14])
{
    const double sigma = exp((want[3] + want[4] + want[5]) / 3), opacity = held(want[9] / 255, 0, 1);
    double dot = 0, lengths[2] = {0, 0};
    int same = fabs(now->opacity - opacity) <= 0.0121;
    for (int k = 0; k < 3; k++)
        same &= fabs(now->position[k] - want[k]) <= 0.2001 * sigma + 1e-6 * fabs(want[k]) &&
                fabs((double)g->scale[k] - want[3 + k]) <= 0.0301 &&
                fabs(0.28209479177387814 * (double)g->dc[k] + 0.5 - want[6 + k] / 255) <= 0.0101;
    for (int k = 0; k < 4; k++) {
        dot += now->rotation[k] * want[10 + k];
        lengths[0] += now->rotation[k] * now->rotation[k];
        lengths[1] += want[10 + k] * want[10 + k];
    }
    return same && dot * dot >= 0.97 * lengths[0] * lengths[1];
}

static void make(int frames, int group)
{
    made.count = COUNT;
    made.frames = frames;
    made.group = group;
    made.is_still = is_still;
    made.number = number;
    made.extra = EXTRA;
    splat4d_make(&made);
}

/* Returns how often a Gaussian is there in a frame, as expected. Adds the number of all that are there to *alive. */
static int find(int f, const double want[14], long total, int *alive)
{
    int found = 0;
    for (long n = 0; n < total; n++) {
        const double inside = (f + 0.02) / 12.5;
        if (!(inside >= (double)motions[n].from && inside < (double)motions[n].to))
            continue;
        fxs_motion always = motions[n];
        always.from = -INFINITY;
        always.to = INFINITY;
        const moment_gaussian now = at_moment(&gaussians[n], &always, f / 12.5);
        found += is_expected(&gaussians[n], &now, want);
        ++*alive;
    }
    return found;
}

/* Checks that each Gaussian is there once in every frame, as it was put in, but for those with an opacity of 0 there
   that are not still in all. */
static void check_frames(int frames, long total)
{
    for (int f = 0; f < frames; f++) {
        int seen = 0, all = 0;
        for (int i = 0; i < COUNT; i++) {
            double want[14];
            int alive = 0;
            expect(want, i, f);
            const int is_there = want[9] > 0 || i % 8 == 7, found = find(f, want, total, &alive);
            CHECK(!is_there || found == 1);
            seen += is_there;
            all = alive;
        }
        CHECK(all == seen);
    }
}

static void every_frame(void)
{
    static const int frames[] = {1, 2, 4, 5, 11, 40}, groups[] = {1, 4, 11};
    for (int f = 0; f < 6; f++)
        for (int g = 0; g < 3; g++)
            for (is_smooth = 0; is_smooth < 2; is_smooth++) {
                make(frames[f], groups[g]);
                const long total = read_moving(gaussians, motions, MOST);
                if (!CHECK(total > 0)) {
                    printf("  %s\n", message.text);
                    continue;
                }
                CHECK(info.time.duration == frames[f] / 12.5 && info.time.rate == 12.5 && info.time.loops == 1 &&
                      !info.time.fades && !strcmp(info.format, "splat4d"));
                CHECK(!is_smooth || total < 2 * COUNT);
                check_frames(frames[f], total);
            }
    is_smooth = 0;
}

/* What is still in every attribute is one Gaussian, exact and for ever. */
static void still_gaussians(void)
{
    make(FRAMES, GROUP);
    const long total = read_moving(gaussians, motions, MOST);
    CHECK(total > COUNT);
    for (int i = 7, n = 0; i < COUNT; i += 8, n++) {
        double want[14];
        expect(want, i, 0);
        for (int k = 0; k < 3; k++)
            CHECK(is_near((double)gaussians[n].position[k], want[k], 1e-7) &&
                  is_near((double)gaussians[n].scale[k], want[3 + k], 1e-7) &&
                  is_near((double)gaussians[n].dc[k] * 0.28209479177387814 + 0.5, want[6 + k] / 255, 1e-6));
        CHECK(want[9] <= 0 ? gaussians[n].opacity == -20 : want[9] >= 255 ? gaussians[n].opacity == 20
              : is_near(opacity_of(&gaussians[n]), want[9] / 255, 1e-6));
        for (int k = 0; k < 4; k++)
            CHECK((double)gaussians[n].rotation[k] == want[10 + k] / 128);
        CHECK(motions[n].from == -INFINITY && motions[n].to == INFINITY && motions[n].fade == INFINITY);
    }
}

static void no_motion(void)
{
    period = 1000;
    make(FRAMES, GROUP);
    CHECK(read_moving(gaussians, motions, MOST) == COUNT);
    period = 3;
}

/* Replaces text of the header by text of the same length. */
static void replace(const char *from, const char *to)
{
    char *at = strstr((char *)bytes + 12, from);
    if (CHECK(at && strlen(from) == strlen(to)))
        memcpy(at, to, strlen(to));
}

static void faulty_headers(void)
{
    static const struct { const char *from, *to, *words; } cases[] = {
        {"\"n\":37", "\"n\":-7", "no valid \"n\" and \"t\""},
        {"\"n\":37", "\"n\":38", "a stream of 111 numbers, not 114"},
        {"\"n\":37", "\"n\":xx", "bad JSON"},
        {"\"t\":11", "\"t\": 0", "no valid \"n\" and \"t\""},
        {"\"t\":11", "\"t\":12", "groups of 11 frames, but the header tells of 12"},
        {"\"t\":11", "\"t\":9 ", "a group of frames without valid"},
        {"12.5", "-2.5", "no valid \"fps\""},
        {"12.5", "null", "no valid \"fps\""},
        {"12.5", "1e99", "no valid \"fps\""},
        {"0.004", "0.000", "no valid \"steps\""},
        {"0.04", "-0.4", "no valid \"steps\""},
        {"\"rgb\":9", "\"rgb\":0", "no valid \"steps\""},
        {"\"alpha\":7", "\"alpha\":x", "bad JSON"},
        {"\"gops\"", "\"pogs\"", "no valid \"gops\""},
        {"\"f0\":4", "\"f0\":3", "a group begins with frame 3, not 4"},
        {"\"f1\":7", "\"f1\":2", "a group of frames without valid"},
        {"static_s", "static_t", "no valid \"static_section\""}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make(FRAMES, GROUP);
        replace(cases[i].from, cases[i].to);
        check_fails(cases[i].words);
    }
    make(FRAMES, GROUP);
    bytes[4] = 2;
    check_fails(".splat4d version 2, not 1");
    make(FRAMES, GROUP);
    put_u32_at(8, 0x7fffffff);
    check_fails("the file ends early");
    make(FRAMES, GROUP);
    check_cut_fails(11, "the file ends early");
    check_cut_fails(size - 1, "a group of frames without valid \"offset\"");
}

/* Ten million frames in a header of a small file. */
static void many_frames(void)
{
    make(1, 1);
    replace("\"t\":1,", "\"t\":9,");
    check_fails("groups of 1 frames, but the header tells of 9");
    make(1, 1);
    char text[2048];
    snprintf(text, sizeof text, "{\"n\":37,\"t\":10000000,%s", strstr((char *)bytes + 12, EXTRA));
    strcpy(strstr(text, "\"f1\":0}") + 5, "9999999}]}");
    memset(bytes + 12, ' ', 2048);
    memcpy(bytes + 12, text, strlen(text));
    check_fails("frames 0 to 9999999 lack a stream");
}

static size_t first_group(void)
{
    return made.header_size + (size_t)strtoul(strstr((char *)bytes + 12, "\"len\":") + 6, NULL, 10);
}

static void faulty_streams(void)
{
    static const struct { size_t at; int value; const char *words; } cases[] = {
        {2, 3, "a stream of numbers of 3 bytes, not 1, 2 or 4"},
        {3, 9, "a stream of 9 numbers, not 5"},
        {10, 1, "a stream ends after its section"},
        {11, 0, "a zstd stream is damaged"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make(FRAMES, GROUP);
        bytes[made.header_size + cases[i].at] = (uint8_t)cases[i].value;
        check_fails(cases[i].words);
    }
    make(FRAMES, GROUP);
    const size_t group = first_group();
    bytes[group] = 200;
    check_fails("");
    make(FRAMES, GROUP);
    bytes[group]--;
    check_fails("a zstd stream is damaged");
    make(FRAMES, GROUP);
    bytes[group + 2] = 5;
    check_fails("a group with a stream of an unknown kind");
    make(FRAMES, GROUP);
    bytes[group + 2] = 1;
    check_fails("");
    make(FRAMES, GROUP);
    bytes[group + 3] = 1;
    check_fails("");
}

static int is_still_but_opacity(int i, int attribute)
{
    (void)i;
    return attribute != OPACITY;
}

/* Zeros pack well: a Gaussian that stays the same in 200 million frames. */
static void bomb(void)
{
    enum { ZEROS = 200000000 };
    static uint8_t packed[1 << 16];
    uint8_t *zeros = calloc(ZEROS, 1), one[64], *to;
    const size_t length = ZSTD_compress(packed, sizeof packed, zeros, ZEROS, 1), key = ZSTD_compress(one, 64, "", 1, 1);
    free(zeros);
    if (!CHECK(!ZSTD_isError(length) && !ZSTD_isError(key)))
        return;
    make(1, 1);
    made.count = 1;
    made.is_still = is_still_but_opacity;
    splat4d_make(&made);
    const size_t still = first_group() - made.header_size, at = size;
    bytes[at] = 2;
    bytes[at + 1] = 0;
    to = s4_head(s4_head(bytes + at + 2, OPACITY, 0, 1, 1, key), OPACITY, 1, 1, ZEROS, length);
    memcpy(to, one, key);
    memcpy(to + key, packed, length);
    const size_t end = (size_t)(to - bytes) + key + length;
    memset(bytes + 12, ' ', 2048);
    size = 12;
    put("{\"n\":1,\"t\":%d,%s,\"static_section\":{\"offset\":%zu,\"len\":%zu},\"gops\":[{\"offset\":%zu,\"len\":%zu,"
        "\"f0\":0,\"f1\":%d}]}", ZEROS + 1, EXTRA, made.header_size, still, at, end - at, ZEROS);
    bytes[size] = ' ';
    size = end;
    check_fails("its streams unpack to far more bytes than the file has");
}

static int only_first_moves(int i, int attribute)
{
    return i > 0 || attribute != OPACITY;
}

/* A million frames of one Gaussian that moves, among a thousand that are still, take the time of the one. */
static void many_frames_of_one(void)
{
    enum { FRAMES_OF_ONE = 1000000 };
    static uint8_t zeros[FRAMES_OF_ONE], packed[1 << 16], one[64];
    fxs_scene_file *file;
    const size_t length = ZSTD_compress(packed, sizeof packed, zeros, sizeof zeros, 1);
    const size_t key = ZSTD_compress(one, 64, "\24", 1, 1);
    make(1, 1);
    made.count = 1000;
    made.is_still = only_first_moves;
    splat4d_make(&made);
    const size_t still = first_group() - made.header_size, at = size;
    bytes[at] = 2;
    bytes[at + 1] = 0;
    uint8_t *to = s4_head(bytes + at + 2, OPACITY, 0, 1, 1, key);
    to = s4_head(to, OPACITY, 1, 1, FRAMES_OF_ONE, length);
    memcpy(to, one, key);
    memcpy(to + key, packed, length);
    const size_t end = (size_t)(to - bytes) + key + length;
    memset(bytes + 12, ' ', 2048);
    size = 12;
    put("{\"n\":1000,\"t\":%d,%s,\"static_section\":{\"offset\":%zu,\"len\":%zu},\"gops\":[{\"offset\":%zu,\"len\":%zu,"
        "\"f0\":0,\"f1\":%d}]}", FRAMES_OF_ONE + 1, EXTRA, made.header_size, still, at, end - at, FRAMES_OF_ONE);
    bytes[size] = ' ';
    if (!CHECK(fxs_scene_file_open_memory(path, bytes, end, NULL, &file, &info, &message) == 0))
        printf("  %s\n", message.text);
    else
        CHECK(info.count == 1000);
    fxs_scene_file_close(file);
}

static void other_kinds(void)
{
    fxs_scene_file *file;
    static const char *const names[] = {"a.splat4d", "b.SPLAT4D"};
    size = 0;
    for (int i = 0; i < 16; i++)
        put_float(0.5f);
    for (int i = 0; i < 2; i++) {
        CHECK(fxs_scene_file_open_memory(names[i], bytes, size, NULL, &file, &info, &message) == FXS_ERR_FILE);
        CHECK(strstr(message.text, "a .splat4d of another kind (of FreeTimeGsVanilla's exporter for Unity, perhaps)"));
    }
    CHECK(fxs_scene_file_open_memory("a.splat", bytes, size, NULL, &file, &info, &message) == 0);
    fxs_scene_file_close(file);
}

int main(void)
{
    RUN(every_frame);
    RUN(still_gaussians);
    RUN(no_motion);
    RUN(faulty_headers);
    RUN(many_frames);
    RUN(faulty_streams);
    RUN(bomb);
    RUN(many_frames_of_one);
    RUN(other_kinds);
    return check_report();
}

#else

static void refused(void)
{
    size = 0;
    put("SP4D");
    put_u32(1);
    put_u32(0);
    check_fails("built without zstd or cJSON");
}

int main(void)
{
    RUN(refused);
    return check_report();
}

#endif
