/* The window of `fixsplat view`: its scene, the view that is on show and how it moves. One thread has the window
   (viewer.c, viewer_crop.c, viewer_panels.c), one the renderer (viewer_frame.c), one opens scenes. */
#ifndef VIEWER_H
#define VIEWER_H

#include "port/window/recent.h"
#include "port/window/window.h"
#include "port/window/worker.h"
#include "drawing.h"

enum viewer_picture { SHOW_COLOUR, SHOW_DEPTH, SHOW_IDS };
enum viewer_film { FILM_NONE, FILM_TAKEN, FILM_WRITTEN };   /* being so */
enum { FILM_RATE = 30, FILM_MOST = FILM_RATE * 600 };       /* frames a second, frames */

/* What is drawn where it is on: Gaussians with their centres within it. The world's units. */
typedef struct crop_box {
    int on;
    double low[3], high[3];
} crop_box;

typedef struct viewer viewer;

/* Something for the renderer's thread, and what it has found out: `work` is called there, then `done` here. */
typedef struct request {
    void (*work)(viewer *v, struct request *r);
    void (*done)(viewer *v, struct request *r);
    fxs_file_view view;
    fxs_options render;
    int divisor, x, y;
    int moves, shows_part;                  /* of a frame: in motion; what has not come yet is drawn coarser */
    enum viewer_picture shown;
    crop_box crop;
    int status;                             /* of the work; of a pick, as renderer_pick has it */
    char path[4096];                        /* of what is written */
    int unwritten;
    fxs_message message;                    /* why */
    fxs_stats stats;
    fxs_pick_result pick;
} request;

enum { REQUESTS_MOST = 8, NEAR_POINTS = 1024, BUDGET_LEAST = 4096 };

/* A scene on its way: all but `status` is the loader's until it is done. */
typedef struct loading {
    int on;
    char *path, *next;                      /* dropped, or null; the one after it */
    char why[256];                          /* what failed */
    frame_options options;
    world world;
    fxs_file_view *views;
    long count, index;
    int status;
    int unkept;                             /* how often it could not be kept among the recent ones */
} loading;

struct viewer {
    frame_options options;                  /* as given; a dropped scene takes the camera out, keys change the rest */
    const char *screenshot;                 /* where to, or null: fixsplat-001.png and on */
    fxs_window *window;
    fxs_words *words;                       /* or null */
    fxs_worker *drawer, *loader;

    request requests[REQUESTS_MOST];
    int request_count, given;               /* whether the first is with the drawer */
    renderer renderer;                      /* the drawer's while there are requests, with the world, and: */
    frame_options opened;                   /* what the renderer was opened by */
    int cropped;                            /* whether a box crops the world's objects */
    picture drawn;
    picture picture;                        /* the last frame */
    fxs_file_view seen;                     /* its view; no width: there is none */

    loading loading;
    int installing;                         /* what was loaded is asked to be installed */
    fxs_recent recent;                      /* for the window without a scene */
    int recent_marked;                      /* that the pointer is on, or -1 */
    char *path;                             /* of the scene, or of the file that says which there are; null: none */
    world world;
    fxs_file_view *views;                   /* of the camera file, or the one to start from */
    long view_count, index;                 /* the view that was moved away from */
    double (*points)[3];                    /* of the scene, spread over it: NEAR_POINTS or fewer */
    int point_count;

    fxs_file_view view;                     /* on show, at the size that it came with */
    double up[3];                           /* in the scene */
    double distance;                        /* from the camera's centre to the point that it turns about */
    double radius, speed;                   /* of the scene, units; of flight, by what lies near, a second */

    int changed, moving, exposed;           /* since the last frame: to be drawn, and by a motion; to be shown */
    int flying, coarse;                     /* a key of flight is down; the last frame was at less than full size */
    int divisor;                            /* of width and height while moving */
    enum viewer_picture shown;
    uint64_t clock, moved;                  /* of the last step; since when it is still: nanoseconds */
    uint64_t hint;                          /* until when the hint is shown; 0: it is not */

    enum viewer_film film;
    fxs_file_view *way;                     /* of the camera, FILM_MOST at most; the drawer's while it is written */
    int way_count;
    uint64_t filmed;                        /* the time of the next, nanoseconds */

    crop_box crop;                          /* stays while it is not on, for the next time */
    int face, dragged;                      /* whose handle the pointer is on, or CROP_NONE; whether it drags it */
    int crop_written;                       /* being so */

