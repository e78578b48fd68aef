/* Tests the driver of display panels with models of the controllers and of the glass. A model takes the bytes of the
   bus and refuses sequences that the data sheets forbid. With arguments, the model takes the byte stream of a board:
   test_panel SCENE.fxs WIDTH HEIGHT FRAMES STREAM [PANEL ROTATION]. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/stage.h>
#include "port/board/panel.h"
#include "port/board/turntable.h"
#include "one_scene.h"
#include "check.h"
#include "random_scene.h"

static const fxs_options options = {.size = sizeof(fxs_options), .sh_degree = 3, .background = {0x11, 0x13, 0x1b}};

#define UNTOUCHED 0xbeef
enum { SIDE_MOST = 320 };
enum { COMMAND, DATA, WAIT };              /* kinds of events that the driver causes on the bus to the display */
enum { MIRROR_Y = 0x80, MIRROR_X = 0x40, TRANSPOSE = 0x20, BGR = 0x08 };

typedef struct model {
    const struct glass *glass;
    uint16_t memory[SIDE_MOST][SIDE_MOST]; /* 1 bit: a byte of a page in each number */
    const char *fault;                     /* text of the first fault that the model of the display found, or null */
    uint32_t now, reset_at, awake_at;      /* times in milliseconds: now, of the last reset, of the last wake-up */
    int is_reset, is_awake, is_on;
    uint8_t command, data[16], access, format, inverted, pumped;
    uint32_t count;                        /* number of data bytes since the last command byte */
    int32_t window[2][2], at[2];   /* window: first and last column and row for pixels; at: place of the next pixel */
    uint64_t pixels;
} model;

/* How a panel is made, from the data sheets of its controller and of common modules. */
static const struct glass {
    int32_t width, height, memory_width, memory_height, left, top;
    int leftward, upward;                  /* columns of memory run right to left on the glass, rows bottom to top */
    int is_bgr, is_inverted, bits;
    uint8_t own[100];                      /* commands of this controller, each with its number of data bytes */
} glasses[FXS_PANELS] = {
    {240, 320, 240, 320, 0, 0, 1, 0, 1, 0, 16, {0xb1, 2, 0xc0, 1, 0xc1, 1, 0xc5, 2, 0xc7, 1}},
    {240, 320, 240, 320, 0, 0, 0, 0, 0, 1, 16, {0}},
    {240, 240, 240, 320, 0, 0, 0, 0, 0, 1, 16, {0}},
    {128, 160, 132, 162, 2, 1, 1, 1, 1, 0, 16,
     {0xb1, 3, 0xb4, 1, 0xc0, 3, 0xc1, 1, 0xc2, 2, 0xc5, 1, 0xe0, 16, 0xe1, 16}},
    {240, 240, 240, 240, 0, 0, 1, 0, 1, 1, 16,
     {0xfe, 0, 0xef, 0, 0xeb, 1, 0x84, 1, 0x85, 1, 0x86, 1, 0x87, 1, 0x88, 1, 0x89, 1, 0x8a, 1, 0x8b, 1, 0x8c, 1,
      0x8d, 1, 0x8e, 1, 0x8f, 1, 0xb6, 2, 0x90, 4, 0xbd, 1, 0xbc, 1, 0xff, 3, 0xc3, 1, 0xc4, 1, 0xc9, 1, 0xbe, 1,
      0xe1, 2, 0xdf, 3, 0xf0, 6, 0xf1, 6, 0xf2, 6, 0xf3, 6, 0xed, 2, 0xae, 1, 0xcd, 1, 0x70, 9, 0xe8, 1, 0x62, 12,
      0x63, 12, 0x64, 7, 0x66, 10, 0x67, 10, 0x74, 7, 0x98, 2}},
    {128, 64, 128, 64, 0, 0, 1, 1, 0, 0, 1,
     {0xae, 0, 0xaf, 0, 0xd5, 1, 0xa8, 1, 0xd3, 1, 0x40, 0, 0x8d, 1, 0xda, 1, 0x81, 1, 0xd9, 1, 0xdb, 1, 0x20, 1,
      0xa0, 0, 0xa1, 0, 0xa4, 0, 0xa6, 0, 0xc0, 0, 0xc8, 0, 0x21, 2, 0x22, 2}},
};

