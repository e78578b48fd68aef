/* Paths of a camera through keys, for films. Functions with a message return 0, or an error and the message. */
#ifndef FXS_PATH_H
#define FXS_PATH_H

#include <fixsplat/camera.h>

enum { FXS_KEY_VALUES = 12 };

/* A key of a path. Its values are eye, look-at point, up and field of view in degrees; or those of a view: position,
   quaternion, logarithms of the focal lengths, principal point, and logarithm of the near plane. */
typedef struct fxs_path_key {
    double at;                       /* time in seconds; without times, the way from key to key up to this one */
    double values[FXS_KEY_VALUES];
} fxs_path_key;

typedef struct fxs_path {
    fxs_path_key *keys;
    long count;
    int of_views;                    /* 1: the keys are views of a camera file; 0: eye, look-at point, up, angle */
    int timed;                       /* 1: the keys have times */
    int is_wide;                     /* 1: the fields of view are those of the picture's longer side */
    int steps;                       /* 1: the camera jumps from key to key */
    int closed, returns;             /* 1: the path ends where it begins; 1: it goes back on the same way */
    double smoothness;               /* 1: a smooth path; 0: straight from key to key */
    double end;                      /* time or length at the end of the path; a path that returns turns there */
    fxs_view frame;                  /* size, projection and name of the path's views */
    long frames;                     /* number of frames; 0: the frames follow the keys' times, at `rate` a second */
    double rate;
    double ease;                     /* share of the film in which the camera speeds up, and slows down */
    double *lengths;                 /* length of the path up to each of `samples` + 1 places */
    long samples;
} fxs_path;

/* Reads a settings file of the web viewer or of supersplat-viewer, or a text (name.txt) with a key per line. `track`
   names a track of a settings file, by its number from 0 or its name; null: the first. `up` is for keys without one.
   Returns 1, or 0 for a file of another kind, or an error. */
int fxs_path_read(fxs_path *path, const char *name, const char *track, const double up[3], fxs_message *message);

/* Makes a path through the views (cameras) of a camera file. The first view gives the size of all. */
int fxs_path_of_views(fxs_path *path, const fxs_view *views, long count, fxs_message *message);

/* Divides a path into `frames` frames of even speed, which starts and ends gently: within a second, at most a quarter
   of the film. Speed counts length in units, turn in radians, and zoom as the logarithm of the focal length. `unit`:
   the length that counts as much as a turn of a radian. */
int fxs_path_even(fxs_path *path, double unit, long frames, double seconds, fxs_message *message);

/* Measures the way from one view to another as above. */
double fxs_path_step(const fxs_view *from, const fxs_view *to, double unit);

/* Makes the view of a frame; between two frames, `frame` is not a whole number. */
int fxs_path_view(const fxs_path *path, double frame, fxs_view *view, fxs_message *message);

void fxs_path_free(fxs_path *path);

#endif
