/* GL objects of the OpenGL ES back end: functions, programs, textures and buffers; reading back; rendering to the
 * caller's target. */
#include <stdlib.h>

#include <fixsplat/gl.h>

#include "src/core/memory.h"
#include "src/core/sized.h"
#include "device.h"
#include "shaders.h"

#define TIME_ELAPSED 0x88BF        /* constants of EXT_disjoint_timer_query */
#define DISJOINT 0x8FBB

static int say(char *message, const char *text, const char *what)
{
    const char *parts[] = {text, what};
    size_t used = 0;
    for (int i = 0; i < 2; i++) {
        size_t length = strlen(parts[i]), room = FXS_GLES_MESSAGE - 1 - used;
        length = length < room ? length : room;
        memcpy(message + used, parts[i], length);
        used += length;
    }
    message[used] = 0;
    for (char *c = message; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
    return FXS_ERR_UNSUPPORTED;
}

fxs_gl_info fxs_gles_info(const fxs_gles *g)
{
    return (fxs_gl_info){g->renderer, g->no_fetch[0] ? g->no_fetch : 0, g->nanoseconds};
}

/* Accepts OpenGL ES 3.0 and later, and desktop OpenGL with GL_ARB_ES3_compatibility. */
static int check_version(fxs_gles *g, char *message)
{
    static const char es[] = "OpenGL ES ";
    const char *version = (const char *)g->gl.GetString(GL_VERSION);
    const char *renderer = (const char *)g->gl.GetString(GL_RENDERER);
    if (!version || !renderer)
        return say(message, "no context is current", "");
    strncpy(g->renderer, renderer, sizeof g->renderer - 1);
    int is_es = !strncmp(version, es, sizeof es - 1);
    const char *number = is_es ? version + sizeof es - 1 : version;
    if (number[0] < '3' || number[0] > '9' || (!is_es && number[0] == '3' && (number[1] != '.' || number[2] < '3')))
        return say(message, "the context is too old, OpenGL ES 3.0 is needed: ", version);
    if (!is_es && !fxs_gl_has_extension(&g->gl, "GL_ARB_ES3_compatibility"))
        return say(message, "no GL_ARB_ES3_compatibility in OpenGL ", version);
    g->points = is_es;             /* on desktop GL, extra state sets the size of points, so points are not used */
    g->timer = is_es && fxs_gl_has_extension(&g->gl, "GL_EXT_disjoint_timer_query");
    return 0;
}

static int check_limits(fxs_gles *g, char *message)
{
    GLint texture = 0, renderbuffer = 0, points[2] = {0, 0};
    g->gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    g->gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
    g->gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, g->viewport);
    g->gl.GetIntegerv(GL_ALIASED_POINT_SIZE_RANGE, points);
    g->points &= points[1] >= FXS_TILE;
    g->most = fxs_min(fxs_min(texture, renderbuffer), fxs_min(g->viewport[0], g->viewport[1]));
    g->most = fxs_min(g->most, FXS_GLES_MOST) & -FXS_TILE;
    if (g->most < FXS_TILE)
        return say(message, "textures of less than 16x16 texels", "");
    while (2 << g->shift <= fxs_min(texture, FXS_GLES_SIDE))
        g->shift++;
    return 0;
}

static const char version[] = "#version 300 es\n", fetching[] = "#extension GL_EXT_shader_framebuffer_fetch : enable\n";
static const char prelude[] = "precision highp int;\nprecision highp float;\n#define FXS_FN\n";

/* Returns the definition of the shaders' macro FACTOR. Mesa's software renderer multiplies faster if factors are masked
   to 15 bits. */
static const char *factor_of(const fxs_gles *g)
{
    return strncmp(g->renderer, "llvmpipe", 8) ? "#define FACTOR(x) (x)\n" : "#define FACTOR(x) ((x) & 32767)\n";
}

