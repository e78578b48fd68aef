/* The bookkeeping of a scene that is partly on a device. */
#include "mirror.h"

#include "chunk.h"
#include "memory.h"
#include "sized.h"

#define POOL_USUAL ((uint64_t)256 << 20)
#define UPLOAD_USUAL ((uint64_t)8 << 20)

uint64_t fxs_mirror_place_bytes(const fxs_scene *scene)
{
    return sizeof(fxs_chunk) + (uint64_t)scene->chunk_bytes;
}

uint64_t fxs_mirror_bytes(const fxs_scene *scene, uint32_t room)
{
    return fxs_scene_chunks(scene) * (uint64_t)sizeof(uint32_t) +
           room * (uint64_t)(sizeof(fxs_place) + sizeof(uint32_t));
}

int fxs_mirror_is_asked(const fxs_request *request)
{
    int parts = 0;
    for (uint32_t i = 0; i < request->count; i++)
        parts |= fxs_object_at(request->objects, i)->scene->places != 0;
    return parts;
}

uint64_t fxs_mirror_usual_bytes(const fxs_request *request, uint64_t bytes)
{
    const uint32_t budget = request->options.budget;
    const uint32_t count = request->objects && request->count <= FXS_MAX_OBJECTS ? request->count : 0;
    for (uint32_t i = 0; i < count; i++) {
        const fxs_scene *scene = fxs_object_at(request->objects, i)->scene;
        if (!scene || !scene->places)
            continue;
        const uint64_t chunks = budget ? 2 * (uint64_t)fxs_chunks_of(budget) + FXS_KEPT_MOST : fxs_scene_chunks(scene);
        const uint64_t usual = chunks * fxs_mirror_place_bytes(scene);
        bytes = usual > bytes ? usual : bytes;
    }
    return bytes;
}

uint32_t fxs_mirror_room(const fxs_scene *scene, uint64_t bytes, uint64_t limit, fxs_message *why)
{
    static const char small[] = "the device's pool for a scene in parts has no room for 16 chunks";
    const uint64_t each = fxs_mirror_place_bytes(scene), pool = bytes ? bytes : POOL_USUAL;
    const uint32_t room = fxs_places_room(scene, limit && limit / 2 < pool ? limit / 2 : pool, each);
    if (!room) {
        memset(why, 0, sizeof *why);
        memcpy(why->text, small, sizeof small);
        why->bytes_needed = FXS_PLACES_LEAST * each * (limit ? 2 : 1);
    }
    return room;
}

uint64_t fxs_mirror_upload_bytes(const fxs_scene *scene, uint64_t bytes)
{
    const uint64_t each = fxs_mirror_place_bytes(scene), most = bytes ? bytes : UPLOAD_USUAL;
    return most > each ? most : each;
}

fxs_scene fxs_mirror_pool(const fxs_mirror *m)
{
    fxs_scene pool = *m->from;
    pool.chunk_count = m->pool.room;
    pool.nodes = 0;
    return pool;
}

void fxs_mirror_init(fxs_mirror *m, const fxs_scene *scene, uint32_t room, void *memory)
{
    uint32_t *of_chunks = memory, *wanted = of_chunks + fxs_scene_chunks(scene);
    *m = (fxs_mirror){.scene = *scene, .from = scene, .wanted = wanted};
    fxs_places_init(&m->pool, scene, room, of_chunks, (fxs_place *)(void *)(wanted + room));
    m->scene.places = of_chunks;
}

void fxs_mirror_forget(fxs_mirror *m)
{
    fxs_mirror_init(m, m->from, m->pool.room, m->pool.of_chunks);
}

void fxs_mirror_begin(fxs_mirror *m, uint32_t turn, uint32_t since, const fxs_want *want)
{
    m->want = *want;
    m->wanted_count = m->pool.turn == turn ? m->wanted_count : 0;
    m->pool.turn = turn;
    m->since = since;
}

static int is_in_memory(const fxs_mirror *m, uint32_t chunk)
{
    return !m->from->places || m->from->places[chunk] != FXS_NOTHING;
}

void fxs_mirror_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    fxs_mirror *m = (fxs_mirror *)(uintptr_t)scene;
    (void)argument;
    if (there)
        fxs_places_note_drawn(&m->pool, scene->places[chunk]);
    else if (m->wanted_count < m->pool.room)
        m->wanted[m->wanted_count++] = chunk;
    if (m->want.call)
        m->want.call(m->want.argument, m->from, chunk, is_in_memory(m, chunk));
}

int fxs_mirror_take(fxs_request *request, fxs_object *objects, uint32_t turn, fxs_mirror_of_fn *of, const void *copies)
{
    int error = 0;
    for (uint32_t i = 0; i < request->count && !error; i++) {
        fxs_mirror *m = of(copies, i);
        error = fxs_object_read(&objects[i], request->objects, i);
        error = error ? error : !objects[i].scene->places != !m ? FXS_ERR_ARGUMENT : 0;
        if (error || !m)
            continue;
        objects[i].scene = &m->scene;
        fxs_mirror_begin(m, turn, turn - 1, &request->options.want);
    }
    request->objects = objects;
    request->options.want.call = fxs_mirror_want;
    return error;
}

static uint32_t take_place(fxs_mirror *m)
{
    return m->used < m->pool.room ? m->used++ : fxs_places_evict(&m->pool, m->since);
}

uint32_t fxs_mirror_step(fxs_mirror *m, uint64_t bytes, const uint32_t **places)
{
    const uint32_t wanted = m->wanted_count, all = wanted + m->pool.kept;
    const uint64_t most = bytes / fxs_mirror_place_bytes(m->from);
    uint32_t count = 0;
    m->wanted_count = 0;
    for (uint32_t i = 0; i < all && count < most && count < m->pool.room; i++) {
        const uint32_t chunk = i < wanted ? m->wanted[i] : m->pool.leaves + i - wanted;
        if (m->scene.places[chunk] != FXS_NOTHING || !is_in_memory(m, chunk))
            continue;
        const uint32_t place = take_place(m);
        if (place == FXS_NOTHING)
            break;
        fxs_places_settle(&m->pool, chunk, place);
        m->wanted[count++] = place;
    }
    *places = m->wanted;
    return count;
}

void fxs_mirror_fill(const fxs_mirror *m, const uint32_t *places, uint32_t count, void *to)
{
    const size_t rows = m->from->chunk_bytes;
    unsigned char *header = to, *row = header + count * sizeof(fxs_chunk);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t chunk = fxs_mirror_chunk(m, places[i]);
        memcpy(header + i * sizeof(fxs_chunk), fxs_header(m->from, chunk), sizeof(fxs_chunk));
        memcpy(row + i * rows, fxs_rows(m->from, chunk), rows);
    }
}

uint32_t fxs_mirror_run(const uint32_t *places, uint32_t count, uint32_t part_chunks)
{
    uint32_t run = 1;
    while (run < count && places[run] == places[0] + run && places[run] % part_chunks)
        run++;
    return run;
}
