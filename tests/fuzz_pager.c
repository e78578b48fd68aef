/* Fuzzes the pager, which loads the chunks (256 Gaussians each) of a scene on demand. The source of the chunks
   may fail, corrupt bytes or state a wrong size. Once all chunks are loaded, an intact scene must render like the
   whole scene. */
#include <fixsplat/pager.h>
#include <fixsplat/internal/message.h>

#include "fuzz_frame.h"
#include "random_tree.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { CONTROL = 12, FRAMES = 3, TURNS = 40, WAIT_NS = 2000000 };

typedef struct fuzz_source {
    const unsigned char *bytes;
    size_t there, claimed;
    /* fails_each n: every n-th read fails; lies_each n: every n-th read returns wrong bytes; 0: none */
    uint32_t reads, fails_each, lies_each;
    int closed;
} fuzz_source;

static int read_part(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message)
{
    fuzz_source *s = (fuzz_source *)argument;
    s->reads++;
    if (offset > s->claimed || size > s->claimed - offset || s->closed)
        abort();
    if (offset > s->there || size > s->there - offset || (s->fails_each && s->reads % s->fails_each == 0))
        return fxs_fail(message, "the line is cut");
    memcpy(out, s->bytes + offset, size);
    if (size && s->lies_each && s->reads % s->lies_each == 0)
        ((unsigned char *)out)[s->reads * 7919u % size] ^= 1;
    return 0;
}

static void close_part(void *argument)
{
    ((fuzz_source *)argument)->closed++;
}

/* Renders a frame of a paged scene. Returns the error code of fxs_render. Sets *missing to the number of missing
   chunks (256 Gaussians each), 0 on failure. */
static int draw(const fxs_scene *scene, fxs_pager *pager, const fxs_camera *camera, const fxs_options *options,
                unsigned char *pixels, size_t *picture, uint32_t *missing)
{
    fxs_context context;
    fxs_request request;
    fxs_object object;
    fxs_stats stats;
    fxs_context_init(&context, NULL);
    fxs_object_init(&object, scene);
    fxs_request_init(&request, &object, 1);
    request.options = *options;
    request.options.want.call = pager ? fxs_pager_want : NULL;
    request.options.want.argument = pager;
    request.cameras[0] = *camera;
    request.targets[0].colour = (fxs_image){pixels, 4 * (ptrdiff_t)camera->width};
    *picture = 4 * (size_t)camera->width * (size_t)camera->height;
    const size_t bytes = fxs_request_bytes(&context, &request, 0);
    if (!bytes || bytes > FUZZ_ROOM || *picture > FUZZ_ROOM / 4)
        return FXS_ERR_MEMORY;
    const int error = fxs_render(&context, &request, fuzz_room(0, bytes), bytes, &stats);
    *missing = error ? 0 : stats.missing;
    return error;
}

static int has_cut(const fxs_scene *scene, const fxs_options *options)
{
    return options->detail_q8 || (options->budget && options->budget < scene->count);
}

static void look(fxs_pager *pager, const fxs_scene *whole, int turns)
{
    static unsigned char pixels[2][FUZZ_ROOM / 4];
    fxs_camera camera;
    fxs_options options;
    fxs_pager_state state_of;
    fxs_message why;
    uint32_t missing = 0, none;
    size_t picture;
    int error, failed = 0;
    random_cut(&camera, &options, fxs_scene_chunks(fxs_pager_scene(pager)));
    do {
        error = draw(fxs_pager_scene(pager), pager, &camera, &options, pixels[0], &picture, &missing);
        failed = fxs_pager_turn(pager, &state_of, &why);
        if (state_of.there > state_of.room || (whole && failed))
            abort();
        fxs_pager_wait(pager, WAIT_NS);
    } while (!error && missing && --turns > 0);
    if (error || missing || !whole || !has_cut(whole, &options))
        return;
    if (draw(whole, NULL, &camera, &options, pixels[1], &picture, &none) || memcmp(pixels[0], pixels[1], picture) != 0)
        abort();
}

static void page(fuzz_source *s, const fxs_scene *whole, size_t pool)
{
    const fxs_pager_source source = {.size = s->claimed, .read = read_part, .close = close_part, .argument = s,
                                     .gap = s->reads};
    const fxs_pager_options options = {.size = sizeof(fxs_pager_options), .pool_bytes = pool};
    fxs_pager *pager;
    fxs_message why;
    s->reads = 0;
    const int error = fxs_pager_open("fuzz", &source, &options, &pager, &why);
    if (error ? pager || s->closed != 1 || strchr(why.text, '\n') : !pager || s->closed)
        abort();
    for (int i = 0; i < FRAMES && !error; i++)
        look(pager, whole, whole ? TURNS : 2);
    fxs_pager_close(pager);
    if (s->closed != 1)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fxs_message why;
    fxs_scene whole;
    if (size < CONTROL)
        return 0;
    state = fuzz_word(data + 8);
    const packed_scene made = random_tree((enum fxs_profile)(data[0] % 3), 2 + data[1] % 32, data[0] >> 2 & 1,
                                          data[0] >> 3 & 1);
    fuzz_frame f = {.data = made.data, .bytes = made.bytes};
    fxs_file_seal(f.data, f.bytes);
    fuzz_edit(&f, (size_t)(made.scene.rows - made.data), data + CONTROL, size - CONTROL);
    if (data[0] & 16)                      /* bit 4: updates the checksums, so that the damaged bytes pass as valid */
        fxs_file_seal(f.data, f.bytes);
    fuzz_source s = {.bytes = f.data, .there = f.bytes, .claimed = f.bytes, .reads = data[0] & 32 ? 4096 : 0};
    switch (data[2] % 8) {
    case 1: s.fails_each = 1 + data[3]; break;
    case 2: s.lies_each = 1 + data[3]; break;
    case 3: s.claimed += fuzz_word(data + 4); break;
    case 4: s.claimed -= fuzz_word(data + 4) % f.bytes; break;
    }
    const int is_sound = data[2] % 8 == 0 && !fxs_file_check("fuzz", f.data, f.bytes, 1, &why) &&
                         !fxs_scene_open(&whole, f.data, f.bytes);
    page(&s, is_sound ? &whole : NULL, made.scene.chunk_bytes * (size_t)(16 + data[7] % 48));
    free(f.data);
    return 0;
}
