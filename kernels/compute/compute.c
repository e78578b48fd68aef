/* The compute back end: scenes on the device, and frames from the objects to the caller's targets. The stages are the
 * .wgsl files beside this one; shaders.h has them in GLSL ES 3.10. */
#include "records.h"
#include "shaders.h"
#include "src/core/memory.h"
#include "src/core/parts.h"

#define TIME_ELAPSED 0x88BF        /* EXT_disjoint_timer_query */
#define DISJOINT 0x8FBB

enum { TABLE_WORDS = FXS_OPACITY_LAWS * 256 / 2, HEADER_BYTES = 128, SPLAT_BYTES = 32, ENTRY_BYTES = 8, TRIES = 6, MERGES = 5 };

/* A frame on its way. */
typedef struct job {
    fxs_compute *c;
    const fxs_request *request;
    const fxs_compute_scene *const *copies;
    fxs_view view;                 /* of the world */
    fxs_object_view *objects;
    const fxs_drawn *drawn;        /* null: all leaves are drawn */
    uint32_t places, cut_room;
    uint64_t memory_words, picture_words, read_words;
    uint32_t status[FXS_COMPUTE_STATUS];
} job;

/* A stretch of an object's chunks that are drawn, whose rows lie in one part of its scene. */
typedef struct span {
    uint32_t object, first_place, end_place, part;
} span;

/* ---- Messages and errors ----------------------------------------------------------------------------------------- */

/* Writes a text and what it is about. */
static int say(fxs_message *why, int error, const char *text, const char *what)
{
    const char *parts[] = {text, what};
    size_t used = 0;
    for (int i = 0; i < 2; i++) {
        size_t length = strlen(parts[i]), room = sizeof why->text - 1 - used;
        length = length < room ? length : room;
        memcpy(why->text + used, parts[i], length);
        used += length;
    }
    why->text[used] = 0;
    for (char *c = why->text; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
    why->bytes_needed = 0;
    return error;
}

static int said(fxs_message *why, int error)
{
    return error ? say(why, error, fxs_strerror(error), "") : 0;
}

static int too_large(fxs_message *why, uint64_t bytes)
{
    say(why, FXS_ERR_MEMORY, "the frame takes more than a storage buffer of this device can hold", "");
    why->bytes_needed = bytes;
    return FXS_ERR_MEMORY;
}

/* Whether so many more bytes of the device may be taken. */
static int allow(const fxs_compute *c, uint64_t bytes, fxs_message *why)
{
    const uint64_t needed = fxs_compute_taken(c) + c->scene_bytes + bytes;
    if (!c->limit || needed <= c->limit)
        return 0;
    say(why, FXS_ERR_MEMORY, "the device memory allowed is too small", "");
    why->bytes_needed = needed;
    return FXS_ERR_MEMORY;
}

/* Takes the errors that are pending. Returns 0 where there were none. A lost context may report errors for ever. */
static int check(const fxs_compute *c, fxs_message *why)
{
    GLenum first = GL_NO_ERROR, next;
    for (int i = 0; i < 16 && (next = c->gl.GetError()) != GL_NO_ERROR; i++)
        first = first == GL_NO_ERROR ? next : first;
    return first == GL_NO_ERROR         ? 0
           : first == GL_OUT_OF_MEMORY ? say(why, FXS_ERR_MEMORY, "the device is out of memory", "")
                                        : say(why, FXS_ERR_DEVICE, "the device failed, or its context was lost", "");
}

/* The same for a call that failed, whether it left an error or not: never 0. */
static int failure(const fxs_compute *c, fxs_message *why)
{
    const int error = check(c, why);
    return error ? error : say(why, FXS_ERR_DEVICE, "the device failed, or its context was lost", "");
}

static int use(const fxs_compute *c, fxs_message *why)
{
    return c->use && c->use(c->use_argument) ? say(why, FXS_ERR_DEVICE, "the context cannot be made current", "") : 0;
}

/* ---- The device -------------------------------------------------------------------------------------------------- */

size_t fxs_compute_bytes(void)
{
    return sizeof(fxs_compute);
}

const char *fxs_compute_renderer(const fxs_compute *c)
{
    return c->renderer;
}

uint64_t fxs_compute_nanoseconds(const fxs_compute *c)
{
    return c->nanoseconds;
}

uint64_t fxs_compute_taken(const fxs_compute *c)
{
    uint64_t sum = 0;
    for (int i = 0; i < FXS_COMPUTE_BUFFERS; i++)
        sum += c->bytes[i];
    return sum;
}

void fxs_compute_limit(fxs_compute *c, uint64_t bytes)
{
    c->limit = bytes;
}

static int load_functions(fxs_compute_gl *gl, fxs_compute_load_fn *load, void *argument, fxs_message *why)
{
#define LOAD(type, name) \
    gl->name = (PFNGL##type##PROC)load(argument, "gl" #name); \
    if (!gl->name) \
        return say(why, FXS_ERR_UNSUPPORTED, "no compute shaders: no function gl", #name);
    FXS_COMPUTE_FUNCTIONS(LOAD)
    return 0;
}

static int has_extension(const fxs_compute_gl *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const char *one = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (one && !strcmp(one, name))
            return 1;
    }
    return 0;
}

static int check_version(fxs_compute *c, fxs_message *why)
{
    static const char es[] = "OpenGL ES ";
    const char *version = (const char *)c->gl.GetString(GL_VERSION);
    const char *renderer = (const char *)c->gl.GetString(GL_RENDERER);
    if (!version || !renderer)
        return say(why, FXS_ERR_DEVICE, "no context is current", "");
    strncpy(c->renderer, renderer, sizeof c->renderer - 1);
    const char *number = strncmp(version, es, sizeof es - 1) ? "" : version + sizeof es - 1;
    if (number[0] < '3' || number[0] > '9' || (number[0] == '3' && (number[1] != '.' || number[2] < '1')))
        return say(why, FXS_ERR_UNSUPPORTED, "OpenGL ES 3.1 is needed, this is ", version);
    c->timer = has_extension(&c->gl, "GL_EXT_disjoint_timer_query");
    return 0;
}

/* Every device has these, but for the storage blocks of some. */
static int check_limits(fxs_compute *c, fxs_message *why)
{
    static const struct limit {
        GLenum name;
        GLint least;
        const char *says;
    } limits[] = {
        {GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, 4, "fewer than 4 storage buffers in a compute shader"},
        {GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, FXS_COMPUTE_THREADS, "workgroups of fewer than 128 threads"},
        {GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, 16384, "less than 16 KiB of memory of a workgroup"},
        {GL_MAX_SHADER_STORAGE_BLOCK_SIZE, 1 << 24, "storage buffers of less than 16 MiB"},
        {GL_MAX_UNIFORM_BLOCK_SIZE, FXS_COMPUTE_STRIDE, "uniform buffers of less than 1 KiB"}};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        GLint has = 0;
        c->gl.GetIntegerv(limits[i].name, &has);
        if (has < limits[i].least)
            return say(why, FXS_ERR_UNSUPPORTED, limits[i].says, "");
        if (limits[i].name == GL_MAX_SHADER_STORAGE_BLOCK_SIZE)
            c->most = (uint64_t)has / 64 * 64;
    }
    return 0;
}

static int make_program(fxs_compute *c, int which, const char *entry, const char *text, fxs_message *why)
{
    const fxs_compute_gl *gl = &c->gl;
    char log[400] = "";
    GLint done = 0;
    const GLuint shader = gl->CreateShader(GL_COMPUTE_SHADER), program = c->programs[which] = gl->CreateProgram();
    gl->ShaderSource(shader, 1, &text, 0);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done)
        gl->GetShaderInfoLog(shader, sizeof log, 0, log);
    gl->AttachShader(program, shader);
    gl->DeleteShader(shader);
    if (done) {
        gl->LinkProgram(program);
        gl->GetProgramiv(program, GL_LINK_STATUS, &done);
        if (!done)
            gl->GetProgramInfoLog(program, sizeof log, 0, log);
    }
    if (done)
        return 0;
    fxs_message which_one;
    say(&which_one, 0, entry, " does not compile: ");
    return say(why, FXS_ERR_UNSUPPORTED, which_one.text, log);
}

