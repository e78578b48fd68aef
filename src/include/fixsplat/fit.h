/* Fits a scene to photographs. The same photographs, options and seed give the same scene, byte for byte, with any
 * number of threads, compiler and processor.
 *
 *     fxs_photos_options how;
 *     fxs_photos_options_init(&how);
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
 *     fxs_start_choose(scene.data, scene.bytes, &message);
 *     fxs_fit_destroy(fit);
 *     fxs_photos_free(&photos);
 *
 * Between two steps, the program may show the scene, save the fit or stop. Functions return 0, or an error and a
 * message. One thread at a time may use a fit; several threads may each have their own. A fit takes memory from malloc:
 * 4 floats for each of the 59 parameters of a Gaussian, and buffers for the step of one photograph. */
#ifndef FXS_FIT_H
#define FXS_FIT_H

#include <stddef.h>
#include <stdint.h>

#include "camera.h"
#include "pack.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_fit fxs_fit;

/* A photograph for a fit, with its camera. The camera is perspective, has the photograph's size, and is accepted by
   fxs_camera_from_view. */
typedef struct fxs_fit_photo {
    fxs_view view;
    const uint8_t *pixels;         /* pixels of the photograph: red, green, blue; rows from the top without padding. The
                                      caller keeps them until the fit is freed */
    double exposure;               /* relative exposure of the photograph: time * ISO / f^2, in any unit that all
                                      photographs share; 0: unknown. It gives the start value of the exposure fit */
    const uint8_t *mask;           /* mask: one byte per pixel, rows as in the photograph. 0: the pixel is ignored, and
                                      the fit does not depend on its colour. Null: no mask */
} fxs_fit_photo;

/* A point of the scene; the fit starts with a Gaussian at each point. */
typedef struct fxs_fit_point {
    float position[3];             /* scene units */
    uint8_t colour[3];             /* colour of the point: red, green, blue */
} fxs_fit_point;

enum fxs_fit_recipe {
    FXS_FIT_REFERENCE = 0,         /* fits by the method of Kerbl et al. 2023 as in their code of 2025, but splits
                                      Gaussians along the longest axis */
    FXS_FIT_MCMC = 1,              /* fits by the method of Kheradmand et al. 2024: dead Gaussians are relocated, and
                                      their number grows to max_gaussians. Small versions of the photographs come first,
                                      then large ones */
    FXS_FIT_FAST = 2               /* fits like FXS_FIT_MCMC, with fewer steps and Gaussians by default */
};

#define FXS_FIT_SKY 20000          /* a number of sky directions that suits most sets of photographs; the maximum is
                                      FXS_FIT_SKY_MOST */
#define FXS_FIT_SKY_MOST 1000000

/* How a fit corrects exposure differences between photographs. */
enum fxs_fit_exposure {
    FXS_FIT_EXPOSURE_NONE = 0,     /* no correction: all photographs have the same exposure */
    FXS_FIT_EXPOSURE_GAIN = 1,     /* corrects gain and colour balance for each photograph: fits log2 of three factors
                                      (red, green, blue) that multiply the picture before it is compared with the
                                      photograph. The mean of each over the photographs is 0. From 30 photographs on,
                                      the part that is linear in the cameras' directions keeps its start value. The
                                      scene contains no correction. The start value is 0. If the exposure of every
                                      photograph is known, it is log2(exposure) / 2.2 minus the mean of this over all
                                      photographs, as pixel values grow about as light^(1 / 2.2). White in a photograph
                                      counts as clipped: the picture may be brighter */
    FXS_FIT_EXPOSURE_AFFINE = 2    /* corrects each photograph by an affine map of colours: 3x3 factors and three
                                      constants, as in the 2024 code of Kerbl et al. The mean of these maps over the
                                      photographs is the identity map */
};

