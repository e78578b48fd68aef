/* Compares the GLES back end with the CPU renderer byte for byte. Drawing into the caller's target must keep the
   caller's OpenGL state. Fake OpenGL functions simulate device failures. */
#include <math.h>
#include <string.h>

#include <fixsplat/camera.h>
#include "check.h"
#include "one_scene.h"
#include "packed_scene.h"
#include "procedural_scene.h"
#ifdef FXS_WITH_GLES
#include "losing_gl.h"
#include <GLES3/gl31.h>

#include <fixsplat/gl.h>
#include <fixsplat/renderer.h>
#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/internal/pixel.h>


static int wrong_factors;

static int FACTOR(int x)
{
    wrong_factors += x < 0 || x > 32767;
    return x;
}

#define min fxs_min
#include "kernels/gles/weight.frag"
#undef min
#endif
#ifdef FXS_WITH_EGL
#endif
#ifdef FXS_WITH_OSMESA
#endif

#ifndef FXS_WITH_GLES
static void gles(void)
{
    SKIP("built without the headers of OpenGL ES");
}

int main(void)
{
    RUN(gles);
    return check_report();
}
#else

static const struct port {
    const char *name;
    int (*open)(void **context, fxs_message *message);
    fxs_gl_load_fn *load;
    fxs_gl_use_fn *use;
    void (*close)(void *context);
} ports[] = {
#ifdef FXS_WITH_EGL
    {"EGL", fxs_egl_open, fxs_egl_load, fxs_egl_use, fxs_egl_close},
#endif
#ifdef FXS_WITH_OSMESA
    {"OSMesa", fxs_osmesa_open, fxs_osmesa_load, fxs_osmesa_use, fxs_osmesa_close},
#endif
    {0, 0, 0, 0, 0}
};

static const struct port *port;
static void *context;
static fxs_message why_not;

/* Table of fake OpenGL functions by name. A null name ends the table. */
static struct fake {
    const char *name;
    fxs_gl_function function;
} fakes[4];

static fxs_gl_function load(void *argument, const char *name)
{
    for (int i = 0; i < 4 && fakes[i].name; i++)
        if (!strcmp(name, fakes[i].name))
            return fakes[i].function;
    return port->load(argument, name);
}

static void fake(int i, const char *name, fxs_gl_function function)
{
    fakes[i].name = name;
    fakes[i].function = function;
}

static PFNGLGETINTEGERVPROC real_GetIntegerv;
static GLint limit, read_type;             /* limit: fake largest texture size; 0: the limit of the device */
static int no_blocks;                      /* 1: simulates a device without storage buffers in fragment shaders */

static void GL_APIENTRY fake_GetIntegerv(GLenum name, GLint *value)
{
    real_GetIntegerv(name, value);
    if (limit && name == GL_MAX_TEXTURE_SIZE)
        *value = limit;
    if (read_type && name == GL_IMPLEMENTATION_COLOR_READ_TYPE)
        *value = read_type;
    if (read_type && name == GL_ALIASED_POINT_SIZE_RANGE)
        value[0] = value[1] = 1;
    if (no_blocks && name == GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS)
        *value = 0;
}

static void fake_limits(GLint size, GLint type)
{
    real_GetIntegerv = (PFNGLGETINTEGERVPROC)port->load(context, "glGetIntegerv");
    limit = size;
    read_type = type;
    fake(0, "glGetIntegerv", (fxs_gl_function)fake_GetIntegerv);
}

static fxs_gles *open_gles(int *error)
{
    fxs_gles *gles;
    why_not.text[0] = 0;
    *error = fxs_gles_create(&gles, load, 0, context, &why_not);
    return gles;
}

static void close_gles(fxs_gles *gles)
{
    fxs_gles_destroy(gles);
    memset(fakes, 0, sizeof fakes);
}

typedef struct subject {
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_camera camera;
    fxs_options options;
    enum fxs_format format;
} subject;

static int make_subject(subject *s, const char *name, uint64_t count, int width, int height)
{
    static const double eye[3] = {0.9, -2.6, -12.8}, look[3] = {0, 0.4, 0}, up[3] = {0, -1, 0};
    fxs_message m = {.text = "no camera"};
    fxs_view view;
    fxs_options_init(&s->options);
    s->format = FXS_FORMAT_RGBA8;
    s->options.background[0] = 17;
    s->options.background[2] = 200;
    const int made = !procedural_scene_make(name, count, 0, &s->packed, 0, &m) &&
                     !fxs_scene_open(&s->scene, s->packed.data, s->packed.bytes) &&
                     !fxs_view_look_at(&view, eye, look, up, &(fxs_picture){40, width, height}, &m) &&
                     !fxs_camera_from_view(&s->camera, &view, &m);
    if (!CHECK(made))
        puts(m.text);
    return made;
}

static void run_backwards(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    while (jobs-- > 0)
        job(argument, jobs);
}

static fxs_compute *compute;   /* the compute back end that draws in place of the GLES back end, or null */

/* Draws into an OpenGL target by the compute back end. All objects must share one scene. */
static int draw_by_compute(const fxs_request *request, const fxs_gl_target *target, fxs_stats *stats)
{
    fxs_compute_scene copy = {.key = 0};
    const fxs_compute_scene *const copies[] = {&copy, &copy};
    void *memory = malloc(fxs_compute_memory(request));
    int error = fxs_compute_upload(compute, &copy, request->objects->scene, &why_not);
    error = error ? error : fxs_compute_draw(compute, request, copies, target, memory, stats, &why_not);
    fxs_compute_drop(compute, &copy);
    free(memory);
    return error;
}

static int render_target(const fxs_context *c, fxs_gles *gles, const fxs_request *request,
                         const fxs_gl_target *target, void *memory, size_t bytes, fxs_stats *stats)
{
    return compute ? draw_by_compute(request, target, stats)
                   : fxs_gles_render(gles, c, request, target, memory, bytes, stats);
}

/* Renders into `pixels`, or into the OpenGL target if `target` is not null. */
static int render(const subject *s, fxs_draw_fn *draw, fxs_gles *gles, const fxs_gl_target *target, void *pixels,
                  ptrdiff_t stride, fxs_stats *stats)
{
    fxs_context c;
    fxs_config config = {.size = sizeof(fxs_config), .workers.run = run_backwards, .workers.count = 3, .draw = draw,
                         .draw_argument = gles,
                         .draw_unlisted = draw && draw != fxs_gles_draw};
    fxs_context_init(&c, &config);
    size_t bytes = one_frame_bytes(&c, &s->scene, s->camera.width, s->camera.height, 0);
    void *memory = check_aligned(bytes);
    const fxs_object object = one_object(&s->scene);
    const fxs_request request = request_for(&object, 1, &s->options, 1, &s->camera, 0);
    int error = target ? render_target(&c, gles, &request, target, memory, bytes, stats)
                       : one_render(&c, &s->scene, &s->camera, &s->options, s->format, memory, bytes, pixels, stride,
                                    stats);
    free(memory);
    return error;
}

static size_t picture_bytes(const subject *s)
{
    return (size_t)s->camera.width * (size_t)s->camera.height * 4;
}

static uint8_t *new_picture(const subject *s)
{
    uint8_t *pixels = malloc(picture_bytes(s));
    memset(pixels, 0x5a, picture_bytes(s));
    return pixels;
}

/* Modes of drawing that give the CPU's bytes: by tile lists, and by framebuffer fetch if supported. */
static fxs_draw_fn *const exact[] = {fxs_gles_draw, fxs_gles_draw_fetch};

static int exact_ways(const fxs_gles *gles)
{
    return compute || fxs_gles_info(gles).no_fetch ? 1 : 2;
}

/* Draws in each exact mode and compares the bytes with the CPU's. Sets *stats to the statistics of the mode with
   tile lists. */
static int same_laid_out(const subject *s, fxs_gles *gles, ptrdiff_t stride, ptrdiff_t first, fxs_stats *stats)
{
    uint8_t *expected = new_picture(s);
    int same = CHECK(!render(s, 0, 0, 0, expected + first, stride, 0));
    for (int way = exact_ways(gles) - 1; way >= 0; way--) {
        uint8_t *actual = new_picture(s);
        same &= CHECK(!render(s, exact[way], gles, 0, actual + first, stride, stats)) &&
                CHECK(!memcmp(expected, actual, picture_bytes(s)));
        free(actual);
    }
    free(expected);
    return same;
}

static int same(const subject *s, fxs_gles *gles)
{
    return same_laid_out(s, gles, (ptrdiff_t)s->camera.width * 4, 0, 0);
}

#define OPEN_OR_SKIP(gles) \
    int error; \
    fxs_gles *gles = open_gles(&error); \
    if (!gles) \
        SKIP(why_not.text)

static void sizes(void)
{
    static const int all[][2] = {{1, 1}, {15, 17}, {16, 16}, {33, 1}, {1279, 719}, {4096, 64}, {31, 2100}};
    OPEN_OR_SKIP(gles);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        subject s;
        if (!make_subject(&s, "knot", 20000, all[i][0], all[i][1]))
            break;
        if (!same(&s, gles))
            printf("  %dx%d\n", all[i][0], all[i][1]);
        fxs_packed_scene_free(&s.packed);
    }
    close_gles(gles);
}

