/* headset SCENE gles|compute: the frame loop of an OpenXR program, with a small imitation of the OpenXR runtime. The
 * GPU draws each eye's colour and median depth. The imitation reprojects these pictures by depth to a newer head pose.
 * Prints "ok" or a fault. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLES3/gl3.h>

#include <fixsplat/camera.h>
#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/kernels.h>

enum { WIDTH = 208, HEIGHT = 224, IMAGES = 3, FRAMES = 4 };
#define NEAR_PLANE 0.1f            /* near plane of the depth images; their far plane is 100 */

/* ---- Imitations of XrPosef, XrFovf, XrView and a swapchain ------------------------------------------------------- */

typedef struct pose {
    double orientation[4];
    double position[3];            /* position in metres: x right, y up, z back */
} pose;

typedef struct fov {
    double left, right, up, down;  /* field of view: angles in radians; left and down are negative */
} fov;

typedef struct view {
    pose pose;
    fov fov;
} view;

typedef struct swapchain {
    GLuint colours[IMAGES], depths[IMAGES], framebuffers[2][IMAGES];
    unsigned acquired;
} swapchain;

/* ---- OpenGL ES functions ----------------------------------------------------------------------------------------- */

#define FUNCTIONS(_) \
    _(void, GenTextures, (GLsizei, GLuint *)) \
    _(void, BindTexture, (GLenum, GLuint)) \
    _(void, TexStorage2D, (GLenum, GLsizei, GLenum, GLsizei, GLsizei)) \
    _(void, TexParameteri, (GLenum, GLenum, GLint)) \
    _(void, GenFramebuffers, (GLsizei, GLuint *)) \
    _(void, BindFramebuffer, (GLenum, GLuint)) \
    _(void, FramebufferTexture2D, (GLenum, GLenum, GLenum, GLuint, GLint)) \
    _(void, DrawBuffers, (GLsizei, const GLenum *)) \
    _(void, ReadBuffer, (GLenum)) \
    _(void, ReadPixels, (GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void *)) \
    _(GLuint, CreateProgram, (void)) \
    _(GLuint, CreateShader, (GLenum)) \
    _(void, ShaderSource, (GLuint, GLsizei, const GLchar *const *, const GLint *)) \
    _(void, CompileShader, (GLuint)) \
    _(void, AttachShader, (GLuint, GLuint)) \
    _(void, LinkProgram, (GLuint)) \
    _(void, UseProgram, (GLuint)) \
    _(void, Viewport, (GLint, GLint, GLsizei, GLsizei)) \
    _(void, Enable, (GLenum)) \
    _(void, Disable, (GLenum)) \
    _(void, DepthFunc, (GLenum)) \
    _(void, DrawArrays, (GLenum, GLint, GLsizei)) \
    _(GLenum, GetError, (void))

static struct {
#define MEMBER(result, name, arguments) result (*name) arguments;
    FUNCTIONS(MEMBER)
} gl;