typedef struct fxs_fit_options {
    uint32_t size;
    enum fxs_fit_recipe recipe;    /* initially fast */
    uint32_t steps;                /* number of steps of the fit, 1 or more; initially 8,000. The recipes mcmc and fast
                                      adapt their schedule to it. The recipe reference with fewer than 30,000 steps is
                                      the beginning of a fit with 30,000 */
    int sh_degree;                 /* SH degree of the fitted scene, 0 to 3; initially 3 */
    size_t max_gaussians;          /* largest number of Gaussians; initially 250,000. Near this limit, the recipe
                                      reference splits or copies the Gaussians with the largest gradients first */
    uint64_t seed;
    uint32_t batch;                /* number of photographs per step, 1 to 8; their gradients are added up. 0: one per
                                      device, or one on the processor */
    uint8_t background[3];
    enum fxs_cutoff cutoff;
    enum fxs_profile profile;      /* profile (packed format) of fxs_fit_pack; the last tenth of the steps fits the
                                      codes of this profile */
    unsigned cpu;                  /* instruction sets that the fit may use, as bits of enum fxs_cpu; initially all */
    fxs_workers workers;
    fxs_clock_fn *clock;           /* clock for the times in reports; null: no times are reported */
    float extent;                  /* size of the scene, which scales learning rates; 0: computed from the
                                      photographs */
    uint32_t block, blocks;        /* number of this block and number of blocks, up to 65535, if the fit is a block
                                      (spatial part) of a larger fit. A saved fit can only be resumed with the same two
                                      numbers. 0, 0: not a block */
    uint64_t coarse;               /* for a block (spatial part) of a larger fit: fxs_fit_coarse_number of the coarse
                                      fit that the block continues. A saved fit can only be resumed with the same
                                      number. 0: none */
    uint32_t device_count;         /* number of GPUs that share the photographs of a step evenly; 0: the processor makes
                                      the steps. The fitted scene does not depend on this number */
    int devices[8];                /* numbers of the GPUs to use: NVIDIA GPUs through CUDA, unless `vulkan` is set */
    uint64_t max_memory;           /* limit of memory on each GPU, bytes; 0: no limit */
    enum fxs_fit_exposure exposure;    /* how exposure differences are corrected, for a whole fit; a block uses the
                                          exposures of its coarse fit */
    int refine_poses;              /* 1: refines the photographs' camera poses together with the scene, from step 501
                                      on; fxs_fit_pose_photos returns the refined poses. For a whole fit; a block uses
                                      the poses of its coarse fit */
    int antialiased;               /* 1: fits for views at other distances or sizes than the photographs (Mip-Splatting,
                                      Yu et al. 2024). Opacities then compensate for the dilation, a blur that the
                                      renderer adds to each Gaussian, and the scene records this. No sigma is below
                                      0.447 pixels in the photograph that shows the Gaussian largest. A block uses its
                                      coarse fit's setting */
    uint32_t sky;                  /* number of sky directions, at most FXS_FIT_SKY_MOST, spread evenly around the
                                      cameras (spherical Fibonacci lattice). For each direction that photographs show
                                      and that has no points, the fit starts with a distant Gaussian in the photographs'
                                      colour. Beyond the extent, sizes are measured as angles from the cameras. For a
                                      whole fit; must be 0 for a block, which gets the sky of its coarse fit. 0: no
                                      sky */
    int surfaces;                  /* 1: fits the scene for surfaces: flattens Gaussians along their shortest axis, and
                                      turns these axes towards the normals of the rendered depths. For a mesh of the
                                      scene; costs some PSNR and time. A block uses its coarse fit's setting. 0: no */
    int vulkan;                    /* 1: the one device is a GPU of any maker, through Vulkan 1.1. devices[0] is its
                                      number among Vulkan's devices, discrete GPUs first. It needs workgroups of 256
                                      threads with 32 KiB of memory, and 8 storage buffers. 0: no */
} fxs_fit_options;

/* Sets the options to their initial values: those that the comments of fxs_fit_options name, and 0 in the other fields
   (one thread). */