static int make_objects(fxs_compute *c, fxs_message *why)
{
    int error = 0;
#define MAKE(entry) error = error ? error : make_program(c, FXS_COMPUTE_##entry, #entry, entry##_comp, why);
    FXS_COMPUTE_PROGRAMS_OF(MAKE)
    c->gl.GenBuffers(FXS_COMPUTE_BUFFERS, c->buffers);
    if (c->timer)
        c->gl.GenQueries(1, &c->query);
    return error ? error : check(c, why);
}

int fxs_compute_init(fxs_compute *c, fxs_compute_load_fn *load, fxs_compute_use_fn *use_fn, void *argument,
                     fxs_message *why)
{
    memset(c, 0, sizeof *c);
    c->use = use_fn;
    c->use_argument = argument;
    int error = use(c, why);
    error = error ? error : load_functions(&c->gl, load, argument, why);
    error = error ? error : check_version(c, why);
    error = error ? error : check_limits(c, why);
    if (error)
        return error;
    check(c, why);                 /* not ours */
    error = make_objects(c, why);
    if (error) {
        const fxs_message first = *why;
        fxs_compute_free(c);
        *why = first;
    }
    return error;
}

void fxs_compute_free(fxs_compute *c)
{
    fxs_message why;
    if (use(c, &why))
        return;                    /* its objects went with the context */
    c->gl.UseProgram(0);
    for (int i = 0; i < FXS_COMPUTE_PROGRAMS; i++)
        c->gl.DeleteProgram(c->programs[i]);
    c->gl.DeleteBuffers(FXS_COMPUTE_BUFFERS, c->buffers);
    if (c->timer)
        c->gl.DeleteQueries(1, &c->query);
    check(c, &why);
}

/* Makes a buffer at least so large; what was in it is lost then. Returns 0 or an error. */
static int reserve(fxs_compute *c, int buffer, uint64_t bytes, GLenum usage, fxs_message *why)
{
    if (bytes <= c->bytes[buffer])
        return 0;
    if (bytes > c->most)
        return too_large(why, bytes);
    int error = allow(c, bytes - c->bytes[buffer], why);
    if (error)
        return error;
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[buffer]);
    c->gl.BufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)bytes, 0, usage);
    c->bytes[buffer] = bytes;
    error = check(c, why);
    if (error)
        c->bytes[buffer] = 0;
    return error;
}

/* After an error: the next frame begins with little memory. */
static void give_back(fxs_compute *c)
{
    fxs_message why;
    c->gl.DeleteBuffers(FXS_COMPUTE_BUFFERS, c->buffers);
    c->gl.GenBuffers(FXS_COMPUTE_BUFFERS, c->buffers);
    memset(c->bytes, 0, sizeof c->bytes);
    c->chunk_room = c->large_room = c->page_room = 0;
    check(c, &why);
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

static uint32_t palette_bytes(const fxs_scene *scene)
{
    const uint32_t stages = fxs_palette_stages(scene->profile, scene->sh_degree);
    return scene->palette ? (stages * scene->palette_entries * FXS_PALETTE_STRIDE + 63) / 64 * 64 : 0;
}

static void put(fxs_compute *c, uint64_t at, const void *from, uint64_t bytes)
{
    if (bytes)
        c->gl.BufferSubData(GL_COPY_WRITE_BUFFER, (GLintptr)at, (GLsizeiptr)bytes, from);
}

/* A buffer of its own, to which data are put. */
static int make_buffer(fxs_compute *c, fxs_compute_scene *copy, uint32_t *name, uint64_t bytes, fxs_message *why)
{
    GLuint made = 0;
    bytes = bytes ? bytes : 64;
    const int error = allow(c, bytes, why);
    if (error)
        return error;
    c->gl.GenBuffers(1, &made);
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, made);
    c->gl.BufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)bytes, 0, GL_STATIC_DRAW);
    *name = made;
    copy->bytes += bytes;
    c->scene_bytes += bytes;
    return check(c, why);
}

