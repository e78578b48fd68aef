/* State of the window of `fixsplat view`: its scene, the current view and the camera's motion. Three threads: the
   window's (viewer.c, viewer_crop.c, viewer_panels.c), the renderer's (viewer_frame.c), and a loader that opens
   scenes. */
#ifndef VIEWER_H
#define VIEWER_H

#include "port/window/recent.h"
#include "port/window/window.h"
#include "port/window/worker.h"
#include "tools/command/drawing.h"

enum viewer_picture { SHOW_COLOUR, SHOW_DEPTH, SHOW_IDS };
enum viewer_film { FILM_NONE, FILM_TAKEN, FILM_WRITTEN };
enum { FILM_RATE = 30, FILM_MOST = FILM_RATE * 600 };       /* frames a second; longest film in frames */

/* A crop box in world units. While `on`, only Gaussians with their centre inside are drawn. */
typedef struct crop_box {
    int on;
    double low[3], high[3];
} crop_box;

typedef struct viewer viewer;

/* A job for the renderer's thread: `work` runs there, then `done` runs on the window's thread with the result. */
typedef struct request {
    void (*work)(viewer *v, struct request *r);
    void (*done)(viewer *v, struct request *r);
    fxs_file_view view;
    fxs_options render;
    int divisor, x, y;
    int moves, shows_part;                  /* a frame: the camera is moving; chunks not loaded yet are drawn by
                                               coarser levels */
    enum viewer_picture shown;
    crop_box crop;
    int status;                             /* result of `work`; a pick: result of renderer_pick */
    char path[4096];                        /* the file written */
    int unwritten;
    fxs_message message;                    /* the reason of a failure */
    fxs_stats stats;
    fxs_pick_result pick;
} request;

enum { REQUESTS_MOST = 8, NEAR_POINTS = 1024, BUDGET_LEAST = 4096 };

/* A scene being opened. Only the loader's thread touches the fields, except `status`, until it has finished. */
typedef struct loading {
    int on;
    char *path, *next;                      /* path: dropped file, or null; next: the file to open after it */
    char why[256];                          /* message of a failure */
    frame_options options;
    world world;
    fxs_file_view *views;
    long count, index;
    int status;
    int unkept;                             /* failures to save it in the list of recent scenes */
} loading;

struct viewer {
    frame_options options;                  /* as given; a dropped scene resets the camera options, keys change the
                                               others */
    const char *screenshot;                 /* output path; null: fixsplat-001.png, -002 ... */
    fxs_window *window;
    fxs_words *words;                       /* null: no font */
    fxs_worker *drawer, *loader;

    request requests[REQUESTS_MOST];
    int request_count, given;               /* given: the drawer (renderer's thread) has the first */
    renderer renderer;                      /* owned by the drawer while requests wait, as are world, opened,
                                               cropped, drawn */
    frame_options opened;                   /* the options that the renderer was opened with */
    int cropped;                            /* a crop box is applied to the world's objects */
    picture drawn;
    picture picture;                        /* the last frame */
    fxs_file_view seen;                     /* view of the last frame; width 0: no frame yet */

    loading loading;
    int installing;                         /* an install of the loaded scenes is requested */
    fxs_recent recent;                      /* listed in the window without a scene */
    int recent_marked;                      /* the recent scene under the pointer, or -1 */
    char *path;                             /* the scene, or the --scene file; null: no scene */
    world world;
    fxs_file_view *views;                   /* from the camera file, or one start view */
    long view_count, index;                 /* index: the view that the camera moved away from */
    double (*points)[3];                    /* sample of the scene's positions, at most NEAR_POINTS */
    int point_count;

    fxs_file_view view;                     /* current view, at its original size */
    double up[3];                           /* up direction in the scene */
    double distance;                        /* from the camera's centre to the pivot that it orbits */
    double radius, speed;                   /* the scene's radius, units; flight speed: distances to the nearest
                                               part, a second */

    int changed, moving, exposed;           /* since the last frame: needs a frame; the camera moves; needs a repaint */
    int flying, coarse;                     /* a flight key is down; the last frame had a reduced size */
    int divisor;                            /* divides width and height while the camera moves */
    enum viewer_picture shown;
    uint64_t clock, moved;                  /* time of the last step and of the last motion, nanoseconds */
    uint64_t hint;                          /* when the hint disappears; 0: no hint */

    enum viewer_film film;
    fxs_file_view *way;                     /* the camera's path, at most FILM_MOST views; the drawer's while the
                                               film is written */
    int way_count;
    uint64_t filmed;                        /* time of the next frame, nanoseconds */

    crop_box crop;                          /* keeps its sides while off */
    int face, dragged;                      /* face: handle under the pointer, or CROP_NONE; dragged: this
                                               handle is being dragged */
    int crop_written;                       /* a cropped scene is being written */

