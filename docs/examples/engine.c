/* Draws a Gaussian splatting scene around a mesh, in a program with its own OpenGL ES window. The mesh hides the
 * Gaussians behind it, and Gaussians in front cover the mesh.
 *
 *     cc engine.c -o engine $(pkg-config --cflags --libs fixsplat sdl2 glesv2)
 *     ./engine SCENE                    opens a window; a click prints the Gaussian under the pointer
 *     ./engine SCENE PICTURE X Y        writes one frame to a file; prints the Gaussian at pixel (X, Y) */
#define _POSIX_C_SOURCE 200809L    /* posix_memalign */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLES3/gl3.h>
#include <SDL.h>

#include <fixsplat/gl.h>
#include <fixsplat/renderer.h>
#include <fixsplat/internal/kernels.h>

enum { WIDTH = 640, HEIGHT = 360 };
enum { COLOUR, DEPTH, PICTURE, MEDIAN, ID, TEXTURES };     /* COLOUR and DEPTH belong to the mesh, the others to the
                                                              scene */
enum { MESH, SCENE, FRAMEBUFFERS };
#define NEAR 0.2
#define FAR 100.0

/* The mesh's camera. It looks along z from (0, 0, -12); the world's y points down. */
static const double view[16] = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, -12, 1};
static const double projection[16] = {1024.0 / WIDTH, 0, 0, 0, 0, 1024.0 / HEIGHT, 0, 0, 0, 0,
                                      (FAR + NEAR) / (NEAR - FAR), -1, 0, 0, 2 * FAR * NEAR / (NEAR - FAR), 0};
static GLuint textures[TEXTURES], framebuffers[FRAMEBUFFERS];

static int fail(const char *why)
{
    fprintf(stderr, "engine: %s\n", why);
    return 1;
}

/* ---- The mesh and the textures ----------------------------------------------------------------------------------- */

static void attach(int framebuffer, GLenum attachment, int texture, GLenum format)
{
    glBindTexture(GL_TEXTURE_2D, textures[texture]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexStorage2D(GL_TEXTURE_2D, 1, format, WIDTH, HEIGHT);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[framebuffer]);
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, textures[texture], 0);
}

static void make_framebuffers(void)
{
    static const GLenum three[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
    glGenTextures(TEXTURES, textures);
    glGenFramebuffers(FRAMEBUFFERS, framebuffers);
    attach(MESH, GL_COLOR_ATTACHMENT0, COLOUR, GL_RGBA8);
    attach(MESH, GL_DEPTH_ATTACHMENT, DEPTH, GL_DEPTH_COMPONENT32F);
    attach(SCENE, GL_COLOR_ATTACHMENT0, PICTURE, GL_RGBA8);
    attach(SCENE, GL_COLOR_ATTACHMENT1, MEDIAN, GL_R32UI);
    attach(SCENE, GL_COLOR_ATTACHMENT2, ID, GL_RG32UI);
    glDrawBuffers(3, three);
}

static void set_matrix(GLuint program, const char *name, const double matrix[16])
{
    GLfloat floats[16];
    for (int i = 0; i < 16; i++)
        floats[i] = (GLfloat)matrix[i];
    glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, floats);
}

static GLuint make_program(void)
{
    static const char *const texts[] = {
        "#version 300 es\nuniform mat4 view, projection;\nvoid main() {\n"
        "vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);\n"
        "gl_Position = projection * view * vec4(corner * vec2(-5, 5) - vec2(0, 2.5), 0, 1); }",
        "#version 300 es\nout mediump vec4 colour;\nvoid main() { colour = vec4(0.8, 0.4, 0.2, 1); }"};
    const GLuint program = glCreateProgram();
    for (int i = 0; i < 2; i++) {
        const GLuint shader = glCreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        glShaderSource(shader, 1, &texts[i], NULL);
        glCompileShader(shader);
        glAttachShader(program, shader);
    }
    glLinkProgram(program);
    glUseProgram(program);
    set_matrix(program, "view", view);
    set_matrix(program, "projection", projection);
    return program;
}

/* Draws a rectangle in the plane z = 0, left of the middle. */
static void draw_mesh(GLuint program)
{
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[MESH]);
    glViewport(0, 0, WIDTH, HEIGHT);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

static void show(SDL_Window *window)
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[SCENE]);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, 0, WIDTH, HEIGHT, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    SDL_GL_SwapWindow(window);
}

/* ---- The Gaussian splatting scene -------------------------------------------------------------------------------- */

static fxs_gl_function load(void *unused, const char *name)
{
    fxs_gl_function function;
    void *address = SDL_GL_GetProcAddress(name);
    (void)unused;
    memcpy(&function, &address, sizeof function);          /* C has no cast between the two kinds of pointers */
    return function;
}

/* The compute back end draws all stages on the GPU, with OpenGL ES 3.1. The other back end projects and sorts on the
   processor and blends in fragment shaders, with OpenGL ES 3.0. Both give the same bytes. */
typedef struct drawer {
    fxs_compute *compute;                                  /* null: the fragment shader back end draws */
    fxs_compute_scene scene;
    fxs_gles *gles;
    fxs_context context;
    void *memory;
    size_t bytes;
} drawer;

