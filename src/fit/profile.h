/* Quantises the Gaussians in the last steps of a fit, so that these steps optimise the packed scene. Adam changes exact
 * parameters, called masters, with the gradient at the quantised parameters (straight-through estimator: Bengio,
 * Leonard, Courville 2013). Functions return 0 or an error. */
#ifndef FXS_FIT_PROFILE_H
#define FXS_FIT_PROFILE_H

#include "src/pack/coded.h"
#include "model.h"

/* The state of quantisation in a fit. Its pointers are null until quantisation begins. */
typedef struct fxs_fit_profile {
    enum fxs_profile profile;
    int sh_degree;
    size_t count;
    fxs_chunk *chunks;
    fxs_fit_chunk *steps;          /* quantisation steps of each chunk (256 Gaussians) */
    fxs_fit_grid grid;
    fxs_palette *palette;
    unsigned char *records;        /* palette codes of each Gaussian's spherical harmonics */
} fxs_fit_profile;

/* Orders the Gaussians of a fit, and begins to quantise them. `model` and `profile` must not move in memory
   afterwards. */
int fxs_fit_profile_begin(fxs_fit_profile *profile, fxs_fit_model *model, int sh_degree,
                          const fxs_pack_options *options, fxs_message *message);

/* Finds the quantisation's ranges, steps and palette again from the exact parameters. The caller must then quantise. */
int fxs_fit_profile_code(fxs_fit_profile *profile, fxs_fit_model *model, const fxs_pack_options *options,
                         fxs_message *message);

/* Ends the quantisation of a fit: the exact parameters replace the quantised ones. */
void fxs_fit_profile_end(fxs_fit_profile *profile, fxs_fit_model *model);

int fxs_fit_profile_pack(const fxs_fit_profile *profile, const fxs_fit_model *model,
                         const fxs_gaussian_source *gaussians, fxs_packed_scene *scene, fxs_pack_report *report,
                         const fxs_pack_options *options, fxs_message *message);

/* Calls a function for each memory block of the quantisation's state, to save or read it. `masters` gets floats;
   `others` gets bytes with the same layout on every machine. */
typedef int fxs_fit_visit_fn(void *argument, void *block, size_t bytes);
int fxs_fit_profile_walk(fxs_fit_profile *profile, fxs_fit_model *model, fxs_fit_visit_fn *masters,
                         fxs_fit_visit_fn *others, void *argument);

int fxs_fit_profile_allocate(fxs_fit_profile *profile, fxs_fit_model *model, enum fxs_profile which, int sh_degree);

/* Checks a quantisation's state and computes what depends on it. Must be called after the state was read; fails if it
   is invalid. */
int fxs_fit_profile_restore(fxs_fit_profile *profile, fxs_fit_model *model);

void fxs_fit_profile_free(fxs_fit_profile *profile);

#endif