static int load_functions(void *egl)
{
    int all = 1;
#define LOAD(result, name, arguments) \
    gl.name = (result (*) arguments)fxs_egl_load(egl, "gl" #name), all = all && gl.name;
    FUNCTIONS(LOAD)
    return all;
}

/* ---- The imitated OpenXR runtime --------------------------------------------------------------------------------- */

static GLuint make_texture(GLenum format)
{
    GLuint texture;
    gl.GenTextures(1, &texture);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.TexStorage2D(GL_TEXTURE_2D, 1, format, WIDTH, HEIGHT);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

static void attach(GLuint framebuffer, GLenum attachment, GLuint texture)
{
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
}

static void make_swapchain(swapchain *s, GLuint medians, GLuint ids)
{
    static const GLenum three[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
    memset(s, 0, sizeof *s);
    gl.GenFramebuffers(2 * IMAGES, s->framebuffers[0]);
    for (int i = 0; i < IMAGES; i++) {
        s->colours[i] = make_texture(GL_RGBA8);
        s->depths[i] = make_texture(GL_DEPTH_COMPONENT32F);
        attach(s->framebuffers[1][i], GL_DEPTH_ATTACHMENT, s->depths[i]);
        attach(s->framebuffers[0][i], three[0], s->colours[i]);
        attach(s->framebuffers[0][i], three[1], medians);
        attach(s->framebuffers[0][i], three[2], ids);
        gl.DrawBuffers(3, three);
    }
}

/* Imitates xrLocateViews: eyes 63 mm apart in a moving head, with the fields of view of a real headset. */
static void locate_views(int frame, view views[2])
{
    const double turn = 0.05 * frame, sine = sin(turn / 2), cosine = cos(turn / 2);
    for (int eye = 0; eye < 2; eye++) {
        const double apart = eye ? 0.0315 : -0.0315;
        const pose p = {{0, sine, 0, cosine}, {apart * cos(turn) + 0.1 * frame, 0.4, 2.4 - apart * sin(turn)}};
        const fov wide = {-0.94, 0.70, 0.77, -0.87}, mirrored = {-0.70, 0.94, 0.77, -0.87};
        views[eye].pose = p;
        views[eye].fov = eye ? mirrored : wide;
    }
}

/* ---- The OpenXR program ------------------------------------------------------------------------------------------ */

/* Fills in the rotation from world to camera, with y down and z forward. OpenXR's orientation is camera to world,
   with y up and z back. */
static void turn(const pose *p, double rotation[9], double position[3])
{
    const double x = p->orientation[0], y = p->orientation[1], z = p->orientation[2], w = p->orientation[3];
    const double to_world[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                                2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                                2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)};
    const double flip[3] = {1, -1, -1};        /* flips the y and z axes of the camera and of the world */
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            rotation[3 * row + column] = flip[row] * to_world[3 * column + row] * flip[column];
    for (int i = 0; i < 3; i++)
        position[i] = flip[i] * p->position[i];
}

static int camera_of(const view *v, fxs_camera *camera)
{
    fxs_message message;
    fxs_view file;
    const double tangents[4] = {tan(v->fov.left), tan(v->fov.right), tan(v->fov.up), tan(v->fov.down)};
    memset(&file, 0, sizeof file);
    file.width = WIDTH;
    file.height = HEIGHT;
    file.near = NEAR_PLANE;
    turn(&v->pose, file.rotation, file.position);
    if (fxs_view_set_tangents(&file, tangents, &message) || fxs_camera_from_view(camera, &file, &message))
        return puts(message.text), 1;
    return 0;
}

typedef struct program {
    fxs_scene scene;
    fxs_object object;
    fxs_context context;
    fxs_options options;
    fxs_gles *gles;
    fxs_compute *compute;
    fxs_compute_scene copy;
    GLuint medians, ids, copies, copying;
    GLuint to_depth, to_words;
    void *allocation, *memory;
    size_t bytes;
    uint32_t depths[2][HEIGHT * WIDTH];            /* median depths drawn by the processor, multiplied by 2^16 */
    unsigned char colours[2][HEIGHT * WIDTH * 4];
} program;

static GLuint make_program(const char *fragment)
{
    static const char vertex[] =
        "#version 300 es\n"
        "void main() { gl_Position = vec4(ivec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1); }";
    const GLuint program = gl.CreateProgram();
    for (int i = 0; i < 2; i++) {
        const GLchar *text = i ? fragment : vertex;
        const GLuint shader = gl.CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        gl.ShaderSource(shader, 1, &text, 0);
        gl.CompileShader(shader);
        gl.AttachShader(program, shader);
    }
    gl.LinkProgram(program);
    return program;
}

static void draw_over(GLuint framebuffer, GLuint program, GLuint texture)
{
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.UseProgram(program);
    gl.Viewport(0, 0, WIDTH, HEIGHT);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

/* Fragment shader that converts median depths to the depth buffer. Pixels without a depth get the far plane. */
static const char to_depth[] =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nuniform highp usampler2D medians;\n"
    "void main() {\nuint depth = texelFetch(medians, ivec2(gl_FragCoord.xy), 0).x;\n"
    "float z = depth == 0xffffffffu ? 100.0 : float(depth) / 65536.0;\n"
    "gl_FragDepth = 100.0 * (z - 0.1) / (z * (100.0 - 0.1)); }";

static void fill_depth(const program *p, GLuint framebuffer)
{
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_ALWAYS);
    draw_over(framebuffer, p->to_depth, p->medians);
    gl.Disable(GL_DEPTH_TEST);
}

static int draw(program *p, const fxs_request *request, const fxs_gl_target *target)
{
    const fxs_compute_scene *const copies[] = {&p->copy};
    fxs_message message;
    return p->compute ? fxs_compute_draw(p->compute, request, copies, target, p->memory, 0, &message)
                      : fxs_gles_render(p->gles, &p->context, request, target, p->memory, p->bytes, 0);
}

static int draw_eye(program *p, int eye, const fxs_camera *camera, const swapchain *s)
{
    const unsigned image = s->acquired % IMAGES;
    fxs_gl_target target;
    fxs_request request;
    fxs_request_init(&request, &p->object, 1);
    request.options = p->options;
    request.cameras[0] = *camera;
    fxs_gl_target_init(&target);
    target.framebuffer = s->framebuffers[0][image];
    target.depths_and_ids = 1;
    int error = draw(p, &request, &target);
    fill_depth(p, s->framebuffers[1][image]);
    request.targets[0].median_depth.pixels = p->depths[eye];
    request.targets[0].median_depth.stride = WIDTH * 4;
    request.targets[0].colour.pixels = p->colours[eye];
    request.targets[0].colour.stride = WIDTH * 4;
    if (!error)
        error = fxs_render(&p->context, &request, p->memory, p->bytes, 0);
    return error ? printf("eye %d: %s\n", eye, fxs_strerror(error)), 1 : 0;
}

/* ---- Checks of the eyes' pictures -------------------------------------------------------------------------------- */

static int compare_colours(const program *p, int eye, const swapchain *s)
{
    static unsigned char pixels[HEIGHT * WIDTH * 4];
    gl.BindFramebuffer(GL_FRAMEBUFFER, s->framebuffers[0][s->acquired % IMAGES]);
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    for (int y = 0; y < HEIGHT; y++)
        if (memcmp(pixels + y * WIDTH * 4, p->colours[eye] + (HEIGHT - 1 - y) * WIDTH * 4, WIDTH * 4))
            return printf("eye %d, row %d: not the bytes of the processor\n", eye, y), 1;
    const GLenum error = gl.GetError();
    if (error)
        printf("error 0x%x of OpenGL\n", (unsigned)error);
    return error != 0;
}

static const char to_words[] =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nuniform highp sampler2D depths;\nout uint word;\n"
    "void main() { word = floatBitsToUint(texelFetch(depths, ivec2(gl_FragCoord.xy), 0).x); }";

static int compare_depths(const program *p, int eye, const swapchain *s)
{
    static GLuint words[HEIGHT * WIDTH][4];
    draw_over(p->copying, p->to_words, s->depths[s->acquired % IMAGES]);
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float is;
            const uint32_t depth = p->depths[eye][(HEIGHT - 1 - y) * WIDTH + x];
            const double z = depth == FXS_NOTHING ? 100 : depth / 65536.0, expected = 100 * (z - 0.1) / (z * 99.9);
            memcpy(&is, words[y * WIDTH + x], sizeof is);
            if (!(fabs(is - expected) < 1e-6))
                return printf("eye %d, pixel %d, %d: depth %g, not %g\n", eye, x, y, is, expected), 1;
        }
    return 0;
}

/* Reprojects the left eye's picture to the right eye, by depth or as if everything were at infinity. Returns the mean
 * squared difference from the right eye's picture. */
static double difference(const program *p, const fxs_camera cameras[2], int by_depth)
{
    double sum = 0;
    int count = 0;
    const double apart = (double)(cameras[1].position_q32[0] - cameras[0].position_q32[0]) / 4294967296.0;
    const double ahead = (double)(cameras[1].position_q32[2] - cameras[0].position_q32[2]) / 4294967296.0;
    const double distance = sqrt(apart * apart + ahead * ahead);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const uint32_t depth = p->depths[0][y * WIDTH + x];
            if (depth == FXS_NOTHING)
                continue;
            const double z = depth / 65536.0;
            const double slope = (x + 0.5 - cameras[0].cx_q12 / 4096.0) / (cameras[0].fx_q12 / 4096.0) -
                                 (by_depth ? distance / z : 0);
            const int to = (int)floor(slope * (cameras[1].fx_q12 / 4096.0) + cameras[1].cx_q12 / 4096.0);
            for (int c = 0; c < 3 && to >= 0 && to < WIDTH; c++) {
                const double d = p->colours[0][(y * WIDTH + x) * 4 + c] - p->colours[1][(y * WIDTH + to) * 4 + c];
                sum += d * d;
                count++;
            }
        }
    return count > 10000 ? sum / count : 1e9;
}

