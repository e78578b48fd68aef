/* Compares the compute back end on a GPU with the CPU renderer: stages, random frames, real scenes, long lists and
   small buffers. Fake OpenGL functions simulate device failures. */
#include "check.h"

#if !defined(FXS_WITH_GLES) || !defined(FXS_WITH_EGL)
static void compute(void)
{
    SKIP("built without the headers of OpenGL ES and EGL");
}

int main(void)
{
    RUN(compute);
    return check_report();
}
#else

#include <fixsplat/gl.h>
#include <fixsplat/internal/gl_contexts.h>
#include "kernels/compute/gl31.h"
#include "src/core/animate.h"
#include "losing_gl.h"
typedef fxs_compute stream_device;
#include "streamed.h"

static void *egl;
static fxs_compute *device;

static struct fake {
    const char *name;
    fxs_gl_function function;
} fakes[2];

static fxs_gl_function load(void *argument, const char *name)
{
    for (int i = 0; i < 2 && fakes[i].name; i++)
        if (!strcmp(name, fakes[i].name))
            return fakes[i].function;
    return fxs_egl_load(argument, name);
}

/* Creates a compute back end with one OpenGL function replaced by a fake. *out is null on failure. */
static int open_with(fxs_compute **out, const char *name, fxs_gl_function function)
{
    fakes[0] = (struct fake){name, function};
    why.text[0] = 0;
    const int error = fxs_compute_create(out, load, fxs_egl_use, egl, &why);
    fakes[0] = (struct fake){0, 0};
    return error;
}

static void close_compute(fxs_compute *c)
{
    fxs_compute_destroy(c);
}

static int render_by(fxs_compute *c, const fxs_request *request, fxs_stats *stats)
{
    fxs_compute_scene copies[OBJECTS] = {{.key = 0}};
    const fxs_compute_scene *of_objects[OBJECTS];
    const uint64_t most = c->rooms.most;
    int error = 0;
    c->rooms.most = part_bytes ? part_bytes : most;
    for (uint32_t i = 0; i < request->count && !error; i++) {
        error = fxs_compute_upload(c, &copies[i], request->objects[i].scene, &why);
        of_objects[i] = &copies[i];
    }
    c->rooms.most = most;
    const size_t bytes = fxs_compute_memory(request);
    void *memory = malloc(bytes + !bytes);
    error = error ? error : fxs_compute_render(c, request, of_objects, memory, stats, &why);
    free(memory);
    for (uint32_t i = 0; i < request->count; i++)
        fxs_compute_drop(c, &copies[i]);
    return error;
}

static int render_on_device(const fxs_request *request, fxs_stats *stats)
{
    return render_by(device, request, stats);
}

static uint64_t *device_most(void)
{
    return &device->rooms.most;
}

static void *read_words(int buffer, uint64_t first, uint64_t count)
{
    uint32_t *words = malloc(4 * count);
    device->more.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    device->gl.BindBuffer(GL_COPY_READ_BUFFER, device->buffers[0][buffer]);
    const void *from = device->gl.MapBufferRange(GL_COPY_READ_BUFFER, (GLintptr)(4 * first), (GLsizeiptr)(4 * count),
                                                 GL_MAP_READ_BIT);
    if (CHECK(from))
        memcpy(words, from, 4 * count);
    device->gl.UnmapBuffer(GL_COPY_READ_BUFFER);
    return words;
}

/* Writes a chunk of a moving scene as it is at a time to `room`. Returns the scene of this chunk. */
static fxs_scene at_time(const fxs_scene *scene, uint32_t chunk, int64_t time_q32, unsigned char *room)
{
    fxs_motion_header header;
    fxs_moment moment;
    CHECK(!fxs_motion_read(&header, scene));
    CHECK(fxs_moment_of(&moment, scene, chunk, fxs_time_of(&header, time_q32)) == 1);
    const fxs_motion_rows rows = fxs_motion_rows_of(scene, &header);
    CHECK(!fxs_animate_chunk(&fxs_kernels_c, scene, &rows, chunk, &moment, room));
    fxs_animate_sh(scene, chunk, room);
    return fxs_animated_scene(scene, room);
}