    int graph, help, rate, light, quit, status;
    int measuring, ends;                    /* the ends that there are, of: */
    double end[2][3];
    fxs_frame_times times;
    uint32_t gaussians, missing;            /* drawn in the last frame; chunks that it lacks, as they have not come */
    int arrived;                            /* some have; set atomically by a pager's thread */
    int lost;                               /* that something cannot be read has been said */
    double rate_wanted;                     /* frames a second that the budget follows; 0: it does not */
    uint64_t slider;                        /* until when the budget's slider is shown; 0: it is not */
    char note[256];                         /* shown in the window and its title; empty: none */
};

/* Opens a window, which shows the scenes when they are there. `options` and `screenshot` (or null) as on the command
   line; without a scene the window waits for one. Returns 0 and a viewer for viewer_close, or prints why not and
   returns the exit status. The viewer stays where it is in between. */
int viewer_open(viewer *v, const frame_options *options, const char *screenshot, double rate_wanted);
void viewer_close(viewer *v);

/* Waits up to so many milliseconds (negative: for ever) for something to do, and does it. v->quit is set at the end,
   with v->status. */
void viewer_step(viewer *v, int milliseconds);

/* Whether something is being opened or drawn, or is to be. */
int viewer_busy(const viewer *v);

/* ---- viewer_frame.c ---------------------------------------------------------------------------------------------- */

/* They ask for something to be done, in order; where REQUESTS_MOST wait already, for nothing. ask_install returns
   whether it is asked for. */
void ask_open(viewer *v);
void ask_frame(viewer *v);

/* Has a frame of the full size end that is under way, where the view has begun to move and is drawn smaller. */
void stop_frame(viewer *v);
void ask_screenshot(viewer *v);
void ask_backend(viewer *v);
void ask_focus(viewer *v, double x, double y);
void ask_film(viewer *v);                            /* of v->way, which is not empty */
void ask_end(viewer *v, double x, double y);         /* of what is measured */
void ask_crop(viewer *v);                            /* to be written */
int ask_install(viewer *v);                          /* puts the loaded scenes in the place of those there are */

/* Takes what the renderer's thread has done, and gives it the next. */
void viewer_collect(viewer *v);

/* Side by side in the window. */
int eyes_of(const viewer *v);

/* ---- viewer_crop.c ----------------------------------------------------------------------------------------------- */

enum { CROP_FACES = 6, CROP_NONE = -1 };

/* A box around what a new scene shows. */
void crop_begin(viewer *v);

/* Shows the box, or the whole scene. */
void crop_toggle(viewer *v);

/* The middle of a face: of axis face / 2 the low side where face is even, else the high one. */
void crop_handle(const crop_box *crop, int face, double point[3]);

/* The face whose handle is at a place of the window, or CROP_NONE. */
int crop_face_at(const viewer *v, double x, double y);

/* Moves v->face so that its handle comes to that place, or as near as it can. */
void crop_drag(viewer *v, double x, double y);

/* For the renderer's thread: gives the world's objects the crops of their placements within the box. */
void crop_world(world *w, const crop_box *crop);

/* ---- viewer.c ---------------------------------------------------------------------------------------------------- */

/* Takes the loaded scenes; nothing is drawn meanwhile. */
void viewer_install(viewer *v);

/* Whether a scene has levels of detail, and the most Gaussians that a budget may have: all, or what pools hold. */
int viewer_has_levels(const viewer *v);
uint32_t viewer_budget_most(const viewer *v);

/* The budget comes nearer to what a frame of so many nanoseconds says of the wanted rate. */
void viewer_follow_rate(viewer *v, uint64_t nanoseconds, uint32_t drawn);

/* ---- viewer_panels.c --------------------------------------------------------------------------------------------- */

/* Where the view that is shown has a point: pixels of the window. Returns 0 for what is behind the camera. */
int viewer_project(const viewer *v, const double point[3], double pixel[2]);

/* The last name of a path. */
const char *viewer_file_name(const char *path);

/* Which of the recent scenes is listed at a place of the window, or -1. */
int viewer_recent_at(const viewer *v, double x, double y);

/* Shows the last frame and what is over it. Returns 0, or prints why not and returns EXIT_FAILED. */
int viewer_show(viewer *v);

#endif
