/* State of the window of `fixsplat view`. There are three threads: the window's (viewer.c, viewer_crop.c,
   viewer_edit.c, viewer_panels.c, viewer_walk.c), the renderer's (viewer_frame.c), and one that loads scenes; a walk
   starts a fourth one, which makes walls. */
#ifndef VIEWER_H
#define VIEWER_H

#include "port/window/recent.h"
#include "port/window/vulkan_screen.h"
#include "port/window/window.h"
#include "port/window/worker.h"
#include "tools/command/drawing.h"
#include <fixsplat/internal/edits.h>
#include <fixsplat/collide.h>
#include <fixsplat/pace.h>

/* Playing of a scene that moves. */
typedef struct playback {
    fxs_time time;                          /* of the shown scenes; a duration of 0: they are still */
    int on, loops;
    double at, speed;                       /* moment of the pictures in seconds; seconds of the scene in a second */
    uint64_t clock;                         /* time of the last step in nanoseconds */
    int dragged;                            /* 1: the pointer drags the time bar */
    int spaced;                             /* 1: space is held, and has started or stopped the scene */
    int slow;                               /* 1: frames of full size take too long while the scene plays */
} playback;

enum { PLAY_MS = 16 };                      /* least time from frame to frame */

enum viewer_picture { SHOW_COLOUR, SHOW_DEPTH, SHOW_IDS };
enum viewer_film { FILM_NONE, FILM_TAKEN, FILM_WRITTEN };
enum { FILM_RATE = 30, FILM_MOST = FILM_RATE * 600 };       /* frames per second of a film; most frames of a film */

/* A crop box in world units. While `on`, only Gaussians with their centre inside are drawn. */
typedef struct crop_box {
    int on;
    double low[3], high[3];
} crop_box;

enum edit_tool { EDIT_OFF, EDIT_LASSO, EDIT_BRUSH, EDIT_OBJECT };
enum edit_act { EDIT_SELECT, EDIT_DELETE, EDIT_KEEP, EDIT_CLEAR, EDIT_UNDO, EDIT_REDO, EDIT_WRITE };

/* Editing by hand. */
typedef struct editing {
    enum edit_tool tool;
    int front;                              /* 1: selects only in front of the surface */
    double (*stroke)[2];                    /* the stroke that is drawn, window pixels */
    int stroke_count;
    void *copy;                             /* the edited scene; null: not edited. With the editor and the list, it
                                               belongs to the renderer's thread */
    fxs_editor editor;
    fxs_edits list;
} editing;

enum walk_state { WALK_OFF, WALK_ASKED, WALK_MAKING, WALK_ON };

/* Walking. While the state is WALK_ASKED, the renderer's thread finds the eye's height. While it is WALK_MAKING, the
   maker's thread makes walls. */
typedef struct walking {
    enum walk_state state;
    const char *file;                       /* .voxel.json of the scene; null: walls are made */
    double height_given;                    /* of the eye, scene units; 0: is estimated */
    fxs_worker *maker;
    fxs_voxels *voxels;                     /* walls of the shown scene; null: none yet */
    fxs_walker walker;
    int is_new;                             /* 1: the walls are made for this start of a walk */
    frame_options options;                  /* of the maker's thread, as the following fields */
    double seed[3];
    int status;
    char why[256];
} walking;

typedef struct viewer viewer;

/* A job: `work` runs on the renderer's thread, then `done` on the window's thread. */
typedef struct request {
    void (*work)(viewer *v, struct request *r);
    void (*done)(viewer *v, struct request *r);
    fxs_view view;
    fxs_options render;
    int divisor, x, y;
    int moves, shows_part;
    int on_screen;                          /* 1: the picture is in the screen's memory */
    enum viewer_picture shown;
    crop_box crop;
    enum edit_act edit;
    fxs_edit_shape shape;                   /* shape to select by; the renderer's thread frees its points */
    int adds;                               /* 1: adds to the selection */
    int status;
    char path[4096];
    int unwritten;
    fxs_message message;
    fxs_stats stats;
    fxs_pick_result pick;
} request;

enum { REQUESTS_MOST = 8, NEAR_POINTS = 1024, BUDGET_LEAST = 4096 };

/* A scene that the loader's thread is opening. The results are valid once that thread is idle. */
typedef struct loading {
    int on;
    char *path, *next;                      /* path of a dropped file, or null; path of the file to open next */
    char why[256];
    frame_options options;
    world world;
    fxs_view *views;
    long count, index;
    int status;
    int unkept;
} loading;