FXS_API void fxs_fit_options_init(fxs_fit_options *options, uint32_t size);
#define fxs_fit_options_init(options) fxs_fit_options_init(options, (uint32_t)sizeof *(options))

/* Return the defaults of a recipe (method of fitting). Number of steps: 30,000; fast 8,000. Largest number of
   Gaussians: reference 2^22, mcmc 1,000,000, fast 250,000. */
FXS_API uint32_t fxs_fit_recipe_steps(enum fxs_fit_recipe recipe);
FXS_API size_t fxs_fit_recipe_gaussians(enum fxs_fit_recipe recipe);

typedef struct fxs_fit_report {
    double absolute, dissimilar;   /* loss of the step: means of |picture - photograph| and of 1 - SSIM over pixels and
                                      channels; ignored pixels count as 0 */
    uint64_t entries;              /* number of splats (projected Gaussians) in the lists of all tiles */
    uint32_t visible;              /* number of Gaussians that the picture shows: those with a splat on a tile */
    size_t gaussians;              /* number of Gaussians after the step */
    uint64_t nanoseconds[6];       /* times of the parts of a step in nanoseconds: project, bin, blend, loss, backward
                                      pass, update; 0 without a clock */
} fxs_fit_report;

/* Creates a fit. It copies its arguments, except the photographs' pixels and masks. Of more than max_gaussians points,
   the fit uses max_gaussians of them, evenly spaced in their order. fxs_fit_destroy frees *fit, which is null after an
   error. Errors: FXS_ERR_ARGUMENT (an option, a camera, no photographs, no points, or none in front of a camera),
   FXS_ERR_MEMORY; with devices also FXS_ERR_DEVICE, and FXS_ERR_UNSUPPORTED if the library has no CUDA. */
FXS_API int fxs_fit_create(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                           size_t point_count, const fxs_fit_options *options, fxs_message *message);
FXS_API void fxs_fit_destroy(fxs_fit *fit);      /* frees a fit; `fit` may be null */

/* Makes one step of a fit. `report` may be null; then a device may still be working on the step when the function
   returns, and a later call may return the step's error. After an error, FXS_ERR_MEMORY or FXS_ERR_DEVICE, the fit can
   only be freed. */
FXS_API int fxs_fit_step(fxs_fit *fit, fxs_fit_report *report, fxs_message *message);

/* Returns the number of steps that a fit has made so far. */
FXS_API uint32_t fxs_fit_steps(const fxs_fit *fit);

/* Returns the options that a fit uses. After fxs_fit_resume, most of them come from the saved file. */
FXS_API const fxs_fit_options *fxs_fit_options_of(const fxs_fit *fit);

/* Replaces the views (cameras) of `photos` by the poses that the fit has refined. `photos` are the photographs that the
   fit was created with, with their original views. Does nothing without the option refine_poses. Errors: as
   fxs_fit_gaussians. */
FXS_API int fxs_fit_pose_photos(fxs_fit *fit, fxs_fit_photo *photos, fxs_message *message);

/* Gives the current Gaussians of a fit as a source for fxs_scene_file_open_gaussians; the source is valid until the
   next step. This function, fxs_fit_pack and fxs_fit_crop_to_subject may also return FXS_ERR_DEVICE or FXS_ERR_MEMORY,
   like fxs_fit_step. */
FXS_API int fxs_fit_gaussians(fxs_fit *fit, fxs_gaussian_source *gaussians, fxs_message *message);

/* Packs the current Gaussians of a fit, with the profile in its options, for rendering or for an .fxs file. Errors and
   ownership are as in fxs_pack. `report` may be null. */
FXS_API int fxs_fit_pack(fxs_fit *fit, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message);

/* The subject of a fit, as a sphere: fxs_fit_crop_to_subject drops the Gaussians outside. */
typedef struct fxs_fit_subject {
    double middle[3], radius;      /* scene units */
    size_t dropped;                /* number of Gaussians that the crop dropped */
} fxs_fit_subject;