/* Puts chunks `first` to before `end` of what lies in two pieces, the leaves' and the nodes'. */
static void put_pieces(fxs_compute *c, const fxs_scene *scene, uint64_t at, uint32_t first, uint32_t end, uint64_t size,
                       const unsigned char *leaves, const unsigned char *nodes)
{
    const uint32_t leaf_end = end < scene->chunk_count ? end : scene->chunk_count;
    if (first < leaf_end) {
        put(c, at, leaves + first * size, (leaf_end - first) * size);
        at += (leaf_end - first) * size;
        first = leaf_end;
    }
    if (first < end)
        put(c, at, nodes + (first - scene->chunk_count) * size, (end - first) * size);
}

static int copy_scene(fxs_compute *c, fxs_compute_scene *copy, const fxs_scene *scene, fxs_message *why)
{
    const uint32_t chunks = fxs_scene_chunks(scene), palette = palette_bytes(scene);
    const uint64_t most = (c->most - palette) / (scene->chunk_bytes + !scene->chunk_bytes);
    copy->part_chunks = most < UINT32_MAX ? (uint32_t)most : UINT32_MAX;
    if ((uint64_t)chunks * HEADER_BYTES > c->most || (uint64_t)copy->part_chunks * FXS_COMPUTE_PARTS < chunks)
        return too_large(why, (uint64_t)chunks * (HEADER_BYTES + scene->chunk_bytes));
    int error = make_buffer(c, copy, &copy->heads, (uint64_t)chunks * HEADER_BYTES, why);
    if (!error)
        put_pieces(c, scene, 0, 0, chunks, HEADER_BYTES, scene->chunks, scene->node_chunks);
    for (uint32_t part = 0, first = 0; first < chunks && !error; part++) {
        const uint32_t end = chunks - first < copy->part_chunks ? chunks : first + copy->part_chunks;
        error = make_buffer(c, copy, &copy->parts[part], palette + (uint64_t)(end - first) * scene->chunk_bytes, why);
        if (error)
            break;
        put(c, 0, scene->palette, scene->palette ? palette : 0);
        put_pieces(c, scene, palette, first, end, scene->chunk_bytes, scene->rows, scene->node_rows);
        first = end;
    }
    return error ? error : check(c, why);
}

int fxs_compute_upload(fxs_compute *c, fxs_compute_scene *copy, const fxs_scene *scene, fxs_message *why)
{
    if (scene->places)
        return say(why, FXS_ERR_UNSUPPORTED, "a scene of which a part is in memory cannot be on the device", "");
    int error = use(c, why);
    if (error)
        return error;
    check(c, why);                 /* not ours */
    fxs_compute_drop(c, copy);
    copy->here = *scene;
    error = copy_scene(c, copy, scene, why);
    if (error) {
        const fxs_message first = *why;
        fxs_compute_drop(c, copy);
        *why = first;
    }
    return error;
}

void fxs_compute_drop(fxs_compute *c, fxs_compute_scene *copy)
{
    fxs_message why;
    if (copy->heads && !use(c, &why)) {
        c->gl.DeleteBuffers(1, &copy->heads);
        c->gl.DeleteBuffers(FXS_COMPUTE_PARTS, copy->parts);
        c->scene_bytes -= copy->bytes;
        check(c, &why);
    }
    memset(copy, 0, sizeof *copy);
}

/* ---- The request ------------------------------------------------------------------------------------------------- */

/* Counts the chunks of the objects. */
static int count_objects(job *j, uint64_t *gaussians)
{
    const fxs_request *r = j->request;
    uint64_t chunks = 0;
    int error = !r->objects && r->count ? FXS_ERR_ARGUMENT : r->count > FXS_MAX_OBJECTS ? FXS_ERR_OBJECT : 0;
    *gaussians = 0;
    for (uint32_t i = 0; i < r->count && !error; i++) {
        error = fxs_object_check(&r->objects[i]);
        chunks += error ? 0 : r->objects[i].scene->chunk_count;
        *gaussians += error ? 0 : r->objects[i].scene->count;
    }
    if (!error && chunks > FXS_MAX_COUNT / FXS_CHUNK)
        error = FXS_ERR_OBJECT;
    j->places = (uint32_t)chunks;
    j->cut_room = error ? 0 : fxs_cut_room(r->objects, r->count, &r->options);
    return error;
}

static uint64_t objects_bytes(uint32_t count)
{
    return (count * (uint64_t)sizeof(fxs_object_view) + 63) / 64 * 64;
}

