/* Compute back end for OpenGL ES 3.1: uploads scenes and renders frames to images in memory, with the buffers and
 * dispatches of plan.c. */
#include <stdlib.h>

#include "gl31.h"
#include "shaders.h"
#include "src/core/memory.h"
#include "src/core/mirror.h"
#include "src/core/targets.h"

#define TIME_ELAPSED 0x88BF        /* constants of EXT_disjoint_timer_query */
#define DISJOINT 0x8FBB

enum { ALL_BUFFERS = FXS_COMPUTE_EYES * FXS_COMPUTE_BUFFERS };

int fxs_compute_allow(const fxs_compute *c, uint64_t bytes, fxs_message *why)
{
    const uint64_t needed = fxs_compute_taken(c) + c->scene_bytes + bytes;
    if (!c->limit || needed <= c->limit)
        return 0;
    fxs_plan_say(why, FXS_ERR_MEMORY, "the device memory allowed is too small", "");
    why->bytes_needed = needed;
    return FXS_ERR_MEMORY;
}

static int said(int error, fxs_message *why)
{
    return !error ? 0
           : error == FXS_ERR_MEMORY
               ? fxs_plan_say(why, FXS_ERR_MEMORY, "the device is out of memory", "")
               : fxs_plan_say(why, FXS_ERR_DEVICE, "the device failed, or its context was lost", "");
}

int fxs_compute_check(const fxs_compute *c, fxs_message *why)
{
    return said(fxs_gl_check(&c->gl), why);
}

static int failure(const fxs_compute *c, fxs_message *why)
{
    return said(fxs_gl_failure(&c->gl), why);
}

/* Returns the error for a missing feature of the device. A pending GL error is returned instead, because a lost context
   also looks like a missing feature. */
int fxs_compute_lacks(const fxs_compute *c, const char *text, const char *what, fxs_message *why)
{
    const int error = fxs_compute_check(c, why);
    return error ? error : fxs_plan_say(why, FXS_ERR_UNSUPPORTED, text, what);
}

static int use(const fxs_compute *c, fxs_message *why)
{
    return c->use && c->use(c->use_argument)
               ? fxs_plan_say(why, FXS_ERR_DEVICE, "the context cannot be made current", "") : 0;
}

fxs_gl_info fxs_compute_info(const fxs_compute *c)
{
    return (fxs_gl_info){c->renderer, 0, c->nanoseconds};
}

uint64_t fxs_compute_taken(const fxs_compute *c)
{
    uint64_t sum = c->stage_bytes;
    sum += c->shift ? (uint64_t)c->word_rows * 4 << c->shift : 0;
    for (int eye = 0; eye < FXS_COMPUTE_EYES; eye++)
        for (int i = 0; i < FXS_COMPUTE_BUFFERS; i++)
            sum += c->bytes[eye][i];
    return sum;
}

void fxs_compute_limit(fxs_compute *c, uint64_t bytes)
{
    c->limit = bytes;
}

void fxs_compute_stream(fxs_compute *c, uint64_t pool_bytes, uint64_t upload_bytes)
{
    c->pool_bytes = pool_bytes;
    c->upload_bytes = upload_bytes;
}

static const char *load_more(fxs_compute_gl *table, fxs_gl_load_fn *load, void *argument)
{
    FXS_COMPUTE_FUNCTIONS(FXS_GL_LOAD)
    return 0;
}

static int load_functions(fxs_compute *c, fxs_gl_load_fn *load, void *argument, fxs_message *why)
{
    const char *missing = fxs_gl_load(&c->gl, load, argument);
    missing = missing ? missing : load_more(&c->more, load, argument);
    return missing ? fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "no compute shaders: no function ", missing) : 0;
}