/* Compares the splats (projected Gaussians) and depths of the n-th visible chunk with the CPU's. Returns the number
   of visible splats. */
static uint32_t compare_chunk(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk, uint32_t n,
                              const fxs_splat *splats, const uint32_t *depths)
{
    fxs_splat own[FXS_CHUNK];
    fxs_bounds bounds[FXS_CHUNK];
    uint32_t indices[FXS_CHUNK], keys[FXS_CHUNK];
    const int32_t count = fxs_project_c(view, scene, chunk, own, bounds, indices, keys);
    if (!CHECK(count >= 0) || !CHECK(!fxs_shade_c(view, scene, chunk, indices, (uint32_t)count, own)))
        return 0;
    for (int32_t i = 0; i < count; i++) {
        const uint32_t slot = n * FXS_CHUNK + indices[i] % FXS_CHUNK;
        if (!CHECK(!memcmp(&splats[slot], &own[i], sizeof *own)) || !CHECK(depths[slot] == keys[i])) {
            const uint32_t *a = (const uint32_t *)&splats[slot], *b = (const uint32_t *)&own[i];
            for (int k = 0; k < 8; k++)
                printf("  word %d: %08x, not %08x\n", k, (unsigned)a[k], (unsigned)b[k]);
            return 0;
        }
    }
    return (uint32_t)count;
}

static int check_lists(const uint32_t *depths)
{
    const fxs_compute_frame *f = device->plan.frames;
    const uint32_t tiles = (uint32_t)(f->tiles[0] * f->tiles[1]);
    uint32_t *counts = read_words(FXS_COMPUTE_COUNTS, 0, f->classes);
    int good = 1;
    for (uint32_t tile = 0; tile < tiles && good; tile++) {
        const uint32_t *list = counts + FXS_COMPUTE_TILES + FXS_COMPUTE_LIST * tile;
        const uint32_t count = list[0], first = list[1] - count;
        uint32_t *entries = read_words(FXS_COMPUTE_ENTRIES, first, (uint64_t)count + 1);
        fxs_key before = 0;
        for (uint32_t i = 0; i < count && good; i++) {
            const fxs_key key = FXS_KEY(depths[entries[i] & ~FXS_ENTRY_CUT_OFF], entries[i]);
            good = CHECK(!i || before < key);
            before = key;
        }
        if (!good)
            printf("  tile %u, %u entries\n", (unsigned)tile, (unsigned)count);
        free(entries);
    }
    free(counts);
    return good;
}

static int compare_stages(const fxs_scene *scene)
{
    const fxs_object object = one_object(scene);
    fxs_request request;
    fxs_stats stats;
    fxs_stage_view view;
    fxs_request_init(&request, &object, 1);
    random_view(request.cameras, &request.options);
    request.options.time_q32 = random_time();
    random_near(request.cameras);
    picture p = picture_new(request.cameras->width, request.cameras->height, FXS_FORMAT_RGBA8);
    request.targets[0] = p.targets;
    /* the first frame enlarges the lists, so that the second frame is drawn from complete lists */
    if (!CHECK(!render_by(device, &request, &stats)) || !CHECK(!render_by(device, &request, &stats)) ||
        !CHECK(!one_view_init(&view, scene, request.cameras, &request.options)))
        return 0;
    const fxs_compute_frame *f = device->plan.frames;
    uint32_t *status = read_words(FXS_COMPUTE_COUNTS, 0, FXS_COMPUTE_STATUS), visible = 0;
    const uint32_t chunks = status[FXS_COMPUTE_VISIBLE_CHUNKS];
    uint32_t *places = read_words(FXS_COMPUTE_MEMORY, f->visible, chunks + 1);
    uint32_t *depths = read_words(FXS_COMPUTE_MEMORY, f->depths, FXS_CHUNK * (uint64_t)chunks + 1);
    fxs_splat *splats = read_words(FXS_COMPUTE_SPLATS, 0, 8 * FXS_CHUNK * (uint64_t)chunks + 1);
    uint32_t *drawn = read_words(FXS_COMPUTE_MEMORY, f->drawn, FXS_COMPUTE_DRAWN * (uint64_t)f->places + 1);
    unsigned char *room = check_aligned(fxs_animated_bytes(scene));
    for (uint32_t n = 0; n < chunks; n++) {
        const uint32_t chunk = f->drawn ? drawn[FXS_COMPUTE_DRAWN * places[n] + 2] : places[n];
        const fxs_scene there = scene->motion ? at_time(scene, chunk, request.options.time_q32, room) : *scene;
        CHECK(n == 0 || places[n] > places[n - 1]);
        visible += compare_chunk(&view, &there, scene->motion ? 0 : chunk, n, splats, depths);
    }
    free(room);
    free(drawn);
    const int same = CHECK(visible == stats.visible) && check_lists(depths);
    free(status);
    free(places);
    free(depths);
    free(splats);
    picture_free(&p);
    return same;
}