struct viewer {
    frame_options options;
    const char *screenshot;                 /* output path of screenshots; null: fixsplat-001.png and so on */
    fxs_window *window;
    fxs_words *words;
    fxs_worker *drawer, *loader;

    request requests[REQUESTS_MOST];
    int request_count, given;               /* number of queued requests; `given` 1: the first is in progress */
    renderer renderer;                      /* the renderer's thread owns it while requests are queued */
    renderer screen_renderer;               /* draws frames for the screen; self is null without a screen */
    fxs_screen *screen;                     /* shows Vulkan frames; belongs to the window's thread; null: none */
    int vulkan;                             /* 1: the window was opened for Vulkan */
    int on_screen;                          /* 1: the last frame is in the screen's memory */
    int screen_lost;                        /* 1: the next back end must replace the screen's */
    frame_options opened;
    int cropped;
    picture drawn;
    picture picture;
    fxs_view seen;                     /* view of the last frame; width 0: no frame yet */

    loading loading;
    int installing;                         /* 1: the loaded scenes are about to replace the current ones */
    fxs_recent recent;
    int recent_marked;                      /* index of the recent scene under the pointer; -1: none */
    char *path;                             /* path of the shown scene; null: no scene */
    world world;
    fxs_view *views;
    long view_count, index;                 /* number of views; index of the view that the camera started from */
    double (*points)[3];
    int point_count;

    fxs_view view;
    double up[3];
    double distance;                        /* distance from the camera to its pivot (centre of orbits), scene units */
    double radius, speed;                   /* radius of the scene in units; relative speed of flight */

    int changed, moving, exposed;
    int flying, coarse;
    int divisor;                            /* divisor of the picture's size while the camera moves */
    enum viewer_picture shown;
    uint64_t clock, moved;                  /* times of the last step and of the last camera motion in nanoseconds */
    uint64_t hint;                          /* time when the hint text disappears in nanoseconds; 0: no hint */

    enum viewer_film film;
    fxs_view *way;                     /* recorded path of the camera, at most FILM_MOST views */
    int64_t *way_times_q32;                 /* and the moments of scenes that move, seconds */
    int way_count;
    uint64_t filmed;                        /* time of the next film frame in nanoseconds */

    playback play;
    walking walk;
    editing edit;
    crop_box crop;
    int face, dragged;                      /* crop box face under the pointer or CROP_NONE; 1: the face is dragged */
    int crop_written;

    int graph, help, rate, light, quit, status;
    int measuring, ends;                    /* 1: clicks measure a distance; number of its ends picked so far */
    double end[2][3];
    fxs_frame_times times;
    uint32_t gaussians, missing;    /* number of Gaussians in the last frame; number of missing parts of the scene */
    int arrived;                            /* 1: missing parts of the scene were loaded; set by another thread */
    int lost;
    double rate_wanted;                     /* wanted frames per second; 0: fixed budget of Gaussians */
    fxs_pace pace;                          /* of frames while the camera moves, since the scene was shown */
    uint64_t slider;                        /* time when the budget slider disappears in nanoseconds; 0: hidden */
    char note[256];
};

/* Opens a window that shows the scenes of the options, or waits for a dropped scene. `screenshot` may be null. *v
   must not move until viewer_close. */
int viewer_open(viewer *v, const frame_options *options, const char *screenshot, double rate_wanted);
void viewer_close(viewer *v);

/* Waits up to `milliseconds` (negative: no limit) for an event, and handles the event. To end the program, sets
   v->quit and v->status. */
void viewer_step(viewer *v, int milliseconds);

int viewer_busy(const viewer *v);

/* Each ask function queues a request for the renderer's thread, or does nothing if the queue is full. */
request *ask(viewer *v, void (*work)(viewer *, request *), void (*done)(viewer *, request *), int divisor);
void ask_open(viewer *v);
void ask_frame(viewer *v);

/* Aborts a frame of full size when the camera begins to move. */
void stop_frame(viewer *v);
void ask_screenshot(viewer *v);
void ask_backend(viewer *v);

/* Goes on with the next back end after an error of the screen. */
void lose_screen(viewer *v);

/* Drops the copies of the world's scenes on devices. Runs on the renderer's thread. */
void forget_scenes(viewer *v);
void ask_focus(viewer *v, double x, double y);
void ask_film(viewer *v);
void ask_end(viewer *v, double x, double y);
void ask_crop(viewer *v);
int ask_install(viewer *v);

/* Finishes the request that the renderer's thread has completed, and starts the next request. */
void viewer_collect(viewer *v);

void tell(viewer *v, const char *text);
void tell_written(viewer *v, const request *r);