/* Crops a finished fit to its subject (a sphere that the cameras look at): drops Gaussians whose distance from the
   sphere's middle plus largest sigma exceeds its radius. Returns 0, or an error and a message: as fxs_fit_find_subject;
   FXS_ERR_ARGUMENT if no Gaussian would be left, with the fit unchanged; FXS_ERR_MEMORY or FXS_ERR_DEVICE like
   fxs_fit_step. */
FXS_API int fxs_fit_crop_to_subject(fxs_fit *fit, fxs_fit_subject *subject, fxs_message *message);

/* Stores a start view (the first camera for viewers) in a packed scene at `data`, for fxs_file_write. It is the view of
   the most level photograph (the first, if several are equal), rolled upright, where up is fxs_views_up of all
   photographs. If their up directions cancel each other, it is the view of the first photograph. fxs_start_choose
   (renderer.h) then finds a view that shows more of the scene, with the up direction of the photographs.
   Errors: as fxs_view_to_start; FXS_ERR_ARGUMENT without photographs. */
FXS_API int fxs_fit_start_view(const fxs_fit_photo *photos, size_t photo_count, void *data, fxs_message *message);

/* Saves the whole state of the fit to a file, with the same bytes on every machine. An existing file of that name is
   replaced only once the new one is complete and on disk (system.h). Errors: FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_fit_save(fxs_fit *fit, const char *path, fxs_message *message);

/* Resumes a saved fit with the same photographs: further steps give the same result as without the interruption.
   `options` supplies the means of computation (cpu, workers, clock, devices and device_count, max_memory),
   and the number of steps if its `steps` is not 0; the other options come from the file. The saved batch must be a
   multiple of device_count. Errors: FXS_ERR_FILE if the file is not a saved fit, is damaged, or belongs to another
   block or to photographs with other pixels, masks, cameras or order (names do not matter); FXS_ERR_VERSION if it has
   another version; errors of fxs_fit_create. Allocated memory is in proportion to the file. */
FXS_API int fxs_fit_resume(fxs_fit **fit, const char *path, const fxs_fit_photo *photos, size_t photo_count,
                           const fxs_fit_options *options, fxs_message *message);

/* ---- Photographs ------------------------------------------------------------------------------------------------- */

/* Reads photographs with their cameras, for a fit:

   - COLMAP: a folder with images and sparse/0 or sparse (.bin or .txt); or the folder or a file of the model, with the
     images in that folder or up to two folders above it. The points are in points3D.bin or .txt in the folder of the
     model.
   - nerfstudio: a transforms.json, or a folder with one. The paths "file_path" (a photograph) and "ply_file_path" (the
     points) are relative to its folder. "applied_transform" was already applied to cameras and points. With
     "train_filenames", only those photographs are fitted; "test_filenames", or else "val_filenames", are held out and
     never fitted.
   - Blender: transforms_train.json, or a folder with one; transforms_test.json next to it, or else transforms_val.json,
     lists the held-out photographs.
   - Inria: a cameras.json, or a folder with one; images next to it or in images, the points in input.ply next to it.
   - Metashape's .xml, RealityCapture's .csv: images next to it or in images, the points in points.ply next to it.
   - Bundler: a .out, with list.txt or NAME.list.txt next to it, images next to it or in images; it contains the points.

   In a folder, the first of these is read: sparse/0, sparse, images.bin or .txt, transforms.json,
   transforms_train.json, cameras.json, cameras.xml, cameras.csv, bundle.out. Image names may lack their ending (.png,
   .jpg, .jpeg, or these in capitals).

   The result is the same on every machine, for any number of threads (image.h says how for pixels):

   - Size: a photograph may have another size than its camera, but its proportions must be the same to within a pixel.
     If the file states no size, the photograph's is used.
   - Orientation: a photograph is used as stored if it has its camera's proportions; square photographs always are. If
     it has them only after the quarter turn that its EXIF states, it is turned. EXIF that is damaged or out of range is
     ignored.
   - Lens distortion is removed (every model of COLMAP 4 except EQUIRECTANGULAR; k1 to k6, p1, p2, sx1 and sy1 of
     transforms.json): each pixel of a pinhole picture is interpolated between the four pixels around its distorted
     place. Principal point and size stay. The focal lengths are scaled so that the picture has no gaps: by a factor of
     1/2 to 2, or for a fisheye by any factor with which each side of the picture is at most 60 degrees from the axis.
   - A photograph with alpha becomes colour * alpha + background * (1 - alpha), in the 8-bit values of the file.
   - Masks mark ignored pixels (fxs_fit_photo). They are in a folder masks next to the folder images, or next to the
     .json file: for images/a.jpg that is masks/a.jpg.png, as in COLMAP, or masks/a.png. "mask_path" in a
     transforms.json has priority. A mask has the size of its photograph. White pixels are used (the mean of red, green
     and blue, times alpha, is 128 or more). A photograph without a mask is used completely. A pixel of the pinhole
     picture is used if all pixels that it is interpolated from are used; a pixel of a reduced picture, if all pixels
     that it averages are used.
   - Larger pictures are reduced by area averaging. Blending with the background and averaging are rounded once,
     together, half up.

   A set without points gets 100,000 grey points at random positions: in the cube from -1.3 to 1.3 if transforms.json
   states no size (Blender's synthetic scenes), else in a cube around the cameras, three times as wide as the cameras'
   bounding box (Kerbl et al. 2023), or 3 units wide if all cameras are in one place. */