static void stages(void)
{
    state = 20263;
    for (int i = 0; i < 160; i++) {
        packed_scene packed = random_scene((enum fxs_profile)(i % 3), 3000);
        fxs_scene scene;
        if (i % 4 == 1)
            fill_wild(&packed);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        if (i % 4 > 1)
            set_moving(&packed, &scene);
        const int same = compare_stages(&scene);
        free(packed.data);
        if (!same) {
            printf("  scene %d\n", i);
            return;
        }
    }
}

/* Returns 1 if the shader `finish` drew the last frame, because the frame's lists did not fit. */
static int is_finished_late(void)
{
    uint32_t *words = read_words(FXS_COMPUTE_LATER, 4 * (4 + FXS_PLAN_MERGES), 1);
    const int late = words[0] > 0;
    free(words);
    return late;
}

/* Draws frames that exceed the capacity for large splats, pages of entries, or merge passes. */
static void frames_that_do_not_fit(void)
{
    static const int sizes_of_knot[][2] = {{33, 31}, {200, 150}};
    int late = 0;
    part p;
    if (!part_make(&p, "knot", 30000))
        return;
    state = 20265;
    for (int kind = 0; kind < 2; kind++) {
        *(kind ? &device->rooms.most_pages : &device->rooms.most_larges) = 1;
        for (int i = 0; i < 40 && !check_faults; i++) {
            if (!CHECK(random_frame((int[]){STILL, MOVING, STILL, WILD}[i % 4], 1 + (i % 4 == 1))))
                printf("  kind %d, frame %d\n", kind, i);
            late += is_finished_late();
        }
        device->rooms.most_larges = device->rooms.most_pages = 0;
    }
    CHECK(late > 30);
    for (int i = 0; i < 2; i++) {
        device->rooms.most_merges = 1;
        compare_scene(&p.scene, sizes_of_knot[i][0], sizes_of_knot[i][1], 12.8, 0);
        CHECK(is_finished_late());
        device->rooms.most_merges = 0;
        compare_scene(&p.scene, sizes_of_knot[i][0], sizes_of_knot[i][1], 12.8, 0);
        CHECK(!is_finished_late());
    }
    part_free(&p);
}

static fxs_compute_scene stream_copies[2];

static void stream_set(fxs_compute *c, uint64_t pool_bytes, uint64_t upload_bytes)
{
    fxs_compute_stream(c, pool_bytes, upload_bytes);
}

static int stream_upload(streamed *s, fxs_compute *c, const fxs_scene *scene)
{
    fxs_compute_scene *copy = &stream_copies[s->number];
    const uint64_t most = c->rooms.most;
    c->rooms.most = part_bytes ? part_bytes : most;
    const int error = fxs_compute_upload(c, copy, scene, &why);
    CHECK(!part_bytes == !copy->parts[1]);
    c->rooms.most = most;
    copy->key = &s->part;
    s->mirror = copy->mirror;
    return error;
}

static int stream_render(fxs_compute *c, const fxs_request *request, fxs_stats *stats)
{
    const fxs_compute_scene *copies[2];
    for (uint32_t i = 0; i < request->count; i++)
        copies[i] = &stream_copies[request->objects[i].scene != stream_copies->key];
    void *memory = malloc(fxs_compute_memory(request));
    const int error = fxs_compute_render(c, request, copies, memory, stats, &why);
    free(memory);
    return error;
}

