/* Frames of a scene in parts by a back end with a pool on the device (src/core/mirror.h), compared with the CPU
   renderer. The test program defines stream_device, a back end, and the functions declared below. */
#ifndef STREAMED_H
#define STREAMED_H

#include "device_frames.h"
#include "src/core/mirror.h"

/* `part` has some chunks in memory, `shown` those that the device had before the last frame. */
typedef struct streamed {
    fxs_packed_scene packed;
    fxs_scene whole, part, shown;
    uint32_t *in_memory, *on_device, chunks, wanted[16], wanted_count;
    uint32_t objects, eyes, number;        /* objects and eyes of a frame, 1 or 2 each; number of the scene, 0 or 1 */
    unsigned char *rows, *moving;          /* `moving`: bytes of a moving scene, or null */
    int64_t time_q32;
    picture expected[2], drawn[2];
    const fxs_mirror *mirror;      /* set by stream_upload; null: no scene in parts is on the device */
} streamed;

/* stream_set sets the pool's size and the upload's, in bytes. stream_upload copies s->part or s->whole to the device,
   in buffers of at most `part_bytes` bytes; stream_drop drops it. stream_render renders objects of such scenes. */
static void stream_set(stream_device *d, uint64_t pool_bytes, uint64_t upload_bytes);
static int stream_upload(streamed *s, stream_device *d, const fxs_scene *scene);
static int stream_render(stream_device *d, const fxs_request *request, fxs_stats *stats);
static void stream_drop(streamed *s, stream_device *d);

static void note_wanted(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    streamed *s = argument;
    CHECK(scene == &s->part && there == (s->in_memory[chunk] != FXS_NOTHING));
    if (!there && s->wanted_count < 16)
        s->wanted[s->wanted_count++] = chunk;
}

/* Begins with the root of the tree in memory, or with nothing. */
static void streamed_begin(streamed *s)
{
    const uint32_t leaves = s->whole.chunk_count, bytes = s->whole.chunk_bytes;
    s->chunks = fxs_scene_chunks(&s->whole);
    s->in_memory = malloc(s->chunks * sizeof *s->in_memory);
    s->on_device = malloc(s->chunks * sizeof *s->on_device);
    memset(s->in_memory, 0xff, s->chunks * sizeof *s->in_memory);
    memset(s->on_device, 0xff, s->chunks * sizeof *s->on_device);
    if (s->whole.nodes)
        s->in_memory[leaves] = leaves;
    s->rows = check_aligned((size_t)s->chunks * bytes);
    memcpy(s->rows, s->whole.rows, (size_t)leaves * bytes);
    if (s->whole.nodes)
        memcpy(s->rows + (size_t)leaves * bytes, s->whole.node_rows, (size_t)(leaves - 1) * bytes);
    s->part = s->shown = s->whole;
    s->part.rows = s->shown.rows = s->rows;
    s->part.places = s->in_memory;
    s->shown.places = s->on_device;
    s->objects = s->eyes = 1;
    for (int eye = 0; eye < 2; eye++) {
        s->expected[eye] = picture_new(100, 75, FXS_FORMAT_RGBA8);
        s->drawn[eye] = picture_new(100, 75, FXS_FORMAT_RGBA8);
    }
}

static int streamed_make(streamed *s, enum fxs_profile profile)
{
    memset(s, 0, sizeof *s);
    if (!CHECK(pack_tree("knot", profile, &s->packed, &s->whole)))
        return 0;
    streamed_begin(s);
    return 1;
}

/* Makes a moving scene in parts, which has no tree. */
static int streamed_make_moving(streamed *s)
{
    size_t bytes;
    part p;
    memset(s, 0, sizeof *s);
    if (!part_make(&p, "knot", 10000))
        return 0;
    s->moving = make_moving(&p.scene, 3, FXS_MOTION_LOOPS | FXS_MOTION_TURNS | FXS_MOTION_FADES, 5, &bytes);
    part_free(&p);
    if (!CHECK(!fxs_scene_open(&s->whole, s->moving, bytes)))
        return 0;
    streamed_begin(s);
    return 1;
}

static void streamed_free(streamed *s)
{
    fxs_packed_scene_free(&s->packed);
    for (int eye = 0; eye < 2; eye++) {
        picture_free(&s->expected[eye]);
        picture_free(&s->drawn[eye]);
    }
    free(s->moving);
    free(s->in_memory);
    free(s->on_device);
    free(s->rows);
}

static uint64_t bytes_of_chunk(const streamed *s)
{
    return s->whole.chunk_bytes + 128;
}

/* Takes over which chunks the device has. Returns how many came. */
static uint32_t note_device(streamed *s)
{
    uint32_t came = 0;
    for (uint32_t i = 0; i < s->chunks; i++) {
        const uint32_t now = s->mirror->scene.places[i] == FXS_NOTHING ? FXS_NOTHING : i;
        came += now != FXS_NOTHING && s->on_device[i] == FXS_NOTHING;
        s->on_device[i] = now;
    }
    return came;
}

