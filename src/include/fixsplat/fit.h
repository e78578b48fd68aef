/* Fitting a scene to photographs: the same scene, byte for byte, for the same photographs, options and seed, whatever
 * the threads, the compiler and the processor.
 *
 *     fxs_photos_options how = {0};
 *     fxs_photos photos;
 *     fxs_photos_read("garden", &how, &photos, &message);
 *     fxs_fit_options options;
 *     fxs_fit_options_init(&options);
 *     fxs_fit *fit;
 *     fxs_fit_create(&fit, photos.fit, photos.fit_count, photos.points, photos.point_count, &options, &message);
 *     while (fxs_fit_steps(fit) < options.steps && !fxs_fit_step(fit, &report, &message))
 *         ...
 *     fxs_fit_pack(fit, &scene, &pack_report, &message);
 *     fxs_fit_free(fit);
 *     fxs_photos_free(&photos);
 *
 * draws nothing, waits for nothing and writes nothing: between two steps the program may show the scene, save the fit
 * or stop. Functions return 0, or an error and a message. A fit is used by one thread at a time; several threads may
 * each have their own. Its memory comes from malloc: 4 numbers of single precision for each parameter of a Gaussian, 59
 * of those, and what a step needs for one photograph. */
#ifndef FXS_FIT_H
#define FXS_FIT_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "camera_file.h"
#include "pack.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_fit fxs_fit;

/* A photograph and the camera that took it: a perspective one, of the pixels' size, that fxs_camera_from_view takes. */
typedef struct fxs_fit_photo {
    fxs_file_view view;
    const uint8_t *pixels;         /* red, green, blue, rows from the top without gaps; stays until the fit is freed */
} fxs_fit_photo;

/* Where a Gaussian begins. */
typedef struct fxs_fit_point {
    float position[3];             /* scene units */
    uint8_t colour[3];             /* red, green, blue */
} fxs_fit_point;

enum fxs_fit_recipe {
    FXS_FIT_REFERENCE = 0,         /* Kerbl et al. 2023, and its reference code of 2025 */
    FXS_FIT_MCMC = 1,              /* Kheradmand et al. 2024: up to max_gaussians, of which it makes use of all */
    FXS_FIT_FAST = 2               /* the reference's, shorter, from small photographs to large ones */
};

typedef struct fxs_fit_options {
    enum fxs_fit_recipe recipe;
    uint32_t steps;                /* 1 and more; 30,000. Fewer of reference and mcmc are the beginning of 30,000;
                                      fast fits its course to them */
    int sh_degree;                 /* 0 to 3; 3 */
    size_t max_gaussians;          /* 2^22; where more are to be cloned and split, those of the largest gradients are */
    uint64_t seed;
    uint32_t batch;                /* photographs of a step, whose gradients are added up: 1 to 8; 0: one for each
                                      device, or one */
    uint8_t background[3];
    enum fxs_cutoff cutoff;
    enum fxs_profile profile;      /* that fxs_fit_pack packs by, and that the last tenth of the steps fits */
    unsigned cpu;                  /* instruction sets that may be used, of enum fxs_cpu; all */
    fxs_run_fn *run;               /* null: one thread */
    void *pool;
    uint32_t threads;              /* that run uses, 1 to 64; 0: 1 */
    fxs_clock_fn *clock;           /* null: no times are reported */
    float extent;                  /* of the scene, that learning rates go by; 0: that of the photographs */
    uint32_t block, blocks;        /* which part of a larger fit this is, up to 65535: a saved fit goes on only as the
                                      same; 0, 0: no part */
    uint32_t device_count;         /* NVIDIA GPUs that make the steps, each as many photographs of a batch; 0: the
                                      processor does. The scene does not depend on it */
    int devices[8];                /* their numbers */
    uint64_t max_memory;           /* bytes that are taken of each device, at most; 0: any */
} fxs_fit_options;

/* The values that the comments above name, 0 where there is none: recipe reference, one thread. */
void fxs_fit_options_init(fxs_fit_options *options);

/* The steps that a recipe is meant for: 30,000, fast 8,000. And its max_gaussians: 2^22, mcmc 1,000,000, fast
   250,000. */
uint32_t fxs_fit_recipe_steps(enum fxs_fit_recipe recipe);
size_t fxs_fit_recipe_gaussians(enum fxs_fit_recipe recipe);

typedef struct fxs_fit_report {
    double absolute, dissimilar;   /* means of |a - b| and of 1 - SSIM over pixels and channels */
    uint64_t entries;
    uint32_t visible;
    size_t gaussians;              /* after the step */
    uint64_t nanoseconds[6];       /* project, bin, blend, loss, back, update; with a clock */
} fxs_fit_report;

/* Copies all but the photographs' pixels. *fit is for fxs_fit_free, and null after an error: FXS_ERR_ARGUMENT (an
   option, a camera, no photographs, no points, none before a camera), FXS_ERR_MEMORY, and with devices FXS_ERR_DEVICE,
   FXS_ERR_UNSUPPORTED where the library is without CUDA. Of more points than max_gaussians as many are taken, evenly by
   their order. */
int fxs_fit_create(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                   size_t point_count, const fxs_fit_options *options, fxs_message *message);
void fxs_fit_free(fxs_fit *fit);      /* null is allowed */

/* One step. `report` may be null: then a device need not have completed it when this returns, and works on while the
   next ones are asked for; an error may be that of a step before. Errors: FXS_ERR_MEMORY, FXS_ERR_DEVICE: then the fit
   can only be freed. */
int fxs_fit_step(fxs_fit *fit, fxs_fit_report *report, fxs_message *message);

/* Steps that were made. */
uint32_t fxs_fit_steps(const fxs_fit *fit);

/* The options that it goes by: after fxs_fit_resume, those of the file. */
const fxs_fit_options *fxs_fit_options_of(const fxs_fit *fit);

/* The Gaussians as they are, for fxs_scene_file_open_gaussians; valid until the next step. Errors, of this and the next
   two beside their own: FXS_ERR_DEVICE, FXS_ERR_MEMORY, as of fxs_fit_step. */
int fxs_fit_gaussians(fxs_fit *fit, fxs_gaussian_source *gaussians, fxs_message *message);

/* Packs them by the options' profile: what the renderer draws, and what is written to a .fxs. Errors and ownership as
   of fxs_pack. `report` may be null. */
int fxs_fit_pack(fxs_fit *fit, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message);

/* Writes all of the fit's state to a file, in the same bytes on every machine. Until it is complete and on the disk, an
   earlier file of that name stays as it is (output.h). Errors: FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_fit_save(fxs_fit *fit, const char *path, fxs_message *message);

/* fxs_fit_create from such a file, with the same photographs: its further steps are those of the fit that was saved. Of
   `options`, what says how it is computed is taken (cpu, run, pool, threads, clock, devices and their count,
   max_memory), and `steps` where that is not 0; the rest is the file's. The batch that was saved must be a multiple of
   the devices. Errors: FXS_ERR_FILE where the file is no such file, damaged, or of other photographs (pixels, cameras,
   their order; names do not matter); FXS_ERR_VERSION where it is of another version; else those of fxs_fit_create. What
   is allocated is in proportion to the file. */
int fxs_fit_resume(fxs_fit **fit, const char *path, const fxs_fit_photo *photos, size_t photo_count,
                   const fxs_fit_options *options, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