size_t fxs_compute_memory(const fxs_request *request)
{
    job j = {.request = request};
    uint64_t gaussians;
    if (count_objects(&j, &gaussians))
        return 0;
    const uint64_t bytes = 64 + objects_bytes(request->count) + (j.cut_room ? fxs_cut_bytes(j.cut_room) : 0);
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

static int check_targets(const fxs_request *r)
{
    const fxs_targets *t = r->targets;
    const int error = fxs_targets_check(t, r->cameras->width, r->cameras->height);
    return error ? error
           : t->format > FXS_FORMAT_RGBA16_COVERAGE ? FXS_ERR_UNSUPPORTED
           : t->colour.pixels || t->coverage.pixels || t->mean_depth.pixels || t->median_depth.pixels || t->id.pixels
               ? 0 : FXS_ERR_TARGET;
}

static int place_objects(job *j)
{
    uint32_t chunks = 0;
    int error = 0;
    for (uint32_t i = 0; i < j->request->count && !error; i++) {
        const fxs_object *object = &j->request->objects[i];
        error = fxs_object_view_init(&j->objects[i], &j->view, j->request->cameras, object);
        j->objects[i].first_chunk = chunks;
        chunks += fxs_cut_chunks(object->scene, j->cut_room != 0);
        j->objects[i].end_chunk = chunks;
    }
    return error;
}

static int choose_chunks(job *j, void *memory)
{
    fxs_cut cut = {.objects = j->request->objects, .object_count = j->request->count,
                   .options = &j->request->options, .eye_count = 1, .cameras = {j->request->cameras},
                   .views = {j->objects}, .room = j->cut_room, .memory = memory};
    const int error = fxs_cut_find(&cut);
    j->drawn = cut.drawn;
    j->places = cut.count;
    return error;
}

static int take_request(job *j, void *memory, uint64_t *gaussians, fxs_message *why)
{
    const fxs_options *o = &j->request->options;
    int error = o->sh_degree < 0 || o->sh_degree > 3 || (unsigned)o->cutoff > FXS_CUTOFF_SQUARE ? FXS_ERR_ARGUMENT : 0;
    error = error ? error : count_objects(j, gaussians);
    error = error ? error : fxs_view_init(&j->view, j->request->cameras, o);
    error = error ? error : check_targets(j->request);
    j->objects = memory;
    error = error ? error : place_objects(j);
    if (!error && j->cut_room)
        error = choose_chunks(j, (unsigned char *)memory + objects_bytes(j->request->count));
    if (!error && o->stop && o->stop(o->stop_argument))
        error = FXS_ERR_STOPPED;
    return said(why, error);
}

/* ---- Spans ------------------------------------------------------------------------------------------------------- */

static uint32_t chunk_of(const job *j, uint32_t place)
{
    return j->drawn ? j->drawn[place].chunk : place;
}

/* Goes on to the next span; *s is all 0 at first. Returns 0 where there is none. */
static int next_span(const job *j, span *s)
{
    uint32_t place = s->end_place;
    if (place >= j->places)
        return 0;
    while (chunk_of(j, place) >= j->objects[s->object].end_chunk)
        s->object++;
    const fxs_object_view *object = &j->objects[s->object];
    const uint32_t part_chunks = j->copies[s->object]->part_chunks;
    s->first_place = place;
    s->part = (chunk_of(j, place) - object->first_chunk) / part_chunks;
    const uint64_t part_end = object->first_chunk + (uint64_t)(s->part + 1) * part_chunks;
    const uint32_t end = part_end < object->end_chunk ? (uint32_t)part_end : object->end_chunk;
    if (!j->drawn)
        place = end;
    while (place < j->places && chunk_of(j, place) < end)
        place++;
    s->end_place = place;
    return 1;
}

static void split(uint32_t out[2], uint64_t x)
{
    out[0] = (uint32_t)x;
    out[1] = (uint32_t)(x >> 32);
}

static void fill_view(fxs_compute_object *o, const fxs_view *v)
{
    const uint64_t x = (uint64_t)v->tiles_x * FXS_TILE, y = (uint64_t)v->tiles_y * FXS_TILE;
    split(o->near_q32, (uint64_t)v->near_q32);
    split(o->dilation_q30, ((x * x + y * y) << 30) / 14400);
    for (int i = 0; i < 3; i++) {
        split(o->position_q32[i], (uint64_t)v->position_q32[i]);
        split(o->eye_q32[i], (uint64_t)v->eye_q32[i]);
        memcpy(o->rotation_q30[i], v->rotation_q30 + 3 * i, 3 * sizeof(int32_t));
    }
    for (int i = 0; i < 2; i++) {
        memcpy(o->row_q15[i], v->row_q15[i], sizeof v->row_q15[i]);
        memcpy(o->forward_q15[i], v->forward_q15[i], sizeof v->forward_q15[i]);
        o->f_q12[i] = (int32_t)(i ? v->fy_q12 : v->fx_q12);
        o->c_q12[i] = (int32_t)(i ? v->cy_q12 : v->cx_q12);
        o->slope_low_q23[i] = v->slope_low_q23[i];
        o->slope_high_q23[i] = v->slope_high_q23[i];
        o->edge_low_q23[i] = v->edge_low_q23[i];
        o->edge_high_q23[i] = v->edge_high_q23[i];
        o->hidden_low_q23[i] = v->hidden_low_q23[i];
        o->hidden_high_q23[i] = v->hidden_high_q23[i];
        o->hidden[i] = v->hidden[i];
        o->hidden_end[i] = v->hidden_end[i];
    }
    o->focal_q32 = v->focal_q32;
    o->focal_exponent = v->focal_exponent;
    o->veil_exponent = v->veil_exponent;
    o->jacobian_exponent = v->jacobian_exponent;
    o->offset_q11 = v->offset_q11;
    o->degree = v->sh_degree;
    o->antialiased = v->antialiased;
    o->orthographic = v->orthographic;
    o->plane_exponent = v->plane_exponent;
}

static void fill_object(fxs_compute_object *o, const job *j, const span *s, uint32_t number)
{
    const fxs_object_view *view = &j->objects[s->object];
    const fxs_scene *scene = &view->scene;
    memset(o, 0, sizeof *o);
    fill_view(o, &view->view);
    o->profile = scene->profile;
    o->scene_degree = scene->sh_degree;
    o->chunk_words = scene->chunk_bytes / 4;
    o->palette_entries = scene->palette ? scene->palette_entries : 0;
    o->palette_step_q19 = (int32_t)scene->palette_step_q19;
    o->scale_mantissa = view->scale.mantissa;
    o->scale_exponent = view->scale.exponent;
    o->plain = view->plain;
    memcpy(o->tint_q13, view->tint_q13, sizeof view->tint_q13);
    o->crop_count = view->crop_count;
    o->keep_count = view->keep_count;
    o->first_chunk = view->first_chunk;
    o->first_place = s->first_place;
    o->end_place = s->end_place;
    o->span = number;
    o->part_chunk = s->part * j->copies[s->object]->part_chunks;
    o->rows_at = palette_bytes(scene) / 4;
    for (uint32_t i = 0; i < view->crop_count; i++) {
        const fxs_crop *crop = &view->crops[i];
        for (int k = 0; k < 3; k++) {
            split(o->crops[i] + 2 * k, (uint64_t)crop->low_q32[k]);
            split(o->crops[i] + 6 + 2 * k, (uint64_t)crop->high_q32[k]);
        }
        o->crops[i][12] = crop->outside != 0;
    }
}

/* ---- Memory of a frame ------------------------------------------------------------------------------------------- */

static uint32_t larger(uint64_t a, uint64_t b)
{
    const uint64_t x = a > b ? a : b;
    return x < UINT32_MAX ? (uint32_t)x : UINT32_MAX;
}

/* How much a frame is likely to need, at first. */
static void guess_rooms(job *j, uint64_t gaussians)
{
    fxs_compute *c = j->c;
    const uint64_t slots = j->drawn ? (uint64_t)j->places * FXS_CHUNK : gaussians, all = c->most / (2 * ENTRY_BYTES);
    const uint64_t entries = 2 * slots + 65536 < all ? 2 * slots + 65536 : all;
    const uint64_t chunks = c->most / (FXS_CHUNK * SPLAT_BYTES);
    c->chunk_room = larger(c->chunk_room, j->places < chunks ? j->places + 1 : chunks);
    c->large_room = larger(c->large_room, slots / 16 + 4096);
    c->page_room = larger(c->page_room, entries / FXS_COMPUTE_PAGE);
}

static uint32_t words_at(uint64_t *used, uint64_t words)
{
    const uint64_t at = *used;
    *used += (words + 15) / 16 * 16;
    return (uint32_t)at;
}

static uint32_t plane_at(uint64_t *used, const fxs_image *image, uint64_t words)
{
    return image->pixels ? words_at(used, words) : FXS_NOTHING;
}

/* Where all lies in the memory, the counts and the picture. */
static void lay_out(job *j)
{
    const fxs_compute *c = j->c;
    const fxs_targets *t = j->request->targets;
    fxs_compute_frame *f = &j->c->frame;
    const uint64_t tiles = (uint64_t)j->view.tiles_x * (uint64_t)j->view.tiles_y;
    const uint64_t pixels = (uint64_t)j->view.width * (uint64_t)j->view.height;
    uint64_t words = TABLE_WORDS, picture = 0;
    span s = {0, 0, 0, 0};
    for (f->spans = 0; next_span(j, &s); f->spans++)
        ;
    f->size[0] = j->view.width;
    f->size[1] = j->view.height;
    f->tiles[0] = j->view.tiles_x;
    f->tiles[1] = j->view.tiles_y;
    f->places = j->places;
    f->chunk_room = c->chunk_room;
    f->large_room = c->large_room;
    f->page_room = c->page_room;
    f->spans_at = words_at(&words, FXS_COMPUTE_SPAN * ((uint64_t)f->spans + 1));
    f->drawn = j->drawn ? words_at(&words, 2 * (uint64_t)j->places) : 0;
    f->ranks = words_at(&words, j->places / 32 + 1);
    f->visible = words_at(&words, j->places);
    f->records = words_at(&words, (uint64_t)FXS_COMPUTE_RECORD * j->places);
    f->boxes = words_at(&words, 2 * (uint64_t)FXS_CHUNK * c->chunk_room);
    f->depths = words_at(&words, (uint64_t)FXS_CHUNK * c->chunk_room);
    f->larges = words_at(&words, (uint64_t)FXS_COMPUTE_LARGE * c->large_room);
    j->memory_words = words;
    f->seen = (uint32_t)(FXS_COMPUTE_TILES + tiles);
    f->cleared = f->next = f->seen + j->places / 32 + 1;
    f->classes = (uint32_t)(f->next + tiles);
    f->blocks = (uint32_t)(f->classes + FXS_COMPUTE_CLASSES * tiles);
    f->block_room = (uint32_t)(tiles + (uint64_t)c->page_room * (FXS_COMPUTE_PAGE / FXS_COMPUTE_BLOCK));
    f->spare = c->page_room * FXS_COMPUTE_PAGE;
    f->cutoff = (int32_t)j->view.cutoff;
    f->cut_q11 = j->view.cut_q11;
    f->format = t->format;
    for (int i = 0; i < 3; i++)
        f->background_q13[i] = fxs_is_premultiplied(t->format)
                                   ? 0 : fxs_background_q13(j->request->options.background[i]);
    f->depth_bits = fxs_depth_bits(t);
    f->colour = plane_at(&picture, &t->colour, pixels * (t->format == FXS_FORMAT_RGBA16_COVERAGE ? 2 : 1));
    f->coverage = plane_at(&picture, &t->coverage, pixels);
    f->mean_depth = plane_at(&picture, &t->mean_depth, pixels);
    f->median_depth = plane_at(&picture, &t->median_depth, pixels);
    f->id = plane_at(&picture, &t->id, 2 * pixels);
    j->read_words = picture;
    f->occluder = plane_at(&picture, &t->occluder, pixels);
    f->backdrop = plane_at(&picture, &t->backdrop, pixels);
    j->picture_words = picture;
}

static int reserve_frame(const job *j, fxs_message *why)
{
    fxs_compute *c = j->c;
    const fxs_compute_frame *f = &j->c->frame;
    const GLuint memory = c->buffers[FXS_COMPUTE_MEMORY];
    const uint64_t had = c->bytes[FXS_COMPUTE_MEMORY];
    int error = reserve(c, FXS_COMPUTE_MEMORY, 4 * j->memory_words, GL_DYNAMIC_COPY, why);
    if (!error && c->bytes[FXS_COMPUTE_MEMORY] != had) {
        c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, memory);
        put(c, 0, fxs_offset_of_code_q11, sizeof fxs_offset_of_code_q11);
    }
    error = error ? error : reserve(c, FXS_COMPUTE_COUNTS, 4 * (f->blocks + 2 * (uint64_t)f->block_room),
                                    GL_DYNAMIC_COPY, why);
    error = error ? error : reserve(c, FXS_COMPUTE_ARGUMENTS, 16 * ((uint64_t)f->spans + 2), GL_DYNAMIC_COPY, why);
    error = error ? error : reserve(c, FXS_COMPUTE_LATER, 16 * (1 + MERGES), GL_DYNAMIC_COPY, why);
    error = error ? error : reserve(c, FXS_COMPUTE_SPLATS, (uint64_t)FXS_CHUNK * SPLAT_BYTES * f->chunk_room,
                                    GL_DYNAMIC_COPY, why);
    error = error ? error : reserve(c, FXS_COMPUTE_ENTRIES, 2 * (uint64_t)FXS_COMPUTE_PAGE * ENTRY_BYTES * f->page_room,
                                    GL_DYNAMIC_COPY, why);
    error = error ? error : reserve(c, FXS_COMPUTE_PICTURE, 4 * j->picture_words, GL_DYNAMIC_COPY, why);
    error = error ? error : reserve(c, FXS_COMPUTE_DOWNLOAD, 4 * (FXS_COMPUTE_STATUS + j->read_words),
                                    GL_STREAM_READ, why);
    return error ? error : reserve(c, FXS_COMPUTE_UNIFORMS, FXS_COMPUTE_STRIDE * ((uint64_t)f->spans + 1),
                                   GL_STREAM_DRAW, why);
}

