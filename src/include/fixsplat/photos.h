/* Photographs with the cameras that took them, for a fit:
 *
 * - COLMAP: a folder with sparse/0 or sparse (.bin or .txt) and images; or that model's folder, or a file of it, with
 *   images there or up to two folders above. Points: points3D.bin or .txt beside it.
 * - nerfstudio: a transforms.json, or a folder with one; "file_path" and "ply_file_path", its points, are relative to
 *   it.
 * - Blender: transforms_train.json, or a folder with one; transforms_test.json beside it has those held out.
 * - Inria: a cameras.json, or a folder with one, with images beside it or in images. Points: input.ply beside it.
 *
 * In a folder with several, the first of: sparse/0, sparse, images.bin or .txt, transforms.json, transforms_train.json,
 * cameras.json. Names of images may lack their ending (.png, .jpg, .jpeg, or these in capitals).
 *
 * What is read is the same on every machine, for any number of threads (image_file.h says why of the pixels):
 *
 * - A photograph may be of another size than its camera says, in the same proportion to a pixel; where transforms.json
 *   says no size, the photograph does.
 * - A lens (COLMAP's SIMPLE_RADIAL, RADIAL, OPENCV, OPENCV_FISHEYE and FULL_OPENCV; k1 to k6, p1 and p2 of
 *   transforms.json) is undone: each pixel of a pinhole's picture is taken from where the lens put it, between four
 *   pixels. Principal point and size stay; the focal lengths are scaled so that the picture is filled without gaps, by
 *   1/2 to 2.
 * - Alpha: colour times alpha and background times the rest, in the file's 8-bit values.
 * - Larger pictures are averaged down by area. Background and average are rounded once, half up.
 *
 * Where there are no points: 100,000 grey ones, at random in the cube of -1.3 to 1.3 where transforms.json says no size
 * (Blender's synthetic scenes), else in a cube around the cameras, three times as wide as their box (Kerbl et al.
 * 2023), or 3 units wide where all are in one place. */
#ifndef FXS_FIT_PHOTOS_H
#define FXS_FIT_PHOTOS_H

#include "fit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Why a photograph is left out: its file's name, and what is wrong with it; one line, valid during the call. */
typedef void fxs_left_out_fn(void *argument, const char *why);

/* All 0: every photograph is for the fit, at its own size but at most 1600 pixels wide or high. */
typedef struct fxs_photos_options {
    int resolution;                /* pixels of the longer side, at most; 0: 1600 */
    uint32_t hold_out;             /* 0: none is held out; else every n-th by name, from the first on, or,
                                      whatever n is, those of transforms_test.json where there is one */
    uint8_t background[3];         /* below photographs with alpha */
    int skip_bad;                  /* 1: photographs that cannot be read are left out, and counted */
    fxs_left_out_fn *left_out;     /* may be null; called as progress is, for each of them, by name in each list */
    uint64_t seed;                 /* of the points where the files have none */
    fxs_run_fn *run;               /* null: one thread */
    void *pool;                    /* first argument of run */
    fxs_progress_fn *progress;     /* may be null; called on the thread that called fxs_photos_read */
    void *argument;                /* first argument of progress and left_out */
} fxs_photos_options;

typedef struct fxs_photos {
    fxs_fit_photo *fit, *held_out; /* by name, in order of its bytes; never none to fit */
    size_t fit_count, held_out_count;
    fxs_fit_point *points;
    size_t point_count;
    int points_are_random;         /* 1: the files had none */
    size_t skipped;                /* photographs */
} fxs_photos;

/* Each thread holds one photograph as it is in its file; kept are 3 bytes for each pixel averaged down.

   Returns 0 and photographs that fxs_photos_free frees, or an error and a message, with photos all 0. Errors:
   FXS_ERR_FILE where a file is missing or damaged (a photograph: of several, the first by name, unless skip_bad leaves
   it out and others are left), a photograph is of another proportion than its camera, a camera cannot be drawn, is not
   a perspective one or has a lens that is not known or cannot be undone, none would be left to fit, a point is not
   finite or beyond 2^27 units, or all points lie behind all cameras; FXS_ERR_STOPPED by `progress`; FXS_ERR_CAMERA
   where a camera is out of the renderer's range; FXS_ERR_ARGUMENT (the resolution); FXS_ERR_UNSUPPORTED where this was
   built without cJSON, stb or libjpeg-turbo and the files need it; FXS_ERR_MEMORY. All-black photographs are as good
   as others. */
int fxs_photos_read(const char *path, const fxs_photos_options *options, fxs_photos *photos, fxs_message *message);
void fxs_photos_free(fxs_photos *photos);

#ifdef __cplusplus
}
#endif

#endif