static int check_version(fxs_compute *c, fxs_message *why)
{
    static const char es[] = "OpenGL ES ";
    const char *version = (const char *)c->gl.GetString(GL_VERSION);
    const char *renderer = (const char *)c->gl.GetString(GL_RENDERER);
    if (!version || !renderer)
        return fxs_plan_say(why, FXS_ERR_DEVICE, "no context is current", "");
    strncpy(c->renderer, renderer, sizeof c->renderer - 1);
    const char *number = strncmp(version, es, sizeof es - 1) ? "" : version + sizeof es - 1;
    if (number[0] < '3' || number[0] > '9' || (number[0] == '3' && (number[1] != '.' || number[2] < '1')))
        return fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "OpenGL ES 3.1 is needed, this is ", version);
    c->timer = fxs_gl_has_extension(&c->gl, "GL_EXT_disjoint_timer_query");
    c->rooms.finishes = fxs_plan_finishes(renderer);
    return 0;
}

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
            return fxs_compute_lacks(c, limits[i].says, "", why);
        if (limits[i].name == GL_MAX_SHADER_STORAGE_BLOCK_SIZE)
            c->rooms.most = (uint64_t)has / 64 * 64;
    }
    return 0;
}

static int make_program(fxs_compute *c, int which, const char *entry, const char *text, fxs_message *why)
{
    char log[400] = "";
    const GLuint program = c->programs[which] = c->gl.CreateProgram();
    if (fxs_gl_compile(&c->gl, program, GL_COMPUTE_SHADER, &text, 1, log, sizeof log) &&
        fxs_gl_link(&c->gl, program, log, sizeof log))
        return 0;
    fxs_message which_one;
    fxs_plan_say(&which_one, 0, entry, " does not compile: ");
    return fxs_compute_lacks(c, which_one.text, log, why);
}

static int make_objects(fxs_compute *c, fxs_message *why)
{
    int error = 0;
#define MAKE(entry) error = error ? error : make_program(c, FXS_COMPUTE_##entry, #entry, entry##_comp, why);
    FXS_COMPUTE_PROGRAMS_OF(MAKE)
    c->gl.GenBuffers(ALL_BUFFERS, c->buffers[0]);
    c->gl.GenBuffers(FXS_COMPUTE_FLIGHTS, c->statuses);
    if (c->timer)
        c->gl.GenQueries(1, &c->query);
    return error ? error : fxs_compute_check(c, why);
}

static void drop_flights(fxs_compute *c)
{
    for (int i = 0; i < FXS_COMPUTE_FLIGHTS; i++)
        c->more.DeleteSync(c->flights[i].done);
    memset(c->flights, 0, sizeof c->flights);
}

/* Deletes the GL objects of the back end. A lost context has already freed its objects. */
static void end(fxs_compute *c)
{
    fxs_message why;
    if (use(c, &why))
        return;
    fxs_compute_end_drawing(c);
    drop_flights(c);
    c->gl.DeleteBuffers(FXS_COMPUTE_FLIGHTS, c->statuses);
    fxs_gl_delete_programs(&c->gl, FXS_COMPUTE_PROGRAMS, c->programs);
    c->gl.DeleteBuffers(ALL_BUFFERS, c->buffers[0]);
    c->gl.DeleteBuffers(1, &c->stage);
    if (c->timer)
        c->gl.DeleteQueries(1, &c->query);
    fxs_compute_check(c, &why);
}

static int begin(fxs_compute *c, fxs_gl_load_fn *load, fxs_gl_use_fn *use_fn, void *argument, fxs_message *why)
{
    c->use = use_fn;
    c->use_argument = argument;
    int error = use(c, why);
    error = error ? error : load_functions(c, load, argument, why);
    if (error)
        return error;
    fxs_compute_check(c, why);     /* clears errors of earlier GL calls */
    error = check_version(c, why);
    error = error ? error : check_limits(c, why);
    if (error)
        return error;
    error = make_objects(c, why);
    if (error) {
        const fxs_message first = *why;
        end(c);
        *why = first;
    }
    return error;
}

int fxs_compute_create(fxs_compute **compute, fxs_gl_load_fn *load, fxs_gl_use_fn *use_fn, void *argument,
                       fxs_message *why)
{
    fxs_compute *c = *compute = calloc(1, sizeof *c);
    const int error = c ? begin(c, load, use_fn, argument, why) : fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory",
                                                                               "");
    if (error) {
        free(c);
        *compute = 0;
    }
    return error;
}

void fxs_compute_destroy(fxs_compute *c)
{
    if (c)
        end(c);
    free(c);
}

/* Grows a buffer to at least `bytes` bytes, without keeping its contents. */
static int reserve(fxs_compute *c, uint32_t eye, int buffer, uint64_t bytes, GLenum usage, fxs_message *why)
{
    uint64_t *has = &c->bytes[eye][buffer];
    if (bytes <= *has)
        return 0;
    int error = fxs_compute_allow(c, bytes - *has, why);
    if (error)
        return error;
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[eye][buffer]);
    c->gl.BufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)bytes, 0, usage);
    *has = bytes;
    error = fxs_compute_check(c, why);
    if (error)
        *has = 0;
    return error;
}

