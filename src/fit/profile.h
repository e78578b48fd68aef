/* Fitting what ships: the last steps of a fit pass through the packed profile. Adam's step is taken by masters, the
 * gradient is that of what packing makes of them (straight through: Bengio, Leonard, Courville 2013).
 *
 * The Gaussians are in the order of the packed scene. Steps and ranges of chunks, and the SH of a palette, are found
 * anew now and then; codes of all else in every step. */
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
    fxs_fit_chunk *steps;          /* of each chunk, from its header */
    fxs_fit_grid grid;
    fxs_palette *palette;          /* null without one */
    unsigned char *records;        /* SH of each Gaussian by the palette */
} fxs_fit_profile;

/* Puts the model's Gaussians in order and gives it masters, which are coded as below. `options`: profile, run (not
   null), pool. Returns 0, or an error and a message, and the model is one without masters. `model` and `profile` stay
   where they are. */
int fxs_fit_profile_begin(fxs_fit_profile *profile, fxs_fit_model *model, int sh_degree,
                          const fxs_pack_options *options, fxs_message *message);

/* Finds ranges, steps and palette anew from the masters, and the parameters that the palette has; the others are to be
   quantised after that. Without a palette, nothing of the model is read but the masters, and nothing written. Takes 64
   bytes a Gaussian meanwhile where there is a palette. Returns 0, or an error and a message. */
int fxs_fit_profile_code(fxs_fit_profile *profile, fxs_fit_model *model, const fxs_pack_options *options,
                         fxs_message *message);

/* The masters become the parameters of a model without, as where more steps are wanted of a fit that was at its end. */
void fxs_fit_profile_end(fxs_fit_profile *profile, fxs_fit_model *model);

/* Packs the model: what the packed scene says are the model's parameters. `gaussians` are those. */
int fxs_fit_profile_pack(const fxs_fit_profile *profile, const fxs_fit_model *model,
                         const fxs_gaussian_source *gaussians, fxs_packed_scene *scene, fxs_pack_report *report,
                         const fxs_pack_options *options, fxs_message *message);

/* Gives every block of the phase's state beside the model's planes to a visitor, the masters to one of its own, to be
   saved or, after fxs_fit_profile_allocate, read: floats, and bytes that are the same on every machine. Returns 0 or
   what a visitor returned. */
typedef int fxs_fit_visit_fn(void *argument, void *block, size_t bytes);
int fxs_fit_profile_walk(fxs_fit_profile *profile, fxs_fit_model *model, fxs_fit_visit_fn *masters,
                         fxs_fit_visit_fn *others, void *argument);

/* Makes room for the state of a phase that has begun, with a model of `count` Gaussians. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_fit_profile_allocate(fxs_fit_profile *profile, fxs_fit_model *model, enum fxs_profile which, int sh_degree);

/* After a state was read. Returns 0, or an error where there can be no such state. */
int fxs_fit_profile_restore(fxs_fit_profile *profile, fxs_fit_model *model);

void fxs_fit_profile_free(fxs_fit_profile *profile);

#endif