static void stream_drop(streamed *s, fxs_compute *c)
{
    fxs_compute_drop(c, &stream_copies[s->number]);
    CHECK(stream_copies[!s->number].heads || !c->scene_bytes);
    s->mirror = 0;
}

/* Returns the bytes of the splats' buffer that a frame of a view gets first. */
static uint64_t first_splats(const streamed *s, const fxs_scene *scene)
{
    fxs_object objects[2];
    fxs_request request = streamed_view(s, objects, scene, 5, 0);
    fxs_plan_rooms rooms = {.most = 1 << 30};
    static fxs_plan plan;
    request.targets[0] = s->drawn[0].targets;
    void *memory = malloc(fxs_plan_memory(&request));
    CHECK(memory && !fxs_plan_begin(&plan, &request, memory, &why));
    plan.part_chunks[0] = s->chunks;
    plan.part_counts[0] = 1;
    CHECK(!fxs_plan_lay_out(&plan, &rooms, &why));
    free(memory);
    return plan.bytes[FXS_COMPUTE_SPLATS];
}

/* The first frame of a scene that is being read has the buffers of its last one. */
static void room_ahead(void)
{
    streamed s;
    if (!streamed_make(&s, FXS_PROFILE_SMALL))
        return;
    const uint64_t first = first_splats(&s, &s.part), last = first_splats(&s, &s.whole);
    CHECK(first >= last && last > 10 * FXS_CHUNK * 32);
    streamed_free(&s);
}

static void streams(void)
{
    for (int i = 0; i < 3; i++)
        fly(device, (enum fxs_profile)i, 1, 1, i != 0);
    fly(device, FXS_PROFILE_SMALL, 2, 2, 1);
    fly_in_time(device);
    two_scenes(device);
    stopped_frames(device);
}

static PFNGLGETINTEGERVPROC real_GetIntegerv;
static GLenum limited;

static void GL_APIENTRY fake_GetIntegerv(GLenum name, GLint *value)
{
    real_GetIntegerv(name, value);
    if (name == limited)
        *value = 1;
}

static PFNGLGETSHADERIVPROC real_GetShaderiv;

static void GL_APIENTRY fake_GetShaderiv(GLuint shader, GLenum name, GLint *value)
{
    real_GetShaderiv(shader, name, value);
    if (name == GL_COMPILE_STATUS)
        *value = 0;
}

static void GL_APIENTRY fake_GetShaderInfoLog(GLuint shader, GLsizei size, GLsizei *length, GLchar *text)
{
    (void)shader, (void)length;
    snprintf(text, (size_t)size, "0:17: what is\nthat?");
}

static const GLubyte *GL_APIENTRY fake_GetString(GLenum name)
{
    return (const GLubyte *)(name == GL_VERSION ? "OpenGL ES 3.0 Old" : "old");
}

static void init_fails(void)
{
    static const GLenum limits[] = {GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS,
                                    GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, GL_MAX_SHADER_STORAGE_BLOCK_SIZE,
                                    GL_MAX_UNIFORM_BLOCK_SIZE};
    fxs_compute *c;
    CHECK(open_with(&c, "glDispatchCompute", 0) == FXS_ERR_UNSUPPORTED);
    CHECK(!strcmp(why.text, "no compute shaders: no function glDispatchCompute"));
    CHECK(open_with(&c, "glGetString", (fxs_gl_function)fake_GetString) == FXS_ERR_UNSUPPORTED);
    CHECK(!strcmp(why.text, "OpenGL ES 3.1 is needed, this is OpenGL ES 3.0 Old"));
    real_GetIntegerv = device->gl.GetIntegerv;
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        limited = limits[i];
        CHECK(open_with(&c, "glGetIntegerv", (fxs_gl_function)fake_GetIntegerv) == FXS_ERR_UNSUPPORTED);
        CHECK(strstr(why.text, "than") != 0);
    }
    real_GetShaderiv = device->gl.GetShaderiv;
    fakes[1] = (struct fake){"glGetShaderInfoLog", (fxs_gl_function)fake_GetShaderInfoLog};
    CHECK(open_with(&c, "glGetShaderiv", (fxs_gl_function)fake_GetShaderiv) == FXS_ERR_UNSUPPORTED);
    CHECK(!strcmp(why.text, "clear_counts does not compile: 0:17: what is that?"));
    fakes[1] = (struct fake){0, 0};
}

