/* libFuzzer target: a packed scene, damaged or not, rendered in all its memory and in the least, for one eye and two,
   and its pairs counted; every version of the stages that this processor has against plain C, byte for byte. */
#include "fuzz_frame.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What one version of the stages makes of a frame. */
typedef struct result {
    int error;
    unsigned char pixels[2][FUZZ_ROOM / 64];
} result;

static size_t picture_bytes(const fuzz_frame *f)
{
    return f->row * (size_t)f->cameras[0].height;
}

/* All pixels of one value, so that one that is left out is the same in every version. */
static unsigned char *picture(const fuzz_frame *f, int eye)
{
    unsigned char *pixels = fuzz_room(1 + eye, picture_bytes(f));
    memset(pixels, 0x5a, picture_bytes(f));
    return pixels;
}

static void render(const fuzz_frame *f, const fxs_context *context, size_t bytes, result *r)
{
    unsigned char *pixels = picture(f, 0);
    r->error = one_render(context, &f->scene, &f->cameras[0], &f->options, f->format, fuzz_room(0, bytes), bytes,
                          pixels, (ptrdiff_t)f->row, NULL);
    memcpy(r->pixels[0], pixels, picture_bytes(f));
}

static void render_stereo(const fuzz_frame *f, const fxs_context *context, size_t bytes, result *r)
{
    unsigned char *left = picture(f, 0), *right = picture(f, 1);
    r->error = one_render_stereo(context, &f->scene, f->cameras, &f->options, f->format, f->exact, fuzz_room(0, bytes),
                                 bytes, (void *const[2]){left, right}, (ptrdiff_t)f->row, NULL);
    memcpy(r->pixels[0], left, picture_bytes(f));
    memcpy(r->pixels[1], right, picture_bytes(f));
}

static void compare(const fuzz_frame *f, const result *a, const result *b, int eyes)
{
    if (a->error != b->error)
        abort();
    for (int eye = 0; eye < eyes; eye++)
        if (memcmp(a->pixels[eye], b->pixels[eye], picture_bytes(f)) != 0)
            abort();
}

static void count(const fuzz_frame *f, size_t bytes, const result *expected, uint64_t pairs[2])
{
    if (one_count_pairs(&f->scene, &f->cameras[0], &f->options, fuzz_room(0, bytes), bytes, &pairs[0], &pairs[1]) !=
        expected->error)
        abort();
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
    const fxs_camera *camera = &f.cameras[0];
    const size_t all = one_frame_bytes(&f.levels[0], &f.scene, camera->width, camera->height, &memory);
    const size_t both = one_stereo_bytes(&f.levels[0], &f.scene, camera->width, camera->height);
    if (all && both <= FUZZ_ROOM && picture_bytes(&f) <= sizeof first.pixels[0]) {
        const size_t least = fuzz_least(&f, &f.levels[0], &memory);
        render(&f, &f.levels[0], all, &first);
        render_stereo(&f, &f.levels[0], both, &first_pair);
        for (int level = 0; level < f.level_count; level++) {
            render(&f, &f.levels[level], all, &other);
            compare(&f, &first, &other, 1);
            render(&f, &f.levels[level], least, &other);
            compare(&f, &first, &other, 1);
            render_stereo(&f, &f.levels[level], both, &other_pair);
            compare(&f, &first_pair, &other_pair, 2);
        }
        count(&f, all, &first, pairs);
        count(&f, least, &first, pairs_in_bands);
        if (memcmp(pairs, pairs_in_bands, sizeof pairs) != 0)
            abort();
    }
    free(f.data);
    return 0;
}