static void give_back(fxs_compute *c)
{
    fxs_message why;
    c->gl.DeleteBuffers(ALL_BUFFERS, c->buffers[0]);
    c->gl.GenBuffers(ALL_BUFFERS, c->buffers[0]);
    memset(c->bytes, 0, sizeof c->bytes);
    drop_flights(c);
    c->rooms = (fxs_plan_rooms){.most = c->rooms.most, .finishes = c->rooms.finishes};
    fxs_compute_check(c, &why);
}

static void put(fxs_compute *c, uint64_t at, const void *from, uint64_t bytes)
{
    if (bytes)
        c->more.BufferSubData(GL_COPY_WRITE_BUFFER, (GLintptr)at, (GLsizeiptr)bytes, from);
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* Makes one buffer of a scene's copy. The pool of a scene in parts gets only its palette. */
static int make_part(fxs_compute *c, fxs_compute_scene *copy, const fxs_scene *scene, uint32_t *name, int64_t part,
                     fxs_message *why)
{
    fxs_piece pieces[3];
    GLuint made = 0;
    uint64_t bytes = fxs_plan_pieces(scene, copy->part_chunks, part, pieces);
    bytes = bytes ? bytes : 64;
    const int error = fxs_compute_allow(c, bytes, why);
    if (error)
        return error;
    c->gl.GenBuffers(1, &made);
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, made);
    c->gl.BufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)bytes, 0, GL_STATIC_DRAW);
    *name = made;
    copy->bytes += bytes;
    c->scene_bytes += bytes;
    for (int i = copy->mirror ? 2 : 0; i < 3; i++)
        put(c, pieces[i].at, pieces[i].from, pieces[i].bytes);
    return fxs_compute_check(c, why);
}

static int copy_scene(fxs_compute *c, fxs_compute_scene *copy, fxs_message *why)
{
    const fxs_scene scene = copy->mirror ? fxs_mirror_pool(copy->mirror) : copy->here;
    const uint64_t chunks = fxs_scene_chunks(&scene);
    copy->part_chunks = fxs_plan_part_chunks(&scene, c->rooms.most, why);
    if (!copy->part_chunks)
        return FXS_ERR_MEMORY;
    const uint64_t parts = (chunks + copy->part_chunks - 1) / copy->part_chunks;
    int error = parts > FXS_COMPUTE_PARTS
                    ? fxs_plan_say(why, FXS_ERR_MEMORY, "the scene takes more buffers than there may be", "")
                    : make_part(c, copy, &scene, &copy->heads, FXS_PLAN_HEADS, why);
    for (uint32_t part = 0; part < parts && !error; part++)
        error = make_part(c, copy, &scene, &copy->parts[part], part, why);
    return error;
}

/* Makes the mirror of a scene in parts, and sets how many bytes a frame may upload. */
static int make_mirror(fxs_compute *c, fxs_compute_scene *copy, const fxs_scene *scene, fxs_message *why)
{
    const uint64_t stage = fxs_mirror_upload_bytes(scene, c->upload_bytes);
    const uint32_t room = fxs_mirror_room(scene, c->pool_bytes, c->limit, why);
    if (!room)
        return FXS_ERR_MEMORY;
    const int error = stage > c->stage_bytes ? fxs_compute_allow(c, stage - c->stage_bytes, why) : 0;
    if (error)
        return error;
    copy->mirror = malloc(sizeof *copy->mirror + (size_t)fxs_mirror_bytes(scene, room));
    if (!copy->mirror)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    c->stage_bytes = stage > c->stage_bytes ? stage : c->stage_bytes;
    fxs_mirror_init(copy->mirror, scene, room, copy->mirror + 1);
    c->mirrors++;
    return 0;
}