static GLenum failing;                     /* error that the fake glGetError returns in its next `failures` calls */
static int failures;

static GLenum GL_APIENTRY fake_GetError(void)
{
    return failures > 0 ? failures--, failing : GL_NO_ERROR;
}

static GLboolean GL_APIENTRY no_unmap(GLenum target)
{
    device->gl.UnmapBuffer(target);
    return GL_FALSE;
}

static void *GL_APIENTRY no_map(GLenum target, GLintptr at, GLsizeiptr bytes, GLbitfield access)
{
    (void)target, (void)at, (void)bytes, (void)access;
    return 0;
}

static void frames_fail(void)
{
    part p;
    fxs_request request;
    fxs_compute *c;
    if (!part_make(&p, "knot", 3000))
        return;
    const fxs_object object = one_object(&p.scene);
    fxs_request_init(&request, &object, 1);
    look_at(request.cameras, 100, 80, 12.8);
    picture a = picture_new(100, 80, FXS_FORMAT_RGBA8), b = picture_new(100, 80, FXS_FORMAT_RGBA8);
    request.targets[0] = a.targets;
    CHECK(!render_there(&request, 0));
    request.targets[0] = b.targets;
    if (CHECK(!open_with(&c, 0, 0))) {
        for (int i = 0; i < 4; i++) {
            const fxs_gl gl = c->gl;
            fxs_compute_scene copy = {.key = 0};
            const fxs_compute_scene *copies[] = {&copy};
            void *memory = malloc(fxs_compute_memory(&request));
            CHECK(!fxs_compute_upload(c, &copy, &p.scene, &why));
            failing = i ? CONTEXT_LOST : GL_OUT_OF_MEMORY;
            /* many errors, since a frame discards the OpenGL errors from before the frame */
            failures = i ? 1000 : 20;
            if (i < 2)
                c->gl.GetError = fake_GetError;
            else if (i == 2)
                c->gl.MapBufferRange = no_map;
            else
                c->gl.UnmapBuffer = no_unmap;
            CHECK(fxs_compute_render(c, &request, copies, memory, 0, &why) == (i ? FXS_ERR_DEVICE : FXS_ERR_MEMORY));
            CHECK(!strcmp(why.text, i ? "the device failed, or its context was lost" : "the device is out of memory"));
            c->gl = gl;
            picture_clear(&b);
            CHECK(!fxs_compute_render(c, &request, copies, memory, 0, &why));
            CHECK(!memcmp(a.block, b.block, a.bytes));
            fxs_compute_drop(c, &copy);
            free(memory);
        }
        close_compute(c);
    }
    picture_free(&a);
    picture_free(&b);
    part_free(&p);
}

static fxs_gl_function load_losing(void *argument, const char *name)
{
    return losing_load(fxs_egl_load, argument, name);
}

static int open_losing(fxs_compute **out)
{
    return fxs_compute_create(out, load_losing, fxs_egl_use, egl, &why);
}

static long calls_made(void)
{
    const long calls = LONG_MAX - calls_left;
    find_again();
    return calls;
}

static const GLenum losses[] = {CONTEXT_LOST, GL_OUT_OF_MEMORY};

static void init_loses(void)
{
    fxs_compute *c;
    if (!CHECK(!open_losing(&c)))
        return;
    const long calls = calls_made();
    close_compute(c);
    CHECK(calls > 6 * FXS_COMPUTE_PROGRAMS);
    for (int k = 0; k < 2; k++)
        for (long n = 0; n < calls && !check_faults; n += 1 + n / 16) {
            lose_after(n, losses[k]);
            why.text[0] = 0;
            const int error = open_losing(&c);
            find_again();
            if (!CHECK(is_loss(error) && why.text[0]))
                printf("  call %ld: %d, %s\n", n, error, why.text);
            if (!error)
                close_compute(c);
        }
    CHECK(!open_losing(&c));
    close_compute(c);
}

