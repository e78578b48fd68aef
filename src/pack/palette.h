/* Codes the SH of a Gaussian as the sum of the mean of its chunk and one signed entry of each of several palettes. This
 * is residual vector quantisation (Juang and Gray 1982). Each palette is learned by k-means (Lloyd 1982) on the rest
 * that the palettes before it leave. All computation is in integers, so the result is the same on every machine. */
#ifndef FXS_PALETTE_H
#define FXS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/packed.h>
#include <fixsplat/message.h>
#include <fixsplat/pack.h>

/* A Gaussian that waits for the palette of its scene, in 64 bytes. */
typedef struct fxs_sh_item {
    float position[3];
    float step;                        /* a coefficient is code * step */
    int16_t area;                      /* log2 of the product of the two largest sigmas, times 8 */
    uint8_t opacity;                   /* times 255; 0: it is not seen, or there is none in this place */
    int8_t codes[45];                  /* red, green, blue of each coefficient */
} fxs_sh_item;

/* Fills in an item from a Gaussian. `opacity` is 0 to 1. */
void fxs_sh_item_set(fxs_sh_item *item, const fxs_gaussian *gaussian, double opacity, int sh_degree);

/* The coefficients of an entry, in the order of a packed palette: red, green and blue of 16 coefficients, of which the
   last is 0. In units of the palette. */
typedef int16_t fxs_sh_vector[FXS_PALETTE_STRIDE];

#define FXS_PALETTE_GROUPS (FXS_PALETTE_ENTRIES / 8)

typedef struct fxs_palette {
    enum fxs_profile profile;
    int sh_degree;
    uint32_t stages, entries;          /* entries of each stage */
    int unit_exponent;                 /* a unit is 2^-unit_exponent */
    int centred;                       /* entries are of what is left of the chunks' means; else the means are 0 */
    int32_t step;                      /* of the packed palette, units; 1 to 10 */
    fxs_sh_vector vectors[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];
    int32_t squares[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];   /* |entry|^2 */
    fxs_sh_vector groups[FXS_PALETTE_STAGES][FXS_PALETTE_GROUPS];   /* the middle of 8 entries in a row each */
    int32_t group_squares[FXS_PALETTE_STAGES][FXS_PALETTE_GROUPS];
} fxs_palette;

/* Returns how many entries a stage should have in a scene of `count` Gaussians in so many chunks, so that the palette
   is worth its bytes; 0 for a scene without a palette. */
uint32_t fxs_palette_entries_for(uint64_t count, uint64_t chunks, enum fxs_profile profile, int sh_degree);

/* A palette is learned from a sample of about 2^14 Gaussians and the means of their chunks. So of a scene of `count`
   Gaussians it needs the items of these chunks alone, one chunk after the other: fxs_palette_sample items, at most 2^22
   and FXS_CHUNK. Those of a chunk begin at fxs_palette_sample_at, which is FXS_NOT_SAMPLED for the others. */
#define FXS_NOT_SAMPLED UINT32_MAX
uint32_t fxs_palette_sample(uint32_t count);
uint32_t fxs_palette_sample_at(uint32_t count, uint32_t chunk);

/* Learns the palette of a scene of `count` Gaussians. `items` is the sample, and `entries` the result of
   fxs_palette_entries_for. options->run is not null; options->progress is given 0 to 1. Returns 0,
   or an error and a message: out of memory, or stopped. */
int fxs_palette_learn(fxs_palette *palette, uint32_t entries, const fxs_sh_item *items, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message);

/* Improves a palette that was learned before, for Gaussians that have changed since. Arguments and result are as for
   fxs_palette_learn. */
int fxs_palette_refine(fxs_palette *palette, const fxs_sh_item *items, uint32_t count,
                       const fxs_pack_options *options, fxs_message *message);

/* Checks a palette that was read from a file and completes its fields. Returns 1, or 0 where its fields are not
   possible for a palette with this number of entries. */
int fxs_palette_restore(fxs_palette *palette, uint32_t entries);

/* Fills in the palette of an open packed scene that has one, so that more Gaussians can be coded by it. */
void fxs_palette_of_scene(fxs_palette *palette, const fxs_scene *scene);

/* Returns the step of the palette in the form of a packed scene. */
uint32_t fxs_palette_step_q19(const fxs_palette *palette);

/* Writes the entries of all stages in the form of a packed scene. */
void fxs_palette_write(const fxs_palette *palette, int8_t *to);

/* The largest difference of a coded coefficient from the original coefficient, and the sum of the squares of all
   differences. */
typedef struct fxs_sh_loss {
    double largest, squares;
} fxs_sh_loss;

/* Codes the SH of a chunk of `count` Gaussians. Writes the mean of the chunk and a record for each Gaussian
   (src/include/fixsplat/packed.h), `stride` bytes from one record to the next. The error of the code of a Gaussian is
   added to the Gaussians that overlap it and come later in the chunk, which make up for it. */
void fxs_palette_code_chunk(const fxs_palette *palette, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                            unsigned char *records, size_t stride, fxs_sh_loss *loss);

/* Computes the coefficients that a record stands for, in a chunk with this mean. Coefficients above the degree
   are 0. */
void fxs_palette_decode(const fxs_palette *palette, const int8_t mean[48], const unsigned char *record, float sh[45]);

#endif
