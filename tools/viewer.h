/* What `fixsplat view` does: a scene in a window, the view that is on show and how it moves. */
#ifndef VIEWER_H
#define VIEWER_H

#include "../port/window/window.h"
#include "renderer.h"

typedef struct viewer {
    frame_options options;                  /* as given; a dropped scene takes the camera out, keys change the rest */
    const char *screenshot;                 /* where to, or null: beside the scene */
    fxs_window *window;
    renderer renderer;

    picture picture;                        /* the last frame */

    char *path;                             /* of the scene, or of the file that says which there are */
    world world;
    fxs_file_view *views;                   /* of the camera file, or the one to start from */
    long view_count, index;                 /* the view that was moved away from */

    fxs_file_view view;                     /* on show, at the size that it came with */
    double up[3];                           /* in the scene */
    double distance;                        /* from the camera's centre to the point that it turns about */
    double radius, speed;                   /* of the scene, units; of flight, radii a second */

    int changed, moving;                    /* since the last frame: to be drawn, and by a motion */
    int flying, coarse;                     /* a key of flight is down; the last frame was at less than full size */
    int divisor;                            /* of width and height while moving */
    uint64_t clock;                         /* of the last step, nanoseconds */

    int graph, help, quit;
    fxs_frame_times times;
    fxs_picture overlay;
    char note[256];                         /* shown in the title; empty: none */
} viewer;

/* Opens scenes in a window. `options` and `screenshot` (or null) as on the command line. Returns 0 and a viewer for
   viewer_close, or prints why not and returns the exit status. The viewer stays where it is in between. */
int viewer_open(viewer *v, const frame_options *options, const char *screenshot);
void viewer_close(viewer *v);

/* Waits up to so many milliseconds (negative: for ever) for something to do, and does it. v->quit is set at the
   end. */
void viewer_step(viewer *v, int milliseconds);

#endif