static void *map(const fxs_compute *c, int buffer, uint64_t at, uint64_t bytes)
{
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[buffer]);
    return c->gl.MapBufferRange(GL_COPY_WRITE_BUFFER, (GLintptr)at, (GLsizeiptr)bytes,
                                GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_RANGE_BIT);
}

static int unmap(const fxs_compute *c, fxs_message *why)
{
    return c->gl.UnmapBuffer(GL_COPY_WRITE_BUFFER) ? 0 : failure(c, why);
}

static int put_uniforms(const job *j, fxs_message *why)
{
    unsigned char *to = map(j->c, FXS_COMPUTE_UNIFORMS, 0, FXS_COMPUTE_STRIDE * ((uint64_t)j->c->frame.spans + 1));
    span s = {0, 0, 0, 0};
    if (!to)
        return failure(j->c, why);
    memcpy(to, &j->c->frame, sizeof j->c->frame);
    for (uint32_t i = 0; next_span(j, &s); i++) {
        fxs_compute_object object;
        fill_object(&object, j, &s, i);
        memcpy(to + FXS_COMPUTE_STRIDE * (i + 1), &object, sizeof object);
    }
    return unmap(j->c, why);
}

/* The spans' places, and the chunks of the cut. */
static int put_places(const job *j, fxs_message *why)
{
    const fxs_compute_frame *f = &j->c->frame;
    uint32_t *to = map(j->c, FXS_COMPUTE_MEMORY, 4 * (uint64_t)f->spans_at, 4 * (uint64_t)(f->ranks - f->spans_at));
    span s = {0, 0, 0, 0};
    if (!to)
        return failure(j->c, why);
    for (uint32_t i = 0; next_span(j, &s); i++) {
        uint32_t *words = to + FXS_COMPUTE_SPAN * i;
        words[0] = s.first_place;
        words[1] = s.end_place;
        words[4] = j->objects[s.object].id;
        words[5] = j->objects[s.object].first_chunk;
    }
    to[FXS_COMPUTE_SPAN * f->spans] = 0;
    to[FXS_COMPUTE_SPAN * f->spans + 1] = f->places;
    for (uint32_t i = 0; i < j->places && j->drawn; i++) {
        uint32_t *words = to + (f->drawn - f->spans_at) + 2 * (size_t)i;
        words[0] = j->drawn[i].chunk;
        words[1] = j->drawn[i].share_q8 | (uint32_t)j->drawn[i].grow_q8 << 16;
    }
    return unmap(j->c, why);
}