static void formats(void)
{
    subject s;
    OPEN_OR_SKIP(gles);
    if (!make_subject(&s, "fog", 3000, 77, 50))
        return;
    const ptrdiff_t row = 77 * 4;
    for (int format = FXS_FORMAT_RGBA8; format <= FXS_FORMAT_RGB565; format++)
        for (int cutoff = FXS_CUTOFF_MAHALANOBIS; cutoff <= FXS_CUTOFF_SQUARE; cutoff++) {
            s.format = (enum fxs_format)format;
            s.options.cutoff = (enum fxs_cutoff)cutoff;
            same_laid_out(&s, gles, row, 0, 0);
            same_laid_out(&s, gles, -row, row * 49, 0);
        }
    s.format = FXS_FORMAT_RGB565;
    same_laid_out(&s, gles, 77 * 2, 0, 0);
    static unsigned char pixels[77 * 50 * 4];
    for (int format = FXS_FORMAT_BGRA8; format <= FXS_FORMAT_RGB565_SWAPPED; format++) {
        s.format = (enum fxs_format)format;
        CHECK(render(&s, fxs_gles_draw, gles, 0, pixels, row, 0) == FXS_ERR_UNSUPPORTED);
    }
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

/* Draws thin Gaussians, with more tile lists than the memory holds. In tiles that a thin Gaussian does not
   touch, its coordinate u overflows. */
static void runs(void)
{
    subject s;
    fxs_stats stats = {0};
    OPEN_OR_SKIP(gles);
    if (!make_subject(&s, "needles", 4000, 640, 360))
        return;
    s.options.cutoff = FXS_CUTOFF_SQUARE;
    same_laid_out(&s, gles, 640 * 4, 0, &stats);
    CHECK(stats.runs > 1);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static void small_textures(void)
{
    static const GLint limits[] = {16, 63, 64, 200, 2048};
    subject s;
    if (!make_subject(&s, "knot", 20000, 333, 187))
        return;
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        int error;
        fake_limits(limits[i], 0);
        fxs_gles *gles = open_gles(&error);
        if (gles && !same(&s, gles))
            printf("  textures of %d\n", limits[i]);
        close_gles(gles);
        if (error)
            SKIP(why_not.text);
    }
    fxs_packed_scene_free(&s.packed);
}

/* Makes a scene of 80,000 faint points. Point 65,536 is large and bright, so a missing entry in a tile's list
   shows. */
static packed_scene faint_points(void)
{
    packed_scene p = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 80000, 0);
    uint32_t state = 1;
    for (uint32_t chunk = 0; chunk < p.header->chunk_count; chunk++) {
        fxs_chunk *c = &p.chunks[chunk];
        unsigned char *rows = packed_scene_rows(&p, chunk);
        for (int i = 0; i < 3; i++) {
            c->origin_q32[i] = i < 2 ? -(INT64_C(15) << 28) : INT64_C(4) << 32;
            c->step_q32[i] = i < 2 ? 15 << 13 : 0;
            c->colour_step_q20[i] = 4000;
        }
        c->scale_q16 = chunk == 255 ? 0 : -10 * 65536;
        for (uint32_t i = 0; i < p.header->chunk_bytes; i++)
            rows[i] = (unsigned char)((state = state * 1664525 + 1013904223) >> 24);
        memset(rows + FXS_ROW_ROTATION, 0x55, 4 * FXS_CHUNK);
        for (uint32_t i = 0; i < FXS_CHUNK; i++)
            rows[FXS_ROW_COLOUR + 4 * i + 3] = chunk == 255 && i == 255 ? 120 : 2;
    }
    CHECK(packed_scene_finish(&p) == 0);
    return p;
}

static PFNGLDRAWARRAYSPROC real_DrawArrays;
static unsigned draws;

static void GL_APIENTRY count_DrawArrays(GLenum mode, GLint first, GLsizei count)
{
    draws++;
    real_DrawArrays(mode, first, count);
}

static void long_list(void)
{
    const packed_scene p = faint_points();
    subject s = {.scene = p.scene, .camera = {16, 16, 32 << 12, 32 << 12, 8 << 12, 8 << 12,
                                              {1 << 30, 0, 0, 0, 1 << 30, 0, 0, 0, 1 << 30}, {0, 0, 0}}};
    fxs_stats stats = {0};
    real_DrawArrays = (PFNGLDRAWARRAYSPROC)port->load(context, "glDrawArrays");
    fake(0, "glDrawArrays", (fxs_gl_function)count_DrawArrays);
    OPEN_OR_SKIP(gles);
    fxs_options_init(&s.options);
    same_laid_out(&s, gles, 16 * 4, 0, 0);
    s.format = FXS_FORMAT_RGBA8_COVERAGE;
    uint8_t *pixels = new_picture(&s);
    draws = 0;
    CHECK(!render(&s, fxs_gles_draw, gles, 0, pixels, 16 * 4, &stats));
    CHECK(stats.entries >= 80000 && draws == 2 * ((stats.entries + 32767) / 32768));
    CHECK(!render(&s, 0, 0, 0, pixels, 16 * 4, 0));
    for (int i = 0; i < 16 * 16; i++)
        CHECK(pixels[4 * i + 3] < 255);
    free(pixels);
    free(p.data);
    close_gles(gles);
}

static void words_read(void)
{
    subject s;
    fake_limits(0, GL_UNSIGNED_INT);
    OPEN_OR_SKIP(gles);
    if (!make_subject(&s, "knot", 5000, 50, 40))
        return;
    same(&s, gles);
    s.format = FXS_FORMAT_RGB565;
    same_laid_out(&s, gles, 50 * 2, 0, 0);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static int load_subject(subject *s, const char *folder, const char *name, const double up[3])
{
    char path[512];
    fxs_message m = {.text = ""};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    fxs_view view;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    fxs_options_init(&s->options);
    s->format = FXS_FORMAT_RGBA8;
    if (fxs_scene_file_open(path, 0, &file, &info, &m))
        return 0;
    int error = fxs_pack(file, &info, &s->packed, &report, 0, &m);
    fxs_scene_file_close(file);
    return CHECK(!error && !fxs_scene_open(&s->scene, s->packed.data, s->packed.bytes) &&
                 !fxs_view_frame_box(&view, report.inner_low, report.inner_high, up, &(fxs_picture){50, 479, 269},
                                     &m) &&
                 !fxs_camera_from_view(&s->camera, &view, &m));
}

static void real_scenes(void)
{
    static const struct {
        const char *name;
        double up[3];
    } scenes[] = {
        {"snowmiku/snowmiku.ply", {0, -1, 0}}, {"guitar/guitar.ply", {0, -1, 0}},
        {"luma-seal/luma-seal.ply", {0, -1, 0}}, {"boatyard-tile3/boatyard-tile3.ply", {0, 0, 1}},
        {"kitchen-marble/kitchen-marble.ply", {0, -1, 0}}, {"statue-st-peter/st-peter.ply", {0, -1, 0}},
        {"donut/donut.ply", {0, 0, 1}}, {"fruit-drops/fruit_drops_minimal.ply", {0, -1, 0}},
        {"train-1000/train-1000.ply", {0, -1, 0}},
    };
    const char *folder = getenv("FXS_SCENES");
    int seen = 0;
    OPEN_OR_SKIP(gles);
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        subject s;
        if (!load_subject(&s, folder ? folder : "../shared/scenes", scenes[i].name, scenes[i].up))
            continue;
        printf("  %s: %s\n", scenes[i].name, same(&s, gles) ? "the same bytes" : "differs");
        fxs_packed_scene_free(&s.packed);
        seen++;
    }
    close_gles(gles);
    if (!seen)
        SKIP("no scenes at FXS_SCENES");
}

/* Compares the shaders' versions of the fixed-point functions in pixel.h with the C versions. */
static void products(void)
{
    int differing = 0;
    for (int level = 0; level <= FXS_FAINT_Q11; level++)
        differing += fxs_exp_q15(level) != fxs_alpha_q15(level);
    for (int a = 0; a <= 32767; a++)
        for (int b = a & 63; b <= 32767; b += 64)
            differing += fxs_product_q15(a, b) != fxs_mul_q15(a, b);
    for (int c = -32767; c <= 32767; c++) {
        const int q24 = c * 2048 + (c & 2047), far = (c < 0 ? -1 : 1) * (1 << 26) + q24;
        const int u = fxs_distance_q13(q24), v = fxs_coordinate_q13(q24);
        differing += u > 32767 || fxs_product_q15(u, u) != fxs_mul_q15(v, v);
        differing += fxs_distance_q13(far) <= 32767;
    }
    CHECK(!differing && !wrong_factors);
}

static PFNGLGETSTRINGIPROC real_GetStringi;

static const GLubyte *GL_APIENTRY hiding_GetStringi(GLenum name, GLuint i)
{
    const GLubyte *one = real_GetStringi(name, i);
    return one && !strcmp((const char *)one, "GL_EXT_shader_framebuffer_fetch") ? 0 : one;
}

static PFNGLSHADERSOURCEPROC real_ShaderSource;

/* Simulates a driver that lists the extension for framebuffer fetch, but rejects its keyword in shaders. */
static void GL_APIENTRY unknowing_ShaderSource(GLuint shader, GLsizei count, const GLchar *const *parts, const GLint *n)
{
    static const GLchar *const broken = "#version 300 es\nvoid main() { nonsense(); }\n";
    int asks = 0;
    for (GLsizei i = 0; i < count; i++)
        asks |= strstr(parts[i], "inout ivec4 state;") != 0;
    real_ShaderSource(shader, asks ? 1 : count, asks ? &broken : parts, n);
}

static void fetch_hidden(void)
{
    subject s;
    real_GetStringi = (PFNGLGETSTRINGIPROC)port->load(context, "glGetStringi");
    real_ShaderSource = (PFNGLSHADERSOURCEPROC)port->load(context, "glShaderSource");
    if (!make_subject(&s, "knot", 2000, 50, 40))
        return;
    uint8_t *pixels = new_picture(&s);
    int error;
    fxs_gles *plain = open_gles(&error);
    const int unknowns = plain ? exact_ways(plain) : 0;
    close_gles(plain);
    for (int unknown = 0; unknown < unknowns; unknown++) {
        fake(0, unknown ? "glShaderSource" : "glGetStringi",
             unknown ? (fxs_gl_function)unknowing_ShaderSource : (fxs_gl_function)hiding_GetStringi);
        fxs_gles *gles = open_gles(&error);
        if (!CHECK(gles != 0))
            return;
        const fxs_gl_target t = {.fetch = 1};
        const char *why = fxs_gles_info(gles).no_fetch;
        CHECK(why && strstr(why, unknown ? "nonsense" : "no GL_EXT_shader_framebuffer_fetch"));
        CHECK(exact_ways(gles) == 1 && same(&s, gles));
        CHECK(render(&s, fxs_gles_draw_fetch, gles, 0, pixels, 50 * 4, 0) == FXS_ERR_UNSUPPORTED);
        CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
        close_gles(gles);
    }
    free(pixels);
    fxs_packed_scene_free(&s.packed);
}