static int fill_stage(fxs_compute *c, const fxs_mirror *m, const uint32_t *places, uint32_t count, fxs_message *why)
{
    const GLsizeiptr bytes = (GLsizeiptr)(count * fxs_mirror_place_bytes(m->from));
    if (!c->stage)
        c->gl.GenBuffers(1, &c->stage);
    c->gl.BindBuffer(GL_COPY_READ_BUFFER, c->stage);
    c->gl.BufferData(GL_COPY_READ_BUFFER, bytes, 0, GL_STREAM_DRAW);
    void *to = c->gl.MapBufferRange(GL_COPY_READ_BUFFER, 0, bytes, GL_MAP_WRITE_BIT);
    if (!to)
        return failure(c, why);
    fxs_mirror_fill(m, places, count, to);
    return c->gl.UnmapBuffer(GL_COPY_READ_BUFFER) ? 0 : failure(c, why);
}

static void put_staged(const fxs_compute *c, uint32_t name, uint64_t from, uint64_t to, uint64_t bytes)
{
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, name);
    c->more.CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, (GLintptr)from, (GLintptr)to,
                              (GLsizeiptr)bytes);
}

static int put_chunks(fxs_compute *c, const fxs_compute_scene *copy, const uint32_t *places, uint32_t count,
                      fxs_message *why)
{
    const fxs_mirror *m = copy->mirror;
    const uint64_t header = sizeof(fxs_chunk), rows = m->from->chunk_bytes;
    const int error = fill_stage(c, m, places, count, why);
    for (uint32_t i = 0, run; i < count && !error; i += run) {
        const uint32_t place = places[i];
        run = fxs_mirror_run(places + i, count - i, copy->part_chunks);
        put_staged(c, copy->heads, i * header, place * header, run * header);
        put_staged(c, copy->parts[place / copy->part_chunks], count * header + i * rows,
                   fxs_plan_place_at(m->from, copy->part_chunks, place), run * rows);
    }
    return error ? error : fxs_compute_check(c, why);
}

/* Uploads chunks that frames of scenes in parts want. The GL state stays. After an error, nothing of the scene counts
   as uploaded. */
static int put_wanted(fxs_compute *c, const fxs_compute_scene *const *copies, uint32_t count, fxs_message *why)
{
    uint64_t bytes = c->stage_bytes;
    GLint bound[2] = {0, 0};
    int error = 0;
    for (uint32_t i = 0; i < count && !error; i++) {
        fxs_mirror *m = copies[i]->mirror;
        const uint32_t *places, wanted = m ? fxs_mirror_step(m, bytes, &places) : 0;
        if (!wanted)
            continue;
        bytes -= wanted * fxs_mirror_place_bytes(m->from);
        c->gl.GetIntegerv(GL_COPY_WRITE_BUFFER_BINDING, &bound[0]);
        c->gl.GetIntegerv(GL_COPY_READ_BUFFER_BINDING, &bound[1]);
        error = put_chunks(c, copies[i], places, wanted, why);
        c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, (GLuint)bound[0]);
        c->gl.BindBuffer(GL_COPY_READ_BUFFER, (GLuint)bound[1]);
        if (error)
            fxs_mirror_forget(m);
    }
    return error;
}

int fxs_compute_upload(fxs_compute *c, fxs_compute_scene *copy, const fxs_scene *scene, fxs_message *why)
{
    GLint bound = 0;
    int error = use(c, why);
    if (error)
        return error;
    fxs_compute_check(c, why);     /* clears errors of earlier GL calls */
    fxs_compute_drop(c, copy);
    copy->here = *scene;
    c->gl.GetIntegerv(GL_COPY_WRITE_BUFFER_BINDING, &bound);
    error = scene->places ? make_mirror(c, copy, scene, why) : 0;
    error = error ? error : copy_scene(c, copy, why);
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, (GLuint)bound);
    error = error ? error : put_wanted(c, &(const fxs_compute_scene *){copy}, 1, why);
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
        if (copy->mirror && c->mirrors == 1) {
            c->gl.DeleteBuffers(1, &c->stage);
            c->stage = 0;
        }
        c->scene_bytes -= copy->bytes;
        fxs_compute_check(c, &why);
    }
    if (copy->mirror && --c->mirrors == 0)
        c->stage_bytes = 0;
    free(copy->mirror);
    memset(copy, 0, sizeof *copy);
}