/* Commands of all controllers with 16 bits a pixel, each with its number of data bytes. */
static const uint8_t common[] = {0x01, 0, 0x11, 0, 0x20, 0, 0x21, 0, 0x29, 0, 0x2a, 4, 0x2b, 4, 0x2c, 0, 0x36, 1,
                                 0x3a, 1, 0};

static void model_init(model *m, int panel)
{
    memset(m, 0, sizeof *m);
    m->glass = &glasses[panel];
    for (int i = 0; i < SIDE_MOST * SIDE_MOST; i++)
        m->memory[i / SIDE_MOST][i % SIDE_MOST] = UNTOUCHED;
}

static void refuse(model *m, const char *fault)
{
    m->fault = m->fault ? m->fault : fault;
}

static int32_t side(const model *m, int is_page)
{
    return is_page == !(m->access & TRANSPOSE) ? m->glass->memory_height : m->glass->memory_width;
}

static void reset(model *m)
{
    m->is_reset = 1;
    m->is_awake = m->is_on = 0;
    m->reset_at = m->now;
    m->access = m->inverted = 0;
    m->format = 0x66;
    m->window[0][1] = m->glass->memory_width - 1;
    m->window[1][1] = m->glass->memory_height - 1;
    m->window[0][0] = m->window[1][0] = 0;
}

static void begin_command(model *m)
{
    if (m->command == 0x01)
        reset(m);
    if (m->command == 0x11) {
        if (m->is_awake || m->now - m->reset_at < 120)
            refuse(m, "sleep out too early, or twice");
        m->is_awake = 1;
        m->awake_at = m->now;
    }
    if (m->command == 0x29 && !m->is_awake)
        refuse(m, "on in its sleep");
    m->is_on |= m->command == 0x29;
    if ((m->command & 0xfe) == 0x20)
        m->inverted = m->command & 1;
    if (m->command == 0x2c) {
        if ((m->format & 7) != 5)
            refuse(m, "pixels of other than 16 bits");
        for (int i = 0; i < 2; i++) {
            m->at[i] = m->window[i][0];
            if (m->window[i][1] >= side(m, i))
                refuse(m, "a window beyond the memory");
        }
    }
}

static void end_command(model *m)
{
    const uint8_t *d = m->data;
    if (m->command == 0x36)
        m->access = d[0];
    if (m->command == 0x3a)
        m->format = d[0];
    if (m->command == 0x2a || m->command == 0x2b) {
        int32_t *range = m->window[m->command - 0x2a];
        range[0] = d[0] << 8 | d[1];
        range[1] = d[2] << 8 | d[3];
        if (range[0] > range[1] || range[1] >= side(m, m->command - 0x2a))
            refuse(m, "a range that is none");
    }
}

/* Returns the number of a command's data bytes, or -1 for an unknown command. */
static int count_of(const model *m, uint8_t code)
{
    const uint8_t *const lists[] = {m->glass->own, common};
    for (int i = 0; i < (m->glass->bits == 16 ? 2 : 1); i++)
        for (const uint8_t *c = lists[i]; *c; c += 2)
            if (*c == code)
                return c[1];
    return -1;
}

static int is_complete(const model *m)
{
    if (m->command == 0x2c && m->glass->bits == 16)
        return m->count % 2 == 0;
    return !m->command || (int)m->count == count_of(m, m->command);
}

static void take_command(model *m, uint8_t code)
{
    if (count_of(m, code) < 0)
        refuse(m, "an unknown command");
    if (!m->is_reset && code != 0x01)
        refuse(m, "not reset");
    if (m->is_reset && (m->now - m->reset_at < 5 || (m->is_awake && m->now - m->awake_at < 5)))
        refuse(m, "less than 5 ms after reset or sleep out");
    if (!is_complete(m))
        refuse(m, "a command without all of its data");
    m->command = code;
    m->count = 0;
    if (!m->fault)
        begin_command(m);
}