static int compile(const fxs_gles *g, GLuint program, GLenum kind, const char *define, const char *text, char *message)
{
    char log[FXS_GLES_MESSAGE] = "";
    const int is_fragment = kind == GL_FRAGMENT_SHADER;
    const char *parts[] = {version,
                           is_fragment ? fetching : "",
                           prelude,
                           define,
                           factor_of(g),
                           is_fragment ? pixel_h : "",
                           is_fragment ? weight_frag : "",
                           is_fragment ? depth_frag : "",
                           is_fragment ? mesh_frag : "",
                           is_fragment ? records_frag : "",
                           text};
    return fxs_gl_compile(&g->gl, program, kind, parts, sizeof parts / sizeof *parts, log, sizeof log)
               ? 0 : say(message, "the shader does not compile: ", log);
}

static int make_program(fxs_gles *g, int which, const char *define, const char *vertex, const char *fragment,
                        char *message)
{
    static const char *const units[] = {"lists",        "records",  "masks",   "chunks", "occluder",
                                        "depth_buffer", "backdrop", "carried", "ids",    "traces"};
    const fxs_gl *gl = &g->gl;
    char log[FXS_GLES_MESSAGE] = "";
    fxs_gles_program *p = &g->programs[which];
    p->name = gl->CreateProgram();
    int error = compile(g, p->name, GL_VERTEX_SHADER, define, vertex, message);
    if (!error)
        error = compile(g, p->name, GL_FRAGMENT_SHADER, define, fragment, message);
    if (error)
        return error;
    if (!fxs_gl_link(gl, p->name, log, sizeof log))
        return say(message, "the shaders do not link: ", log);
    p->place = gl->GetUniformLocation(p->name, "place");
    p->source = gl->GetUniformLocation(p->name, "source");
    p->background = gl->GetUniformLocation(p->name, "background");
    p->mesh = gl->GetUniformLocation(p->name, "mesh");
    p->planes = gl->GetUniformLocation(p->name, "planes");
    p->size = gl->GetUniformLocation(p->name, "size");
    gl->UseProgram(p->name);
    for (int i = 0; i < FXS_GLES_UNITS; i++)
        gl->Uniform1i(gl->GetUniformLocation(p->name, units[i]), i);
    return 0;
}

static int make_programs(fxs_gles *g, char *message)
{
    int error = make_program(g, FXS_GLES_STATE, "#define STATE\n", tiles_vert, tiles_frag, message);
    if (!error)
        error = make_program(g, FXS_GLES_INTEGER, "#define INTEGER\n", tiles_vert, tiles_frag, message);
    if (!error)
        error = make_program(g, FXS_GLES_NORMALISED, "", tiles_vert, tiles_frag, message);
    if (!error)
        error = make_program(g, FXS_GLES_BLOCKS, "", screen_vert, masks_frag, message);
    return error;
}

static void make_fetch_programs(fxs_gles *g)
{
    if (!fxs_gl_has_extension(&g->gl, "GL_EXT_shader_framebuffer_fetch")) {
        say(g->no_fetch, "no GL_EXT_shader_framebuffer_fetch", "");
        return;
    }
    int error = make_program(g, FXS_GLES_BLEND, "", fetch_vert, fetch_frag, g->no_fetch);
    if (!error)
        error = make_program(g, FXS_GLES_LIMITED, "#define LIMITED\n", fetch_vert, fetch_frag, g->no_fetch);
    if (!error)
        error = make_program(g, FXS_GLES_RESOLVED_INTEGER, "#define INTEGER\n#define FETCHED\n", screen_vert,
                             tiles_frag, g->no_fetch);
    if (!error)
        make_program(g, FXS_GLES_RESOLVED_NORMALISED, "#define FETCHED\n", screen_vert, tiles_frag, g->no_fetch);
}

static int make_traced(fxs_gles *g)
{
    static const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    char message[FXS_GLES_MESSAGE];
    const fxs_gl *gl = &g->gl;
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl->ActiveTexture(GL_TEXTURE0);
    for (int i = 0; i < 2; i++) {
        gl->BindTexture(GL_TEXTURE_2D, g->textures[i ? FXS_GLES_NEXT_TRACES : FXS_GLES_TRACES]);
        gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32UI, FXS_TILE, FXS_TILE, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 0);
        gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_FIRST_TRACED + i]);
        gl->FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                                 g->textures[i ? FXS_GLES_NEXT : FXS_GLES_CARRIED], 0);
        gl->FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D,
                                 g->textures[i ? FXS_GLES_NEXT_TRACES : FXS_GLES_TRACES], 0);
        gl->DrawBuffers(2, both);
        if (gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            return FXS_ERR_UNSUPPORTED;
    }
    int error = make_program(g, FXS_GLES_TRACED_STATE, "#define STATE\n#define TRACED\n", tiles_vert, tiles_frag,
                             message);
    if (!error)
        error = make_program(g, FXS_GLES_TRACED, "#define TRACED\n", tiles_vert, tiles_frag, message);
    return error ? error : fxs_gl_check(&g->gl);
}