static void fetch_eyes(void)
{
    subject s;
    OPEN_OR_SKIP(gles);
    if (!make_subject(&s, "knot", 6000, 60, 45))
        return;
    s.camera.position_q32[0] += INT64_C(3) << 32;
    fxs_camera cameras[2] = {s.camera, s.camera};
    cameras[1].position_q32[0] -= INT64_C(6) << 32;
    const fxs_object object = one_object(&s.scene);
    uint8_t *pictures[2][2];
    for (int way = 0; way < exact_ways(gles); way++) {
        for (int drawn = 0; drawn < 2; drawn++) {
            fxs_context c;
            const fxs_config config = {.size = sizeof(fxs_config), .draw = drawn ? exact[way] : 0,
                                       .draw_argument = gles,
                                       .draw_unlisted = drawn && way};
            fxs_targets targets[2];
            fxs_context_init(&c, &config);
            const size_t bytes = fxs_frame_bytes(&c, &object, 1, s.camera.width, s.camera.height, 0);
            void *memory = check_aligned(bytes);
            for (int eye = 0; eye < 2; eye++) {
                pictures[drawn][eye] = new_picture(&s);
                targets[eye] = one_target(FXS_FORMAT_RGBA8, pictures[drawn][eye], 60 * 4);
            }
            CHECK(!render_eyes(&c, &object, 1, cameras, &s.options, targets, memory, bytes, 0));
            free(memory);
        }
        for (int eye = 0; eye < 2; eye++) {
            CHECK(!memcmp(pictures[0][eye], pictures[1][eye], picture_bytes(&s)));
            free(pictures[0][eye]);
            free(pictures[1][eye]);
        }
    }
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

/* Depths and colours of an opaque mesh behind the splats: a slanted plane with holes over a colour gradient. */
typedef struct mesh {
    uint32_t *depths;
    uint8_t *colours;
} mesh;

static mesh make_mesh(const subject *s)
{
    const int width = s->camera.width, height = s->camera.height;
    mesh m = {malloc((size_t)width * (size_t)height * 4), malloc((size_t)width * (size_t)height * 4)};
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const int i = y * width + x;
            const double z = 9.0 + 8.0 * x / width - 3.0 * y / height;
            m.depths[i] = (x / 8 + y / 8) % 5 ? (uint32_t)(z * 65536) : x % 16 ? FXS_NOTHING : 0;
            m.colours[4 * i] = (uint8_t)(x * 3);
            m.colours[4 * i + 1] = (uint8_t)(y * 5);
            m.colours[4 * i + 2] = (uint8_t)(x + y);
            m.colours[4 * i + 3] = (uint8_t)(x * y);
        }
    return m;
}

static void free_mesh(mesh m)
{
    free(m.depths);
    free(m.colours);
}

static int render_mesh(const subject *s, fxs_draw_fn *draw, fxs_gles *gles, const mesh *m, int bottom_up,
                       size_t memory_bytes, uint8_t *pixels)
{
    const ptrdiff_t stride = 4 * (ptrdiff_t)s->camera.width, last = (s->camera.height - 1) * stride;
    fxs_context c;
    fxs_config config = {.size = sizeof(fxs_config), .draw = draw, .draw_argument = gles, .draw_unlisted = draw &&
                         draw != fxs_gles_draw};
    const fxs_object object = one_object(&s->scene);
    fxs_targets t = one_target(s->format, pixels, stride);
    fxs_context_init(&c, &config);
    t.occluder = (fxs_image){m->depths, stride};
    if (bottom_up)
        t.occluder = (fxs_image){(uint8_t *)m->depths + last, -stride};
    if (s->format != FXS_FORMAT_RGBA8_COVERAGE)
        t.backdrop = (fxs_image){m->colours, stride};
    size_t bytes = one_frame_bytes(&c, &s->scene, s->camera.width, s->camera.height, 0);
    bytes = memory_bytes && memory_bytes < bytes ? memory_bytes : bytes;
    void *memory = check_aligned(bytes);
    const int error = render_frame(&c, &object, 1, &s->camera, &s->options, &t, memory, bytes, 0);
    free(memory);
    return error;
}

static void meshes(void)
{
    subject s;
    for (int small = 0; small < 2; small++) {
        fake_limits(small ? 64 : 0, 0);
        OPEN_OR_SKIP(gles);
        if (!make_subject(&s, "knot", 6000, 133, 90))
            return;
        uint8_t *expected = new_picture(&s), *actual = new_picture(&s), *plain = new_picture(&s);
        const mesh m = make_mesh(&s);
        for (int i = 0; i < 6; i++) {
            s.format = (enum fxs_format)(i % 3);
            s.options.cutoff = i == 4 ? FXS_CUTOFF_SQUARE : FXS_CUTOFF_MAHALANOBIS;
            memset(expected, 0, picture_bytes(&s));
            CHECK(!render_mesh(&s, 0, 0, &m, i / 3, 0, expected));
            for (int way = 0; way < exact_ways(gles); way++) {
                memset(actual, 0, picture_bytes(&s));
                CHECK(!render_mesh(&s, exact[way], gles, &m, i / 3, i % 2 ? 700000 : 0, actual));
                CHECK(!memcmp(expected, actual, picture_bytes(&s)));
            }
        }
        s.format = FXS_FORMAT_RGBA8;
        CHECK(!render(&s, 0, 0, 0, plain, 4 * s.camera.width, 0));
        CHECK(memcmp(expected, plain, picture_bytes(&s)));
        free(expected);
        free(actual);
        free(plain);
        free_mesh(m);
        fxs_packed_scene_free(&s.packed);
        close_gles(gles);
    }
}

#define GL(type, name) ((PFNGL##type##PROC)port->load(context, "gl" #name))

enum { UNITS = 10 };                       /* number of texture units that the GLES back end binds */

/* A copy of the OpenGL state, to compare the state before and after a frame. Unsupported state stays 0. */
typedef struct state {
    GLint values[64][4], units[UNITS][3];
    GLint64 places[6][3];
    GLboolean switches[16];
} state;

static void dump(state *s)
{
    static const GLenum names[] = {
        GL_CURRENT_PROGRAM, GL_VERTEX_ARRAY_BINDING, GL_ARRAY_BUFFER_BINDING, GL_ELEMENT_ARRAY_BUFFER_BINDING,
        GL_PIXEL_PACK_BUFFER_BINDING, GL_PIXEL_UNPACK_BUFFER_BINDING, GL_UNIFORM_BUFFER_BINDING,
        GL_COPY_READ_BUFFER_BINDING, GL_COPY_WRITE_BUFFER_BINDING, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
        GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_RENDERBUFFER_BINDING, GL_ACTIVE_TEXTURE,
        GL_VIEWPORT, GL_SCISSOR_BOX, GL_COLOR_WRITEMASK, GL_DEPTH_WRITEMASK, GL_STENCIL_WRITEMASK, GL_DEPTH_FUNC,
        GL_STENCIL_FUNC, GL_STENCIL_REF, GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA,
        GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA, GL_COLOR_CLEAR_VALUE, GL_CULL_FACE_MODE, GL_FRONT_FACE,
        GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS, GL_UNPACK_ALIGNMENT,
        GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_IMAGE_HEIGHT,
        GL_UNPACK_SKIP_IMAGES, GL_DRAW_BUFFER0, GL_READ_BUFFER, GL_LINE_WIDTH, GL_POLYGON_OFFSET_FACTOR,
        GL_SHADER_STORAGE_BUFFER_BINDING, GL_DISPATCH_INDIRECT_BUFFER_BINDING};
    static const GLenum switches[] = {
        GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_DITHER, GL_RASTERIZER_DISCARD, GL_SAMPLE_ALPHA_TO_COVERAGE,
        GL_SAMPLE_COVERAGE, GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_POLYGON_OFFSET_FILL,
        GL_PRIMITIVE_RESTART_FIXED_INDEX};
    memset(s, 0, sizeof *s);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        GL(GETINTEGERV, GetIntegerv)(names[i], s->values[i]);
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        s->switches[i] = GL(ISENABLED, IsEnabled)(switches[i]);
    for (GLuint i = 0; i < UNITS; i++) {
        GL(ACTIVETEXTURE, ActiveTexture)(GL_TEXTURE0 + i);
        GL(GETINTEGERV, GetIntegerv)(GL_TEXTURE_BINDING_2D, &s->units[i][0]);
        GL(GETINTEGERV, GetIntegerv)(GL_TEXTURE_BINDING_3D, &s->units[i][1]);
        GL(GETINTEGERV, GetIntegerv)(GL_SAMPLER_BINDING, &s->units[i][2]);
    }
    GL(ACTIVETEXTURE, ActiveTexture)((GLenum)s->values[13][0]);
    for (GLuint i = 0; i < 6; i++) {
        static const GLenum of[][3] = {
            {GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE},
            {GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE}};
        for (int k = 0; k < 3; k++)
            GL(GETINTEGER64I_V, GetInteger64i_v)(of[i / 4][k], i % 4, &s->places[i][k]);
    }
    while (GL(GETERROR, GetError)())
        ;
}

