/* The last steps of a fit optimise the packed scene. Adam changes exact parameters, the masters, by the gradient at the
 * parameters that packing quantises from them (the straight-through estimator: Bengio, Leonard, Courville 2013).
 *
 * The Gaussians are in the order of the packed scene. The code steps and ranges of chunks, and SH coded by a palette,
 * are found anew from time to time, all other codes in every step. */
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
    fxs_palette *palette;          /* null: the profile has none */
    unsigned char *records;        /* codes of each Gaussian's SH by the palette */
} fxs_fit_profile;

/* Orders the model's Gaussians and gives it masters, which are coded as below. Of `options`, profile, run (not null)
   and pool are used. Returns 0, or an error and a message with a model without masters. `model` and `profile` must not
   move in memory afterwards. */
int fxs_fit_profile_begin(fxs_fit_profile *profile, fxs_fit_model *model, int sh_degree,
                          const fxs_pack_options *options, fxs_message *message);

/* Finds ranges, code steps and palette anew from the masters, and the SH that the palette codes; the other parameters
   must then be quantised. Without a palette, only the masters of the model are read, and nothing in it is written. A
   palette takes 64 bytes a Gaussian meanwhile. Returns 0, or an error and a message. */
int fxs_fit_profile_code(fxs_fit_profile *profile, fxs_fit_model *model, const fxs_pack_options *options,
                         fxs_message *message);

/* Makes the masters the parameters of a model without masters, for a finished fit that gets more steps. */
void fxs_fit_profile_end(fxs_fit_profile *profile, fxs_fit_model *model);

/* Packs the model with its codes, so the packed scene has exactly the model's parameters, given in `gaussians`. */
int fxs_fit_profile_pack(const fxs_fit_profile *profile, const fxs_fit_model *model,
                         const fxs_gaussian_source *gaussians, fxs_packed_scene *scene, fxs_pack_report *report,
                         const fxs_pack_options *options, fxs_message *message);

/* Calls a visitor for every block of the phase's state beside the model's planes, to save it or, after
   fxs_fit_profile_allocate, to read it: one for the masters, which are floats, another for bytes that are the same on
   every machine. Returns 0 or the error of a visitor. */
typedef int fxs_fit_visit_fn(void *argument, void *block, size_t bytes);
int fxs_fit_profile_walk(fxs_fit_profile *profile, fxs_fit_model *model, fxs_fit_visit_fn *masters,
                         fxs_fit_visit_fn *others, void *argument);

/* Allocates the state of a phase that has begun, for the Gaussians of the model. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_profile_allocate(fxs_fit_profile *profile, fxs_fit_model *model, enum fxs_profile which, int sh_degree);

/* Called after a state was read. Returns 0, or an error where the state is invalid. */
int fxs_fit_profile_restore(fxs_fit_profile *profile, fxs_fit_model *model);

void fxs_fit_profile_free(fxs_fit_profile *profile);

#endif