/* Names a new file SCENE-WORD-001ENDING beside the scene. Returns 0, or nonzero and a message. */
int name_beside(const viewer *v, request *r, const char *word, const char *ending);

/* Returns the number of eyes drawn: 1, or 2 side by side in the window. */
int eyes_of(const viewer *v);

enum { CROP_FACES = 6, CROP_NONE = -1 };

void crop_begin(viewer *v);

void crop_toggle(viewer *v);

/* Computes the middle of a face of the crop box. The axis of a face is face / 2. Even faces are low sides, odd faces
   high sides. */
void crop_handle(const crop_box *crop, int face, double point[3]);

int crop_face_at(const viewer *v, double x, double y);

/* Moves the crop box face v->face, so that its handle comes as near as possible to the window position x, y. */
void crop_drag(viewer *v, double x, double y);

/* Crops all objects of the world by the box. Runs on the renderer's thread. */
void crop_world(world *w, const crop_box *crop);

/* Keys and pointer of editing by hand. edit_leave and edit_write return 0 if there is no tool, edit_drag 0 if no stroke
   is drawn. */
void edit_tool(viewer *v);
void edit_delete(viewer *v);
void edit_undo(viewer *v);
void edit_front(viewer *v);
int edit_leave(viewer *v);
int edit_write(viewer *v);
void edit_press(viewer *v, double x, double y);
int edit_drag(viewer *v, const fxs_window_event *event);
void edit_release(viewer *v);
double edit_brush(const viewer *v);

/* Starts to play the shown scenes, if they move and no --time is given. is_new: 1 for a dropped scene. */
void play_begin(viewer *v, int is_new);

/* True if the shown scenes move. The other functions of playing need that. */
int play_moves(const viewer *v);

/* Keys. */
void play_toggle(viewer *v, int key);
void play_step_frame(viewer *v, int key);
void play_change_speed(viewer *v, int key);
void play_toggle_loop(viewer *v, int key);

/* Takes back what the key space did, as it is held to look around. */
void play_undo_space(viewer *v);

/* Returns when the next frame is due, in nanoseconds of the clock; 0: none is. */
uint64_t play_due(const viewer *v);
void play_advance(viewer *v, uint64_t now);

/* Takes the time of a frame, of the picture's size by `divisor`. */
void play_take_time(viewer *v, uint64_t nanoseconds, int divisor);

/* Writes the moment as text, and the place x, y, width, height of the time bar, pixels. */
void play_words(const viewer *v, char *text, size_t size);
void play_bar(const viewer *v, int bar[4]);

/* Pointer on the time bar. Each returns 1 if the pointer drags it; play_release, if it did. */
int play_press(viewer *v, double x, double y);
int play_drag(viewer *v, const fxs_window_event *event);
int play_release(viewer *v);

/* Walks. walk_start begins one, at once or when its walls are made. walk_stop returns 0 if there is none. */
void walk_start(viewer *v);
int walk_stop(viewer *v);
int walk_is_on(const viewer *v);
int walk_is_making(const viewer *v);
void walk_by_keys(viewer *v, double seconds);
void walk_by_wheel(viewer *v, double factor);
void walk_to(viewer *v, const double point[3]);

/* Returns the speed of a walk in units a second. */
double walk_speed(const viewer *v);

/* Begins to walk once the walls are made. */
void walk_collect(viewer *v);

/* Ends a walk and drops its walls, before the scene is closed. */
void walk_forget(viewer *v);

/* Marks the selected Gaussians in a picture of the request. Runs on the renderer's thread. */
void edit_mark(const viewer *v, const request *r, const picture *p);

/* True if Gaussians are deleted. Runs on the renderer's thread, or after a request. */
int is_edited(const viewer *v);

/* Frees the edited scene. No request may be queued, and the world must be closed. */
void edit_end(editing *e);

/* Replaces the current scenes of the window by the loaded scenes. No frame may be in progress. */
void viewer_install(viewer *v);

int has_levels(const world *w);
uint32_t viewer_budget_most(const viewer *v);

/* Adapts the budget (Gaussians per frame) to the time of a frame that was drawn with the present budget. */
void viewer_follow_rate(viewer *v, uint64_t nanoseconds, uint32_t drawn);

/* Projects a point to window pixels, with the view of the last frame. Returns 0 for a point behind the camera. */
int viewer_project(const viewer *v, const double point[3], double pixel[2]);

const char *viewer_file_name(const char *path);

int viewer_recent_at(const viewer *v, double x, double y);

int viewer_show(viewer *v);

#endif