static GLuint make_program(void)
{
    static const char *const texts[] = {
        "#version 300 es\nvoid main() { gl_Position = vec4(0); }\n",
        "#version 300 es\nprecision highp float;\nout vec4 c;\nvoid main() { c = vec4(1); }\n"};
    GLuint program = GL(CREATEPROGRAM, CreateProgram)();
    for (int i = 0; i < 2; i++) {
        GLuint shader = GL(CREATESHADER, CreateShader)(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        GL(SHADERSOURCE, ShaderSource)(shader, 1, &texts[i], 0);
        GL(COMPILESHADER, CompileShader)(shader);
        GL(ATTACHSHADER, AttachShader)(program, shader);
        GL(DELETESHADER, DeleteShader)(shader);
    }
    GL(LINKPROGRAM, LinkProgram)(program);
    return program;
}

enum { WIDE = 240, HIGH = 160 };

typedef struct caller {
    GLuint texture, framebuffers[2], program, vertex_array, buffers[4], samplers[UNITS], textures[UNITS], renderbuffer;
} caller;

static void upset(caller *c)
{
    static const GLenum switches[] = {GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_RASTERIZER_DISCARD,
                                      GL_SAMPLE_ALPHA_TO_COVERAGE, GL_STENCIL_TEST, GL_SCISSOR_TEST};
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        GL(ENABLE, Enable)(switches[i]);
    GL(USEPROGRAM, UseProgram)(c->program);
    GL(BINDVERTEXARRAY, BindVertexArray)(c->vertex_array);
    GL(BINDBUFFER, BindBuffer)(GL_ARRAY_BUFFER, c->buffers[0]);
    GL(BINDBUFFER, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, c->buffers[1]);
    for (GLuint i = 0; i < 6; i++) {
        const GLenum target = i < 4 ? GL_SHADER_STORAGE_BUFFER : GL_UNIFORM_BUFFER;
        if (i % 2)
            GL(BINDBUFFERRANGE, BindBufferRange)(target, i % 4, c->buffers[2], 256, 64);
        else
            GL(BINDBUFFERBASE, BindBufferBase)(target, i % 4, c->buffers[3]);
    }
    GL(BINDBUFFER, BindBuffer)(GL_SHADER_STORAGE_BUFFER, c->buffers[3]);
    GL(BINDBUFFER, BindBuffer)(GL_COPY_READ_BUFFER, c->buffers[2]);
    GL(BINDBUFFER, BindBuffer)(GL_COPY_WRITE_BUFFER, c->buffers[3]);
    GL(BINDBUFFER, BindBuffer)(GL_DISPATCH_INDIRECT_BUFFER, c->buffers[3]);
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, c->framebuffers[1]);
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_READ_FRAMEBUFFER, c->framebuffers[0]);
    GL(BINDRENDERBUFFER, BindRenderbuffer)(GL_RENDERBUFFER, c->renderbuffer);
    GL(BLENDEQUATIONSEPARATE, BlendEquationSeparate)(GL_MIN, GL_FUNC_SUBTRACT);
    GL(BLENDFUNCSEPARATE, BlendFuncSeparate)(GL_DST_ALPHA, GL_DST_COLOR, GL_SRC_ALPHA, GL_ZERO);
    GL(VIEWPORT, Viewport)(1, 2, 3, 4);
    GL(SCISSOR, Scissor)(5, 6, 7, 8);
    GL(COLORMASK, ColorMask)(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_ALIGNMENT, 1);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_ROW_LENGTH, 7);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_SKIP_PIXELS, 2);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_SKIP_ROWS, 1);
    for (GLuint i = 0; i < UNITS; i++) {
        GL(ACTIVETEXTURE, ActiveTexture)(GL_TEXTURE0 + i);
        GL(BINDTEXTURE, BindTexture)(GL_TEXTURE_2D, c->textures[i]);
        GL(BINDSAMPLER, BindSampler)(i, c->samplers[i]);
    }
}

static void settle(void)
{
    static const GLenum switches[] = {GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_RASTERIZER_DISCARD,
                                      GL_SAMPLE_ALPHA_TO_COVERAGE, GL_STENCIL_TEST, GL_SCISSOR_TEST};
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        GL(DISABLE, Disable)(switches[i]);
    GL(COLORMASK, ColorMask)(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    GL(BINDBUFFER, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
    GL(BINDBUFFER, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_ALIGNMENT, 4);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_ROW_LENGTH, 0);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_SKIP_PIXELS, 0);
    GL(PIXELSTOREI, PixelStorei)(GL_UNPACK_SKIP_ROWS, 0);
}

static caller make_caller(void)
{
    caller c;
    GL(GENTEXTURES, GenTextures)(1, &c.texture);
    GL(GENTEXTURES, GenTextures)(UNITS, c.textures);
    GL(GENSAMPLERS, GenSamplers)(UNITS, c.samplers);
    GL(GENBUFFERS, GenBuffers)(4, c.buffers);
    for (int i = 2; i < 4; i++) {
        GL(BINDBUFFER, BindBuffer)(GL_COPY_WRITE_BUFFER, c.buffers[i]);
        GL(BUFFERDATA, BufferData)(GL_COPY_WRITE_BUFFER, 1024, 0, GL_STATIC_DRAW);
    }
    GL(GENRENDERBUFFERS, GenRenderbuffers)(1, &c.renderbuffer);
    GL(GENVERTEXARRAYS, GenVertexArrays)(1, &c.vertex_array);
    GL(GENFRAMEBUFFERS, GenFramebuffers)(2, c.framebuffers);
    GL(BINDTEXTURE, BindTexture)(GL_TEXTURE_2D, c.texture);
    GL(TEXIMAGE2D, TexImage2D)(GL_TEXTURE_2D, 0, GL_RGBA8, WIDE, HIGH, 0, GL_RGBA, GL_UNSIGNED_BYTE, 0);
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_FRAMEBUFFER, c.framebuffers[0]);
    GL(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, c.texture, 0);
    c.program = make_program();
    return c;
}

static void read_target(const fxs_gl_target *t, uint8_t *pixels)
{
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_READ_FRAMEBUFFER, t->framebuffer);
    GL(READPIXELS, ReadPixels)(0, 0, WIDE, HIGH, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
}

/* Counts pixels of a target that differ from the expected picture, or from the clear colour outside of the
   picture. */
static int differing_pixels(const subject *s, const fxs_gl_target *t, const uint8_t *expected)
{
    const int width = s->camera.width, height = s->camera.height;
    uint8_t *pixels = malloc(WIDE * HIGH * 4);
    int differing = 0;
    read_target(t, pixels);
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++) {
            static const uint8_t beside[4] = {51, 102, 153, 204};
            const int column = x - t->x, line = t->top_down ? y - t->y : t->y + height - 1 - y;
            const int inside = column >= 0 && column < width && line >= 0 && line < height;
            differing += memcmp(pixels + 4 * (y * WIDE + x),
                                inside ? expected + 4 * (line * width + column) : beside, 4) != 0;
        }
    free(pixels);
    return differing;
}

static int in_target(const subject *s, const fxs_gl_target *t, const uint8_t *expected)
{
    return !differing_pixels(s, t, expected);
}

/* Draws into a target. The target must get the picture. Pixels beside the picture and the caller's OpenGL state
   must stay. */
static void check_target(const subject *s, fxs_gles *gles, caller *c, const fxs_gl_target *t,
                         const uint8_t *expected)
{
    static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    state before, after;
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, c->framebuffers[0]);
    GL(DISABLE, Disable)(GL_SCISSOR_TEST);
    GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
    upset(c);
    dump(&before);
    CHECK(!render(s, 0, gles, t, 0, 0, 0));
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    settle();
    CHECK(in_target(s, t, expected));
}

/* Tests drawing into a target. small: fake largest texture size in pixels, which splits the picture; 0: no
   limit. */
static void target_by(int small)
{
    subject s;
    fake_limits(small, 0);
    OPEN_OR_SKIP(gles);
    caller c = make_caller();
    if (!make_subject(&s, "knot", 9000, 111, 83))
        return;
    uint8_t *expected = new_picture(&s);
    for (int i = 0; i < 4 * exact_ways(gles); i++) {
        s.format = i / 2 % 2 ? FXS_FORMAT_RGBA8_COVERAGE : FXS_FORMAT_RGBA8;
        const fxs_gl_target t = {.framebuffer = c.framebuffers[0], .x = 13, .y = 7, .format = s.format,
                                   .top_down = i % 2, .fetch = i / 4};
        CHECK(!render(&s, 0, 0, 0, expected, 111 * 4, 0));
        settle();
        check_target(&s, gles, &c, &t, expected);
    }
    const fxs_gl_target t = {.framebuffer = c.framebuffers[0], .format = FXS_FORMAT_RGB565};
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
    free(expected);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static void target(void)
{
    target_by(0);
}

static void target_in_windows(void)
{
    target_by(64);
}

/* Returns the largest error of a pixel that was drawn over a colour. The expected value is over + beneath * (1 -
   alpha). */
static double off_by(const uint8_t *pixel, const uint8_t *over)
{
    static const uint8_t beneath[4] = {51, 102, 153, 204};
    double most = 0;
    for (int c = 0; c < 4; c++) {
        const double sum = over[c] + beneath[c] * (255 - over[3]) / 255.0;
        most = fmax(most, fabs(pixel[c] - fmin(sum, 255)));
    }
    return most;
}

static void target_over_by(int small)
{
    subject s;
    fake_limits(small, 0);
    OPEN_OR_SKIP(gles);
    caller c = make_caller();
    if (!make_subject(&s, "knot", 9000, 111, 83))
        return;
    s.format = FXS_FORMAT_RGBA8_COVERAGE;
    static uint8_t pixels[WIDE * HIGH * 4];
    uint8_t *expected = new_picture(&s);
    CHECK(!render(&s, 0, 0, 0, expected, 111 * 4, 0));
    for (int way = 0; way < exact_ways(gles); way++) {
        static const GLfloat beneath[4] = {0.2f, 0.4f, 0.6f, 0.8f};
        const fxs_gl_target t = {.framebuffer = c.framebuffers[0], .x = 13, .y = 7, .format = s.format,
                                   .top_down = 1, .fetch = way, .over = 1};
        double most = 0;
        settle();
        GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, c.framebuffers[0]);
        GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beneath);
        upset(&c);
        CHECK(!render(&s, 0, gles, &t, 0, 0, 0));
        settle();
        read_target(&t, pixels);
        for (int i = 0; i < 111 * 83; i++)
            most = fmax(most, off_by(pixels + 4 * ((7 + i / 111) * WIDE + 13 + i % 111), expected + 4 * i));
        if (!CHECK(most <= 1))
            printf("  off by %g, way %d\n", most, way);
    }
    const fxs_gl_target t = {.framebuffer = c.framebuffers[0], .over = 1};
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_TARGET);
    free(expected);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static void target_over(void)
{
    target_over_by(0);
    target_over_by(16);
}

