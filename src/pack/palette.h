/* SH codes: the mean of a chunk plus a signed entry from each of several palettes. This is residual vector
 * quantisation (Juang and Gray 1982). Each palette is learned by k-means (Lloyd 1982) on the residual of the
 * palettes before it. All computation is in integers, so the result is the same on every machine. */
#ifndef FXS_PALETTE_H
#define FXS_PALETTE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/pack.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>

/* SH of a Gaussian, waiting for the scene's palette; 64 bytes. */
typedef struct fxs_sh_item {
    float position[3];
    float step;                        /* coefficient = code * step */
    int16_t area;                      /* 8 log2 of the product of the two largest sigmas */
    uint8_t opacity;                   /* opacity times 255; 0: invisible, or an empty slot */
    int8_t codes[45];                  /* coefficient by coefficient: red, green, blue */
} fxs_sh_item;

/* Fills in an item from a Gaussian. `opacity` is 0 to 1. */
void fxs_sh_item_set(fxs_sh_item *item, const fxs_gaussian *gaussian, double opacity, int sh_degree);

/* The coefficients of an entry, in units of the palette. Order of a packed palette: 16 of red, 16 of green, 16 of
   blue; the 16th is always 0. */
typedef int16_t fxs_sh_vector[FXS_PALETTE_STRIDE];

#define FXS_PALETTE_GROUPS (FXS_PALETTE_ENTRIES / 8)

typedef struct fxs_palette {
    enum fxs_profile profile;
    int sh_degree;
    uint32_t stages, entries;          /* entries per stage */
    int unit_exponent;                 /* a unit is 2^-unit_exponent */
    int centred;                       /* 1: entries code differences from the chunks' means; 0: all means are 0 */
    int32_t step;                      /* quantisation step of the packed palette, units; 1 to 10 */
    fxs_sh_vector vectors[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];
    int32_t squares[FXS_PALETTE_STAGES][FXS_PALETTE_ENTRIES];   /* |entry|^2 */
    fxs_sh_vector groups[FXS_PALETTE_STAGES][FXS_PALETTE_GROUPS];   /* mean of each 8 consecutive entries */
    int32_t group_squares[FXS_PALETTE_STAGES][FXS_PALETTE_GROUPS];
} fxs_palette;

/* Entries per stage for a scene of `count` Gaussians in `chunks` chunks, a compromise between quality and bytes. 0:
   the scene has no palette. */
uint32_t fxs_palette_entries_for(uint64_t count, uint64_t chunks, enum fxs_profile profile, int sh_degree);

/* A palette is learned from a sample: about 2^14 Gaussians and the means of their chunks. The caller passes the items
   of these chunks only, FXS_CHUNK per chunk, one chunk after another. fxs_palette_sample returns the number of items
   for a scene of `count` Gaussians, at most 2^22 + FXS_CHUNK. fxs_palette_sample_at returns the index in the sample of
   a chunk's first item, or FXS_NOT_SAMPLED. */
#define FXS_NOT_SAMPLED UINT32_MAX
uint32_t fxs_palette_sample(uint32_t count);
uint32_t fxs_palette_sample_at(uint32_t count, uint32_t chunk);

/* Learns the palette of a scene of `count` Gaussians. palette->profile and sh_degree are set by the caller. `items`
   is the sample, `entries` the result of fxs_palette_entries_for. options->run must not be null. options->progress
   gets 0 to 1. Returns 0, or an error and a message: out of memory, or stopped. */
int fxs_palette_learn(fxs_palette *palette, uint32_t entries, const fxs_sh_item *items, uint32_t count,
                      const fxs_pack_options *options, fxs_message *message);

/* Improves an existing palette after the Gaussians changed. Arguments and result as for fxs_palette_learn. */
int fxs_palette_refine(fxs_palette *palette, const fxs_sh_item *items, uint32_t count,
                       const fxs_pack_options *options, fxs_message *message);

/* Validates a palette read from a file and computes its squared lengths. Returns 1, or 0 if a field is out of range or
   the palette has not `entries` entries per stage. */
int fxs_palette_restore(fxs_palette *palette, uint32_t entries);

/* Fills in the palette of an open packed scene, so that more Gaussians can be coded with it. The scene must have a
   palette. */
void fxs_palette_of_scene(fxs_palette *palette, const fxs_scene *scene);

/* The palette's step as a packed scene stores it, Q19. */
uint32_t fxs_palette_step_q19(const fxs_palette *palette);

/* Writes the entries of all stages as a packed scene stores them. */
void fxs_palette_write(const fxs_palette *palette, int8_t *to);

/* Error of coded coefficients: the largest error, and the sum of squared errors. */
typedef struct fxs_sh_loss {
    double largest, squares;
} fxs_sh_loss;

/* Codes the SH of a chunk of `count` Gaussians. Writes the chunk's mean, and a record per Gaussian
   (src/include/fixsplat/internal/packed.h), records `stride` bytes apart. The error of a Gaussian is diffused to later
   Gaussians of the chunk that overlap it. */
void fxs_palette_code_chunk(const fxs_palette *palette, const fxs_sh_item *items, uint32_t count, int8_t mean[48],
                            unsigned char *records, size_t stride, fxs_sh_loss *loss);

/* Decodes a record in a chunk with this mean. Coefficients above the scene's degree are 0. */
void fxs_palette_decode(const fxs_palette *palette, const int8_t mean[48], const unsigned char *record, float sh[45]);

#endif