    int graph, help, rate, light, quit, status;
    int measuring, ends;                    /* measuring: 1: distances are measured; ends: ends picked */
    double end[2][3];
    fxs_frame_times times;
    uint32_t gaussians, missing;            /* Gaussians in the last frame; chunks that it lacked, not loaded yet */
    int arrived;                            /* chunks have been loaded since; set atomically by a pager's thread */
    int lost;                               /* a read error was reported */
    double rate_wanted;                     /* target frame rate that the budget follows; 0: fixed budget */
    uint64_t slider;                        /* when the budget's slider disappears; 0: hidden */
    char note[256];                         /* text shown in the window and its title; empty: none */
};

/* Opens a window that shows the scenes once they are loaded. `options` and `screenshot` (or null) come from the
   command line; without a scene the window waits for a dropped one. Returns 0 and a viewer for viewer_close, or
   prints the reason and returns the exit status. The viewer must not move in memory until viewer_close. */
int viewer_open(viewer *v, const frame_options *options, const char *screenshot, double rate_wanted);
void viewer_close(viewer *v);

/* Waits up to `milliseconds` (negative: without limit) for an event, and handles it. Sets v->quit when the viewer
   ends, with the exit status in v->status. */
void viewer_step(viewer *v, int milliseconds);

/* True if a scene is being opened, or a frame is drawn or due. */
int viewer_busy(const viewer *v);

/* ---- viewer_frame.c ---------------------------------------------------------------------------------------------- */

/* Each queues a request for the renderer's thread; requests run in order. With REQUESTS_MOST in the queue it does
   nothing. ask_install returns whether it was queued. */
void ask_open(viewer *v);
void ask_frame(viewer *v);

/* Aborts a frame at full size if the camera has begun to move, since moving frames are drawn smaller. */
void stop_frame(viewer *v);
void ask_screenshot(viewer *v);
void ask_backend(viewer *v);
void ask_focus(viewer *v, double x, double y);
void ask_film(viewer *v);                            /* writes v->way, which must not be empty */
void ask_end(viewer *v, double x, double y);         /* picks an end of the measured distance */
void ask_crop(viewer *v);                            /* writes the cropped scene */
int ask_install(viewer *v);                          /* replaces the current scenes with the loaded ones */

/* Finishes the request that the renderer's thread has completed, and starts the next one. */
void viewer_collect(viewer *v);

/* Number of eyes shown side by side in the window: 1 or 2. */
int eyes_of(const viewer *v);

/* ---- viewer_crop.c ----------------------------------------------------------------------------------------------- */

enum { CROP_FACES = 6, CROP_NONE = -1 };

/* Sets the crop box around a new scene, switched off. */
void crop_begin(viewer *v);

/* Switches the crop box on or off. */
void crop_toggle(viewer *v);

/* The middle of a face. The axis is face / 2; an even face is its low side, an odd face its high side. */
void crop_handle(const crop_box *crop, int face, double point[3]);

/* The face with a handle at the window position x, y, or CROP_NONE. */
int crop_face_at(const viewer *v, double x, double y);

/* Moves v->face so that its handle comes as near as possible to the window position x, y. */
void crop_drag(viewer *v, double x, double y);

/* On the renderer's thread: gives the world's objects their placements' crops, cut by the box. */
void crop_world(world *w, const crop_box *crop);

/* ---- viewer.c ---------------------------------------------------------------------------------------------------- */

/* Replaces the scenes with the loaded ones. Nothing may be drawn meanwhile. */
void viewer_install(viewer *v);

/* viewer_has_levels: true if any scene has levels of detail. viewer_budget_most: the largest useful budget in
   Gaussians, limited by the scenes and by the pools. */
int viewer_has_levels(const viewer *v);
uint32_t viewer_budget_most(const viewer *v);

/* Adapts the budget after a frame that took `nanoseconds` and drew `drawn` Gaussians, towards the wanted frame rate. */
void viewer_follow_rate(viewer *v, uint64_t nanoseconds, uint32_t drawn);

/* ---- viewer_panels.c --------------------------------------------------------------------------------------------- */

/* Projects a point with the view of the last frame to window pixels. Returns 0 for a point behind the camera. */
int viewer_project(const viewer *v, const double point[3], double pixel[2]);

/* The last component of a path. */
const char *viewer_file_name(const char *path);

/* The recent scene listed at a window position, or -1. */
int viewer_recent_at(const viewer *v, double x, double y);

/* Shows the last frame with the panels over it. Returns 0, or prints the reason and returns EXIT_FAILED. */
int viewer_show(viewer *v);

#endif
