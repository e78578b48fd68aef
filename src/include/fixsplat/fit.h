/* Fits a scene to photographs. The same photographs, options and seed give the same scene, byte for byte, with any
 * number of threads, compiler and processor.
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
 *     fxs_fit_start_view(photos.fit, photos.fit_count, scene.data, &message);
 *     fxs_fit_free(fit);
 *     fxs_photos_free(&photos);
 *
 * Between two steps, the program may show the scene, save the fit or stop. Functions return 0, or an error and a
 * message. A fit is used by one thread at a time; several threads may each have a fit of their own. Its memory comes
 * from malloc: 4 floats for each of the 59 parameters of a Gaussian, and the memory of a step for one photograph.
 *
 * Stable from version 1.0 on. */
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

/* A photograph and its camera, a perspective camera of the photograph's size that fxs_camera_from_view accepts. */
typedef struct fxs_fit_photo {
    fxs_file_view view;
    const uint8_t *pixels;         /* red, green, blue; rows from the top without gaps; valid until the fit is freed */
    double exposure;               /* how much light it got, in any unit that is the same for all, as time * sensitivity /
                                      f-number^2; 0: not known. exposures begin with it */
    const uint8_t *mask;           /* null, or a byte for each of the pixels, likewise; 0: the pixel is ignored, and the
                                      fit does not depend on its colour */
} fxs_fit_photo;

/* A point at which the fit begins with a Gaussian. */
typedef struct fxs_fit_point {
    float position[3];             /* scene units */
    uint8_t colour[3];             /* red, green, blue */
} fxs_fit_point;

enum fxs_fit_recipe {
    FXS_FIT_REFERENCE = 0,         /* Kerbl et al. 2023, and its reference code of 2025, with splits along the longest
                                      axis */
    FXS_FIT_MCMC = 1,              /* Kheradmand et al. 2024: relocation, growing to max_gaussians; from small
                                      photographs to large ones */
    FXS_FIT_FAST = 2               /* the same with fewer steps and Gaussians */
};

#define FXS_FIT_SKY 20000          /* directions of a sky that suit most sets, and the most */
#define FXS_FIT_SKY_MOST 1000000

/* What a fit knows of the exposure of its photographs. */
enum fxs_fit_exposure {
    FXS_FIT_EXPOSURE_NONE = 0,     /* all have the same */
    FXS_FIT_EXPOSURE_GAIN = 1,     /* each has a gain and a colour balance, log2 of three factors that the fit finds: by
                                      these the picture is multiplied before it is compared with the photograph. Their
                                      means over the photographs are 0. The scene has none of them. They begin at 0;
                                      where the exposure of every photograph is known, the gain begins at 1 / 2.2 of its
                                      log2, as pixels have about that power of the light, less the mean over all. White
                                      of a photograph counts as white that was cut: the picture may be brighter */
    FXS_FIT_EXPOSURE_AFFINE = 2    /* the same with an affine map of colours for each: 3x3 factors and three constants,
                                      as in the code of Kerbl et al. of 2024, whose means over the photographs are
                                      those of a map that changes nothing */
};

