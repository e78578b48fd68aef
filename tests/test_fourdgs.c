/* Reads .4dgs files made by the test: all modes and widths of streams, every SH degree, and faults. */
#include <fixsplat/internal/sound.h>

#include "moving_bytes.h"

#ifdef FXS_WITH_ZLIB

enum { COUNT = 60, CHUNKS = 3, IN_CHUNK = COUNT / CHUNKS, WINDOWS = 3 };
enum { POSITION, SCALE, OMITTED, ROTATION, COLOUR, OPACITY, VELOCITY, CENTRE, SIGMA, FLAGS, WINDOW, ATTRIBUTES };
enum { RAW, DELTA, CONSTANT };

static const int channels[ATTRIBUTES] = {3, 3, 1, 3, 3, 1, 3, 1, 1, 1, 1};
static const double origin[3] = {-4, 0.5, 10};
static const double steps[8] = {0.001, 0.04, 0.004, 1 / 127.5, 1 / 100.0, 0.0005, 0.004, 0.05};
static const double windows[WINDOWS][2] = {{0, 8}, {0.5, 0.75}, {-1, 2.5}};
static const double cutoff = 0.07;

static fxs_gaussian gaussians[COUNT + 1];
static fxs_motion motions[COUNT + 1];
static int degree, is_constant;        /* is_constant: all Gaussians of a chunk are the same */
static size_t chunk_at, header_at, steps_at;   /* offsets of the first chunk's content, and of the front's contents */

static unsigned mixed(unsigned i, unsigned attribute, unsigned channel)
{
    const unsigned h = 2654435761u * (i + 1) ^ 40503u * (attribute + 1) ^ 104729u * (channel + 2);
    return (h ^ h >> 13) * 2246822519u >> 7;
}

/* Returns a stored number of a Gaussian. */
static int number(int i, int attribute, int channel)
{
    i = is_constant ? i / IN_CHUNK : i;
    const int h = (int)(mixed((unsigned)i, (unsigned)attribute, (unsigned)channel) % 100000);
    switch (attribute) {
    case POSITION: return h * (i % 7 ? 1 : 100) - 50000;
    case SCALE:    return h % 120 - 100;
    case OMITTED:  return h % 4;
    case ROTATION: return h % 280 - 140;
    case COLOUR:   return channel ? h % 100 - 50 : h % 140 - 5;
    case OPACITY:  return h % 110 - 4;
    case SIGMA:    return h % 160 - 120;
    case FLAGS:    return i % 5 == 0;
    case WINDOW:   return h % WINDOWS;
    default:       return h % 2000 - 1000;
    }
}

static int sh_byte(int i, int channel)
{
    return (int)(mixed((unsigned)i, 77, (unsigned)channel) % 256);
}

/* ---- The file ---- */

static void put_u64(uint64_t value)
{
    put_u32((uint32_t)value);
    put_u32((uint32_t)(value >> 32));
}

static void put_double(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, 8);
    put_u64(bits);
}

static void put_text(const char *text)
{
    put_u32((uint32_t)strlen(text));
    put("%s", text);
}

static size_t begin_record(int opcode)
{
    put_u8(opcode);
    put_u64(0);
    return size;
}

static void end_record(size_t content)
{
    put_u32_at(content - 8, (uint32_t)(size - content));
}

/* Writes bytes as a zlib stream of stored blocks. The checksum is not looked at. */
static void put_zlib(const uint8_t *from, size_t length)
{
    put_u8(0x78);
    put_u8(1);
    for (size_t at = 0; at < length || at == 0; at += 1000) {
        const size_t part = length - at < 1000 ? length - at : 1000;
        put_u8(at + part == length);
        put_u16((int)part);
        put_u16(~(int)part);
        memcpy(bytes + size, from + at, part);
        size += part;
    }
    put_u32(0);
}

static void put_stream(int attribute, int mode, const int *numbers, int count, int n)
{
    static uint8_t planes[1 << 16];
    static uint32_t folded[1 << 14];
    const int stored = mode == CONSTANT ? n : count * n;
    uint32_t most = 0;
    for (int i = 0; i < stored; i++) {
        const int64_t value = (int64_t)numbers[i] - (mode == DELTA && i >= n ? numbers[i - n] : 0);
        folded[i] = (uint32_t)(value < 0 ? -2 * value - 1 : 2 * value);
        most = folded[i] > most ? folded[i] : most;
    }
    const int width = most < 256 ? 1 : most < 65536 ? 2 : 4;
    for (int i = 0; i < stored; i++)
        for (int k = 0; k < width; k++)
            planes[k * stored + i] = (uint8_t)(folded[i] >> 8 * k);
    const int head[5] = {attribute, width, mode, 0, n};
    for (int i = 0; i < 5; i++)
        put_u8(head[i]);
    put_u32((uint32_t)count);
    const size_t at = size;
    put_u64(0);
    put_zlib(planes, (size_t)(stored * width));
    put_u32_at(at, (uint32_t)(size - at - 8));
}

