/* Reads photographs with their cameras, for a fit:
 *
 * - COLMAP: a folder with images and sparse/0 or sparse (.bin or .txt); or the folder or a file of the model, with the
 *   images in that folder or up to two folders above it. The points are in points3D.bin or .txt in the folder of the
 *   model.
 * - nerfstudio: a transforms.json, or a folder with one. The paths "file_path" (a photograph) and "ply_file_path" (the
 *   points) are relative to its folder. "applied_transform" was already applied to cameras and points. With
 *   "train_filenames", only those photographs are fitted; "test_filenames", or else "val_filenames", are held out and
 *   never fitted.
 * - Blender: transforms_train.json, or a folder with one; transforms_test.json next to it, or else transforms_val.json,
 *   lists the held-out photographs.
 * - Inria: a cameras.json, or a folder with one; images next to it or in images, the points in input.ply next to it.
 * - Metashape's .xml, RealityCapture's .csv: images next to it or in images, the points in points.ply next to it.
 * - Bundler: a .out, with list.txt or NAME.list.txt next to it, images next to it or in images; it contains the points.
 *
 * In a folder, the first of these is read: sparse/0, sparse, images.bin or .txt, transforms.json,
 * transforms_train.json, cameras.json, cameras.xml, cameras.csv, bundle.out. Image names may lack their ending (.png,
 * .jpg, .jpeg, or these in capitals).
 *
 * The result is the same on every machine, for any number of threads (image_file.h says how for pixels):
 *
 * - Size: a photograph may have another size than its camera, but its proportions must be the same to within a pixel.
 *   If the file states no size, the photograph's is used.
 * - Orientation: a photograph is used as stored if it has its camera's proportions; square photographs always are. If
 *   it has them only after the quarter turn that its EXIF states, it is turned. EXIF that is damaged or out of range is
 *   ignored.
 * - Lens distortion is removed (every model of COLMAP 4 except EQUIRECTANGULAR; k1 to k6, p1, p2, sx1 and sy1 of
 *   transforms.json): each pixel of a pinhole picture is interpolated between the four pixels around its distorted
 *   place. Principal point and size stay. The focal lengths are scaled so that the picture has no gaps: by a factor of
 *   1/2 to 2, or for a fisheye by any factor with which each side of the picture is at most 60 degrees from the axis.
 * - A photograph with alpha becomes colour * alpha + background * (1 - alpha), in the 8-bit values of the file.
 * - Masks mark ignored pixels (fxs_fit_photo). They are in a folder masks next to the folder images, or next to the
 *   .json file: for images/a.jpg that is masks/a.jpg.png, as in COLMAP, or masks/a.png. "mask_path" in a
 *   transforms.json has priority. A mask has the size of its photograph. White pixels are used (the mean of red, green
 *   and blue, times alpha, is 128 or more). A photograph without a mask is used completely. A pixel of the pinhole
 *   picture is used if all pixels that it is interpolated from are used; a pixel of a reduced picture, if all pixels
 *   that it averages are used.
 * - Larger pictures are reduced by area averaging. Blending with the background and averaging are rounded once,
 *   together, half up.
 *
 * A set without points gets 100,000 grey points at random positions: in the cube from -1.3 to 1.3 if transforms.json
 * states no size (Blender's synthetic scenes), else in a cube around the cameras, three times as wide as the cameras'
 * bounding box (Kerbl et al. 2023), or 3 units wide if all cameras are in one place.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_FIT_PHOTOS_H
#define FXS_FIT_PHOTOS_H

#include "fit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reports why photographs were left out: one line with their names and the fault, valid during the call. */
typedef void fxs_left_out_fn(void *argument, const char *why);

/* All fields 0: no photograph is held out; photographs wider or higher than 1600 pixels are reduced to 1600. */
typedef struct fxs_photos_options {
    int resolution;                /* largest width or height, pixels; 0: 1600 */
    uint32_t hold_out;             /* 0: no photograph is held out; n: every n-th by name, from the first on. If the
                                      files name test photographs, any n above 0 holds out the named ones instead */
    uint8_t background[3];         /* behind photographs with alpha */
    const char *masks;             /* folder of masks; null: found as described above; "": no masks */
    int invert_masks;              /* 1: white means ignored */
    int ignore_transparent;        /* 1: pixels of photographs with an alpha below 128 are ignored, and the others
                                      become opaque */
    int held_out_alone;            /* 1: if photographs are held out, only the held-out ones are read, and no points:
                                      `fit` is empty */
    int skip_bad;                  /* 1: photographs that cannot be read are left out and counted */
    fxs_left_out_fn *left_out;     /* called for each photograph left out, in the order of names, and before that for
                                      each folder that has photographs without a camera; on the thread of `progress`;
                                      may be null */
    uint64_t seed;                 /* for random points */
    fxs_run_fn *run;               /* null: one thread */
    void *pool;                    /* first argument of run */
    fxs_progress_fn *progress;     /* may be null; called on the thread that called fxs_photos_read */
    void *argument;                /* first argument of progress and left_out */
} fxs_photos_options;

typedef struct fxs_photos {
    fxs_fit_photo *fit, *held_out; /* sorted by the bytes of their names; `fit` has at least one, except with
                                      held_out_alone */
    size_t fit_count, held_out_count;
    fxs_fit_point *points;
    size_t point_count;
    int points_are_random;         /* 1: the set had no points */
    size_t skipped;                /* photographs left out by skip_bad */
    size_t with_mask, without_mask;    /* photographs with and without a mask, in a set that has masks */
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
   - FXS_ERR_UNSUPPORTED: fixsplat was built without cJSON, expat or a library of image_file.h that the files need.
   - FXS_ERR_MEMORY.

   All-black photographs are accepted. */
FXS_API int fxs_photos_read(const char *path, const fxs_photos_options *options, fxs_photos *photos,
                            fxs_message *message);
FXS_API void fxs_photos_free(fxs_photos *photos);

/* Makes the points of a set without points, for photographs that a program has in memory: 100,000 grey points in the
   cube around the cameras. Returns 0 and points that the caller frees, or an error and a message, with *points null:
   FXS_ERR_ARGUMENT (no photographs), FXS_ERR_FILE if the cube reaches beyond 2^27 units, FXS_ERR_MEMORY. */
FXS_API int fxs_photos_random_points(const fxs_fit_photo *photos, size_t photo_count, uint64_t seed,
                                     fxs_fit_point **points, size_t *point_count, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