typedef struct fxs_fit_options {
    enum fxs_fit_recipe recipe;    /* initially fast */
    uint32_t steps;                /* 1 or more; initially 8,000. mcmc and fast adapt their schedule to their number; in
                                      reference, fewer steps than 30,000 are the beginning of 30,000 */
    int sh_degree;                 /* 0 to 3; initially 3 */
    size_t max_gaussians;          /* initially 250,000; near the limit, the densification of reference takes the largest
                                      gradients first */
    uint64_t seed;
    uint32_t batch;                /* photographs of a step, whose gradients are added up: 1 to 8; 0: one for each
                                      device, or one in all */
    uint8_t background[3];
    enum fxs_cutoff cutoff;
    enum fxs_profile profile;      /* for fxs_fit_pack; the last tenth of the steps fits the codes of this profile */
    unsigned cpu;                  /* instruction sets that may be used, bits of enum fxs_cpu; initially all */
    fxs_run_fn *run;               /* null: one thread */
    void *pool;                    /* first argument of run */
    uint32_t threads;              /* threads that `run` uses, 1 to 64; 0: 1 */
    fxs_clock_fn *clock;           /* null: no times are reported */
    float extent;                  /* size of the scene, which scales learning rates; 0: found from the photographs */
    uint32_t block, blocks;        /* number of this block of a larger fit and their count, up to 65535; a saved fit
                                      can only be resumed with the same two. 0, 0: not a block */
    uint64_t coarse;               /* fxs_fit_coarse_number of the coarse fit that the block goes on from, which a saved
                                      fit can only be resumed with; 0: none */
    uint32_t device_count;         /* NVIDIA GPUs that share the photographs of a batch evenly; 0: the processor makes
                                      the steps. The scene does not depend on it */
    int devices[8];                /* numbers of these GPUs */
    uint64_t max_memory;           /* the most bytes to use on each device; 0: no limit */
    enum fxs_fit_exposure exposure;    /* of a whole fit; a block has that of its coarse fit */
    int refine_poses;              /* 1: the poses of the photographs' cameras are refined beside the scene, from step
                                      501 on; of a whole fit, as above. fxs_fit_pose_photos gives them */
    int antialiased;               /* 1: for other distances and sizes than the photographs' (Yu et al. 2024): opacities
                                      compensate the dilation, which the scene says of itself, and no Gaussian is finer
                                      than 0.447 pixels (sigma) of its finest photograph. A block is as its coarse
                                      fit */
    uint32_t sky;                  /* so many directions, FXS_FIT_SKY_MOST at most, are spread evenly around the cameras
                                      (spherical Fibonacci lattice). Where photographs look and no points lie, the fit
                                      begins with a Gaussian far away, of the photographs' colour, and sizes of what is
                                      farther than the extent are measured as they look from the cameras. Of a whole
                                      fit, as above. 0: no sky */
} fxs_fit_options;

/* Sets the initial values that the comments above name, and 0 for the others, which is one thread. */
FXS_API void fxs_fit_options_init(fxs_fit_options *options);

/* The number of steps that a recipe is made for (30,000; fast 8,000), and its max_gaussians (2^22; mcmc 1,000,000; fast
   250,000). */
FXS_API uint32_t fxs_fit_recipe_steps(enum fxs_fit_recipe recipe);
FXS_API size_t fxs_fit_recipe_gaussians(enum fxs_fit_recipe recipe);

typedef struct fxs_fit_report {
    double absolute, dissimilar;   /* means of |a - b| and of 1 - SSIM over pixels and channels; ignored pixels count
                                      as 0 */
    uint64_t entries;              /* splats in the lists of all tiles */
    uint32_t visible;              /* Gaussians that have a splat */
    size_t gaussians;              /* Gaussians after the step */
    uint64_t nanoseconds[6];       /* project, bin, blend, loss, backward pass, update; 0 without a clock */
} fxs_fit_report;

/* Begins a fit. It copies its arguments, except the pixels and masks of the photographs. Of more than max_gaussians
   points it takes that many, evenly spaced in their order. fxs_fit_free frees *fit, which is null after an error:
   FXS_ERR_ARGUMENT (an option, a camera, no photographs, no points, or none in front of a camera), FXS_ERR_MEMORY, with
   devices also FXS_ERR_DEVICE, and FXS_ERR_UNSUPPORTED where the library has no CUDA. */
FXS_API int fxs_fit_create(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                           size_t point_count, const fxs_fit_options *options, fxs_message *message);
FXS_API void fxs_fit_free(fxs_fit *fit);      /* null is allowed */

/* Makes one step. `report` may be null: then a device may still be working on the step when this function returns, and
   a later call may return the step's error. After an error, FXS_ERR_MEMORY or FXS_ERR_DEVICE, the fit can only be
   freed. */
FXS_API int fxs_fit_step(fxs_fit *fit, fxs_fit_report *report, fxs_message *message);

/* The number of steps made so far. */
FXS_API uint32_t fxs_fit_steps(const fxs_fit *fit);

