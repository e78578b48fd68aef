/* Renders frames to the caller's framebuffer in the caller's GL context, and restores the GL state. */
#include "gl31.h"
#include "shaders.h"
#include "src/core/memory.h"

enum { TAKE_MESH, COLOURS, TRACED };

/* GL buffer bindings that rendering changes, and that are therefore saved and restored. */
static const GLenum bound[][2] = {{GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING},
                                  {GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING},
                                  {GL_COPY_READ_BUFFER, GL_COPY_READ_BUFFER_BINDING},
                                  {GL_COPY_WRITE_BUFFER, GL_COPY_WRITE_BUFFER_BINDING},
                                  {GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING}};
static const struct place {
    GLenum target, name, start, size;
    GLuint index;
} places[] = {
#define STORAGE(i) {GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START, \
                    GL_SHADER_STORAGE_BUFFER_SIZE, i}
#define UNIFORM(i) {GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, i}
    STORAGE(0), STORAGE(1), STORAGE(2), STORAGE(3), UNIFORM(0), UNIFORM(1)
};
enum { BOUND = sizeof bound / sizeof *bound, PLACES = sizeof places / sizeof *places };

typedef struct kept {
    fxs_gl_state state;
    GLint bound[BOUND], names[PLACES];
    GLint64 starts[PLACES], sizes[PLACES];
} kept;

static void save(const fxs_compute *c, kept *k)
{
    memset(k, 0, sizeof *k);       /* zeros, because a lost GL context returns no values */
    fxs_gl_save(&c->gl, &k->state);
    for (int i = 0; i < BOUND; i++)
        c->gl.GetIntegerv(bound[i][1], &k->bound[i]);
    for (int i = 0; i < PLACES; i++) {
        c->more.GetIntegeri_v(places[i].name, places[i].index, &k->names[i]);
        c->more.GetInteger64i_v(places[i].start, places[i].index, &k->starts[i]);
        c->more.GetInteger64i_v(places[i].size, places[i].index, &k->sizes[i]);
    }
}

/* Restores the caller's buffer bindings. A saved size of 0 means that the whole buffer, or no buffer, was bound. */
static void restore(const fxs_compute *c, const kept *k)
{
    for (int i = 0; i < PLACES; i++)
        if (k->sizes[i])
            c->more.BindBufferRange(places[i].target, places[i].index, (GLuint)k->names[i], (GLintptr)k->starts[i],
                                    (GLsizeiptr)k->sizes[i]);
        else
            c->more.BindBufferBase(places[i].target, places[i].index, (GLuint)k->names[i]);
    for (int i = 0; i < BOUND; i++)
        c->gl.BindBuffer(bound[i][0], (GLuint)k->bound[i]);
    fxs_gl_restore(&c->gl, &k->state);
}

static int add_shader(const fxs_compute *c, int which, GLenum kind, const char *text, fxs_message *why)
{
    char log[400] = "";
    const char *parts[] = {"#version 310 es\nprecision highp int;\nprecision highp float;\n",
                           which == TRACED ? "#define TRACED\n" : "",
                           c->shift ? "" : "#define BUFFERED\n",
                           which == TAKE_MESH ? depth_frag : "",
                           text};
    return fxs_gl_compile(&c->gl, c->drawing[which], kind, parts, sizeof parts / sizeof *parts, log, sizeof log)
               ? 0 : fxs_compute_lacks(c, "a shader of the framebuffer does not compile: ", log, why);
}

static int make_program(fxs_compute *c, int which, fxs_message *why)
{
    char log[400] = "";
    c->drawing[which] = c->gl.CreateProgram();
    int error = which == TAKE_MESH ? add_shader(c, which, GL_COMPUTE_SHADER, take_mesh_glsl, why)
                                   : add_shader(c, which, GL_VERTEX_SHADER, screen_vert, why);
    if (!error && which != TAKE_MESH)
        error = add_shader(c, which, GL_FRAGMENT_SHADER, framebuffer_frag, why);
    return error || fxs_gl_link(&c->gl, c->drawing[which], log, sizeof log)
               ? error : fxs_compute_lacks(c, "the framebuffer's shaders do not link: ", log, why);
}