static void write_pixel(model *m, uint16_t pixel)
{
    const int turned = m->access & TRANSPOSE;
    int32_t column = m->at[turned ? 1 : 0], page = m->at[turned ? 0 : 1];
    if (m->at[1] > m->window[1][1]) {
        refuse(m, "more pixels than the window has");
        return;
    }
    column = m->access & MIRROR_X ? m->glass->memory_width - 1 - column : column;
    page = m->access & MIRROR_Y ? m->glass->memory_height - 1 - page : page;
    m->memory[page][column] = pixel;
    m->pixels++;
    if (++m->at[0] > m->window[0][1]) {
        m->at[0] = m->window[0][0];
        m->at[1]++;
    }
}

static void take_data(model *m, uint8_t byte)
{
    if (m->command == 0x2c) {
        m->data[m->count % 2] = byte;
        if (++m->count % 2 == 0)
            write_pixel(m, (uint16_t)(m->data[0] << 8 | m->data[1]));
        return;
    }
    if (!m->command || (int)m->count >= count_of(m, m->command)) {
        refuse(m, "data that no command takes");
        return;
    }
    m->data[m->count++] = byte;
    if ((int)m->count == count_of(m, m->command))
        end_command(m);
}

/* ---- The SSD1306 ------------------------------------------------------------------------------------------------- */

static void end_mono(model *m)
{
    const uint8_t *d = m->data, c = m->command;
    if ((c & 0xfe) == 0xa0 || (c & 0xf7) == 0xc0)
        m->access = (uint8_t)((c & 0xfe) == 0xa0 ? (m->access & MIRROR_Y) | (c & 1 ? MIRROR_X : 0)
                                                 : (m->access & MIRROR_X) | (c & 8 ? MIRROR_Y : 0));
    if (c == 0x8d)
        m->pumped = d[0] == 0x14;
    if (c == 0xaf && !m->pumped)
        refuse(m, "on without its voltage");
    if ((c & 0xfe) == 0xae)
        m->is_on = c & 1;
    if ((c == 0x20 && d[0]) || (c == 0xa8 && d[0] != 63) || (c == 0xda && d[0] != 0x12) || (c == 0xd3 && d[0]))
        refuse(m, "settings for another panel");
    if (c == 0x21 || c == 0x22) {
        int32_t *range = m->window[c - 0x21];
        range[0] = m->at[c - 0x21] = d[0];
        range[1] = d[1];
        if (range[0] > range[1] || range[1] >= (c == 0x21 ? 128 : 8))
            refuse(m, "a range that is none");
    }
}

/* Takes a byte of a command, or data of the command before. */
static void take_mono_command(model *m, uint8_t byte)
{
    if (is_complete(m)) {
        if (count_of(m, byte) < 0)
            refuse(m, "an unknown command");
        m->command = byte;
        m->count = 0;
    } else {
        m->data[m->count++] = byte;
    }
    if (!m->fault && is_complete(m))
        end_mono(m);
}

static void take_mono_data(model *m, uint8_t byte)
{
    const int32_t column = m->access & MIRROR_X ? 127 - m->at[0] : m->at[0];
    if (!is_complete(m) || m->at[1] > m->window[1][1]) {
        refuse(m, "more data than the window has, or none wanted");
        return;
    }
    m->memory[m->at[1]][column] = byte;
    m->pixels += 8;
    if (++m->at[0] > m->window[0][1]) {
        m->at[0] = m->window[0][0];
        m->at[1]++;
    }
}

/* ---- What a viewer sees ------------------------------------------------------------------------------------------ */

static void take(model *m, uint8_t kind, uint8_t byte)
{
    if (kind > WAIT)
        refuse(m, "no event");
    if (m->fault)
        return;
    if (kind == WAIT)
        m->now += byte;
    else if (m->glass->bits == 1)
        (kind == COMMAND ? take_mono_command : take_mono_data)(m, byte);
    else
        (kind == COMMAND ? take_command : take_data)(m, byte);
}

/* Returns what the glass shows at x, y: a colour of RGB565, or a bit; UNTOUCHED if nothing was written there. */
static int lit(const model *m, int32_t x, int32_t y)
{
    const struct glass *g = m->glass;
    const int32_t column = g->left + (g->leftward ? g->width - 1 - x : x);
    const int32_t row = g->top + (g->upward ? g->height - 1 - y : y);
    if (g->bits == 1) {                    /* the scan of rows, not their order in memory, is mirrored */
        const int32_t stored = m->access & MIRROR_Y ? 63 - row : row, byte = m->memory[stored / 8][column];
        return byte == UNTOUCHED ? UNTOUCHED : byte >> stored % 8 & 1;
    }
    int colour = m->memory[row][column];
    if (colour == UNTOUCHED)
        return UNTOUCHED;
    if (g->is_bgr != !!(m->access & BGR))
        colour = (colour & 0x7e0) | colour >> 11 | (colour & 31) << 11;
    return g->is_inverted == m->inverted ? colour : colour ^ 0xffff;
}