static int prepare_traced(fxs_gles *g)
{
    if (!g->traced) {
        const int error = make_traced(g);
        g->traced = error ? error : 1;
    }
    return g->traced < 0 ? g->traced : 0;
}

static int make_objects(fxs_gles *g, char *message)
{
    const fxs_gl *gl = &g->gl;
    gl->GenTextures(FXS_GLES_TEXTURES, g->textures);
    gl->GenFramebuffers(FXS_GLES_FRAMEBUFFERS, g->framebuffers);
    gl->GenRenderbuffers(1, &g->renderbuffer);
    gl->GenVertexArrays(1, &g->vertex_array);
    gl->GenBuffers(FXS_GLES_BUFFERS, g->buffers);
    if (g->timer)
        gl->GenQueries(1, &g->query);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    for (int i = 0; i < FXS_GLES_TEXTURES; i++) {
        gl->BindTexture(GL_TEXTURE_2D, g->textures[i]);
        gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        const int state = i == FXS_GLES_CARRIED ? 0 : i == FXS_GLES_NEXT ? 1 : i == FXS_GLES_WHOLE ? 2 : -1;
        if (state < 0)
            continue;
        gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16I, FXS_TILE, FXS_TILE, 0, GL_RGBA_INTEGER, GL_SHORT, 0);
        gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_FIRST_STATE + state]);
        gl->FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, g->textures[i], 0);
        if (gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            return say(message, "no render target of the format RGBA16I", "");
    }
    g->whole[0] = g->whole[1] = FXS_TILE;
    fxs_gles_set(g);
    return fxs_gles_make_masks(g, 1) ? say(message, "no render target of the format RGBA32UI", "") : 0;
}

int fxs_gles_use(const fxs_gles *g)
{
    return g->use && g->use(g->use_argument) ? FXS_ERR_DEVICE : 0;
}

/* Deletes the GL objects of the back end. A lost context has already freed its objects. */
static void end(const fxs_gles *g);

static int begin(fxs_gles *g, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument, char *message)
{
    fxs_gl_state state;
    g->use = use;
    g->use_argument = argument;
    if (fxs_gles_use(g)) {
        say(message, "the context cannot be made current", "");
        return FXS_ERR_DEVICE;
    }
    const char *missing = fxs_gl_load(&g->gl, load, argument);
    int error = missing ? say(message, "no function ", missing) : check_version(g, message);
    if (!error)
        error = check_limits(g, message);
    if (error)
        return error;
    fxs_gl_save(&g->gl, &state);
    fxs_gl_check(&g->gl);
    error = make_programs(g, message);
    make_fetch_programs(g);
    if (!error)
        error = make_objects(g, message);
    if (!error && (error = fxs_gl_check(&g->gl)) != 0)
        say(message, "the device failed to make textures and buffers", "");
    if (error)
        end(g);
    fxs_gl_restore(&g->gl, &state);
    return error;
}

int fxs_gles_create(fxs_gles **gles, fxs_gl_load_fn *load, fxs_gl_use_fn *use, void *argument, fxs_message *message)
{
    fxs_gles *g = *gles = calloc(1, sizeof *g);
    message->bytes_needed = 0;
    if (!g) {
        say(message->text, "out of memory", "");
        return FXS_ERR_MEMORY;
    }
    const int error = begin(g, load, use, argument, message->text);
    if (error) {
        free(g);
        *gles = 0;
    }
    return error;
}

void fxs_gles_destroy(fxs_gles *g)
{
    if (g)
        end(g);
    free(g);
}