static void put_attribute(int attribute, int first, int mode)
{
    int numbers[3 * IN_CHUNK];
    for (int i = 0; i < IN_CHUNK; i++)
        for (int k = 0; k < channels[attribute]; k++)
            numbers[channels[attribute] * i + k] = number(first + i, attribute, k);
    put_stream(attribute, mode, numbers, IN_CHUNK, channels[attribute]);
}

static void put_bands(int first)
{
    for (int band = 1; band <= degree; band++) {
        const int n = 2 * band + 1, from = band * band - 1;
        int numbers[21 * IN_CHUNK];
        for (int i = 0; i < IN_CHUNK; i++)
            for (int colour = 0; colour < 3; colour++)
                for (int k = 0; k < n; k++)
                    numbers[3 * n * i + n * colour + k] = sh_byte(first + i, 3 * (from + k) + colour);
        const size_t content = begin_record(7);
        put_u8(band);
        put_stream(7, RAW, numbers, IN_CHUNK, 3 * n);
        end_record(content);
    }
}

static void put_chunk(int first)
{
    const size_t content = begin_record(5);
    chunk_at = first ? chunk_at : content;
    put_double(0);
    put_double(8);
    put_u32(0);
    put_u32(IN_CHUNK);
    put_text("");
    put_u64(0);
    put_u64(0);
    const size_t streams = size;
    for (int a = ATTRIBUTES - 1; a >= 0; a--)
        put_attribute(a, first, is_constant && a != WINDOW ? CONSTANT : (a + first / IN_CHUNK) % 2 ? DELTA : RAW);
    put_stream(64, RAW, (const int[IN_CHUNK]){0}, IN_CHUNK, 1);
    put_u32_at(streams - 16, (uint32_t)(size - streams));
    put_u32_at(streams - 8, (uint32_t)(size - streams));
    end_record(content);
    put_bands(first);
}

static void put_front(void)
{
    header_at = begin_record(1);
    put_text("");
    put_text("test");
    put_double(8);
    put_u64(COUNT);
    put_double(cutoff);
    put_text("gaussian-birth");
    for (int i = 0; i < 6; i++)
        put_double(i);
    put_u8(degree);
    put_u8(2);
    put_u32(0);
    end_record(header_at);
    steps_at = begin_record(3);
    put_text("uniform-v1");
    for (int i = 0; i < 3; i++)
        put_double(origin[i]);
    for (int i = 0; i < 8; i++)
        put_double(steps[i]);
    put_u8(1);
    put_u32(0);
    end_record(steps_at);
    const size_t content = begin_record(4);
    put_u32(WINDOWS);
    for (int i = 0; i < 2 * WINDOWS; i++)
        put_double(windows[i / 2][i % 2]);
    end_record(content);
}

static const char *audio;       /* letters of records: l legacy, s source, L and S later ones, d data, c cut off */

static void put_sounds(void)
{
    for (const char *a = audio; a && *a; a++) {
        const int is_source = *a == 's' || *a == 'S', has_data = !is_source;
        const size_t content = begin_record(is_source ? 0x11 : *a == 'd' || *a == 'c' ? 0x12 : 9);
        if (is_source || *a == 'd' || *a == 'c')
            put_u32(7);
        if (is_source)
            put_text("a name that is long");
        if (is_source || *a == 'l' || *a == 'L')
            put_text(is_source ? "opus" : "wav");
        if (is_source) {
            put_text("mono");
            put_u64(9);
        }
        if (is_source || *a == 'l' || *a == 'L')
            put_double(*a == 'S' || *a == 'L' ? 1.5 : 0);
        for (int i = 0; i < 2 && is_source; i++)
            put_double(i ? 0.5 : 3);
        if (has_data) {
            put_u64(*a == 'c' ? 10 : 9);
            put("the sound");
        }
        end_record(content);
    }
}

static void make(void)
{
    size = 0;
    put("\x89" "4DGS1\r\n");
    put_front();
    end_record(begin_record(0x80));
    put_sounds();
    for (int i = 0; i < COUNT; i += IN_CHUNK)
        put_chunk(i);
    const size_t content = begin_record(2);
    for (int i = 0; i < 5; i++)
        put_u32(0);
    end_record(content);
    put("\x89" "4DGS1\r\n");
    put_file(size);
}