/* An image of four bytes a pixel that is read. */
static int put_plane(const job *j, const fxs_image *image, uint32_t at, fxs_message *why)
{
    const uint64_t row = 4 * (uint64_t)j->view.width;
    if (!image->pixels)
        return 0;
    unsigned char *to = map(j->c, FXS_COMPUTE_PICTURE, 4 * (uint64_t)at, row * (uint64_t)j->view.height);
    if (!to)
        return failure(j->c, why);
    for (int32_t y = 0; y < j->view.height; y++)
        memcpy(to + (uint64_t)y * row, fxs_image_at(image, 0, y, 4), row);
    return unmap(j->c, why);
}

/* ---- Stages ------------------------------------------------------------------------------------------------------ */

static void bind(const fxs_compute *c, GLuint at, int buffer)
{
    c->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, at, c->buffers[buffer]);
}

/* What comes sees what was written before. */
static void start(const fxs_compute *c, int program)
{
    c->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    c->gl.UseProgram(c->programs[program]);
}

static void dispatch(const fxs_compute *c, uint64_t groups)
{
    const uint64_t rows = (groups + FXS_COMPUTE_ROW - 1) / FXS_COMPUTE_ROW;
    if (groups)
        c->gl.DispatchCompute((GLuint)(groups < FXS_COMPUTE_ROW ? groups : FXS_COMPUTE_ROW), (GLuint)rows, 1);
}

static void dispatch_indirect(const fxs_compute *c, uint32_t number)
{
    c->gl.DispatchComputeIndirect((GLintptr)(16 * (uint64_t)number));
}

static void bind_object(const fxs_compute *c, uint32_t span_number)
{
    c->gl.BindBufferRange(GL_UNIFORM_BUFFER, 1, c->buffers[FXS_COMPUTE_UNIFORMS],
                          (GLintptr)(FXS_COMPUTE_STRIDE * ((uint64_t)span_number + 1)), sizeof(fxs_compute_object));
}