size_t fxs_compute_memory(const fxs_request *request)
{
    const size_t bytes = fxs_plan_memory(request);
    return bytes && fxs_mirror_is_asked(request) ? bytes + request->count * sizeof(fxs_object) : bytes;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static int reserve_eye(fxs_compute *c, uint32_t eye, fxs_message *why)
{
    const uint64_t had = c->bytes[eye][FXS_COMPUTE_MEMORY];
    int error = 0;
    for (int i = FXS_COMPUTE_MEMORY; i < FXS_COMPUTE_DOWNLOAD && !error; i++)
        error = reserve(c, eye, i, c->plan.bytes[i], GL_DYNAMIC_COPY, why);
    if (!error && c->bytes[eye][FXS_COMPUTE_MEMORY] != had) {
        c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[eye][FXS_COMPUTE_MEMORY]);
        put(c, 0, fxs_offset_of_code_q11, sizeof fxs_offset_of_code_q11);
    }
    return error;
}

static int reserve_frame(fxs_compute *c, fxs_message *why)
{
    const uint64_t *bytes = c->plan.bytes;
    int error = reserve(c, 0, FXS_COMPUTE_UNIFORMS, bytes[FXS_COMPUTE_UNIFORMS] + fxs_plan_places_bytes(&c->plan),
                        GL_STREAM_DRAW, why);
    error = error ? error : reserve(c, 0, FXS_COMPUTE_DOWNLOAD, bytes[FXS_COMPUTE_DOWNLOAD], GL_STREAM_READ, why);
    for (uint32_t eye = 0; eye < c->plan.request->eyes && !error; eye++)
        error = reserve_eye(c, eye, why);
    return error;
}

static void *map(const fxs_compute *c, uint32_t eye, int buffer, uint64_t at, uint64_t bytes)
{
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[eye][buffer]);
    return c->gl.MapBufferRange(GL_COPY_WRITE_BUFFER, (GLintptr)at, (GLsizeiptr)bytes,
                                GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_RANGE_BIT);
}

static int unmap(const fxs_compute *c, fxs_message *why)
{
    return c->gl.UnmapBuffer(GL_COPY_WRITE_BUFFER) ? 0 : failure(c, why);
}

/* Writes the uniforms, and behind them the table of drawn chunks, which the device copies to its place. glBufferData
   gives the buffer new memory, because earlier frames may still read the old one. */
static int put_tables(const fxs_compute *c, fxs_message *why)
{
    const size_t uniforms = (size_t)c->plan.bytes[FXS_COMPUTE_UNIFORMS], places = fxs_plan_places_bytes(&c->plan);
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[0][FXS_COMPUTE_UNIFORMS]);
    c->gl.BufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)c->bytes[0][FXS_COMPUTE_UNIFORMS], 0, GL_STREAM_DRAW);
    unsigned char *to = map(c, 0, FXS_COMPUTE_UNIFORMS, 0, uniforms + places);
    if (!to)
        return failure(c, why);
    fxs_plan_uniforms(&c->plan, to);
    fxs_plan_places(&c->plan, (uint32_t *)(void *)(to + uniforms));
    const int error = unmap(c, why);
    c->more.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    c->gl.BindBuffer(GL_COPY_READ_BUFFER, c->buffers[0][FXS_COMPUTE_UNIFORMS]);
    for (uint32_t eye = 0; eye < c->plan.request->eyes; eye++) {
        c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->buffers[eye][FXS_COMPUTE_MEMORY]);
        c->more.CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, (GLintptr)uniforms,
                                  (GLintptr)(4 * (uint64_t)c->plan.frames->spans_at), (GLsizeiptr)places);
    }
    return error;
}

static int put_plane(const fxs_compute *c, uint32_t eye, const fxs_image *image, uint32_t at, fxs_message *why)
{
    const uint64_t bytes = 4 * (uint64_t)c->plan.size[0] * (uint64_t)c->plan.size[1];
    if (!image->pixels)
        return 0;
    unsigned char *to = map(c, eye, FXS_COMPUTE_MEMORY, 4 * (uint64_t)at, bytes);
    if (!to)
        return failure(c, why);
    fxs_plan_put_plane(&c->plan, image, to);
    return unmap(c, why);
}

/* Puts the input pictures of an eye on the device: those of the request, or of the caller's target. */
static int put_planes(const fxs_compute *c, uint32_t eye, const fxs_gl_target *target, fxs_message *why)
{
    const fxs_targets *t = &c->plan.request->targets[eye];
    const fxs_compute_frame *f = &c->plan.frames[eye];
    const int error = target ? fxs_compute_take_mesh(c, target, eye, why) : put_plane(c, eye, &t->occluder, f->occluder,
                                                                                      why);
    return error || target ? error : put_plane(c, eye, &t->backdrop, f->backdrop, why);
}