/* ---- Values ---- */

static double held(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static void check_still_part(int i)
{
    const fxs_gaussian *g = &gaussians[i];
    const double c[3] = {number(i, COLOUR, 0) + number(i, COLOUR, 1), number(i, COLOUR, 0),
                         number(i, COLOUR, 0) + number(i, COLOUR, 2)};
    double xyzw[4], rest = 1;
    const int omitted = number(i, OMITTED, 0);
    for (int k = 0; k < 3; k++) {
        CHECK(is_near((double)g->position[k], origin[k] + number(i, POSITION, k) * steps[0], 1e-6));
        CHECK(is_near((double)g->scale[k], number(i, SCALE, k) * steps[1], 1e-6));
        CHECK(is_near(0.5 + 0.28209479177387814 * (double)g->dc[k], held(c[k] * steps[3], 0, 1), 1e-6));
        const double q = number(i, ROTATION, k) * steps[2];
        xyzw[k < omitted ? k : k + 1] = q;
        rest -= q * q;
    }
    xyzw[omitted] = sqrt(fmax(rest, 0));
    for (int k = 0; k < 4; k++)
        CHECK(is_near((double)g->rotation[(k + 1) % 4], xyzw[k], 1e-6));
    CHECK(is_near(opacity_of(g), held(number(i, OPACITY, 0) * steps[4], 0, 1), 1e-6));
    for (int k = 0; k < 45; k++)
        CHECK(is_near((double)g->sh[k], k < 3 * degree * (degree + 2) ? -4 + sh_byte(i, k) * 8 / 255.0 : 0, 1e-6));
}

static void check_motion(int i)
{
    const fxs_motion *m = &motions[i];
    const double *span = windows[number(i, WINDOW, 0)], sigma = exp(number(i, SIGMA, 0) * steps[7]);
    const int is_always = number(i, FLAGS, 0);
    const double half = held(is_always ? span[1] - span[0] : sqrt(-2 * log(cutoff)) * sigma, 0.02, 2);
    const double speed = steps[5] * pow(2, -held(ceil(log2(half / 0.5)), -4, 2));
    const double target = is_always ? steps[6] : fmin(steps[6], 0.05 * sigma);
    const double tick = steps[6] * pow(2, held(floor(log2(target / steps[6])), -10, 0));
    for (int k = 0; k < 3; k++)
        CHECK(is_near((double)m->drift[0][k], number(i, VELOCITY, k) * speed, 1e-6) && m->drift[1][k] == 0);
    CHECK(is_near((double)m->centre, number(i, CENTRE, 0) * tick, 1e-6));
    CHECK(is_always ? m->fade == INFINITY : is_near((double)m->fade, sqrt(2) * sigma, 1e-6));
    CHECK(m->from == (float)span[0] && m->to == (float)span[1]);
}

static void every_value(void)
{
    for (degree = 0; degree <= 3; degree++)
        for (is_constant = 0; is_constant < 2; is_constant++) {
            make();
            if (!CHECK(read_moving(gaussians, motions, COUNT + 1) == COUNT)) {
                printf("  %s\n", message.text);
                continue;
            }
            CHECK(info.time.duration == 8 && info.time.rate == 0 && info.time.degree == 1 && info.time.fades &&
                  !info.time.turns && info.time.least == cutoff && info.sh_degree == degree &&
                  !strcmp(info.format, "4dgs"));
            for (int i = 0; i < COUNT; i++) {
                if (!is_constant)
                    check_still_part(i);
                check_motion(i);
            }
        }
    degree = is_constant = 0;
}

/* ---- Faults ---- */

static void faulty_front(void)
{
    static const struct { size_t at; const char *bytes; size_t size; const char *words; } cases[] = {
        {5, "2", 1, ".4dgs of a version that is not known: not 1"},
        {8, "\x80", 1, "a chunk before the header and the quantisation"},
        {9, "\xff\xff\xff\xff\xff\xff\xff\x7f", 8, "a record ends after the file"},
        {9, "\x05", 1, ""},
        {17, "\xff\xff\xff\x7f", 4, "the header ends early"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make();
        memcpy(bytes + cases[i].at, cases[i].bytes, cases[i].size);
        check_fails(cases[i].words);
    }
    static const double durations[] = {0, -1, 1e300, NAN};
    const size_t duration_at = 17 + 4 + 8;
    for (int i = 0; i < 4; i++) {
        make();
        memcpy(bytes + duration_at, &durations[i], 8);
        check_fails("no valid duration, cut-off and SH degree");
        make();
        memcpy(bytes + steps_at + 14 + 24 + 16, &durations[i], 8);
        check_fails("no valid steps in the record of the quantisation");
    }
    make();
    put_u32_at(duration_at + 8, 10000000);
    check_fails("the header tells of 10000000 Gaussians, the chunks have 60");
    make();
    bytes[steps_at + 13]++;
    check_fails(".4dgs of the quantisation \"uniform-v2\", which is not read");
    make();
    memcpy(bytes + duration_at + 28, "keyframe-delta", 14);
    check_fails("temporal model \"keyframe-delta\", which is not read: gaussian-birth is");
    make();
    bytes[steps_at - 9] = 1;
    check_fails("two records of opcode 1");
    make();
    memset(bytes + size - 8 - 29, 0x25, 1);
    check_fails("objects that move on tracks, which are not read");
}

static void faulty_chunks(void)
{
    static const struct { size_t at; int value; const char *words; } cases[] = {
        {20, 255, "the header tells of 60 Gaussians"},
        {24, 255, "a chunk ends early, or has no valid sizes"},
        {28, 1, "a chunk ends early, or has no valid sizes"},
        {36, 1, "a chunk ends early, or has no valid sizes"},
        {43, 1, "a chunk ends early, or has no valid sizes"},
        {44, 9, "a chunk with two streams of attribute 9"},
        {44, 60, "a chunk lacks a stream of an attribute"},
        {45, 3, "numbers of 3 bytes"},
        {46, 3, "mode 3"},
        {47, 9, "streams of the codec 9 are not read"},
        {48, 2, "times 2 numbers"},
        {49, 99, "a stream of 99 times 1 numbers"},
        {53, 255, "a stream"},
        {60, 1, "a stream ends after its chunk"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make();
        bytes[chunk_at + cases[i].at] = (uint8_t)cases[i].value;
        check_fails(cases[i].words);
    }
    make();
    const size_t first_window = chunk_at + 44 + 17 + 2 + 5;
    bytes[first_window] = 200;
    check_fails("a Gaussian in window 100 of 3");
}

static void faulty_bands(void)
{
    degree = 1;
    make();
    const size_t band = chunk_at + bytes[chunk_at - 8] + 256u * bytes[chunk_at - 7];
    bytes[band] = 0x80;
    check_fails("a chunk lacks SH of a band");
    make();
    bytes[band + 9] = 2;
    check_fails("SH band 2 of degree 1, or two of it");
    make();
    bytes[band + 9] = 255;
    check_fails("SH band 255 of degree 1");
    degree = 0;
}

static void sounds(void)
{
    static const struct { const char *audio; int found; double volume; const char *words; } cases[] = {
        {"", 0, 1, ""}, {"l", 1, 1, ".wav"}, {"sd", 1, 0.5, ".opus"}, {"ll", -1, 0, "several sounds, or one that"},
        {"sdsd", -1, 0, "several sounds"}, {"L", -1, 0, "several sounds"}, {"Sd", -1, 0, "several sounds"},
        {"sc", -1, 0, "the record of a sound ends early"}, {"s", -1, 0, "an empty sound"}
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        fxs_scene_file *file;
        fxs_sound sound;
        audio = cases[n].audio;
        make();
        CHECK(read_moving(gaussians, motions, COUNT + 1) == COUNT);
        if (!CHECK(!fxs_scene_file_open_memory(path, bytes, file_size, &open_options, &file, &info, &message)))
            continue;
        CHECK(fxs_scene_file_read(file, gaussians, 1, &message) == 1);
        const int found = fxs_scene_file_sound(file, &sound, &message);
        if (CHECK(found < 0 ? cases[n].found < 0 && strstr(message.text, cases[n].words)
                            : found == cases[n].found && sound.volume == cases[n].volume) && found > 0)
            CHECK(!strcmp(sound.ending, cases[n].words) && sound.bytes == 9 && !memcmp(sound.data, "the sound", 9));
        CHECK(fxs_scene_file_read(file, gaussians, 1, &message) == 1);
        if (found > 0)
            fxs_sound_free(file, &sound);
        fxs_scene_file_close(file);
    }
    audio = NULL;
}

static void truncated(void)
{
    make();
    const size_t whole = size;
    for (size_t length = 8; length < whole - 37; length += 61)
        check_cut_fails(length, "");
    check_cut_fails(6, "");
}

int main(void)
{
    RUN(every_value);
    RUN(faulty_front);
    RUN(faulty_chunks);
    RUN(faulty_bands);
    RUN(sounds);
    RUN(truncated);
    return check_report();
}

#else

int main(void)
{
    return check_report();
}

#endif