void fxs_compute_end_drawing(fxs_compute *c)
{
    fxs_gl_delete_programs(&c->gl, FXS_COMPUTE_DRAWING, c->drawing);
    c->gl.DeleteVertexArrays(1, &c->vertex_array);
    c->gl.DeleteTextures(1, &c->words);
    memset(c->drawing, 0, sizeof c->drawing);
    c->vertex_array = c->words = 0;
    c->word_rows = 0;
}

/* Makes the GL objects for drawing on first use. If fragment shaders have no storage buffers, c->shift is nonzero and a
   texture is used. */
static int begin_drawing(fxs_compute *c, fxs_message *why)
{
    GLint blocks = 0, side = 0;
    int error = 0;
    if (c->vertex_array)
        return 0;
    c->gl.GetIntegerv(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, &blocks);
    c->gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    c->most_rows = side;
    for (c->shift = 0; blocks < 1 && 2 << c->shift <= side;)
        c->shift++;
    for (int i = 0; i < FXS_COMPUTE_DRAWING && !error; i++)
        error = make_program(c, i, why);
    c->gl.GenVertexArrays(1, &c->vertex_array);
    c->gl.GenTextures(1, &c->words);
    c->gl.ActiveTexture(GL_TEXTURE0);
    c->gl.BindTexture(GL_TEXTURE_2D, c->words);
    c->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    c->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    error = error ? error : fxs_compute_check(c, why);
    if (error)
        fxs_compute_end_drawing(c);
    return error;
}

int fxs_compute_take_mesh(const fxs_compute *c, const fxs_gl_target *t, uint32_t eye, fxs_message *why)
{
    const fxs_compute_frame *f = &c->plan.frames[eye];
    const GLuint textures[] = {t->occluder, t->depth_buffer, t->backdrop};
    const int32_t width = f->size[0], height = f->size[1];
    if (f->occluder == FXS_NOTHING && f->backdrop == FXS_NOTHING)
        return 0;
    fxs_gl_set(&c->gl, c->vertex_array, 3, textures);
    c->gl.UseProgram(c->drawing[TAKE_MESH]);
    c->gl.Uniform4i(0, width, height, t->top_down ? 0 : height - 1, t->top_down ? 1 : -1);
    c->gl.Uniform4i(1, (GLint)f->occluder, (GLint)f->backdrop, f->depth_bits, t->depth_buffer != 0);
    if (t->depth_buffer)
        c->gl.Uniform2f(2, 1 / t->plane_0, 1 / t->plane_1);
    c->more.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, c->buffers[eye][FXS_COMPUTE_MEMORY]);
    c->more.DispatchCompute((GLuint)(width + 7) / 8, (GLuint)(height + 7) / 8, 1);
    return fxs_compute_check(c, why);
}

static int put_words(fxs_compute *c, uint32_t eye, fxs_message *why)
{
    const uint64_t words = c->plan.read_words[eye];
    const uintptr_t at = 4 * (uintptr_t)c->plan.read_at[eye];
    const GLsizei width = 1 << c->shift, rows = (GLsizei)(words >> c->shift);
    const GLsizei rest = (GLsizei)(words - ((uint64_t)rows << c->shift));
    if (words > (uint64_t)c->most_rows << c->shift)
        return fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "the picture is larger than the device's textures", "");
    c->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (rows + (rest > 0) > c->word_rows) {
        const int error = fxs_compute_allow(c, (uint64_t)(rows + (rest > 0) - c->word_rows) * 4 << c->shift, why);
        if (error)
            return error;
        c->word_rows = rows + (rest > 0);
        c->gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, width, c->word_rows, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, 0);
    }
    c->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, c->buffers[eye][FXS_COMPUTE_MEMORY]);
    c->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, rows, GL_RED_INTEGER, GL_UNSIGNED_INT, (const void *)at);
    if (rest)
        c->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, rows, rest, 1, GL_RED_INTEGER, GL_UNSIGNED_INT,
                            (const void *)(at + 4 * (uintptr_t)(words - (uint64_t)rest)));
    return fxs_compute_check(c, why);
}