typedef struct walk {
    const fxs_compute *c;
    const fxs_compute_scene *const *copies;
    uint32_t program, frame;
} walk;

static void take_step(void *argument, const fxs_step *step)
{
    walk *w = argument;
    const fxs_compute *c = w->c;
    const fxs_gl *gl = &c->gl;
    if (step->waits)
        c->more.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    if (w->program != step->program)
        gl->UseProgram(c->programs[step->program]);
    w->program = step->program;
    if (w->frame != step->frame)
        c->more.BindBufferRange(GL_UNIFORM_BUFFER, 0, c->buffers[0][FXS_COMPUTE_UNIFORMS], (GLintptr)step->frame,
                                sizeof(fxs_compute_frame));
    w->frame = step->frame;
    for (GLuint i = 0; i < 4; i++) {
        const int32_t buffer = step->buffers[i];
        if (buffer != FXS_PLAN_NONE)
            c->more.BindBufferBase(GL_SHADER_STORAGE_BUFFER, i,
                                   buffer == FXS_PLAN_HEADS  ? w->copies[step->object]->heads
                                   : buffer == FXS_PLAN_ROWS ? w->copies[step->object]->parts[step->part]
                                                             : c->buffers[step->eye][buffer]);
    }
    if (step->uniform)
        c->more.BindBufferRange(GL_UNIFORM_BUFFER, 1, c->buffers[0][FXS_COMPUTE_UNIFORMS], (GLintptr)step->uniform,
                                sizeof(fxs_compute_object));
    if (step->arguments == FXS_PLAN_NONE) {
        if (step->groups[0])
            c->more.DispatchCompute(step->groups[0], step->groups[1], 1);
        return;
    }
    gl->BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, c->buffers[step->eye][step->arguments]);
    c->more.DispatchComputeIndirect((GLintptr)step->arguments_at);
}

static void read_time(fxs_compute *c)
{
    GLuint nanoseconds = 0;
    GLint disjoint = 0;
    c->gl.GetQueryObjectuiv(c->query, GL_QUERY_RESULT, &nanoseconds);
    c->gl.GetIntegerv(DISJOINT, &disjoint);
    c->nanoseconds += disjoint ? 0 : nanoseconds;
}

static int run_stages(const fxs_compute *c, const fxs_compute_scene *const *copies, int timed, fxs_message *why)
{
    const fxs_gl *gl = &c->gl;
    walk w = {c, copies, FXS_COMPUTE_PROGRAMS, FXS_NOTHING};
    if (timed)
        gl->BeginQuery(TIME_ELAPSED, c->query);
    fxs_plan_steps(&c->plan, take_step, &w);
    if (timed)
        gl->EndQuery(TIME_ELAPSED);
    c->more.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    return fxs_compute_check(c, why);
}

/* Copies words of an eye's buffer to the bound buffer, at `to`. Returns the end of the copy. */
static GLintptr copy_range(const fxs_compute *c, uint32_t eye, int buffer, uint64_t first, uint64_t words, GLintptr to)
{
    c->gl.BindBuffer(GL_COPY_READ_BUFFER, c->buffers[eye][buffer]);
    c->more.CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, (GLintptr)(4 * first), to,
                              (GLsizeiptr)(4 * words));
    return to + (GLintptr)(4 * words);
}

/* Binds a buffer, and copies the status of each eye to its start. Returns the end of the copy. */
static GLintptr copy_status(const fxs_compute *c, GLuint buffer)
{
    GLintptr to = 0;
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, buffer);
    for (uint32_t eye = 0; eye < c->plan.request->eyes; eye++)
        to = copy_range(c, eye, FXS_COMPUTE_COUNTS, 0, FXS_COMPUTE_STATUS, to);
    return to;
}