/* A view at a distance and angle, of objects side by side of a scene, with the options of a frame in parts. */
static fxs_request streamed_view(const streamed *s, fxs_object objects[2], const fxs_scene *scene, double distance,
                                 double angle)
{
    const fxs_camera camera = camera_at(distance * sin(angle), -2, -distance * cos(angle));
    fxs_request request = request_of(objects, s->objects, camera, 9000, 0);
    objects[0] = objects[1] = one_object(scene);
    objects[1].translation_q32[0] += FXS_ONE_Q32;
    request.options.time_q32 = s->time_q32;
    request.eyes = s->eyes;
    request.cameras->width = 100;
    request.cameras->height = 75;
    request.cameras[1] = request.cameras[0];
    request.cameras[1].position_q32[0] += FXS_ONE_Q32 / 16;
    return request;
}

/* Draws on the processor what the device had before its last frame. */
static void streamed_expect(streamed *s, double distance, double angle, fxs_stats *stats)
{
    fxs_object objects[2];
    fxs_request request = streamed_view(s, objects, &s->shown, distance, angle);
    for (int eye = 0; eye < 2; eye++)
        request.targets[eye] = s->expected[eye].targets;
    CHECK(!render_there(&request, stats));
}

/* Brings the chunks into memory that the last frame wanted, as a pager does. */
static void streamed_page(streamed *s)
{
    for (uint32_t i = 0; i < s->wanted_count; i++)
        s->in_memory[s->wanted[i]] = s->wanted[i];
    s->wanted_count = 0;
}

/* Draws a view on the device. *uploaded gets the number of uploaded chunks. */
static int streamed_draw(streamed *s, stream_device *d, double distance, double angle, fxs_stats *stats,
                         uint32_t *uploaded)
{
    fxs_object objects[2];
    fxs_stats expected;
    fxs_request request = streamed_view(s, objects, &s->part, distance, angle);
    request.options.want = (fxs_want){note_wanted, s};
    for (int eye = 0; eye < 2; eye++)
        request.targets[eye] = s->drawn[eye].targets;
    note_device(s);
    const int error = stream_render(d, &request, stats);
    streamed_expect(s, distance, angle, &expected);
    CHECK(error || (is_equal(&s->expected[0], &s->drawn[0]) && is_equal(&s->expected[1], &s->drawn[1]) &&
                    stats->missing == expected.missing && stats->drawn == expected.drawn));
    divided += !error && stats->bands > s->eyes;
    *uploaded = note_device(s);
    streamed_page(s);
    return error;
}

/* A flight over a scene in parts, with a small pool and few uploads a frame, and then frames of one view. */
static void fly(stream_device *d, enum fxs_profile profile, uint32_t objects, uint32_t eyes, int buffers)
{
    enum { UPLOADS = 6, FRAMES = 90, FLIGHT = 40 };
    streamed s;
    fxs_stats stats = {0};
    uint32_t uploaded, chunk = 0, most = 0;
    if (!streamed_make(&s, profile))
        return;
    const uint64_t each = bytes_of_chunk(&s);
    s.objects = objects;
    s.eyes = eyes;
    part_bytes = buffers ? 24 * each : 0;
    stream_set(d, 100 * each + 1, UPLOADS * each + 1);
    CHECK(!stream_upload(&s, d, &s.part) && note_device(&s) == 1);
    part_bytes = 0;
    for (int frame = 0; frame < FRAMES && !check_faults; frame++) {
        const int way = frame < FLIGHT ? frame : FLIGHT;
        CHECK(!streamed_draw(&s, d, 4 + way % 7, way * 0.2, &stats, &uploaded));
        most = uploaded > most ? uploaded : most;
        if (frame < FLIGHT)                        /* the pager evicts chunks */
            for (int k = 0; k < 5; k++, chunk = (chunk + 7) % s.whole.chunk_count)
                s.in_memory[chunk] = FXS_NOTHING;
    }
    CHECK(most == UPLOADS && !stats.missing && !uploaded && s.mirror->pool.there == 100);
    stream_drop(&s, d);
    streamed_free(&s);
    stream_set(d, 0, 0);
}