/* A callback that hears why photographs were left out. `why` is one line with their names and the fault, valid during
   the call. */
typedef void fxs_left_out_fn(void *argument, const char *why);

/* How photographs are read. With all fields 0, no photograph is held out, and photographs wider or higher than 1600
   pixels are reduced to 1600. */
typedef struct fxs_photos_options {
    uint32_t size;
    int resolution;                /* largest width or height of a photograph in pixels; larger ones are reduced to it;
                                      0: 1600 */
    uint32_t hold_out;             /* 0: no photograph is held out (kept from the fit for comparison). n: every n-th by
                                      name is held out, from the first on. If the files name test photographs, any n
                                      above 0 holds out the named ones instead */
    uint8_t background[3];         /* colour behind the transparent parts of photographs */
    const char *masks;             /* folder of masks; null: the masks are found next to the photographs; "": no
                                      masks */
    int invert_masks;              /* 1: white pixels of a mask are ignored, instead of black ones */
    int ignore_transparent;        /* 1: pixels of photographs with an alpha below 128 are ignored, and the others
                                      become opaque */
    int held_out_alone;            /* 1: if photographs are held out, only the held-out ones are read, and no points:
                                      `fit` is empty */
    int skip_bad;                  /* 1: photographs that cannot be read are left out and counted, instead of an
                                      error */
    fxs_left_out_fn *left_out;     /* called for each photograph left out, in the order of names, and before that for
                                      each folder that has photographs without a camera. It runs on the thread of
                                      `progress`; may be null */
    void *left_out_argument;       /* first argument of the callback left_out */
    uint64_t seed;                 /* seed of the random points that a set without points gets */
    fxs_workers workers;           /* threads that read photographs; the field `count` is ignored */
    fxs_progress progress;         /* progress callback; it runs on the thread that called fxs_photos_read */
} fxs_photos_options;
FXS_INIT(fxs_photos_options)

typedef struct fxs_photos {
    fxs_fit_photo *fit, *held_out; /* photographs to fit, and held-out ones, each sorted by the bytes of their names.
                                      `fit` has at least one photograph, except with the option held_out_alone */
    size_t fit_count, held_out_count;
    fxs_fit_point *points;
    size_t point_count;
    int points_are_random;         /* 1: the set of photographs had no points, so `points` are random */
    size_t skipped;                /* number of photographs left out because of the option skip_bad */
    size_t with_mask, without_mask;    /* numbers of photographs with a mask and without one, in a set that has masks;
                                          else both 0 */
} fxs_photos;

