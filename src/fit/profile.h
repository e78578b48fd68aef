/* The last steps of a fit optimise the packed scene. Adam changes exact parameters, the masters, with the gradient
 * at the quantised parameters (straight-through estimator: Bengio, Leonard, Courville 2013).
 *
 * The Gaussians are in the order of the packed scene. Chunks' code steps and ranges, and SH coded by a palette, are
 * updated from time to time; all other codes in every step. */
#ifndef FXS_FIT_PROFILE_H
#define FXS_FIT_PROFILE_H

#include "src/pack/coded.h"
#include "model.h"

/* Null pointers: the phase has not begun. */
typedef struct fxs_fit_profile {
    enum fxs_profile profile;
    int sh_degree;
    size_t count;                  /* Gaussians */
    fxs_chunk *chunks;
    fxs_fit_chunk *steps;          /* code steps of each chunk, from its header */
    fxs_fit_grid grid;
    fxs_palette *palette;          /* null: the profile has no palette */
    unsigned char *records;        /* palette codes of each Gaussian's SH */
} fxs_fit_profile;

/* Orders the model's Gaussians, and gives it masters and codes. Of `options`, uses profile, run (not null) and pool.
   Returns 0, or an error and a message with a model without masters. `model` and `profile` must not move in memory
   afterwards. */
int fxs_fit_profile_begin(fxs_fit_profile *profile, fxs_fit_model *model, int sh_degree,
                          const fxs_pack_options *options, fxs_message *message);

/* Finds ranges, code steps, palette and the palette's SH codes anew from the masters; the caller must then quantise the
   other parameters. Without a palette the function reads only the masters and writes nothing in the model. A palette
   needs 64 bytes per Gaussian temporarily. Returns 0, or an error and a message. */
int fxs_fit_profile_code(fxs_fit_profile *profile, fxs_fit_model *model, const fxs_pack_options *options,
                         fxs_message *message);

/* Makes the masters the parameters and removes the masters, for a finished fit that gets more steps. */
void fxs_fit_profile_end(fxs_fit_profile *profile, fxs_fit_model *model);

/* Packs the model with its codes, so the packed scene has exactly the model's parameters, which `gaussians` returns. */
int fxs_fit_profile_pack(const fxs_fit_profile *profile, const fxs_fit_model *model,
                         const fxs_gaussian_source *gaussians, fxs_packed_scene *scene, fxs_pack_report *report,
                         const fxs_pack_options *options, fxs_message *message);

/* Calls a visitor for each block of the phase's state except the model's planes, to save it or (after
   fxs_fit_profile_allocate) to read it. `masters` gets the masters, as floats; `others` gets bytes with the same layout
   on every machine. Returns 0 or a visitor's error. */
typedef int fxs_fit_visit_fn(void *argument, void *block, size_t bytes);
int fxs_fit_profile_walk(fxs_fit_profile *profile, fxs_fit_model *model, fxs_fit_visit_fn *masters,
                         fxs_fit_visit_fn *others, void *argument);

/* Allocates the state of a phase in progress, for the model's Gaussians. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_profile_allocate(fxs_fit_profile *profile, fxs_fit_model *model, enum fxs_profile which, int sh_degree);

/* Call after reading a state. Returns 0, or an error if the state is invalid. */
int fxs_fit_profile_restore(fxs_fit_profile *profile, fxs_fit_model *model);

void fxs_fit_profile_free(fxs_fit_profile *profile);

#endif