static void end(const fxs_gles *g)
{
    const fxs_gl *gl = &g->gl;
    if (fxs_gles_use(g))
        return;
    for (int i = 0; i < FXS_GLES_PROGRAMS; i++)
        fxs_gl_delete_programs(gl, 1, &g->programs[i].name);
    gl->DeleteTextures(FXS_GLES_TEXTURES, g->textures);
    gl->DeleteFramebuffers(FXS_GLES_FRAMEBUFFERS, g->framebuffers);
    gl->DeleteRenderbuffers(1, &g->renderbuffer);
    gl->DeleteVertexArrays(1, &g->vertex_array);
    gl->DeleteBuffers(FXS_GLES_BUFFERS, g->buffers);
    if (g->timer)
        gl->DeleteQueries(1, &g->query);
}

int fxs_gles_make_target(fxs_gles *g, int32_t width, int32_t height)
{
    const fxs_gl *gl = &g->gl;
    if (width <= g->width && height <= g->height)
        return 0;
    g->width = g->height = 0;
    gl->BindRenderbuffer(GL_RENDERBUFFER, g->renderbuffer);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8UI, width, height);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_TARGET]);
    gl->FramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, g->renderbuffer);
    const GLenum status = gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER);
    const int error = status == GL_FRAMEBUFFER_COMPLETE ? fxs_gl_check(&g->gl) : fxs_gl_failure(&g->gl);
    if (error)
        return error;
    g->width = width;
    g->height = height;
    return 0;
}

static void bind(fxs_gles *g, GLenum target, int buffer, GLsizeiptr bytes, GLenum use)
{
    g->gl.BindBuffer(target, g->buffers[buffer]);
    if (bytes > g->buffer_bytes[buffer])
        g->gl.BufferData(target, g->buffer_bytes[buffer] = bytes, 0, use);
}

