/* Fuzzes rendering of a packed scene, valid or damaged. Renders one picture and stereo pairs, in full and in
   minimum memory. Every set of kernels for this processor must match plain C. */
#include "one_scene.h"
#include "fuzz_frame.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct result {
    int error;
    unsigned char pixels[2][FUZZ_ROOM / 16];
} result;

static void render(const fuzz_frame *f, const fxs_context *context, size_t bytes, result *r)
{
    r->error = fuzz_render(f, context, bytes, NULL);
    memcpy(r->pixels[0], fuzz_room(1, f->picture), f->picture);
}

static void render_stereo(const fuzz_frame *f, const fxs_context *context, size_t bytes, result *r)
{
    r->error = fuzz_render_stereo(f, context, bytes);
    memcpy(r->pixels[0], fuzz_room(1, f->picture), f->picture);
    memcpy(r->pixels[1], fuzz_room(2, f->picture), f->picture);
}

static void compare(const fuzz_frame *f, const result *a, const result *b, int eyes)
{
    if (a->error != b->error)
        abort();
    for (int eye = 0; eye < eyes; eye++)
        if (memcmp(a->pixels[eye], b->pixels[eye], f->picture) != 0)
            abort();
}

static void count(const fuzz_frame *f, size_t bytes, const result *expected, uint64_t pairs[2])
{
    const int error = count_pairs(f->objects, f->count, &f->cameras[0], &f->options, fuzz_room(0, bytes), bytes,
                                      &pairs[0], &pairs[1]);
    if (error != expected->error)
        abort();
}

static void pick(const fuzz_frame *f, size_t bytes)
{
    fxs_targets targets = fuzz_targets(f, 0);
    fxs_pick_result picked;
    const int32_t width = f->cameras[0].width, height = f->cameras[0].height;
    fxs_id *ids = (fxs_id *)(void *)fuzz_room(1, (size_t)width * (size_t)height * sizeof *ids);
    const fxs_image occluder = targets.occluder;
    fxs_targets_init(&targets);
    targets.occluder = occluder;
    targets.depth_bits = f->depth_bits;
    targets.id = (fxs_image){ids, width * (ptrdiff_t)sizeof *ids};
    const int error = render_frame(&f->levels[0], f->objects, f->count, &f->cameras[0], &f->options, &targets,
                                 fuzz_room(0, bytes), bytes, NULL);
    for (int i = 0; i < 4; i++) {
        const int32_t x = between(0, width - 1), y = between(0, height - 1);
        const int found = pick_pixel(&f->levels[0], f->objects, f->count, &f->cameras[0], &f->options, &targets, x, y,
                                   fuzz_room(0, bytes), bytes, &picked);
        if (error ? found != error : found != (ids[y * width + x].gaussian != FXS_NOTHING))
            abort();
        if (found == 1 && (picked.id != ids[y * width + x].object || picked.gaussian != ids[y * width + x].gaussian))
            abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static fuzz_frame f;
    static result first, other, first_pair, other_pair;
    uint64_t pairs[2] = {0, 0}, pairs_in_bands[2] = {0, 0};
    fxs_frame_memory memory;
    if (!fuzz_frame_make(&f, data, size)) {
        free(f.data);
        return 0;
    }
    const size_t all = fuzz_frame_bytes(&f, &memory);
    if (!all && fuzz_render(&f, &f.levels[0], FUZZ_ROOM, NULL) >= 0)
        abort();
    if (all && all <= FUZZ_ROOM && f.picture <= sizeof first.pixels[0]) {
        const size_t least = fuzz_least(&f, &f.levels[0], &memory);
        render(&f, &f.levels[0], all, &first);
        render_stereo(&f, &f.levels[0], all, &first_pair);
        for (int level = 0; level < f.level_count; level++) {
            render(&f, &f.levels[level], all, &other);
            compare(&f, &first, &other, 1);
            render(&f, &f.levels[level], least, &other);
            compare(&f, &first, &other, 1);
            render_stereo(&f, &f.levels[level], all, &other_pair);
            compare(&f, &first_pair, &other_pair, 2);
        }
        if (first.error != FXS_ERR_TARGET) {
            count(&f, all, &first, pairs);
            count(&f, memory.rows > least ? memory.rows : least, &first, pairs_in_bands);
        }
        if (memcmp(pairs, pairs_in_bands, sizeof pairs) != 0)
            abort();
        pick(&f, all);
    }
    free(f.data);
    return 0;
}