static uint64_t groups_of(uint64_t threads)
{
    return (threads + FXS_COMPUTE_THREADS - 1) / FXS_COMPUTE_THREADS;
}

static void locate(const job *j)
{
    const fxs_compute *c = j->c;
    span s = {0, 0, 0, 0};
    start(c, FXS_COMPUTE_clear_counts);
    dispatch(c, groups_of(j->c->frame.cleared));
    start(c, FXS_COMPUTE_locate_chunks);
    for (uint32_t i = 0; next_span(j, &s); i++) {
        if (!j->objects[s.object].visible)
            continue;
        bind_object(c, i);
        c->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, j->copies[s.object]->heads);
        dispatch(c, groups_of(s.end_place - s.first_place / 32 * 32));
    }
    bind(c, 0, FXS_COMPUTE_ARGUMENTS);
    start(c, FXS_COMPUTE_gather_chunks);
    dispatch(c, 1);
}

static void project(const job *j)
{
    const fxs_compute *c = j->c;
    span s = {0, 0, 0, 0};
    bind(c, 3, FXS_COMPUTE_SPLATS);
    start(c, FXS_COMPUTE_project_chunk);
    for (uint32_t i = 0; next_span(j, &s); i++) {
        if (!j->objects[s.object].visible)
            continue;
        bind_object(c, i);
        c->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, j->copies[s.object]->parts[s.part]);
        dispatch_indirect(c, i);
    }
}

static void list(const job *j)
{
    const fxs_compute *c = j->c;
    bind(c, 0, FXS_COMPUTE_ARGUMENTS);
    start(c, FXS_COMPUTE_start_lists);
    dispatch(c, (uint64_t)j->c->frame.tiles[1]);
    bind(c, 0, FXS_COMPUTE_LATER);
    bind(c, 3, FXS_COMPUTE_ENTRIES);
    start(c, FXS_COMPUTE_fill_lists);
    dispatch_indirect(c, j->c->frame.spans);
    bind(c, 0, FXS_COMPUTE_SPLATS);
    c->gl.UseProgram(c->programs[FXS_COMPUTE_fill_large]);
    dispatch_indirect(c, j->c->frame.spans + 1);
}

static void draw(const job *j)
{
    const fxs_compute *c = j->c;
    const uint64_t tiles = (uint64_t)j->c->frame.tiles[0] * (uint64_t)j->c->frame.tiles[1];
    c->gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, c->buffers[FXS_COMPUTE_LATER]);
    bind(c, 0, FXS_COMPUTE_COUNTS);
    bind(c, 1, FXS_COMPUTE_ENTRIES);
    bind(c, 2, FXS_COMPUTE_SPLATS);
    bind(c, 3, FXS_COMPUTE_PICTURE);
    start(c, FXS_COMPUTE_sort_blocks);
    dispatch_indirect(c, 0);
    for (uint32_t i = 0; i < MERGES && (uint64_t)FXS_COMPUTE_BLOCK << 4 * i < (uint64_t)j->places * FXS_CHUNK; i++) {
        start(c, FXS_COMPUTE_merge_10 + (int)i);
        dispatch_indirect(c, 1 + i);
    }
    start(c, fxs_targets_traced(j->request->targets) ? FXS_COMPUTE_trace_tiles : FXS_COMPUTE_blend_tiles);
    dispatch(c, 4 * tiles);
    if (j->c->frame.id != FXS_NOTHING) {
        bind(c, 1, FXS_COMPUTE_MEMORY);
        start(c, FXS_COMPUTE_name_pixels);
        dispatch(c, groups_of((uint64_t)j->view.width * (uint64_t)j->view.height));
    }
}

static void read_time(fxs_compute *c)
{
    GLuint nanoseconds = 0;
    GLint disjoint = 0;
    if (!c->timer)
        return;
    c->gl.GetQueryObjectuiv(c->query, GL_QUERY_RESULT, &nanoseconds);
    c->gl.GetIntegerv(DISJOINT, &disjoint);
    c->nanoseconds += disjoint ? 0 : nanoseconds;
}

/* All stages, and the copy of what is read back. */
static int run_stages(const job *j, fxs_message *why)
{
    fxs_compute *c = j->c;
    const fxs_compute_gl *gl = &c->gl;
    if (c->timer)
        gl->BeginQuery(TIME_ELAPSED, c->query);
    gl->BindBufferRange(GL_UNIFORM_BUFFER, 0, c->buffers[FXS_COMPUTE_UNIFORMS], 0, sizeof j->c->frame);
    gl->BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, c->buffers[FXS_COMPUTE_ARGUMENTS]);
    bind(c, 1, FXS_COMPUTE_MEMORY);
    bind(c, 2, FXS_COMPUTE_COUNTS);
    locate(j);
    project(j);
    list(j);
    draw(j);
    if (c->timer)
        gl->EndQuery(TIME_ELAPSED);
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl->BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[FXS_COMPUTE_DOWNLOAD]);
    gl->BindBuffer(GL_COPY_READ_BUFFER, c->buffers[FXS_COMPUTE_COUNTS]);
    gl->CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, 4 * FXS_COMPUTE_STATUS);
    gl->BindBuffer(GL_COPY_READ_BUFFER, c->buffers[FXS_COMPUTE_PICTURE]);
    gl->CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 4 * FXS_COMPUTE_STATUS,
                          (GLsizeiptr)(4 * j->read_words));
    return check(c, why);
}

/* ---- Reading back ------------------------------------------------------------------------------------------------ */