/* Returns what a viewer sees at x, y of a picture that is turned clockwise on the glass. */
static int seen(const model *m, int32_t x, int32_t y, int rotation)
{
    const int32_t right = m->glass->width - 1, bottom = m->glass->height - 1;
    return rotation == 0 ? lit(m, x, y) : rotation == 1 ? lit(m, right - y, x)
         : rotation == 2 ? lit(m, right - x, bottom - y) : lit(m, y, bottom - x);
}

/* True if the display shows the picture. pixels: RGB565, low byte first; for a glass of 1 bit: a number a pixel. */
static int shows(const model *m, const unsigned char *pixels, int32_t width, int32_t height, int rotation)
{
    const int turned = rotation & 1, mono = m->glass->bits == 1;
    const int32_t w = turned ? m->glass->height : m->glass->width, h = turned ? m->glass->width : m->glass->height;
    int differing = m->fault || !m->is_on || !is_complete(m);
    for (int32_t y = 0; y < h; y++)
        for (int32_t x = 0; x < w; x++) {
            const unsigned char *p = x < width && y < height ? pixels + 2 * ((ptrdiff_t)y * width + x) : 0;
            const int want = p ? p[0] | p[1] << 8 : mono && x < width && y < (height + 7) / 8 * 8 ? 0 : UNTOUCHED;
            differing += seen(m, x, y, rotation) != want;
        }
    return !differing;
}

/* A bus to the display, with optional DMA. The DMA reads pixels as late as possible, to find buffers that are
   changed too early. */
typedef struct bus {
    model *model;
    int dma;
    const uint8_t *pending;
    size_t count;
} bus;

static void finish(bus *b)
{
    for (size_t i = 0; i < b->count; i++)
        take(b->model, DATA, b->pending[i]);
    b->count = 0;
}

static void send_command(void *argument, uint8_t command)
{
    finish(argument);
    take(((bus *)argument)->model, COMMAND, command);
}

static void send_data(void *argument, const uint8_t *bytes, size_t count)
{
    bus *b = argument;
    finish(b);
    b->pending = bytes;
    b->count = count;
    if (!b->dma || count <= 16)
        finish(b);
}

static void wait(void *argument, uint32_t milliseconds)
{
    bus *b = argument;
    finish(b);
    for (; milliseconds > 255; milliseconds -= 255)
        take(b->model, WAIT, 255);
    take(b->model, WAIT, (uint8_t)milliseconds);
}

static fxs_panel panel_on(bus *b, int type, int rotation)
{
    return (fxs_panel){.type = &fxs_panel_types[type], .rotation = rotation, .bus = {send_command, send_data, wait, b}};
}

static unsigned char *whole_picture(const fxs_object *object, const fxs_camera *camera)
{
    fxs_context context;
    fxs_context_init(&context, 0);
    unsigned char *pixels = check_aligned((size_t)(camera->width * camera->height * 2));
    const fxs_targets targets = one_target(FXS_FORMAT_RGB565, pixels, camera->width * 2);
    const size_t bytes = fxs_frame_bytes(&context, object, 1, camera->width, camera->height, 0);
    void *memory = check_aligned(bytes);
    CHECK(!render_frame(&context, object, 1, camera, &options, &targets, memory, bytes, 0));
    free(memory);
    return pixels;
}