/* The options in use; after fxs_fit_resume, most are from the file. */
FXS_API const fxs_fit_options *fxs_fit_options_of(const fxs_fit *fit);

/* The number of Gaussians that a sky began with: 0 where no photograph shows one, and in a fit that was resumed. */
FXS_API size_t fxs_fit_sky_count(const fxs_fit *fit);

/* Changes the views of these photographs, those of the fit with the views that it began with, to their refined poses;
   where no poses are refined, nothing. Errors as of fxs_fit_gaussians. */
FXS_API int fxs_fit_pose_photos(fxs_fit *fit, fxs_fit_photo *photos, fxs_message *message);

/* Gives the current Gaussians, for fxs_scene_file_open_gaussians; valid until the next step. This function and the next
   two may also return FXS_ERR_DEVICE or FXS_ERR_MEMORY like fxs_fit_step. */
FXS_API int fxs_fit_gaussians(fxs_fit *fit, fxs_gaussian_source *gaussians, fxs_message *message);

/* Packs the current Gaussians by the profile of the options, to be rendered or written as an .fxs file. Errors and
   ownership are those of fxs_pack. `report` may be null. */
FXS_API int fxs_fit_pack(fxs_fit *fit, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message);

/* What a fit is cropped to. */
typedef struct fxs_fit_subject {
    double middle[3], radius;      /* scene units */
    size_t dropped;                /* Gaussians, where it was cropped */
} fxs_fit_subject;

/* Finds the one thing that the cameras of a fit look at, a sphere. Its middle is the point that is nearest to the axes
   of all cameras (least squares); its radius is the median over the cameras of how far they see to the nearer edge of
   their picture at the depth of that point. Returns 0, or an error and a message: FXS_ERR_ARGUMENT where the cameras do
   not look at one thing (their axes are nearly parallel, or more than a quarter of them do not have the point in the
   middle half of their width and height), or FXS_ERR_MEMORY. */
FXS_API int fxs_fit_find_subject(const fxs_fit *fit, fxs_fit_subject *subject, fxs_message *message);

/* Leaves out of a fit that is at its end what lies around its subject: Gaussians that reach beyond the sphere by their
   largest sigma. Returns 0, or an error and a message, those above, and FXS_ERR_ARGUMENT and the fit as it was where
   nothing would be left; FXS_ERR_MEMORY or FXS_ERR_DEVICE like fxs_fit_step. */
FXS_API int fxs_fit_crop_to_subject(fxs_fit *fit, fxs_fit_subject *subject, fxs_message *message);

/* Keeps the view to begin with in a packed scene at `data`, for fxs_file_write: that of the photograph that was taken
   most level, the first of equal ones, by what is up in all of them (fxs_views_up), and rolled until that is up; that of
   the first where their directions cancel each other. Errors are those of fxs_view_to_start; FXS_ERR_ARGUMENT without
   photographs. */
FXS_API int fxs_fit_start_view(const fxs_fit_photo *photos, size_t photo_count, void *data, fxs_message *message);

/* Saves the whole state of the fit to a file, with the same bytes on every machine. An earlier file of that name is
   unchanged until the new one is complete and on the disk (output.h). Errors: FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_fit_save(fxs_fit *fit, const char *path, fxs_message *message);

/* Resumes a saved fit with the same photographs: its further steps are the same as without the interruption. `options`
   says how they are computed (cpu, run, pool, threads, clock, devices and their count, max_memory), and sets the number
   of steps where its `steps` is not 0; the other options are from the file. The saved batch must be a multiple of
   device_count. Errors: FXS_ERR_FILE where the file is not a saved fit, is damaged, or belongs to other photographs
   (pixels, masks, cameras, their order; names do not matter) or another block; FXS_ERR_VERSION where it has another
   version; and those of fxs_fit_create. The memory allocated is in proportion to the file. */
FXS_API int fxs_fit_resume(fxs_fit **fit, const char *path, const fxs_fit_photo *photos, size_t photo_count,
                           const fxs_fit_options *options, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