static int open_drawer(drawer *d, const fxs_request *request, fxs_message *why)
{
    memset(d, 0, sizeof *d);
    fxs_compute_create(&d->compute, load, NULL, NULL, why);
    puts(d->compute ? "by compute shaders" : "by fragment shaders");
    strcpy(why->text, "no memory");
    if (d->compute) {
        d->memory = malloc(fxs_compute_memory(request));
        return !d->memory || fxs_compute_upload(d->compute, &d->scene, request->objects->scene, why);
    }
    static fxs_kernels fastest;
    fxs_config config;
    fxs_config_init(&config);                              /* one thread; for more, config.workers and system.h */
    fxs_kernels_choose(&fastest, fxs_cpu_detect());
    config.kernels = &fastest;
    if (fxs_context_init(&d->context, &config))
        return 1;
    d->bytes = fxs_request_bytes(&d->context, request, NULL);
    return posix_memalign(&d->memory, 64, d->bytes) || fxs_gles_create(&d->gles, load, NULL, NULL, why);
}

static int draw_scene(drawer *d, const fxs_request *request, const fxs_gl_target *target, fxs_message *why)
{
    const fxs_compute_scene *const scenes[] = {&d->scene};
    if (d->compute)
        return fxs_compute_draw(d->compute, request, scenes, target, d->memory, NULL, why);
    const int error = fxs_gles_render(d->gles, &d->context, request, target, d->memory, d->bytes, NULL);
    if (error)
        snprintf(why->text, sizeof why->text, "%s", fxs_strerror(error));
    return error;
}

static void close_drawer(drawer *d)
{
    if (d->compute)
        fxs_compute_drop(d->compute, &d->scene);
    fxs_compute_destroy(d->compute);
    fxs_gles_destroy(d->gles);
    free(d->memory);
}

/* Prints the Gaussian at a pixel, counted from the upper left. */
static void pick(int x, int y)
{
    GLuint depth[4], id[4];
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[SCENE]);
    glReadBuffer(GL_COLOR_ATTACHMENT1);
    glReadPixels(x, HEIGHT - 1 - y, 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, depth);
    glReadBuffer(GL_COLOR_ATTACHMENT2);
    glReadPixels(x, HEIGHT - 1 - y, 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, id);
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    if (id[1] == FXS_NOTHING)
        puts("nothing");
    else
        printf("object %u, Gaussian %u, depth %.4f\n", id[0], id[1],
               depth[0] == FXS_NOTHING ? INFINITY : depth[0] / 65536.0);
}

static int write_picture(const char *path, fxs_message *why)
{
    static unsigned char rows[HEIGHT][WIDTH][4], picture[HEIGHT][WIDTH][4];
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers[SCENE]);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, rows);
    for (int y = 0; y < HEIGHT; y++)
        memcpy(picture[y], rows[HEIGHT - 1 - y], sizeof rows[y]);
    return fxs_image_file_write(path, picture[0][0], WIDTH, HEIGHT, why);
}

int main(int argc, char **argv)
{
    fxs_message why = {.text = "usage: engine SCENE [PICTURE X Y]"};
    fxs_opened *opened;
    drawer d;
    fxs_object object;
    fxs_request request;
    fxs_gl_target target;
    if ((argc != 2 && argc != 5) || fxs_open(argv[1], NULL, &opened, &why))
        return fail(why.text);
    if (SDL_Init(SDL_INIT_VIDEO) || SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_ES) ||
        SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3))
        return fail(SDL_GetError());
    SDL_Window *window = SDL_CreateWindow("engine", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, WIDTH, HEIGHT,
                                          SDL_WINDOW_OPENGL);
    if (!window || !SDL_GL_CreateContext(window))
        return fail(SDL_GetError());
    make_framebuffers();
    const GLuint program = make_program();
    fxs_object_init(&object, opened->scene);
    object.id = 7;
    fxs_request_init(&request, &object, 1);
    if (fxs_camera_from_matrices(&request.cameras[0], view, projection, WIDTH, HEIGHT, &why))
        return fail(why.text);
    if (open_drawer(&d, &request, &why))
        return fail(why.text);
    fxs_gl_target_init(&target);
    target.framebuffer = framebuffers[SCENE];
    target.depth_buffer = textures[DEPTH];
    target.plane_0 = (float)NEAR;
    target.plane_1 = (float)FAR;
    target.backdrop = textures[COLOUR];
    target.depths_and_ids = 1;
    for (SDL_Event event = {0}; event.type != SDL_QUIT && SDL_WaitEvent(&event);) {
        draw_mesh(program);
        if (draw_scene(&d, &request, &target, &why))
            return fail(why.text);
        show(window);
        if (argc == 5) {
            pick(atoi(argv[3]), atoi(argv[4]));
            return write_picture(argv[2], &why) ? fail(why.text) : 0;
        }
        if (event.type == SDL_MOUSEBUTTONDOWN)
            pick(event.button.x, event.button.y);
    }
    close_drawer(&d);
    fxs_close(opened);
    SDL_Quit();
    return 0;
}