int fxs_compute_show(fxs_compute *c, const fxs_gl_target *t, uint32_t eye, fxs_message *why)
{
    const fxs_compute_frame *f = &c->plan.frames[eye];
    const fxs_gl *gl = &c->gl;
    const int32_t width = f->size[0], height = f->size[1], first = c->shift ? (int32_t)c->plan.read_at[eye] : 0;
    fxs_gl_set(gl, c->vertex_array, 1, &c->words);
    c->more.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
    const int error = c->shift ? put_words(c, eye, why) : 0;
    if (error)
        return error;
    if (t->over)
        fxs_gl_blend_over(gl);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, t->framebuffer);
    gl->Viewport(t->x, t->y, width, height);
    gl->Scissor(t->x, t->y, width, height);
    gl->UseProgram(c->drawing[t->depths_and_ids ? TRACED : COLOURS]);
    /* gl_FragCoord counts from the corner of the framebuffer, not of the drawn part */
    gl->Uniform4i(0, -t->x, t->top_down ? -t->y : height - 1 + t->y, t->top_down ? 1 : -1, width);
    gl->Uniform4i(1, (GLint)f->colour - first, (GLint)f->median_depth - first, (GLint)f->id - first, c->shift);
    c->more.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, c->buffers[eye][FXS_COMPUTE_MEMORY]);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    return fxs_compute_check(c, why);
}

/* Requests the planes (colours, depths, ids) that the caller's target needs. The images given here only mark a plane as
   wanted. */
static void ask_planes(fxs_targets *to, const fxs_gl_target *t)
{
    const fxs_image wanted = to->colour, none = {0, 0};
    to->median_depth = to->id = t->depths_and_ids ? wanted : none;
    to->occluder = t->occluder || t->depth_buffer ? wanted : none;
    to->backdrop = t->backdrop ? wanted : none;
}

int fxs_compute_draw(fxs_compute *c, const fxs_request *request, const fxs_compute_scene *const *copies,
                     const fxs_gl_target *targets, void *memory, fxs_stats *stats, fxs_message *why)
{
    kept k;
    if (!c || !request || !targets || request->eyes < 1 || request->eyes > FXS_COMPUTE_EYES)
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, fxs_strerror(FXS_ERR_ARGUMENT), "");
    fxs_request own = *request;
    for (uint32_t eye = 0; eye < own.eyes; eye++) {
        const fxs_gl_target *t = &targets[eye];
        const int refused = fxs_gl_check_target(t);
        if (refused || t->fetch)
            return fxs_plan_say(why, refused ? refused : FXS_ERR_UNSUPPORTED,
                                fxs_strerror(refused ? refused : FXS_ERR_UNSUPPORTED), "");
        fxs_targets_init(&own.targets[eye]);
        own.targets[eye].rates = request->targets[eye].rates;
        own.targets[eye].format = t->format;
        own.targets[eye].depth_bits = t->depth_bits;
        /* No memory is written here: the images only have to be valid, and apart. */
        own.targets[eye].colour = (fxs_image){(unsigned char *)c + 4 * eye * (ptrdiff_t)own.cameras->width,
                                              4 * (ptrdiff_t)own.eyes * own.cameras->width};
    }
    int error = fxs_compute_begin(c, &own, copies, memory, why);
    if (error)
        return error;
    for (uint32_t eye = 0; eye < own.eyes; eye++)
        ask_planes(&own.targets[eye], &targets[eye]);
    save(c, &k);
    error = fxs_compute_look_back(c, why);
    error = error ? error : begin_drawing(c, why);
    error = error ? error : fxs_compute_finish(c, copies, targets, stats, why);
    restore(c, &k);
    return error;
}