/* Reads a set of photographs. During the call, each thread holds one photograph, and its mask, in the size of the file.
   The reduced photographs take 3 bytes a pixel, their masks 1.

   Returns 0 and photographs that fxs_photos_free frees, or an error and a message, with *photos all 0. Errors:
   - FXS_ERR_FILE: a file is missing or damaged (the message names the first such photograph in the order of names; with
     skip_bad the undamaged ones are used, if any is left); a photograph has other proportions than its camera; a camera
     is invalid, is not perspective or has a lens that cannot be undone; a mask has another size than its photograph, or
     has no white but is not all black; the options' folder `masks` contains no mask; no photograph, or no pixel of any,
     is left to fit; a point is not finite or beyond 2^27 units; all points lie behind all cameras; or all cameras are
     more than 2^16 units from the origin and 16 times closer to each other than to the origin, which exceeds single
     precision.
   - FXS_ERR_STOPPED: by `progress`.
   - FXS_ERR_CAMERA: a camera is out of the renderer's range.
   - FXS_ERR_ARGUMENT: the resolution.
   - FXS_ERR_UNSUPPORTED: fixsplat was built without cJSON, expat or a library of image.h that the files need.
   - FXS_ERR_MEMORY.

   All-black photographs are accepted. */
FXS_API int fxs_photos_read(const char *path, const fxs_photos_options *options, fxs_photos *photos,
                            fxs_message *message);
FXS_API void fxs_photos_free(fxs_photos *photos);

/* ---- Levels of detail -------------------------------------------------------------------------------------------- */

/* Refines the levels of detail of a packed scene: fits coarse Gaussians to pictures of the fine ones. For each node of
   the tree, it also measures how much the node's children improve these pictures, occlusion included. The result is a
   function of the scene, the views and the number of steps, the same with any number of threads and on every processor.
   docs/convert.md has measurements. */

#define FXS_REFINE_STEPS 200u          /* usual number of refinement steps for each level of detail */
#define FXS_REFINE_STEPS_MOST 100000u  /* largest number of refinement steps for each level of detail */
#define FXS_REFINE_VIEWS 64u           /* most views */
#define FXS_REFINE_MEASURED 16u        /* largest number of views for a refinement without steps, which only measures */

typedef struct fxs_refine_options {
    uint32_t size;
    const fxs_context *context;        /* context that renders the pictures; its workers also make the steps. Not
                                          null */
    uint32_t steps;                    /* number of steps for each level of detail, at most FXS_REFINE_STEPS_MOST. 0:
                                          leaves the Gaussians unchanged and only measures the gain of drawing each
                                          node's children */
    /* Cameras that show the scene as viewers will see it; null: none. Only perspective views are used, at most
       FXS_REFINE_VIEWS (without steps FXS_REFINE_MEASURED), evenly spaced in the array. */
    const fxs_view *views;
    size_t view_count;
    unsigned cpu;                      /* instruction sets that the steps may use, as bits of enum fxs_cpu */
    fxs_progress progress;
} fxs_refine_options;
FXS_INIT(fxs_refine_options)

/* Refines the levels of detail of the packed scene of `bytes` bytes at `data` (aligned to 64), in place. Call
   fxs_file_write or fxs_file_seal afterwards. A scene without a tree is unchanged. Without perspective views, the
   function uses views from around and inside the box of the scene's visible part. It takes 1.3 KB for each Gaussian of
   the finest refined level, and up to 200 MB of pictures, or 1.4 GB for a scene of more than a million Gaussians;
   without steps an eighth of that. Returns 0, or an error and a message; levels may then be partly refined, and the
   scene can still be drawn. Errors: FXS_ERR_ARGUMENT, FXS_ERR_STOPPED, FXS_ERR_MEMORY, and the errors of
   fxs_scene_open, also for nodes. */
FXS_API int fxs_refine(void *data, size_t bytes, const fxs_refine_options *options, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