/* Draws with short tile lists. A list is stored in parts of up to 32 splats. The memory for parts is full before
   the memory for the splats. */
static void target_of_short_lists(void)
{
    subject s;
    fake_limits(16, 0);
    OPEN_OR_SKIP(gles);
    caller c = make_caller();
    if (!make_subject(&s, "needles", 40, WIDE, HIGH))
        return;
    uint8_t *expected = new_picture(&s);
    const fxs_gl_target t = {.framebuffer = c.framebuffers[0], .format = s.format, .top_down = 1};
    CHECK(!render(&s, 0, 0, 0, expected, WIDE * 4, 0));
    settle();
    CHECK(!render(&s, 0, gles, &t, 0, 0, 0));
    CHECK(in_target(&s, &t, expected));
    free(expected);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static GLuint make_texture(const subject *s, const void *pixels, int top_down, GLint format, GLenum layout, GLenum type)
{
    const int width = s->camera.width, height = s->camera.height;
    GLuint texture;
    GL(GENTEXTURES, GenTextures)(1, &texture);
    GL(ACTIVETEXTURE, ActiveTexture)(GL_TEXTURE0);
    GL(BINDTEXTURE, BindTexture)(GL_TEXTURE_2D, texture);
    GL(TEXPARAMETERI, TexParameteri)(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    GL(TEXPARAMETERI, TexParameteri)(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    GL(TEXIMAGE2D, TexImage2D)(GL_TEXTURE_2D, 0, format, width, height, 0, layout, type, 0);
    for (int y = 0; y < height; y++)
        GL(TEXSUBIMAGE2D, TexSubImage2D)(GL_TEXTURE_2D, 0, 0, top_down ? y : height - 1 - y, width, 1, layout, type,
                                         (const uint8_t *)pixels + 4 * (size_t)(y * width));
    return texture;
}

/* Draws behind an opaque mesh. Mesh depths given as 32-bit words give the CPU renderer's bytes. Depth buffers
   give nearly these bytes. */
static void target_meshes(void)
{
    static uint8_t by_fragments[8][WIDE * HIGH * 4], pixels_now[WIDE * HIGH * 4];
    static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    const float near_plane = 0.5f;
    subject s;
    OPEN_OR_SKIP(gles);
    caller c = make_caller();
    if (!make_subject(&s, "knot", 9000, 111, 83))
        return;
    uint8_t *expected = new_picture(&s);
    const mesh m = make_mesh(&s);
    const int pixels = s.camera.width * s.camera.height;
    float *buffer = malloc((size_t)pixels * sizeof *buffer);
    CHECK(!render_mesh(&s, 0, 0, &m, 0, 0, expected));
    for (int i = 0; i < 8 * exact_ways(gles); i++) {
        const int top_down = i % 2, by_buffer = i / 2 % 4, reversed = by_buffer == 2;
        const float far_plane = by_buffer == 3 ? INFINITY : 100;
        for (int k = 0; k < pixels; k++) {
            const double z = m.depths[k] / 65536.0, inverse_far = 1 / (double)far_plane, inverse_near = 1 / near_plane;
            const double depth = (inverse_near - 1 / z) / (inverse_near - inverse_far);
            buffer[k] = m.depths[k] == FXS_NOTHING ? 1 : z < near_plane ? 0 : (float)depth;
            buffer[k] = reversed ? 1 - buffer[k] : buffer[k];
        }
        state before, after;
        settle();
        fxs_gl_target t;
        fxs_gl_target_init(&t);
        t.framebuffer = c.framebuffers[0];
        t.x = 13;
        t.y = 7;
        t.top_down = top_down;
        t.fetch = i / 8;
        t.plane_0 = reversed ? far_plane : near_plane;
        t.plane_1 = reversed ? near_plane : far_plane;
        if (by_buffer)
            t.depth_buffer = make_texture(&s, buffer, top_down, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT);
        else
            t.occluder = make_texture(&s, m.depths, top_down, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT);
        t.backdrop = make_texture(&s, m.colours, top_down, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
        GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, c.framebuffers[0]);
        GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
        upset(&c);
        dump(&before);
        CHECK(!render(&s, 0, gles, &t, 0, 0, 0));
        dump(&after);
        CHECK(!memcmp(&before, &after, sizeof before));
        settle();
        if (by_buffer)
            CHECK(differing_pixels(&s, &t, expected) <= pixels / 200);
        else
            CHECK(in_target(&s, &t, expected));
        read_target(&t, compute ? pixels_now : by_fragments[i % 8]);
        CHECK(!compute || !memcmp(pixels_now, by_fragments[i], sizeof pixels_now));
        GL(DELETETEXTURES, DeleteTextures)(1, by_buffer ? &t.depth_buffer : &t.occluder);
        GL(DELETETEXTURES, DeleteTextures)(1, &t.backdrop);
    }
    fxs_gl_target t = {
        .framebuffer = c.framebuffers[0], .occluder = 1, .depth_buffer = 2, .plane_0 = 1, .plane_1 = 2};
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_TARGET);
    t.occluder = 0;
    t.plane_1 = 1;
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_TARGET);
    t = (fxs_gl_target){.framebuffer = c.framebuffers[0], .backdrop = 1, .format = FXS_FORMAT_RGBA8_COVERAGE};
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_TARGET);
    free(buffer);
    free(expected);
    free_mesh(m);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

typedef struct outputs {
    GLuint framebuffer, textures[3];
} outputs;

static outputs make_outputs(void)
{
    static const struct {
        GLint format;
        GLenum layout, type;
    } formats[] = {{GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
                   {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT},
                   {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT}};
    static const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
    outputs o;
    settle();
    GL(GENFRAMEBUFFERS, GenFramebuffers)(1, &o.framebuffer);
    GL(GENTEXTURES, GenTextures)(3, o.textures);
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_FRAMEBUFFER, o.framebuffer);
    for (int i = 0; i < 3; i++) {
        GL(BINDTEXTURE, BindTexture)(GL_TEXTURE_2D, o.textures[i]);
        GL(TEXIMAGE2D, TexImage2D)(GL_TEXTURE_2D, 0, formats[i].format, WIDE, HIGH, 0, formats[i].layout,
                                   formats[i].type, 0);
        GL(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)(GL_FRAMEBUFFER, buffers[i], GL_TEXTURE_2D, o.textures[i], 0);
    }
    GL(DRAWBUFFERS, DrawBuffers)(3, buffers);
    CHECK(GL(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
    return o;
}

/* Renders a scene as two objects with different ids, into `targets` or into the caller's framebuffer. */
static int render_two(const subject *s, fxs_gles *gles, const fxs_targets *targets, const fxs_gl_target *t)
{
    fxs_context c;
    const fxs_config config = {.size = sizeof(fxs_config), .workers.run = run_backwards, .workers.count = 3};
    fxs_object objects[2] = {one_object(&s->scene), one_object(&s->scene)};
    objects[0].id = 70000;
    objects[1].id = 9;
    objects[1].translation_q32[0] = INT64_C(3) << 31;
    objects[1].translation_q32[2] = -(INT64_C(1) << 32);
    fxs_context_init(&c, &config);
    const fxs_request request = request_for(objects, 2, &s->options, 1, &s->camera, targets);
    const size_t bytes = fxs_frame_bytes(&c, objects, 2, s->camera.width, s->camera.height, 0);
    void *memory = check_aligned(bytes);
    const int error = t ? render_target(&c, gles, &request, t, memory, bytes, 0)
                        : fxs_render(&c, &request, memory, bytes, 0);
    free(memory);
    return error;
}

/* Counts 32-bit words of a framebuffer that differ from the expected picture, or from 3 outside of the picture. */
static int differing_words(const subject *s, const fxs_gl_target *t, GLenum buffer, const uint32_t *expected, int n)
{
    static GLuint words[HIGH][WIDE][4];
    int differing = 0;
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_READ_FRAMEBUFFER, t->framebuffer);
    GL(READBUFFER, ReadBuffer)(buffer);
    GL(READPIXELS, ReadPixels)(0, 0, WIDE, HIGH, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words);
    GL(READBUFFER, ReadBuffer)(GL_COLOR_ATTACHMENT0);
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++) {
            const int column = x - t->x, line = t->top_down ? y - t->y : t->y + s->camera.height - 1 - y;
            const int inside = column >= 0 && column < s->camera.width && line >= 0 && line < s->camera.height;
            for (int i = 0; i < n; i++)
                differing += words[y][x][i] != (inside ? expected[n * (line * s->camera.width + column) + i] : 3);
        }
    return differing;
}

/* Draws colours, depths and ids, which must equal the CPU's. The caller's OpenGL state must stay. */
static void check_outputs(const subject *s, fxs_gles *gles, caller *c, const outputs *o, fxs_gl_target *t,
                          const mesh *m)
{
    static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    static const GLuint three[4] = {3, 3, 3, 3};
    const size_t pixels = picture_bytes(s) / 4;
    uint8_t *colours = new_picture(s);
    uint32_t *depths = malloc(pixels * 4), *ids = malloc(pixels * 8);
    const ptrdiff_t row = 4 * (ptrdiff_t)s->camera.width;
    fxs_targets targets = one_target(s->format, colours, row);
    state before, after;
    targets.median_depth = (fxs_image){depths, row};
    targets.id = (fxs_image){ids, 2 * row};
    targets.depth_bits = t->depth_bits;
    targets.occluder = (fxs_image){m ? m->depths : 0, row};
    CHECK(!render_two(s, 0, &targets, 0));
    settle();
    t->occluder = m ? make_texture(s, m->depths, t->top_down, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT) : 0;
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, o->framebuffer);
    GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
    GL(CLEARBUFFERUIV, ClearBufferuiv)(GL_COLOR, 1, three);
    GL(CLEARBUFFERUIV, ClearBufferuiv)(GL_COLOR, 2, three);
    upset(c);
    dump(&before);
    CHECK(!render_two(s, gles, 0, t));
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    settle();
    CHECK(t->over || in_target(s, t, colours));
    CHECK(!differing_words(s, t, GL_COLOR_ATTACHMENT1, depths, 1));
    CHECK(!differing_words(s, t, GL_COLOR_ATTACHMENT2, ids, 2));
    GL(DELETETEXTURES, DeleteTextures)(1, &t->occluder);
    free(colours);
    free(depths);
    free(ids);
}