/* Frames of a moving scene in parts at times that pass, with a pool for a half of its chunks. */
static void fly_in_time(stream_device *d)
{
    streamed s;
    fxs_stats stats = {0};
    uint32_t uploaded, came = 0;
    if (!streamed_make_moving(&s))
        return;
    const uint64_t each = bytes_of_chunk(&s);
    s.objects = s.eyes = 2;
    part_bytes = 12 * each;
    stream_set(d, s.chunks / 2 * each, 6 * each + 1);
    CHECK(!stream_upload(&s, d, &s.part));
    part_bytes = 0;
    for (int frame = 0; frame < 60 && !check_faults; frame++) {
        s.time_q32 = frame * (FXS_ONE_Q32 / 8);
        CHECK(!streamed_draw(&s, d, 5, frame * 0.1, &stats, &uploaded));
        came += uploaded;
    }
    CHECK(came > s.chunks / 2 && stats.drawn);
    stream_drop(&s, d);
    streamed_free(&s);
    stream_set(d, 0, 0);
}

/* A pool that is too small, and one of the usual size, for the whole scene. */
static void pools(stream_device *d, void (*limit)(stream_device *d, uint64_t bytes))
{
    streamed s;
    fxs_stats stats;
    uint32_t uploaded;
    if (!streamed_make(&s, FXS_PROFILE_SMALL))
        return;
    const uint64_t each = bytes_of_chunk(&s);
    stream_set(d, 16 * each - 1, 0);
    CHECK(stream_upload(&s, d, &s.part) == FXS_ERR_MEMORY && why.bytes_needed == 16 * each);
    CHECK(!strcmp(why.text, "the device's pool for a scene in parts has no room for 16 chunks"));
    CHECK(!s.mirror);
    stream_set(d, 0, 0);
    limit(d, 31 * each);           /* the pool takes at most half */
    CHECK(stream_upload(&s, d, &s.part) == FXS_ERR_MEMORY && why.bytes_needed == 32 * each);
    limit(d, 0);
    CHECK(!stream_upload(&s, d, &s.part) && s.mirror->pool.room == s.chunks);
    CHECK(!streamed_draw(&s, d, 5, 0, &stats, &uploaded) && stats.missing);
    stream_drop(&s, d);
    streamed_free(&s);
}

static void bring_all(streamed *s)
{
    for (uint32_t i = 0; i < s->chunks; i++)
        s->in_memory[i] = i;
}

/* Two scenes in parts, which share the bytes that a frame may upload. */
static void two_scenes(stream_device *d)
{
    streamed s[2];
    fxs_stats stats = {0}, expected;
    if (!streamed_make(&s[0], FXS_PROFILE_DEFAULT) || !streamed_make(&s[1], FXS_PROFILE_SMALL))
        return;
    const uint64_t most = 8 * bytes_of_chunk(&s[0]);
    s[1].number = 1;
    s[0].objects = 2;
    stream_set(d, 0, most);
    for (int i = 0; i < 2; i++) {
        bring_all(&s[i]);
        CHECK(!stream_upload(&s[i], d, &s[i].part) && note_device(&s[i]) > 0);
    }
    for (int frame = 0; frame < 20 && !check_faults; frame++) {
        fxs_object objects[2], shown[2];
        fxs_request request = streamed_view(s, objects, &s[0].part, 5, 1);
        objects[1].scene = &s[1].part;
        request.targets[0] = s[0].drawn[0].targets;
        CHECK(!stream_render(d, &request, &stats));
        request = streamed_view(s, shown, &s[0].shown, 5, 1);
        shown[1].scene = &s[1].shown;
        request.targets[0] = s[0].expected[0].targets;
        CHECK(!render_there(&request, &expected));
        CHECK(is_equal(&s[0].expected[0], &s[0].drawn[0]) && stats.missing == expected.missing);
        CHECK(note_device(&s[0]) * bytes_of_chunk(&s[0]) + note_device(&s[1]) * bytes_of_chunk(&s[1]) <= most);
    }
    CHECK(!stats.missing);
    for (int i = 0; i < 2; i++) {
        stream_drop(&s[i], d);
        streamed_free(&s[i]);
    }
    stream_set(d, 0, 0);
}

static int stop_at_once(void *argument)
{
    (void)argument;
    return 1;
}

/* Frames that are stopped upload what they lack, and so complete the frame after them. */
static void stopped_frames(stream_device *d)
{
    streamed s;
    fxs_stats stats;
    uint32_t uploaded;
    if (!streamed_make(&s, FXS_PROFILE_DEFAULT))
        return;
    bring_all(&s);
    stream_set(d, 0, 20 * bytes_of_chunk(&s));
    CHECK(!stream_upload(&s, d, &s.part));
    for (int i = 0; i < 30; i++) {
        fxs_object objects[2];
        fxs_request request = streamed_view(&s, objects, &s.part, 5, 1);
        request.targets[0] = s.drawn[0].targets;
        request.options.stop.call = stop_at_once;
        CHECK(stream_render(d, &request, &stats) == FXS_ERR_STOPPED);
    }
    CHECK(!streamed_draw(&s, d, 5, 1, &stats, &uploaded) && !stats.missing && !uploaded);
    stream_drop(&s, d);
    streamed_free(&s);
    stream_set(d, 0, 0);
}

#endif
