/* Codes spherical-harmonics (SH) coefficients as the mean of a chunk plus a signed entry from each of several
 * palettes. A chunk is 256 Gaussians. The method is residual vector quantisation (Juang and Gray 1982). Each
 * palette is learned by k-means (Lloyd 1982). */
#ifndef FXS_PALETTE_H
#define FXS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/pack.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>

/* SH coefficients of a Gaussian, kept until the scene's palette is known; 64 bytes. */
typedef struct fxs_sh_item {
    float position[3];
    float step;
    int16_t area;                      /* area of the Gaussian: 8 log2 of the product of its two largest sigmas */
    uint8_t opacity;                   /* opacity of the Gaussian times 255; 0: invisible, or no Gaussian */
    int8_t codes[45];                  /* red, green and blue code of each SH coefficient */
} fxs_sh_item;

void fxs_sh_item_set(fxs_sh_item *item, const fxs_gaussian *gaussian, double opacity, int sh_degree);

/* SH coefficients in palette units: 16 of red, 16 of green, 16 of blue. The 16th of each channel is always 0. */
typedef int16_t fxs_sh_vector[FXS_PALETTE_STRIDE];

#define FXS_PALETTE_GROUPS (FXS_PALETTE_ENTRIES / 8)

typedef struct fxs_palette {
    enum fxs_profile profile;
    int sh_degree;
    uint32_t stages, entries;
    int unit_exponent;                 /* a palette unit is 2^-unit_exponent */
    int centred;                       /* 1: entries code differences from the chunks' means; 0: all means are 0 */
    int32_t step;                      /* quantisation step of the packed entries, 1 to 10 palette units */
    fxs_sh_vector vectors[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];
    int32_t squares[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];
    fxs_sh_vector groups[FXS_PALETTE_STAGES][FXS_PALETTE_GROUPS];
    int32_t group_squares[FXS_PALETTE_STAGES][FXS_PALETTE_GROUPS];
} fxs_palette;

/* Returns the number of palette entries per stage for a scene of `count` Gaussians in `chunks` chunks. 0: the scene has
   no palette. */
uint32_t fxs_palette_entries_for(uint64_t count, uint64_t chunks, enum fxs_profile profile, int sh_degree);

/* A palette is learned from a sample of about 2^14 Gaussians. The caller passes the SH items (one per Gaussian) of the
   sampled chunks only, FXS_CHUNK items per chunk. fxs_palette_sample returns the number of items for a scene of `count`
   Gaussians. fxs_palette_sample_at returns the index of a chunk's first item in the sample, or FXS_NOT_SAMPLED. */
#define FXS_NOT_SAMPLED UINT32_MAX
uint32_t fxs_palette_sample(uint32_t count);
uint32_t fxs_palette_sample_at(uint32_t count, uint32_t chunk);

/* Learns the palette of a scene of `count` Gaussians from the sample `items`. The caller sets palette->profile and
   sh_degree. `entries` is the result of fxs_palette_entries_for. options->workers.run must not be null. Returns 0, or
   an error and a message: out of memory, or stopped. */
int fxs_palette_learn(fxs_palette *palette, uint32_t entries, const fxs_sh_item *items, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message);

/* Improves an existing palette after the Gaussians changed. The arguments and the result are like those of
   fxs_palette_learn. */
int fxs_palette_refine(fxs_palette *palette, const fxs_sh_item *items, uint32_t count,
                       const fxs_pack_options *options, fxs_message *message);

/* Validates a palette from a file, which must have `entries` entries per stage. Returns 1, or 0 if a field is
   invalid. */
int fxs_palette_restore(fxs_palette *palette, uint32_t entries);

/* Reads the palette of SH vectors from an open packed scene, which must have a palette. */
void fxs_palette_of_scene(fxs_palette *palette, const fxs_scene *scene);

uint32_t fxs_palette_step_q19(const fxs_palette *palette);

void fxs_palette_write(const fxs_palette *palette, int8_t *to);

typedef struct fxs_sh_loss {
    double largest, squares;
} fxs_sh_loss;

/* Codes the SH coefficients of a chunk of `count` Gaussians. Writes the chunk's mean, and a record per Gaussian
   (src/include/fixsplat/internal/packed.h), records `stride` bytes apart. The error of a Gaussian is diffused to later
   Gaussians of the chunk that overlap it. */
void fxs_palette_code_chunk(const fxs_palette *palette, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                            unsigned char *records, size_t stride, fxs_sh_loss *loss);

/* Decodes the SH record of a Gaussian in a chunk with the given mean. Coefficients above the scene's SH degree are
   0. */
void fxs_palette_decode(const fxs_palette *palette, const int8_t mean[48], const unsigned char *record, float sh[45]);

#endif