/* Tests depths and ids in framebuffers. small: fake largest texture size in pixels, which splits the tile lists;
   0: no limit. */
static void depths_and_ids_by(int small)
{
    static const char *const names[] = {"knot", "fog", "needles"};
    fake_limits(small, 0);
    OPEN_OR_SKIP(gles);
    caller c = make_caller();
    const outputs o = make_outputs();
    subject s;
    for (int i = 0; i < 6; i++) {
        if (!make_subject(&s, names[i % 3], 5000, 111, 83))
            return;
        if (i == 3)
            /* moves the camera back, so that some depths exceed 16, the largest 28-bit depth */
            s.camera.position_q32[2] -= INT64_C(7) << 32;
        const mesh m = make_mesh(&s);
        fxs_gl_target t = {.framebuffer = o.framebuffer, .x = 13, .y = 7, .top_down = i % 2, .depths_and_ids = 1,
                             .depth_bits = i == 2 ? 24 : i == 3 ? 28 : i == 4 ? 1 : 0, .over = i == 3};
        s.options.cutoff = i == 5 ? FXS_CUTOFF_SQUARE : FXS_CUTOFF_MAHALANOBIS;
        t.format = s.format = i % 3 ? FXS_FORMAT_RGBA8 : FXS_FORMAT_RGBA8_COVERAGE;
        check_outputs(&s, gles, &c, &o, &t, i == 1 || i == 4 ? &m : 0);
        free_mesh(m);
        fxs_packed_scene_free(&s.packed);
    }
    close_gles(gles);
}

static void depths_and_ids(void)
{
    depths_and_ids_by(0);
    depths_and_ids_by(16);
}

static void GL_APIENTRY untracing_ShaderSource(GLuint shader, GLsizei count, const GLchar *const *parts, const GLint *n)
{
    static const GLchar *const broken = "#version 300 es\nvoid main() { nonsense(); }\n";
    int asks = 0;
    for (GLsizei i = 0; i < count; i++)
        asks |= !strcmp(parts[i], "#define TRACED\n");
    real_ShaderSource(shader, asks ? 1 : count, asks ? &broken : parts, n);
}

static void depths_and_ids_without_shader(void)
{
    subject s;
    real_ShaderSource = (PFNGLSHADERSOURCEPROC)port->load(context, "glShaderSource");
    fake(0, "glShaderSource", (fxs_gl_function)untracing_ShaderSource);
    OPEN_OR_SKIP(gles);
    const outputs o = make_outputs();
    if (!make_subject(&s, "knot", 100, 40, 30))
        return;
    fxs_gl_target t = {.framebuffer = o.framebuffer, .depths_and_ids = 1};
    for (int i = 0; i < 2; i++)
        CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
    t.depths_and_ids = 0;
    CHECK(!render(&s, 0, gles, &t, 0, 0, 0));
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static void depths_and_ids_refused(void)
{
    subject s;
    OPEN_OR_SKIP(gles);
    if (!make_subject(&s, "knot", 100, 40, 30))
        return;
    fxs_gl_target t = {.depths_and_ids = 1};
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_TARGET);
    t.framebuffer = 1;
    t.fetch = 1;
    CHECK(render(&s, 0, gles, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

static int open_compute_by(fxs_gl_load_fn *by, GLint size)
{
    fake_limits(size, 0);
    const int error = fxs_compute_create(&compute, by, port->use, context, &why_not);
    memset(fakes, 0, sizeof fakes);
    return error;
}

static int open_compute(GLint size)
{
    return open_compute_by(load, size);
}

static void close_compute(void)
{
    fxs_compute_destroy(compute);
    compute = 0;
    no_blocks = 0;
}

/* Runs a test of the compute back end twice: with a storage buffer, then with a texture of several rows in its
   place. */
static void run_by_compute(void (*test)(void))
{
    for (int by_texture = 0; by_texture < 2; by_texture++) {
        no_blocks = by_texture;
        if (open_compute(by_texture ? 256 : 0))
            SKIP(why_not.text);
        test();
        close_compute();
    }
}

static void compute_target(void)
{
    run_by_compute(target);
}

static void compute_target_over(void)
{
    run_by_compute(target_over);
}

static void compute_target_meshes(void)
{
    run_by_compute(target_meshes);
}

static void one_depths_and_ids(void)
{
    depths_and_ids_by(0);
    depths_and_ids_refused();
}

static void compute_depths_and_ids(void)
{
    run_by_compute(one_depths_and_ids);
}

static fxs_gl_function load_losing(void *argument, const char *name)
{
    return losing_load(load, argument, name);
}

/* Fails each OpenGL call of a frame in turn. The target must be complete or untouched. The next frame must be right. */
static void compute_draws_lose_by(int by_texture)
{
    static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    static const GLenum losses[] = {CONTEXT_LOST, GL_OUT_OF_MEMORY};
    subject s, none;
    long calls = 1, fails = 0;
    caller c = make_caller();
    fxs_gl_target t = {.framebuffer = c.framebuffers[0], .x = 13, .y = 7};
    no_blocks = by_texture;
    if (!make_subject(&s, "knot", 500, 111, 83))
        return;
    none = s;
    none.camera.width = none.camera.height = 0;
    uint8_t *expected = new_picture(&s);
    const mesh m = make_mesh(&s);
    t.occluder = make_texture(&s, m.depths, 0, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT);
    t.backdrop = make_texture(&s, m.colours, 0, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
    CHECK(!render_mesh(&s, 0, 0, &m, 0, 0, expected));
    for (long n = -1; n < calls && !check_faults; n += 1 + n / 64) {
        settle();
        GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, c.framebuffers[0]);
        GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
        lose_after(n < 0 ? LONG_MAX : n, losses[n % 2 == 1]);
        const int error = render(&s, 0, 0, &t, 0, 0, 0);
        calls = n < 0 ? LONG_MAX - calls_left : calls;
        find_again();
        fails += error != 0;
        settle();
        if (!CHECK(!error || (n >= 0 && is_loss(error))) ||
            !CHECK(in_target(&s, &t, expected) || (error && in_target(&none, &t, expected))))
            printf("  call %ld of %ld: %d, %s\n", n, calls, error, why_not.text);
        CHECK(!render(&s, 0, 0, &t, 0, 0, 0) && in_target(&s, &t, expected));
    }
    CHECK(calls > 100 && fails > 50);
    GL(DELETETEXTURES, DeleteTextures)(1, &t.occluder);
    GL(DELETETEXTURES, DeleteTextures)(1, &t.backdrop);
    free(expected);
    free_mesh(m);
    fxs_packed_scene_free(&s.packed);
}

static void compute_draws_lose(void)
{
    for (int by_texture = 0; by_texture < 2; by_texture++) {
        no_blocks = by_texture;
        if (open_compute_by(load_losing, by_texture ? 256 : 0))
            SKIP(why_not.text);
        compute_draws_lose_by(by_texture);
        close_compute();
    }
}

static int waits;                          /* number of calls that wait for the device */
static fxs_gl waiting_gl;
static fxs_compute_gl waiting_more;

static void *GL_APIENTRY counted_MapBufferRange(GLenum target, GLintptr at, GLsizeiptr bytes, GLbitfield access)
{
    waits += (access & GL_MAP_READ_BIT) != 0;
    return waiting_gl.MapBufferRange(target, at, bytes, access);
}

static void GL_APIENTRY counted_GetQueryObjectuiv(GLuint query, GLenum name, GLuint *value)
{
    waits++;
    waiting_gl.GetQueryObjectuiv(query, name, value);
}

static void GL_APIENTRY counted_Finish(void)
{
    waits++;
    waiting_more.Finish();
}

static void GL_APIENTRY unsignaled_GetSynciv(GLsync sync, GLenum name, GLsizei size, GLsizei *length, GLint *value)
{
    (void)sync, (void)name, (void)size, (void)length;
    *value = GL_UNSIGNALED;
}

/* Draws more frames than statuses are kept, on a device that finishes none of them. */
static void compute_draws_without_waiting(void)
{
    static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    subject s;
    fxs_stats stats, expected_stats;
    caller c = make_caller();
    const fxs_gl_target t = {.framebuffer = c.framebuffers[0]};
    if (open_compute(0))
        SKIP(why_not.text);
    if (!make_subject(&s, "knot", 500, 111, 83))
        return;
    uint8_t *expected = new_picture(&s);
    CHECK(!render(&s, 0, 0, 0, expected, 4 * 111, &expected_stats));
    waiting_gl = compute->gl;
    waiting_more = compute->more;
    compute->gl.MapBufferRange = counted_MapBufferRange;
    compute->gl.GetQueryObjectuiv = counted_GetQueryObjectuiv;
    compute->more.Finish = counted_Finish;
    compute->more.GetSynciv = unsignaled_GetSynciv;
    waits = 0;
    settle();
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, c.framebuffers[0]);
    GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
    for (int i = 0; i < FXS_COMPUTE_FLIGHTS + 2; i++)
        CHECK(!render(&s, 0, 0, &t, 0, 0, &stats) && !stats.visible);
    CHECK(!waits && in_target(&s, &t, expected));
    compute->more.GetSynciv = waiting_more.GetSynciv;
    CHECK(!fxs_compute_wait(compute, &stats, &why_not) && waits == 1 + FXS_COMPUTE_FLIGHTS);
    CHECK(stats.visible == expected_stats.visible && stats.drawn == expected_stats.drawn);
    close_compute();
    free(expected);
    fxs_packed_scene_free(&s.packed);
}

/* Draws two eyes with maps of rates, and compares with the processor. */
static void draw_with_rates(const fxs_request *request, const fxs_gl_target *targets, const subject *eyes)
{
    uint8_t rates[4] = {1, 2, 4, 2};                       /* 2 x 2 macro tiles */
    fxs_request own = *request;
    uint8_t *expected[2];
    fxs_renderer *cpu;
    if (!CHECK(!fxs_renderer_create("cpu", 0, &cpu, &why_not)))
        return;
    for (int eye = 0; eye < 2; eye++) {
        expected[eye] = new_picture(&eyes[eye]);
        fxs_targets_init(&own.targets[eye]);
        own.targets[eye].rates = (fxs_image){rates, 2};
        own.targets[eye].colour = (fxs_image){expected[eye], 4 * eyes[eye].camera.width};
    }
    CHECK(!fxs_renderer_render(cpu, &own, 0, &why_not));
    CHECK(!draw_by_compute(&own, targets, 0) && !fxs_compute_wait(compute, 0, &why_not));
    for (int eye = 0; eye < 2; eye++) {
        CHECK(in_target(&eyes[eye], &targets[eye], expected[eye]));
        free(expected[eye]);
    }
    fxs_renderer_destroy(cpu);
}

static void clear_target(const fxs_gl_target *target)
{
    static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, target->framebuffer);
    GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
}

/* Draws two eyes into two framebuffers, and compares each with a frame of one eye. */
static void draw_apart(const fxs_request *request, const fxs_gl_target *targets, const subject *eyes)
{
    fxs_stats stats, of_eye = {0}, sum = {0};
    for (int eye = 0; eye < 2; eye++)
        clear_target(&targets[eye]);
    settle();
    CHECK(!draw_by_compute(request, targets, &stats) && !fxs_compute_wait(compute, &stats, &why_not));
    for (int eye = 0; eye < 2; eye++) {
        uint8_t *expected = new_picture(&eyes[eye]);
        CHECK(!render(&eyes[eye], 0, 0, 0, expected, 4 * 60, &of_eye));
        CHECK(in_target(&eyes[eye], &targets[eye], expected));
        sum.visible += of_eye.visible;
        free(expected);
    }
    CHECK(stats.visible == sum.visible && stats.drawn == of_eye.drawn);
}

/* Draws two eyes side by side into the framebuffer of the first target. */
static void draw_side_by_side(const fxs_request *request, const fxs_gl_target *targets, const subject *eyes)
{
    const fxs_gl_target both[2] = {targets[0], {.framebuffer = targets[0].framebuffer, .x = 60}};
    subject wide = eyes[0];
    wide.camera.width = 120;
    uint8_t *expected = new_picture(&wide);
    clear_target(both);
    settle();
    CHECK(!draw_by_compute(request, both, 0) && !fxs_compute_wait(compute, 0, &why_not));
    for (int eye = 0; eye < 2; eye++)
        CHECK(!render(&eyes[eye], 0, 0, 0, expected + 4 * 60 * eye, 4 * 120, 0));
    CHECK(in_target(&wide, both, expected));
    free(expected);
}

/* Makes the two layers of an array texture the colour buffers of the targets. */
static void attach_layers(const fxs_gl_target *targets)
{
    GLuint layers;
    GL(GENTEXTURES, GenTextures)(1, &layers);
    GL(BINDTEXTURE, BindTexture)(GL_TEXTURE_2D_ARRAY, layers);
    GL(TEXIMAGE3D, TexImage3D)(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA8, WIDE, HIGH, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, 0);
    for (int eye = 0; eye < 2; eye++) {
        GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_FRAMEBUFFER, targets[eye].framebuffer);
        GL(FRAMEBUFFERTEXTURELAYER, FramebufferTextureLayer)(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, layers, 0, eye);
    }
}