/* Converts a picture of RGB565 to numbers 0 and 1 of 2 bytes, with the errors of the whole picture in memory. */
static void dither(unsigned char *pixels, int32_t width, int32_t height)
{
    const int32_t row = width + 2;
    int32_t *errors = calloc((size_t)(row * (height + 1)), sizeof *errors);
    for (int32_t y = 0; y < height; y++)
        for (int32_t i = 0; i < width; i++) {
            const int32_t step = y % 2 ? -1 : 1, x = y % 2 ? width - 1 - i : i;
            unsigned char *p = pixels + 2 * (y * width + x);
            const int32_t colour = p[0] | p[1] << 8;
            const int32_t luma = ((colour >> 11) * 1791 + (colour >> 5 & 63) * 2965 + (colour & 31) * 608) / 1024;
            int32_t *here = errors + y * row + 1 + x, *under = here + row;
            const int32_t light = luma * luma / 4 + *here, error = light > 8128 ? light - 16256 : light;
            CHECK(luma <= 255 && abs(error) <= 8130);
            here[step] += error * 7 / 16;
            under[-step] += error * 3 / 16;
            under[step] += error / 16;
            under[0] += error - error * 7 / 16 - error * 3 / 16 - error / 16;
            p[0] = light > 8128;
            p[1] = 0;
        }
    free(errors);
}

static unsigned char *wanted(const fxs_panel_type *type, const fxs_object *object, const fxs_camera *camera)
{
    unsigned char *pixels = whole_picture(object, camera);
    if (type->bits == 1)
        dither(pixels, camera->width, camera->height);
    return pixels;
}

static void draw_on(fxs_panel *panel, const fxs_object *object, const fxs_camera *camera, int32_t rows, int32_t gap)
{
    const ptrdiff_t stride = camera->width * 2 + gap;
    const size_t room = (size_t)(stride * rows);
    unsigned char *strips = check_aligned(2 * room);
    fxs_context context;
    fxs_strip strip = {.pixels = strips, .stride = stride, .rows = rows, .format = FXS_FORMAT_RGB565_SWAPPED,
                       .rows_done = fxs_panel_rows, .argument = panel};
    const fxs_config config = {.size = sizeof(fxs_config), .draw = fxs_strip_draw, .draw_argument = &strip,
                               .draw_blended = 1};
    fxs_frame_memory sizes;
    uint8_t pages[2][128 * 48 / 8];
    int16_t errors[128];
    panel->errors = errors;
    panel->pages = pages[0];
    if (((bus *)panel->bus.argument)->dma)
        panel->other = panel->type->bits == 1 ? pages[1] : strips + room;
    fxs_context_init(&context, &config);
    fxs_frame_bytes(&context, object, 1, camera->width, camera->height, &sizes);
    void *memory = check_aligned(sizes.least);
    CHECK(!fxs_panel_init(panel, camera->width, camera->height));
    CHECK(!render_frame(&context, object, 1, camera, &options, 0, memory, sizes.least, 0));
    finish(panel->bus.argument);
    free(memory);
    free(strips);
}

static void test_picture(int type, int rotation, int is_whole, const packed_scene *scene)
{
    static model m;
    const fxs_panel_type *t = &fxs_panel_types[type];
    const int32_t less = is_whole ? 0 : 7, turned = rotation & 1, rows = 16 * (1 + rotation % 3);
    bus b = {.model = &m, .dma = (rotation + is_whole) % 2};
    fxs_panel panel = panel_on(&b, type, rotation);
    fxs_object object;
    fxs_camera camera;
    fxs_object_init(&object, &scene->scene);
    fxs_camera_init(&camera, (turned ? t->height : t->width) - less, (turned ? t->width : t->height) - less);
    model_init(&m, type);
    draw_on(&panel, &object, &camera, rows, is_whole ? 0 : 6);
    unsigned char *want = wanted(t, &object, &camera);
    if (!CHECK(shows(&m, want, camera.width, camera.height, rotation)))
        printf("  %s, rotation %d: %s\n", t->name, rotation, m.fault ? m.fault : "other pixels");
    want[0] ^= 1;
    CHECK(!shows(&m, want, camera.width, camera.height, rotation));
    want[0] ^= 1;
    m.inverted ^= 1;
    m.access ^= t->bits == 1 ? MIRROR_Y : 0;
    CHECK(!shows(&m, want, camera.width, camera.height, rotation));
    free(want);
}

static void test_pictures(void)
{
    state = 31;
    packed_scene scene = random_scene(FXS_PROFILE_DEFAULT, 700);
    for (int i = 0; i < FXS_PANELS * 8; i++)
        if (fxs_panel_types[i / 8].bits == 16 || i % 4 % 2 == 0)
            test_picture(i / 8, i % 4, i / 4 % 2, &scene);
    free(scene.data);
}