void *fxs_gles_map(fxs_gles *g, GLsizeiptr bytes)
{
    bind(g, GL_PIXEL_UNPACK_BUFFER, (int)(g->turn++ % FXS_GLES_UPLOADS), bytes, GL_STREAM_DRAW);
    return g->gl.MapBufferRange(GL_PIXEL_UNPACK_BUFFER, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
}

void fxs_gles_start_timer(fxs_gles *g)
{
    if (!g->timer || g->timing || g->target)
        return;
    g->gl.BeginQuery(TIME_ELAPSED, g->query);
    g->timing = 1;
}

void fxs_gles_stop_timer(fxs_gles *g)
{
    GLuint nanoseconds = 0;
    GLint disjoint = 0;
    if (!g->timing)
        return;
    g->gl.EndQuery(TIME_ELAPSED);
    g->gl.GetQueryObjectuiv(g->query, GL_QUERY_RESULT, &nanoseconds);
    g->gl.GetIntegerv(DISJOINT, &disjoint);
    g->timing = 0;
    g->nanoseconds += disjoint ? 0 : nanoseconds;
}

static void store(unsigned char *to, const unsigned char *rgba, enum fxs_format format)
{
    const uint16_t packed = fxs_little_16(fxs_rgb565(rgba[0], rgba[1], rgba[2]));
    if (format == FXS_FORMAT_RGB565)
        memcpy(to, &packed, sizeof packed);
    else
        memcpy(to, rgba, 4);
}

static void copy_row(unsigned char *to, const unsigned char *from, int32_t count, int wide, enum fxs_format format)
{
    if (!wide && format != FXS_FORMAT_RGB565) {
        memcpy(to, from, 4 * (size_t)count);
        return;
    }
    for (int32_t i = 0; i < count; i++) {
        unsigned char rgba[4];
        uint32_t words[4];
        memcpy(words, from + (wide ? 16 * i : 0), sizeof words);
        for (int c = 0; c < 4; c++)
            rgba[c] = wide ? (unsigned char)words[c] : from[4 * i + c];
        store(to + (format == FXS_FORMAT_RGB565 ? 2 : 4) * i, rgba, format);
    }
}

/* Copies the pixels of a run (range of tiles) to the image. Also copies pixels after the run's last tile, which the
   next run overwrites. */
static void copy_tiles(const fxs_tile_run *run, const unsigned char *from, int32_t x, int32_t y, int32_t width,
                       int32_t height, int wide)
{
    const int32_t across = run->view->tiles_x, first = (int32_t)run->first_tile;
    const enum fxs_format format = run->targets->format;
    const fxs_image *colour = &run->targets->colour;
    for (int32_t line = y; line < y + height; line++, from += (wide ? 16 : 4) * (ptrdiff_t)width) {
        const int32_t row = line / FXS_TILE;
        const int32_t left = row == first / across ? first % across * FXS_TILE : 0;
        const int32_t begin = left > x ? left : x, end = x + width;
        if (begin < end)
            copy_row((unsigned char *)colour->pixels + line * colour->stride + begin * fxs_pixel_bytes(format),
                     from + (wide ? 16 : 4) * (ptrdiff_t)(begin - x), end - begin, wide, format);
    }
}

int fxs_gles_has(const fxs_gles *g, const fxs_tile_run *run)
{
    const fxs_targets *t = run->targets;
    if (g->target)
        return 0;
    if (!t || !t->colour.pixels)
        return FXS_ERR_TARGET;
    return t->format > FXS_FORMAT_RGB565 || t->coverage.pixels || t->mean_depth.pixels ||
                   t->median_depth.pixels || t->id.pixels
               ? FXS_ERR_UNSUPPORTED : 0;
}

int fxs_gles_read(fxs_gles *g, const fxs_tile_run *run, int32_t x, int32_t y, int32_t width, int32_t height)
{
    const fxs_gl *gl = &g->gl;
    GLint has_format = 0, has_type = 0;
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, g->framebuffers[FXS_GLES_TARGET]);
    gl->GetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &has_format);
    gl->GetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &has_type);
    /* All devices can read integer pixels as 32-bit words, most can read them as bytes. */
    const int wide = has_format != GL_RGBA_INTEGER || has_type != GL_UNSIGNED_BYTE;
    const GLsizeiptr bytes = (GLsizeiptr)(wide ? 16 : 4) * width * height;
    bind(g, GL_PIXEL_PACK_BUFFER, FXS_GLES_DOWNLOAD, bytes, GL_STREAM_READ);
    gl->ReadPixels(0, 0, width, height, GL_RGBA_INTEGER, wide ? GL_UNSIGNED_INT : GL_UNSIGNED_BYTE, 0);
    const unsigned char *read = gl->MapBufferRange(GL_PIXEL_PACK_BUFFER, 0, bytes, GL_MAP_READ_BIT);
    if (!read)
        return fxs_gl_failure(&g->gl);
    copy_tiles(run, read, x, y, width, height, wide);
    return gl->UnmapBuffer(GL_PIXEL_PACK_BUFFER) ? fxs_gl_check(&g->gl) : FXS_ERR_DEVICE;
}

/* ---- Into the caller's target ------------------------------------------------------------------------------------ */

int fxs_gles_render(fxs_gles *g, const fxs_context *context, const fxs_request *request, const fxs_gl_target *target,
                    void *memory, size_t memory_bytes, fxs_stats *stats)
{
    fxs_gl_state state;
    fxs_request own;
    if (!g || !context || !target)
        return FXS_ERR_ARGUMENT;
    int error = fxs_request_read(&own, request);
    error = error ? error : fxs_gl_check_target(target);
    if (error)
        return error;
    if ((target->fetch && g->no_fetch[0]) || (target->depths_and_ids && target->fetch) ||
        own.cameras->width > FXS_TILE << g->shift || own.cameras->height > FXS_TILE << g->shift)
        return FXS_ERR_UNSUPPORTED;
    fxs_context drawing = *context;
    own.eyes = 1;
    fxs_targets_init(own.targets);
    drawing.config.draw = target->fetch ? fxs_gles_draw_fetch : fxs_gles_draw;
    drawing.config.draw_argument = g;
    drawing.config.draw_unlisted = target->fetch;
    if (fxs_gles_use(g))
        return FXS_ERR_DEVICE;
    fxs_gl_save(&g->gl, &state);
    fxs_gl_check(&g->gl);
    g->target = target;
    error = fxs_gles_is_traced(g) ? prepare_traced(g) : 0;
    error = error ? error : fxs_render(&drawing, &own, memory, memory_bytes, stats);
    g->target = 0;
    fxs_gl_restore(&g->gl, &state);
    return error;
}
