/* SH as the sum of a chunk's mean and one signed entry of each of several palettes: residual vector quantisation
 * (Juang and Gray 1982), each palette learned by k-means (Lloyd 1982) on what the ones before it leave. In integers,
 * so that it is the same on every machine. */
#ifndef FXS_PALETTE_H
#define FXS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/packed.h>
#include <fixsplat/message.h>
#include <fixsplat/pack.h>

/* A Gaussian as it waits for the palette of its scene. 64 bytes. */
typedef struct fxs_sh_item {
    float position[3];
    float step;                        /* a coefficient is code * step */
    int16_t area;                      /* log2 of the product of the two largest sigmas, times 8 */
    uint8_t opacity;                   /* times 255; 0: it is not seen, or there is none in this place */
    int8_t codes[45];                  /* red, green, blue of each coefficient */
} fxs_sh_item;

/* opacity: 0..1 */
void fxs_sh_item_set(fxs_sh_item *item, const fxs_gaussian *gaussian, double opacity, int sh_degree);

/* Coefficients as an entry of a packed palette has them: red, green, blue of 16, the last of each 0. In units. */
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

/* Entries of a stage that are worth their bytes in a scene of `count` Gaussians. */
uint32_t fxs_palette_entries_for(uint64_t count, enum fxs_profile profile, int sh_degree);

/* Learns the palette of a scene from its Gaussians, those of a chunk together; `entries` is what
   fxs_palette_entries_for said. options->run is not null; options->progress is given 0 to 1. Returns 0, or an error
   and a message: out of memory, or stopped. */
int fxs_palette_learn(fxs_palette *palette, uint32_t entries, const fxs_sh_item *items, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message);

/* Moves the entries of a palette that was learned towards what is said by Gaussians that have changed since. */
int fxs_palette_refine(fxs_palette *palette, const fxs_sh_item *items, uint32_t count,
                       const fxs_pack_options *options, fxs_message *message);

/* Of a palette that was read from a file: whether it can be one with so many entries. */
int fxs_palette_restore(fxs_palette *palette, uint32_t entries);

/* The palette's step as a packed scene has it. */
uint32_t fxs_palette_step_q19(const fxs_palette *palette);

/* Writes the entries of all stages as a packed scene has them. */
void fxs_palette_write(const fxs_palette *palette, int8_t *to);

/* The largest difference of a coefficient from what was read, and the sum of the squares of all. */
typedef struct fxs_sh_loss {
    double largest, squares;
} fxs_sh_loss;

/* Finds the SH of a chunk of `count` Gaussians: its mean, and the record of each (src/include/fixsplat/packed.h), `stride` bytes from
   one to the next. What a Gaussian's code is off is made good by those that overlap it and come later. */
void fxs_palette_code_chunk(const fxs_palette *palette, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                            unsigned char *records, size_t stride, fxs_sh_loss *loss);

/* The coefficients that a record stands for, in a chunk of this mean; 0 above the degree. */
void fxs_palette_decode(const fxs_palette *palette, const int8_t mean[48], const unsigned char *record, float sh[45]);

#endif