static void compute_draws_two_eyes(void)
{
    subject eyes[2];
    if (open_compute(0))
        SKIP(why_not.text);
    caller callers[2] = {make_caller(), make_caller()};
    if (!make_subject(&eyes[0], "knot", 6000, 60, 45))
        return;
    eyes[1] = eyes[0];
    eyes[1].camera.position_q32[0] -= INT64_C(3) << 32;
    const fxs_camera cameras[2] = {eyes[0].camera, eyes[1].camera};
    const fxs_object object = one_object(&eyes[0].scene);
    const fxs_request request = request_for(&object, 1, &eyes[0].options, 2, cameras, 0);
    const fxs_gl_target targets[2] = {{.framebuffer = callers[0].framebuffers[0]},
                                      {.framebuffer = callers[1].framebuffers[0], .x = 5}};
    draw_apart(&request, targets, eyes);
    draw_with_rates(&request, targets, eyes);
    draw_side_by_side(&request, targets, eyes);
    attach_layers(targets);
    draw_apart(&request, targets, eyes);
    close_compute();
    fxs_packed_scene_free(&eyes[0].packed);
}

static void GL_APIENTRY unshown_ShaderSource(GLuint shader, GLsizei count, const GLchar *const *parts, const GLint *n)
{
    static const GLchar *const broken = "#version 310 es\nvoid main() {\n    that;\n}\n";
    const int is_shown = strstr(parts[count - 1], "uvec4 bytes") != 0;
    real_ShaderSource(shader, is_shown ? 1 : count, is_shown ? &broken : parts, n);
}