static int run_frame(program *p, int frame, swapchain chains[2])
{
    view views[2];
    fxs_camera cameras[2];
    locate_views(frame, views);
    for (int eye = 0; eye < 2; eye++)
        if (camera_of(&views[eye], &cameras[eye]) || draw_eye(p, eye, &cameras[eye], &chains[eye]) ||
            compare_colours(p, eye, &chains[eye]) || compare_depths(p, eye, &chains[eye]))
            return 1;
    const double by_depth = difference(p, cameras, 1), as_far = difference(p, cameras, 0);
    if (by_depth > as_far / 4)
        return printf("frame %d: brought over by depth %.1f, else %.1f\n", frame, by_depth, as_far), 1;
    chains[0].acquired++;
    chains[1].acquired++;
    return 0;
}

static int open_scene(program *p, const char *path, fxs_packed_scene *packed)
{
    fxs_message message;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    if (fxs_scene_file_open(path, 0, &file, &info, &message) || fxs_pack(file, &info, packed, &report, 0, &message))
        return puts(message.text), 1;
    fxs_scene_file_close(file);
    fxs_object_init(&p->object, &p->scene);
    p->object.scale_q32 = (int64_t)1 << 30;
    return fxs_scene_open(&p->scene, packed->data, packed->bytes) != 0;
}