/* Waits for the frame, and copies its pixels to the request's targets. */
static int read_back(fxs_compute *c, fxs_stats *stats, fxs_message *why)
{
    const uint32_t eyes = c->plan.request->eyes;
    GLintptr to = copy_status(c, c->buffers[0][FXS_COMPUTE_DOWNLOAD]);
    for (uint32_t eye = 0; eye < eyes; eye++)
        to = copy_range(c, eye, FXS_COMPUTE_MEMORY, c->plan.read_at[eye], c->plan.read_words[eye], to);
    const uint32_t *from = c->gl.MapBufferRange(GL_COPY_WRITE_BUFFER, 0,
                                                (GLsizeiptr)c->plan.bytes[FXS_COMPUTE_DOWNLOAD], GL_MAP_READ_BIT);
    int error = from ? fxs_compute_check(c, why) : failure(c, why);
    if (error)
        return error;
    const int result = fxs_plan_look(&c->rooms, from, eyes, why);
    fxs_plan_count(stats, from, eyes);
    if (!result)
        fxs_plan_take_pictures(&c->plan, from + eyes * FXS_COMPUTE_STATUS);
    const fxs_message first = *why;
    error = unmap(c, why);
    error = error ? error : fxs_compute_check(c, why);
    if (!error && result)
        *why = first;
    return error ? error : result;
}

static int look_at_flight(fxs_compute *c, uint32_t i, fxs_message *why)
{
    fxs_compute_flight *flight = &c->flights[i];
    c->more.DeleteSync(flight->done);
    flight->done = 0;
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->statuses[i]);
    const uint32_t *status = c->gl.MapBufferRange(GL_COPY_WRITE_BUFFER, 0, flight->eyes * 4 * FXS_COMPUTE_STATUS,
                                                  GL_MAP_READ_BIT);
    if (!status)
        return failure(c, why);
    const int error = fxs_plan_look(&c->rooms, status, flight->eyes, why);
    fxs_plan_count(&flight->stats, status, flight->eyes);
    c->stats = flight->stats;
    return c->gl.UnmapBuffer(GL_COPY_WRITE_BUFFER) ? error : failure(c, why);
}

int fxs_compute_look_back(fxs_compute *c, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < FXS_COMPUTE_FLIGHTS && !error; i++) {
        const uint32_t next = (c->frames + i) % FXS_COMPUTE_FLIGHTS;
        GLint state = GL_UNSIGNALED;
        if (c->flights[next].done)
            c->more.GetSynciv(c->flights[next].done, GL_SYNC_STATUS, 1, 0, &state);
        if (state == GL_SIGNALED)
            error = look_at_flight(c, next, why);
    }
    return error;
}

/* Notes a drawn frame, to read its status later. Drops the status of an old frame if too many are unfinished. */
static int take_off(fxs_compute *c, const fxs_stats *stats, fxs_message *why)
{
    const uint32_t i = c->frames++ % FXS_COMPUTE_FLIGHTS, eyes = c->plan.request->eyes;
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->statuses[i]);
    c->gl.BufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)(eyes * 4 * FXS_COMPUTE_STATUS), 0, GL_STREAM_READ);
    copy_status(c, c->statuses[i]);
    c->more.DeleteSync(c->flights[i].done);
    c->flights[i] = (fxs_compute_flight){c->more.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0), eyes, *stats};
    return fxs_compute_check(c, why);
}

static void fill_stats(const fxs_compute *c, fxs_stats *stats)
{
    fxs_plan_stats(&c->plan, stats);
    memset(&stats->memory, 0, sizeof stats->memory);
    for (uint32_t eye = 0; eye < c->plan.request->eyes; eye++) {
        const uint64_t *bytes = c->bytes[eye];
        stats->memory.splats += (size_t)(bytes[FXS_COMPUTE_MEMORY] + bytes[FXS_COMPUTE_SPLATS]);
        stats->memory.tiles += (size_t)bytes[FXS_COMPUTE_COUNTS];
        stats->memory.entries += (size_t)bytes[FXS_COMPUTE_ENTRIES];
    }
    stats->memory.total = (size_t)fxs_compute_taken(c);
}

typedef struct rendering {
    fxs_compute *c;
    const fxs_compute_scene *const *copies;
    const fxs_gl_target *targets;  /* null: the request's */
    fxs_stats *stats;
} rendering;