/* A ramp of greys becomes as many white pixels as the ramp has light, the same ones on every machine. */
static void test_bits(void)
{
    enum { WIDTH = 128, HEIGHT = 64 };
    static unsigned char pixels[HEIGHT][WIDTH][2];
    int16_t errors[WIDTH];
    uint8_t pages[2 * WIDTH];
    fxs_strip strip = {.stride = sizeof *pixels, .rows = 16, .format = FXS_FORMAT_RGB565_SWAPPED};
    double light[8] = {0};
    int white[8] = {0};
    uint64_t hash = 0xcbf29ce484222325u;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int grey = i % WIDTH / 4;
        pixels[i / WIDTH][i % WIDTH][0] = (unsigned char)(grey << 3 | grey >> 2);
        pixels[i / WIDTH][i % WIDTH][1] = (unsigned char)((grey & 3) << 6 | (grey >> 4) << 5 | grey);
        light[i % WIDTH / 16] += grey / 31.0 * (grey / 31.0);
    }
    for (int32_t first = 0; first < HEIGHT; first += 16) {
        strip.pixels = pixels[first];
        fxs_strip_bits(&strip, WIDTH, first, 16, errors, pages);
        for (int i = 0; i < 2 * WIDTH; i++) {
            hash = (hash ^ pages[i]) * 0x100000001b3u;
            for (int bit = 0; bit < 8; bit++)
                white[i % WIDTH / 16] += pages[i] >> bit & 1;
        }
    }
    for (int i = 0; i < 8; i++)
        CHECK(white[i] > light[i] - 25 && white[i] < light[i] + 25);
    CHECK(hash == 0x6acc42f750a0db51u);
}

static void test_refused(void)
{
    static const int32_t sizes[][2] = {{0, 10}, {10, 0}, {241, 320}, {320, 240}, {240, 321}};
    static model m;
    bus b = {.model = &m};
    fxs_panel panel = panel_on(&b, FXS_PANEL_ILI9341, 0);
    model_init(&m, FXS_PANEL_ILI9341);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        CHECK(fxs_panel_init(&panel, sizes[i][0], sizes[i][1]) == FXS_ERR_SIZE && !m.is_reset);
    panel.rotation = 3;
    CHECK(fxs_panel_init(&panel, 240, 320) == FXS_ERR_SIZE && !m.is_reset);
    static unsigned char pixels[20 * 16 * 2];
    fxs_strip strip = {.pixels = pixels, .stride = 40, .rows = 16, .format = FXS_FORMAT_RGB565};
    CHECK(!fxs_panel_init(&panel, 20, 32));
    CHECK(fxs_panel_rows(&panel, &strip, 0, 16) == FXS_ERR_TARGET);
    strip.format = FXS_FORMAT_RGB565_SWAPPED;
    CHECK(fxs_panel_rows(&panel, &strip, 17, 16) == FXS_ERR_TARGET && !m.pixels);
    strip.stride = 39;
    CHECK(fxs_panel_rows(&panel, &strip, 16, 16) == FXS_ERR_TARGET && !m.pixels);
    strip.stride = 40;
    CHECK(!fxs_panel_rows(&panel, &strip, 16, 16) && m.pixels == 20 * 16 && !m.fault);
    panel = panel_on(&b, FXS_PANEL_SSD1306, 1);
    model_init(&m, FXS_PANEL_SSD1306);
    CHECK(fxs_panel_init(&panel, 64, 64) == FXS_ERR_SIZE && !m.command);
    panel.rotation = 0;
    CHECK(!fxs_panel_init(&panel, 20, 32) && m.is_on);
    CHECK(fxs_panel_rows(&panel, &strip, 0, 16) == FXS_ERR_TARGET && !m.pixels && !m.fault);
}