static void compute_without_shader(void)
{
    subject s;
    state before, after;
    caller c = make_caller();
    const fxs_gl_target t = {.framebuffer = c.framebuffers[0]};
    real_ShaderSource = (PFNGLSHADERSOURCEPROC)port->load(context, "glShaderSource");
    fake(1, "glShaderSource", (fxs_gl_function)unshown_ShaderSource);
    if (open_compute(0))
        SKIP(why_not.text);
    if (!make_subject(&s, "knot", 100, 40, 30))
        return;
    upset(&c);
    dump(&before);
    for (int i = 0; i < 2; i++) {
        CHECK(render(&s, 0, 0, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
        CHECK(strstr(why_not.text, "a shader of the framebuffer does not compile: "));
        CHECK(strstr(why_not.text, ":3") || strstr(why_not.text, "(3)"));
        CHECK(!strchr(why_not.text, '\n'));
    }
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    settle();
    close_compute();
    fxs_packed_scene_free(&s.packed);
}

static void compute_refuses(void)
{
    state before, after;
    subject s;
    caller c = make_caller();
    upset(&c);
    dump(&before);
    no_blocks = 1;
    if (open_compute(64))
        SKIP(why_not.text);
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    settle();
    if (!make_subject(&s, "knot", 100, 80, 64))
        return;
    fxs_gl_target t = {.framebuffer = c.framebuffers[0]};
    CHECK(render(&s, 0, 0, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
    CHECK(!strcmp(why_not.text, "the picture is larger than the device's textures"));
    t.fetch = 1;
    CHECK(render(&s, 0, 0, &t, 0, 0, 0) == FXS_ERR_UNSUPPORTED);
    t.fetch = 0;
    t.depth_bits = 29;
    CHECK(render(&s, 0, 0, &t, 0, 0, 0) == FXS_ERR_TARGET);
    CHECK(fxs_compute_draw(compute, 0, 0, &t, 0, 0, &why_not) == FXS_ERR_ARGUMENT);
    t.depth_bits = 0;
    fxs_packed_scene_free(&s.packed);
    if (!make_subject(&s, "knot", 100, 64, 64))
        return;
    upset(&c);
    dump(&before);
    CHECK(!render(&s, 0, 0, &t, 0, 0, 0));
    close_compute();
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    settle();
    fxs_packed_scene_free(&s.packed);
}

static void init_keeps_state(void)
{
    state before, after;
    caller c = make_caller();
    upset(&c);
    dump(&before);
    OPEN_OR_SKIP(gles);
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    close_gles(gles);
    dump(&after);
    CHECK(!memcmp(&before, &after, sizeof before));
    settle();
}

/* calls: number of calls of the function loader; missing: index of the call that fails */
static int calls, missing;
static char missing_name[64];

static fxs_gl_function load_but_one(void *argument, const char *name)
{
    if (calls++ != missing)
        return load(argument, name);
    snprintf(missing_name, sizeof missing_name, "%s", name);
    return 0;
}

static void missing_functions(void)
{
    fxs_gles *gles = 0;
    int error = FXS_ERR_UNSUPPORTED;
    for (missing = 0; error == FXS_ERR_UNSUPPORTED && missing < 200; missing++) {
        fxs_message said = {.text = ""};
        calls = 0;
        error = fxs_gles_create(&gles, load_but_one, 0, context, &said);
        CHECK(error ? strstr(said.text, missing_name) != 0 : missing == calls);
    }
    CHECK(!error && missing > 50);
    fxs_gles_destroy(gles);
}

static void GL_APIENTRY broken_ShaderSource(GLuint shader, GLsizei count, const GLchar *const *parts, const GLint *n)
{
    static const GLchar *const broken = "#version 300 es\nvoid main() { nonsense(); }\n";
    (void)count, (void)parts, (void)n;
    real_ShaderSource(shader, 1, &broken, 0);
}

static PFNGLGETSTRINGPROC real_GetString;
static const char *fake_version;

static const GLubyte *GL_APIENTRY fake_GetString(GLenum name)
{
    return name == GL_VERSION ? (const GLubyte *)fake_version : real_GetString(name);
}

static const GLubyte *GL_APIENTRY no_GetStringi(GLenum name, GLuint i)
{
    (void)name, (void)i;
    return 0;
}

static void refuses(const char *words)
{
    int error;
    fxs_gles *gles = open_gles(&error);
    if (!CHECK(error == FXS_ERR_UNSUPPORTED && !gles && strstr(why_not.text, words)))
        printf("  said: %s\n", why_not.text);
    close_gles(gles);
}

static void unfit_contexts(void)
{
    static const char *const old[] = {"OpenGL ES 2.0 old", "OpenGL ES-CM 1.1", "2.1 Mesa", "3.2 Mesa"};
    real_ShaderSource = (PFNGLSHADERSOURCEPROC)port->load(context, "glShaderSource");
    real_GetString = (PFNGLGETSTRINGPROC)port->load(context, "glGetString");
    fake(0, "glShaderSource", (fxs_gl_function)broken_ShaderSource);
    refuses("the shader does not compile: ");
    CHECK(strstr(why_not.text, "nonsense"));
    for (size_t i = 0; i < sizeof old / sizeof *old; i++) {
        fake_version = old[i];
        fake(0, "glGetString", (fxs_gl_function)fake_GetString);
        refuses("too old");
        CHECK(strstr(why_not.text, old[i]));
    }
    fake_version = "3.3 Mesa";
    fake(0, "glGetString", (fxs_gl_function)fake_GetString);
    fake(1, "glGetStringi", (fxs_gl_function)no_GetStringi);
    refuses("no GL_ARB_ES3_compatibility");
    fake_version = 0;
    fake(0, "glGetString", (fxs_gl_function)fake_GetString);
    refuses("no context");
    fake_limits(15, 0);
    refuses("16x16");
}

static int good_calls;                     /* number of OpenGL calls that succeed before the device is lost */
static PFNGLMAPBUFFERRANGEPROC real_MapBufferRange;
static PFNGLUNMAPBUFFERPROC real_UnmapBuffer;

static void *GL_APIENTRY lost_MapBufferRange(GLenum name, GLintptr offset, GLsizeiptr bytes, GLbitfield access)
{
    return good_calls-- > 0 ? real_MapBufferRange(name, offset, bytes, access) : 0;
}

static GLboolean GL_APIENTRY lost_UnmapBuffer(GLenum name)
{
    GLboolean unmapped = real_UnmapBuffer(name);
    return good_calls-- > 0 ? unmapped : GL_FALSE;
}

static GLenum GL_APIENTRY lost_GetError(void)
{
    return good_calls-- > 0 ? GL_NO_ERROR : 0x0507;
}

static GLenum GL_APIENTRY full_GetError(void)
{
    return good_calls-- > 0 ? GL_NO_ERROR : GL_OUT_OF_MEMORY;
}

static void *GL_APIENTRY full_MapBufferRange(GLenum name, GLintptr offset, GLsizeiptr bytes, GLbitfield access)
{
    return good_calls > 0 ? real_MapBufferRange(name, offset, bytes, access) : 0;
}

static GLenum GL_APIENTRY lost_CheckFramebufferStatus(GLenum name)
{
    (void)name;
    return good_calls-- > 0 ? GL_FRAMEBUFFER_COMPLETE : 0;
}

/* Fails an OpenGL function from its n-th call on, for each n until a frame succeeds. */
static void loses(const subject *s, const char *name, fxs_gl_function function, int least_calls, int expected)
{
    int error = expected, n;
    for (n = 0; n < 100 && error; n++) {
        uint8_t *pixels = new_picture(s);
        good_calls = 1000;
        fake(0, name, function);
        fxs_gles *gles = open_gles(&error);
        if (!CHECK(gles != 0))
            return;
        good_calls = n;
        error = render(s, fxs_gles_draw, gles, 0, pixels, (ptrdiff_t)s->camera.width * 4, 0);
        CHECK(!error || error == expected);
        good_calls = n;
        int fetch_error = render(s, exact[exact_ways(gles) - 1], gles, 0, pixels, (ptrdiff_t)s->camera.width * 4, 0);
        CHECK(!fetch_error || fetch_error == expected);
        close_gles(gles);
        free(pixels);
    }
    CHECK(n > least_calls && n < 100);
}

static void lost_devices(void)
{
    subject s;
    if (!make_subject(&s, "knot", 2000, 64, 48))
        return;
    real_MapBufferRange = (PFNGLMAPBUFFERRANGEPROC)port->load(context, "glMapBufferRange");
    real_UnmapBuffer = (PFNGLUNMAPBUFFERPROC)port->load(context, "glUnmapBuffer");
    loses(&s, "glMapBufferRange", (fxs_gl_function)lost_MapBufferRange, 2, FXS_ERR_DEVICE);
    loses(&s, "glUnmapBuffer", (fxs_gl_function)lost_UnmapBuffer, 2, FXS_ERR_DEVICE);
    loses(&s, "glGetError", (fxs_gl_function)lost_GetError, 2, FXS_ERR_DEVICE);
    loses(&s, "glGetError", (fxs_gl_function)full_GetError, 2, FXS_ERR_MEMORY);
    loses(&s, "glCheckFramebufferStatus", (fxs_gl_function)lost_CheckFramebufferStatus, 1, FXS_ERR_DEVICE);
    good_calls = 0;
    fake(0, "glCheckFramebufferStatus", (fxs_gl_function)lost_CheckFramebufferStatus);
    int error;
    CHECK(!open_gles(&error) && error && strstr(why_not.text, "RGBA16I"));
    memset(fakes, 0, sizeof fakes);
    fxs_packed_scene_free(&s.packed);
}

static void full_device(void)
{
    subject s;
    fake(0, "glMapBufferRange", (fxs_gl_function)full_MapBufferRange);
    fake(1, "glGetError", (fxs_gl_function)full_GetError);
    good_calls = 1000;
    OPEN_OR_SKIP(gles);
    if (!make_subject(&s, "knot", 2000, 64, 48))
        return;
    uint8_t *pixels = new_picture(&s);
    for (int way = 0; way < exact_ways(gles); way++)
        CHECK(!render(&s, exact[way], gles, 0, pixels, 64 * 4, 0));
    good_calls = 0;
    for (int way = 0; way < exact_ways(gles); way++)
        CHECK(render(&s, exact[way], gles, 0, pixels, 64 * 4, 0) == FXS_ERR_MEMORY);
    free(pixels);
    fxs_packed_scene_free(&s.packed);
    close_gles(gles);
}

typedef struct turn {
    void *context;
    fxs_gles *gles;
    caller caller;
} turn;

static void contexts_in_turn(void)
{
    static const int order[] = {0, 2, 0, 3, 1, 3, 1, 0, 2, 1};
    subject s;
    turn turns[4] = {{0}};
    int count = 0;
    for (int i = 0; i < 4 && ports[i / 2].name; i++) {
        turn *t = &turns[count];
        port = &ports[i / 2];
        if (port->open(&t->context, &why_not))
            SKIP(why_not.text);
        context = t->context;
        t->caller = make_caller();
        count += CHECK(!fxs_gles_create(&t->gles, port->load, port->use, context, &why_not));
    }
    if (count < 4)
        SKIP("not both EGL and OSMesa here");
    if (!make_subject(&s, "knot", 4000, 111, 83))
        return;
    uint8_t *expected = new_picture(&s);
    CHECK(!render(&s, 0, 0, 0, expected, 111 * 4, 0));
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        same(&s, turns[order[i]].gles);
    for (int i = 0; i < 4; i++) {
        static const GLfloat beside[4] = {0.2f, 0.4f, 0.6f, 0.8f};
        const int other = (i + 2) % 4;
        const fxs_gl_target t = {.framebuffer = turns[i].caller.framebuffers[0], .x = 13, .y = 7, .top_down = i % 2};
        port = &ports[i / 2];
        context = turns[i].context;
        port->use(context);
        settle();
        GL(BINDBUFFER, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
        GL(BINDFRAMEBUFFER, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, t.framebuffer);
        GL(CLEARBUFFERFV, ClearBufferfv)(GL_COLOR, 0, beside);
        ports[other / 2].use(turns[other].context);
        CHECK(!render(&s, 0, turns[i].gles, &t, 0, 0, 0));
        CHECK(in_target(&s, &t, expected));
    }
    for (int i = 0; i < 4; i++)
        fxs_gles_destroy(turns[i].gles);
    for (int i = 0; i < 4; i++)
        ports[i / 2].close(turns[i].context);
    free(expected);
    fxs_packed_scene_free(&s.packed);
}

static int use_nothing(void *argument)
{
    (void)argument;
    return -1;
}

static void context_that_cannot_be_used(void)
{
    fxs_gles *gles;
    CHECK(fxs_gles_create(&gles, load, use_nothing, context, &why_not) == FXS_ERR_DEVICE && !gles);
    CHECK(strstr(why_not.text, "current"));
}

int main(void)
{
    for (port = ports; port->name; port++) {
        printf("%s:\n", port->name);
        if (port->open(&context, &why_not)) {
            printf("  skipped: %s\nskip %s\n", why_not.text, port->name);
            check_skipped++;
            continue;
        }
        RUN(sizes);
        RUN(formats);
        RUN(runs);
        RUN(small_textures);
        RUN(long_list);
        RUN(words_read);
        RUN(real_scenes);
        RUN(products);
        RUN(fetch_hidden);
        RUN(fetch_eyes);
        RUN(meshes);
        RUN(target);
        RUN(target_in_windows);
        RUN(target_over);
        RUN(target_of_short_lists);
        RUN(target_meshes);
        RUN(depths_and_ids);
        RUN(depths_and_ids_without_shader);
        RUN(depths_and_ids_refused);
        /* with OSMesa the tests are left out, since OSMesa has desktop OpenGL, not OpenGL ES */
        if (!strcmp(port->name, "EGL")) {
            RUN(compute_target);
            RUN(compute_target_over);
            RUN(compute_target_meshes);
            RUN(compute_depths_and_ids);
            RUN(compute_refuses);
            RUN(compute_draws_lose);
            RUN(compute_draws_without_waiting);
            RUN(compute_draws_two_eyes);
            RUN(compute_without_shader);
        }
        RUN(init_keeps_state);
        RUN(missing_functions);
        RUN(unfit_contexts);
        RUN(lost_devices);
        RUN(full_device);
        RUN(context_that_cannot_be_used);
        port->close(context);
    }
    RUN(contexts_in_turn);
    return check_report();
}
#endif