static int open_compute(program *p, void *egl)
{
    fxs_message message;
    if (fxs_compute_create(&p->compute, fxs_egl_load, fxs_egl_use, egl, &message))
        return printf("skip: %s\n", message.text), 77;
    return fxs_compute_upload(p->compute, &p->copy, &p->scene, &message);
}

static int open_gles(program *p, void *egl)
{
    fxs_message message;
    return fxs_gles_create(&p->gles, fxs_egl_load, fxs_egl_use, egl, &message) ? puts("no OpenGL ES 3.0"), 1 : 0;
}

static int open_graphics(program *p, int by_compute, void **egl)
{
    fxs_message message;
    if (fxs_egl_open(egl, &message))
        return printf("skip: %s\n", message.text), 77;
    const int status = !load_functions(*egl) ? 1 : by_compute ? open_compute(p, *egl) : open_gles(p, *egl);
    if (status)
        return status;
    p->medians = make_texture(GL_R32UI);
    p->ids = make_texture(GL_RG32UI);
    p->copies = make_texture(GL_R32UI);
    gl.GenFramebuffers(1, &p->copying);
    attach(p->copying, GL_COLOR_ATTACHMENT0, p->copies);
    p->to_depth = make_program(to_depth);
    p->to_words = make_program(to_words);
    fxs_context_init(&p->context, 0);
    static fxs_kernels fastest;
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    p->context.config.kernels = &fastest;
    fxs_options_init(&p->options);
    p->bytes = fxs_frame_bytes(&p->context, &p->object, 1, WIDTH, HEIGHT, 0);
    p->allocation = malloc(p->bytes + 63);
    p->memory = (void *)(((uintptr_t)p->allocation + 63) / 64 * 64);
    return p->allocation == 0;
}

static void close_graphics(program *p, void *egl)
{
    if (p->compute)
        fxs_compute_drop(p->compute, &p->copy);
    fxs_compute_destroy(p->compute);
    fxs_gles_destroy(p->gles);
    fxs_egl_close(egl);
    free(p->allocation);
}

int main(int argc, char **argv)
{
    static program p;
    static swapchain chains[2];
    fxs_packed_scene packed;
    void *egl;
    int status = argc != 3 || open_scene(&p, argv[1], &packed)
                     ? 1 : open_graphics(&p, !strcmp(argv[2], "compute"), &egl);
    if (status)
        return status;
    for (int eye = 0; eye < 2; eye++)
        make_swapchain(&chains[eye], p.medians, p.ids);
    for (int frame = 0; frame < FRAMES && !status; frame++)
        status = run_frame(&p, frame, chains);
    close_graphics(&p, egl);
    fxs_packed_scene_free(&packed);
    puts(status ? "failed" : "ok");
    return status;
}