/* Renders the frame, or window of one, that the plan has laid out. */
static int render(void *argument, fxs_message *why)
{
    const rendering *r = argument;
    fxs_compute *c = r->c;
    const uint32_t eyes = c->plan.request->eyes;
    const int timed = c->timer && !r->targets;
    if (r->targets)
        c->plan.bytes[FXS_COMPUTE_DOWNLOAD] = 0;
    int error = reserve_frame(c, why);
    error = error ? error : put_tables(c, why);
    for (uint32_t eye = 0; eye < eyes && !error; eye++)
        error = put_planes(c, eye, r->targets ? &r->targets[eye] : 0, why);
    error = error ? error : run_stages(c, r->copies, timed, why);
    fill_stats(c, r->stats);
    for (uint32_t eye = 0; eye < eyes && !error && r->targets; eye++)
        error = fxs_compute_show(c, &r->targets[eye], eye, why);
    error = error ? error : r->targets ? take_off(c, r->stats, why) : read_back(c, r->stats, why);
    if (!error && timed)
        read_time(c);
    return error;
}

static fxs_mirror *mirror_of(const void *copies, uint32_t i)
{
    return ((const fxs_compute_scene *const *)copies)[i]->mirror;
}

int fxs_compute_begin(fxs_compute *c, fxs_request *request, const fxs_compute_scene *const *copies, void *memory,
                      fxs_message *why)
{
    if (!c || !request || !memory || (!copies && request->count))
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, fxs_strerror(FXS_ERR_ARGUMENT), "");
    const int parts = fxs_plan_memory(request) && fxs_mirror_is_asked(request);
    int error = parts ? fxs_mirror_take(request, memory, ++c->turn, mirror_of, copies) : 0;
    if (error)
        return fxs_plan_say(why, error, fxs_strerror(error), "");
    error = fxs_plan_begin(&c->plan, request, (fxs_object *)memory + (parts ? request->count : 0), why);
    const int stopped = error == FXS_ERR_STOPPED;  /* a stopped frame, too, uploads what it lacks */
    error = error && !stopped ? error : use(c, why);
    if (error)
        return error;
    fxs_compute_check(c, why);     /* clears errors of earlier GL calls */
    error = put_wanted(c, copies, request->count, why);
    if (error || stopped)
        return error ? error : fxs_plan_say(why, FXS_ERR_STOPPED, fxs_strerror(FXS_ERR_STOPPED), "");
    for (uint32_t i = 0; i < request->count; i++) {
        const fxs_mirror *m = copies[i]->mirror;
        c->plan.part_chunks[i] = copies[i]->part_chunks;
        c->plan.part_counts[i] = m ? fxs_mirror_parts(m, copies[i]->part_chunks) : 0;
    }
    return 0;
}

int fxs_compute_finish(fxs_compute *c, const fxs_compute_scene *const *copies, const fxs_gl_target *targets,
                       fxs_stats *stats, fxs_message *why)
{
    fxs_stats of_frame;
    rendering r = {c, copies, targets, &of_frame};
    memset(&of_frame, 0, sizeof of_frame);
    c->nanoseconds = 0;
    int error = targets ? fxs_plan_lay_out(&c->plan, &c->rooms, why)
                        : fxs_plan_draw(&c->plan, &c->rooms, render, &r, why);
    error = error || !targets ? error : render(&r, why);
    if (error == FXS_ERR_MEMORY || error == FXS_ERR_DEVICE)
        give_back(c);
    if (!error && stats)
        *stats = targets ? c->stats : of_frame;
    return error;
}

int fxs_compute_render(fxs_compute *c, const fxs_request *request, const fxs_compute_scene *const *copies, void *memory,
                       fxs_stats *stats, fxs_message *why)
{
    if (!request)
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, fxs_strerror(FXS_ERR_ARGUMENT), "");
    fxs_request own = *request;
    const int error = fxs_compute_begin(c, &own, copies, memory, why);
    return error ? error : fxs_compute_finish(c, copies, 0, stats, why);
}

int fxs_compute_wait(fxs_compute *c, fxs_stats *stats, fxs_message *why)
{
    GLint bound = 0;
    int error = use(c, why);
    if (error)
        return error;
    fxs_compute_check(c, why);     /* clears errors of earlier GL calls */
    c->gl.GetIntegerv(GL_COPY_WRITE_BUFFER_BINDING, &bound);
    c->more.Finish();
    error = fxs_compute_look_back(c, why);
    c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, (GLuint)bound);
    if (!error && stats)
        *stats = c->stats;
    return error;
}