static void frames_lose(void)
{
    part p;
    fxs_request request;
    fxs_compute *c;
    fxs_compute_scene copy = {.key = 0};
    const fxs_compute_scene *copies[] = {&copy};
    if (!part_make(&p, "knot", 3000) || !CHECK(!open_losing(&c)))
        return;
    const fxs_object object = one_object(&p.scene);
    fxs_request_init(&request, &object, 1);
    look_at(request.cameras, 100, 80, 12.8);
    picture a = picture_new(100, 80, FXS_FORMAT_RGBA8), b = picture_new(100, 80, FXS_FORMAT_RGBA8);
    picture untouched = picture_new(100, 80, FXS_FORMAT_RGBA8);
    uint32_t *occluder = calloc(100 * 80, 4);
    memset(occluder, 9, 100 * 80 * 4 / 2);
    a.targets.occluder = b.targets.occluder = (fxs_image){occluder, 400};
    request.targets[0] = a.targets;
    CHECK(!render_there(&request, 0));
    request.targets[0] = b.targets;
    void *memory = malloc(fxs_compute_memory(&request));
    find_again();
    CHECK(!fxs_compute_upload(c, &copy, &p.scene, &why));
    const long of_upload = calls_made();
    CHECK(!fxs_compute_render(c, &request, copies, memory, 0, &why));
    const long of_frame = calls_made();
    CHECK(of_upload > 6 && of_frame > 60);
    long fails = 0;
    for (int k = 0; k < 2; k++) {
        for (long n = 0; n < of_upload && !check_faults; n++) {
            lose_after(n, losses[k]);
            const int error = fxs_compute_upload(c, &copy, &p.scene, &why);
            find_again();
            if (!CHECK(!error || (is_loss(error) && !copy.heads && !c->scene_bytes)))
                printf("  upload, call %ld: %d\n", n, error);
            CHECK(!fxs_compute_upload(c, &copy, &p.scene, &why));
        }
        for (long n = 0; n < of_frame && !check_faults; n++) {
            for (int again = 0; again < 2; again++) {
                picture_clear(&b);
                lose_after(n, losses[k]);
                const int error = fxs_compute_render(c, &request, copies, memory, 0, &why);
                find_again();
                fails += error != 0;
                if (!CHECK(!error || is_loss(error)) ||
                    !CHECK(!memcmp(b.block, a.block, a.bytes) ||
                           (error && !memcmp(b.block, untouched.block, a.bytes))))
                    printf("  call %ld of %ld: %d\n", n, of_frame, error);
            }
            picture_clear(&b);
            CHECK(!fxs_compute_render(c, &request, copies, memory, 0, &why));
            CHECK(is_equal(&a, &b));
        }
    }
    CHECK(fails > 5 * of_frame / 2);
    fxs_compute_drop(c, &copy);
    close_compute(c);
    free(memory);
    free(occluder);
    picture_free(&a);
    picture_free(&b);
    picture_free(&untouched);
    part_free(&p);
}

/* Loses the device at each call of a frame that uploads chunks. Later frames draw what is on the device. */
static void streams_lose(void)
{
    streamed s;
    fxs_compute *c;
    fxs_stats stats;
    uint32_t uploaded, came = 0;
    if (!streamed_make(&s, FXS_PROFILE_SMALL) || !CHECK(!open_losing(&c)))
        return;
    fxs_compute_stream(c, 40 * bytes_of_chunk(&s), 2 * bytes_of_chunk(&s));
    find_again();
    CHECK(!stream_upload(&s, c, &s.part));
    for (int n = 0; n < 60 && !check_faults; n++) {
        CHECK(!streamed_draw(&s, c, 5, n * 0.3, &stats, &uploaded));
        lose_after(n, losses[n % 2]);
        const int error = streamed_draw(&s, c, 5, n * 0.3, &stats, &uploaded);
        find_again();
        CHECK(!error || is_loss(error));
        CHECK(!streamed_draw(&s, c, 5, n * 0.3, &stats, &uploaded));
        came += uploaded;
    }
    CHECK(came > 20);
    stream_drop(&s, c);
    close_compute(c);
    find_again();
    streamed_free(&s);
}