/* A plane of words to an image of as many bytes a pixel: a word's low ones, or two words. */
static void copy_plane(const job *j, const fxs_image *to, int bytes, const uint32_t *picture, uint32_t at)
{
    const size_t width = (size_t)j->view.width;
    if (!to->pixels)
        return;
    for (int32_t y = 0; y < j->view.height; y++) {
        unsigned char *row = fxs_image_at(to, 0, y, bytes);
        const unsigned char *from = (const unsigned char *)(picture + at) + (size_t)y * width * (bytes > 4 ? 8 : 4);
        if (bytes >= 4)
            memcpy(row, from, width * (size_t)bytes);
        else
            for (size_t x = 0; x < width; x++)
                memcpy(row + x * (size_t)bytes, from + 4 * x, (size_t)bytes);
    }
}

static int needs_more(const job *j)
{
    const fxs_compute_frame *f = &j->c->frame;
    return j->status[FXS_COMPUTE_PAGES] > f->page_room || j->status[FXS_COMPUTE_LARGES] > f->large_room ||
           j->status[FXS_COMPUTE_VISIBLE_CHUNKS] > f->chunk_room;
}

/* The status; and where all fitted, the pixels. */
static int read_back(job *j, fxs_message *why)
{
    const fxs_compute *c = j->c;
    const fxs_targets *t = j->request->targets;
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[FXS_COMPUTE_DOWNLOAD]);
    const uint32_t *from = c->gl.MapBufferRange(GL_COPY_WRITE_BUFFER, 0,
                                                (GLsizeiptr)(4 * (FXS_COMPUTE_STATUS + j->read_words)),
                                                GL_MAP_READ_BIT);
    if (!from)
        return failure(c, why);
    memcpy(j->status, from, sizeof j->status);
    if (!needs_more(j) && !j->status[FXS_COMPUTE_DAMAGED]) {
        const uint32_t *picture = from + FXS_COMPUTE_STATUS;
        copy_plane(j, &t->colour, fxs_pixel_bytes(t->format), picture, j->c->frame.colour);
        copy_plane(j, &t->coverage, 1, picture, j->c->frame.coverage);
        copy_plane(j, &t->mean_depth, 4, picture, j->c->frame.mean_depth);
        copy_plane(j, &t->median_depth, 4, picture, j->c->frame.median_depth);
        copy_plane(j, &t->id, 8, picture, j->c->frame.id);
    }
    const int error = unmap(c, why);
    return error                                ? error
           : j->status[FXS_COMPUTE_DAMAGED] ? said(why, FXS_ERR_SCENE) : check(c, why);
}

/* Room for what the frame needed, and an eighth more of what may change with the view. */
static void make_more(job *j)
{
    fxs_compute *c = j->c;
    const uint64_t larges = j->status[FXS_COMPUTE_LARGES], pages = j->status[FXS_COMPUTE_PAGES];
    const uint64_t most_pages = c->most / (2 * FXS_COMPUTE_PAGE * ENTRY_BYTES);
    const uint64_t spare = pages + pages / 8 <= most_pages ? pages / 8 : 0;
    c->chunk_room = larger(c->chunk_room, j->status[FXS_COMPUTE_VISIBLE_CHUNKS]);
    if (larges > c->large_room)
        c->large_room = larger(larges + larges / 8, 0);
    if (pages > c->page_room)
        c->page_room = larger(pages + spare, 0);
}

static int render(job *j, uint64_t gaussians, fxs_message *why)
{
    int error = 0;
    j->c->nanoseconds = 0;
    guess_rooms(j, gaussians);
    for (int i = 0; i < TRIES && !error; i++) {
        lay_out(j);
        error = reserve_frame(j, why);
        error = error ? error : put_uniforms(j, why);
        error = error ? error : put_places(j, why);
        error = error ? error : put_plane(j, &j->request->targets->occluder, j->c->frame.occluder, why);
        error = error ? error : put_plane(j, &j->request->targets->backdrop, j->c->frame.backdrop, why);
        error = error ? error : run_stages(j, why);
        error = error ? error : read_back(j, why);
        if (error)
            break;
        read_time(j->c);
        if (!needs_more(j))
            return 0;
        make_more(j);
    }
    if (!error)
        error = say(why, FXS_ERR_DEVICE, "the device counts a frame differently each time", "");
    if (error == FXS_ERR_MEMORY || error == FXS_ERR_DEVICE)
        give_back(j->c);
    return error;
}

static void fill_stats(const job *j, uint64_t gaussians, fxs_stats *stats)
{
    const fxs_compute *c = j->c;
    memset(stats, 0, sizeof *stats);
    stats->gaussians = (uint32_t)gaussians;
    stats->drawn = j->places * FXS_CHUNK;
    stats->visible = j->status[FXS_COMPUTE_VISIBLE];
    stats->entries = (uint64_t)j->status[FXS_COMPUTE_ENTRY_COUNT + 1] << 32 | j->status[FXS_COMPUTE_ENTRY_COUNT];
    stats->bands = stats->runs = 1;
    stats->memory.splats = (size_t)(c->bytes[FXS_COMPUTE_MEMORY] + c->bytes[FXS_COMPUTE_SPLATS]);
    stats->memory.tiles = (size_t)c->bytes[FXS_COMPUTE_COUNTS];
    stats->memory.entries = (size_t)c->bytes[FXS_COMPUTE_ENTRIES];
    stats->memory.total = (size_t)fxs_compute_taken(c);
}

int fxs_compute_render(fxs_compute *c, const fxs_request *request, const fxs_compute_scene *const *copies, void *memory,
                       fxs_stats *stats, fxs_message *why)
{
    job j = {.c = c, .request = request, .copies = copies};
    uint64_t gaussians = 0;
    int error = !c || !request || !memory || (!copies && request->count) ? said(why, FXS_ERR_ARGUMENT) : 0;
    error = error ? error : take_request(&j, memory, &gaussians, why);
    error = error ? error : use(c, why);
    if (error)
        return error;
    check(c, why);                 /* not ours */
    error = render(&j, gaussians, why);
    if (!error && stats)
        fill_stats(&j, gaussians, stats);
    return error;
}
