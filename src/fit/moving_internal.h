/* The state of a fit that follows the moments of a moving scene (moving.h). */
#ifndef FXS_FIT_MOVING_INTERNAL_H
#define FXS_FIT_MOVING_INTERNAL_H

#include "fit_internal.h"

enum {
    STAYS, ASKED, ADDED            /* whether a Gaussian is tried: from the first step of a moment on, or later */
};

/* The poses of the Gaussians that move, in each fitted moment. Gaussians that stay take no memory for poses. */
enum { FXS_FIT_MOVED = 7 };        /* numbers of a pose: position, quaternion */
#define FXS_FIT_STILL UINT32_MAX

typedef struct fxs_fit_tracks {
    uint32_t *number;              /* track of each Gaussian, or FXS_FIT_STILL */
    uint32_t *gaussian;            /* Gaussian of each track */
    float **poses;                 /* for each moment, FXS_FIT_MOVED floats a track */
    size_t moments, count, room;
} fxs_fit_tracks;

struct fxs_fit_moving {
    float *before;                 /* what steps change, in the last moment; planes of stride floats */
    float *last, *rest;            /* poses in the moment before that, and in the first */
    float *fitted;                 /* mean squared difference of each Gaussian when it was last fitted */
    float *errors, *weights, *some_errors, *some_weights;
    float *asking, *showing;       /* numbers of the photographs that ask a Gaussian to move, and that show it */
    uint32_t *order;               /* Gaussians in the order of the steps: those tried first */
    uint32_t *near;                /* NEAR neighbours of each Gaussian in the first moment */
    uint32_t *place;               /* place of each Gaussian in `order` */
    uint32_t *thing;               /* for each place in `order` that is tried, the first place of its thing */
    size_t made;                   /* number of Gaussians that are in use; the others are spare, and cannot be seen */
    uint8_t *tried, *moves, *doubtful, *carried;
    float *moved_errors;           /* mean squared differences at the new places */
    size_t count, stride, tried_count;
    fxs_fit_tracks tracks;
    int is_under_way;              /* 1: Gaussians have moved before */
};

/* Puts spare Gaussians where light passes through the scene and the photographs show something else than the
   background. Raises moving->made. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_fill_holes(fxs_fit *fit);

/* Functions of tracks return 0 or FXS_ERR_MEMORY. After an error they can only be freed. */
int fxs_fit_tracks_begin(fxs_fit_tracks *tracks, size_t gaussians);
void fxs_fit_tracks_free(fxs_fit_tracks *tracks);

/* Begins the track of a Gaussian, with its pose in the model for all fitted moments. */
int fxs_fit_tracks_add(fxs_fit_tracks *tracks, const fxs_fit_model *model, size_t gaussian);

/* Adds the model's poses as the next moment. */
int fxs_fit_tracks_keep(fxs_fit_tracks *tracks, const fxs_fit_model *model);

/* Returns the pose of a Gaussian that has a track. */
float *fxs_fit_pose_of(const fxs_fit_tracks *tracks, size_t moment, size_t gaussian);

/* Returns the plane of number `k` of a pose among the planes of a model. */
int fxs_fit_moved_plane(int k);

/* Makes the photographs of a moment those that the next steps fit. */
void fxs_fit_show_moment(fxs_fit *fit, const fxs_fit_photo *photos);

#endif
