/* Fitting a scene to photographs: the same scene, byte for byte, for the same photographs, options and seed, whatever
 * the threads, the compiler and the processor.
 *
 *     fxs_fit_options options;
 *     fxs_fit_options_init(&options);
 *     fxs_fit_create(&fit, photographs, count, points, point_count, &options, &message);
 *     while (fxs_fit_steps(fit) < options.steps && !fxs_fit_step(fit, &report))
 *         ...
 *     fxs_fit_gaussians(fit, &gaussians);
 *     fxs_fit_free(fit);
 *
 * A fit is used by one thread at a time. */
#ifndef FXS_FIT_H
#define FXS_FIT_H

#include "../camera/camera_file.h"
#include "../import/pack.h"
#include "../scene/scene_file.h"
#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_fit fxs_fit;

/* A photograph and the camera that took it: a perspective one, of the pixels' size. */
typedef struct fxs_fit_photo {
    fxs_file_view view;
    const uint8_t *pixels;         /* red, green, blue, rows from the top without gaps; stays until the fit is freed */
} fxs_fit_photo;

enum fxs_fit_recipe {
    FXS_FIT_REFERENCE = 0,         /* Kerbl et al. 2023, and its reference code of 2025 */
    FXS_FIT_MCMC = 1,              /* Kheradmand et al. 2024 */
    FXS_FIT_FAST = 2
};

typedef struct fxs_fit_options {
    enum fxs_fit_recipe recipe;
    uint32_t steps;                /* 1 and more; 30,000 */
    int sh_degree;                 /* 0 to 3; 3 */
    size_t max_gaussians;          /* 2^22 */
    uint64_t seed;
    uint8_t background[3];
    enum fxs_cutoff cutoff;
    enum fxs_profile profile;      /* that fxs_fit_pack packs by, and that the last tenth of the steps fits */
    unsigned cpu;                  /* instruction sets that may be used, of enum fxs_cpu; all */
    fxs_run_fn *run;               /* null: one thread */
    void *pool;
    uint32_t threads;
    fxs_clock_fn *clock;           /* null: no times are reported */
} fxs_fit_options;

void fxs_fit_options_init(fxs_fit_options *options);

/* Copies all but the photographs' pixels. Returns 0 and a fit that fxs_fit_free frees, or an error and a message. */
int fxs_fit_create(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                   size_t point_count, const fxs_fit_options *options, fxs_message *message);
void fxs_fit_free(fxs_fit *fit);

/* One step. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_step(fxs_fit *fit, fxs_fit_report *report);

/* Steps that were made. */
uint32_t fxs_fit_steps(const fxs_fit *fit);

/* The Gaussians as they are, for fxs_scene_file_open_gaussians; valid until the next step. */
void fxs_fit_gaussians(const fxs_fit *fit, fxs_gaussian_source *gaussians);

/* Packs them by the options' profile: what the renderer draws, and what is written to a .fxs. */
int fxs_fit_pack(const fxs_fit *fit, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message);

/* Writes all of the fit's state to a file (by output.h: a failure leaves the one that is there). */
int fxs_fit_save(const fxs_fit *fit, const char *path, fxs_message *message);

/* fxs_fit_create from such a file, of the same photographs: its further steps are those of the fit that was saved. Of
   `options`, what says how it is computed is taken, and `steps`; the rest is the file's. */
int fxs_fit_resume(fxs_fit **fit, const char *path, const fxs_fit_photo *photos, size_t photo_count,
                   const fxs_fit_options *options, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