static void test_model_refuses(void)
{
#define AWAKE COMMAND, 0x01, WAIT, 120, COMMAND, 0x3a, DATA, 0x55, COMMAND, 0x11, WAIT, 5
#define ONE_PIXEL COMMAND, 0x2a, DATA, 0, DATA, 7, DATA, 0, DATA, 7, COMMAND, 0x2b, DATA, 0, DATA, 0, DATA, 0, DATA, 0
    static const struct {
        uint8_t count, events[64];
    } streams[] = {
        {2, {COMMAND, 0x29}},
        {2, {DATA, 0}},
        {2, {3, 0}},
        {6, {COMMAND, 0x01, WAIT, 4, COMMAND, 0x3a}},
        {6, {COMMAND, 0x01, WAIT, 119, COMMAND, 0x11}},
        {6, {COMMAND, 0x01, WAIT, 5, COMMAND, 0x29}},
        {6, {COMMAND, 0x01, WAIT, 5, COMMAND, 0x2c}},
        {10, {COMMAND, 0x01, WAIT, 120, COMMAND, 0x11, WAIT, 4, COMMAND, 0x29}},
        {14, {AWAKE, COMMAND, 0x11}},
        {14, {AWAKE, COMMAND, 0x33}},
        {16, {AWAKE, COMMAND, 0x29, DATA, 1}},
        {16, {AWAKE, COMMAND, 0x3a, COMMAND, 0x29}},
        {22, {AWAKE, COMMAND, 0x2a, DATA, 0, DATA, 2, DATA, 0, DATA, 1}},
        {22, {AWAKE, COMMAND, 0x2a, DATA, 0, DATA, 0, DATA, 0, DATA, 240}},
        {22, {AWAKE, COMMAND, 0x2b, DATA, 0, DATA, 0, DATA, 1, DATA, 64}},
        {18, {AWAKE, COMMAND, 0x36, DATA, 0x28, COMMAND, 0x2c}},
        {18, {AWAKE, COMMAND, 0x2c, DATA, 1, COMMAND, 0x29}},
        {42, {AWAKE, ONE_PIXEL, COMMAND, 0x2c, DATA, 1, DATA, 2, DATA, 3, DATA, 4}},
    };
    static model m;
    for (size_t i = 0; i < sizeof streams / sizeof *streams; i++) {
        model_init(&m, FXS_PANEL_ILI9341);
        for (int at = 0; at < streams[i].count; at += 2) {
            CHECK(!m.fault);
            take(&m, streams[i].events[at], streams[i].events[at + 1]);
        }
        if (!CHECK(m.fault))
            printf("  stream %zu\n", i);
    }
}

/* ---- Byte stream of a board -------------------------------------------------------------------------------------- */

static int check_stream(char **arguments, int type, int rotation)
{
    static model m;
    fxs_mapping scene, stream;
    fxs_message message;
    fxs_turntable t;
    const int32_t width = (int32_t)strtol(arguments[1], 0, 10), height = (int32_t)strtol(arguments[2], 0, 10);
    const uint32_t frames = (uint32_t)strtoul(arguments[3], 0, 10);
    if (fxs_map_open(&scene, arguments[0], &message) || fxs_map_open(&stream, arguments[4], &message) ||
        fxs_turntable_open(&t, scene.data, scene.bytes, width, height))
        return puts("no scene or no stream"), 1;
    model_init(&m, type);
    const uint8_t *events = stream.data;
    for (size_t at = 0; at + 1 < stream.bytes; at += 2)
        take(&m, events[at], events[at + 1]);
    fxs_turntable_turn(&t, (frames - 1) * FXS_TURNTABLE_STEPS / frames);
    unsigned char *want = wanted(&fxs_panel_types[type], &t.object, &t.camera);
    const int same = shows(&m, want, width, height, rotation) &&
                     m.pixels == (uint64_t)frames * (uint64_t)(width * height);
    printf("%s, %" PRIu64 " pixels\n", m.fault ? m.fault : same ? "the same picture" : "another picture", m.pixels);
    free(want);
    fxs_map_close(&stream);
    fxs_map_close(&scene);
    return !same;
}

int main(int argc, char **argv)
{
    if (argc == 6 || argc == 8)
        return check_stream(argv + 1, argc > 6 ? atoi(argv[6]) % FXS_PANELS : FXS_PANEL_ILI9341,
                            argc > 6 ? atoi(argv[7]) : strtol(argv[2], 0, 10) > 240);
    RUN(test_pictures);
    RUN(test_bits);
    RUN(test_refused);
    RUN(test_model_refuses);
    return check_report();
}