static void streams_refused(void)
{
    streamed s;
    fxs_object objects[2];
    pools(device, fxs_compute_limit);
    if (!streamed_make(&s, FXS_PROFILE_SMALL))
        return;
    const fxs_request request = streamed_view(&s, objects, &s.part, 5, 0);
    CHECK(!stream_upload(&s, device, &s.whole));
    CHECK(stream_render(device, &request, 0) == FXS_ERR_ARGUMENT);
    stream_drop(&s, device);
    streamed_free(&s);
}

static int yes(void *argument)
{
    (void)argument;
    return 1;
}

static void refusals(void)
{
    part p;
    fxs_request request;
    fxs_compute *c;
    if (!part_make(&p, "knot", 3000) || !CHECK(!open_with(&c, 0, 0)))
        return;
    const uint64_t most = c->rooms.most;
    fxs_object object = one_object(&p.scene);
    picture a = picture_new(100, 80, FXS_FORMAT_RGBA8);
    fxs_request_init(&request, &object, 1);
    look_at(request.cameras, 100, 80, 12.8);
    request.targets[0] = a.targets;
    c->rooms.most = 30000;   /* limits the device memory to less than the first buffers of a frame need */
    part_bytes = most;
    CHECK(render_by(c, &request, 0) == FXS_ERR_MEMORY && why.bytes_needed > 30000);
    c->rooms.most = most;
    fxs_compute_limit(c, 1 << 20);
    part_bytes = most;
    CHECK(render_by(c, &request, 0) == FXS_ERR_MEMORY && why.bytes_needed > 1 << 20);
    CHECK(!strcmp(why.text, "the device memory allowed is too small"));
    fxs_compute_limit(c, 1000);
    CHECK(render_by(c, &request, 0) == FXS_ERR_MEMORY && c->scene_bytes == 0);
    fxs_compute_limit(c, 0);
    part_bytes = 1000;                     /* limits uploads to fewer bytes than a chunk (256 Gaussians) has */
    CHECK(render_by(c, &request, 0) == FXS_ERR_MEMORY && why.bytes_needed > 1000);
    part_bytes = 0;
    request.options.stop.call = yes;
    CHECK(render_by(c, &request, 0) == FXS_ERR_STOPPED);
    request.options.stop.call = 0;
    request.options.sh_degree = 4;
    CHECK(render_by(c, &request, 0) == FXS_ERR_ARGUMENT);
    request.options.sh_degree = 3;
    request.targets->format = FXS_FORMAT_BGRA8;
    CHECK(render_by(c, &request, 0) == FXS_ERR_UNSUPPORTED);
    request.targets->format = FXS_FORMAT_RGBA8;
    fxs_targets_init(request.targets);
    CHECK(render_by(c, &request, 0) == FXS_ERR_TARGET);
    request.targets[0] = a.targets;
    /* puts an invalid value into the field step_shift of the first chunk header */
    ((unsigned char *)p.packed.data)[192 + 74] = 77;
    CHECK(render_by(c, &request, 0) == FXS_ERR_SCENE);
    close_compute(c);
    picture_free(&a);
    part_free(&p);
}

int main(void)
{
    if (fxs_egl_open(&egl, &why) || open_with(&device, 0, 0)) {
        printf("%s\n", why.text);
        printf("skip compute\n");
        check_skipped++;
        return check_report();
    }
    RUN(stages);
    device_frames();
    RUN(frames_that_do_not_fit);
    RUN(room_ahead);
    RUN(streams);
    RUN(streams_lose);
    RUN(streams_refused);
    RUN(init_fails);
    RUN(frames_fail);
    RUN(init_loses);
    RUN(frames_lose);
    RUN(refusals);
    close_compute(device);
    fxs_egl_close(egl);
    return check_report();
}
#endif
