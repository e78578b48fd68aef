/* Ways to draw frames into a window of Android, and a view, which draws a scene into a window by one of the ways. One
 * thread uses a view. Functions return 0, or an FXS_ERR_* and a message. */
#ifndef FXS_WINDOW_WAY_H
#define FXS_WINDOW_WAY_H

#include <fixsplat/pace.h>
#include <fixsplat/renderer.h>

#define FXS_WINDOW_POOL (128u << 20)    /* for a scene in parts: pool in memory, and first pool on the device, bytes */

/* Functions of libandroid.so. A window is an ANativeWindow. */
typedef struct fxs_window_library {
    int32_t (*width)(void *window);
    int32_t (*height)(void *window);
    void (*release)(void *window);
} fxs_window_library;

/* A way to draw. */
typedef struct fxs_window_way {
    /* Opens a device that can show frames in `window`, with pools of `pool_bytes` for scenes in parts. */
    int (*open)(void **self, void *window, uint64_t pool_bytes, fxs_message *why);
    /* Lets go of the window, and takes another one, or none: null. */
    int (*take)(void *self, void *window, fxs_message *why);
    /* Draws a picture and waits for it; then shows it, scaled to the window. */
    int (*draw)(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why);
    int (*show)(void *self, fxs_message *why);
    void (*drop)(void *self, const fxs_scene *scene);
    void (*limit)(void *self, uint64_t pool_bytes);    /* drops scenes in parts */
    const char *(*name)(const void *self);             /* name of the back end, as in backend.h */
    void (*close)(void *self);
} fxs_window_way;

extern const fxs_window_way fxs_window_vulkan, fxs_window_egl;

/* Finds a function of a library of the system, which is loaded at run time. Returns whether it is there. */
int fxs_system_function(const char *library, const char *name, void *function);

enum { FXS_EYE, FXS_LOOKED_AT = 3, FXS_UP = 6, FXS_FOV = 9, FXS_NUMBERS };    /* numbers of a camera in Java */

typedef struct fxs_window_state {
    uint32_t missing;                  /* chunks that the last frame drew coarser */
    uint32_t coming;                   /* chunks that are still to be read, also those that could not be read */
    uint32_t budget;
    int32_t width, height;             /* size of the drawn picture */
    int changed;                       /* the clock chose anew: the next frame differs */
} fxs_window_state;

typedef struct fxs_window_view {
    const fxs_window_way *way;         /* null: not open */
    void *self;
    void *window;                      /* null: none */
    int32_t width, height;
    fxs_opened *opened;                /* null: no scene */
    fxs_pace pace;
    int paced;                         /* 0: the budget is pace.budget_most, and the picture has the window's
                                          size; 1: the clock chooses */
    uint64_t pool_bytes;
    fxs_renderer *processor;           /* for picks; made by the first */
    fxs_window_state state;
} fxs_window_view;

/* Writes the numbers of a scene's first camera. */
int fxs_window_camera(const fxs_opened *opened, int32_t width, int32_t height, double numbers[FXS_NUMBERS],
                      fxs_message *why);

/* Takes a window, which the view releases later; null: none. A window without pixels is like none. */
int fxs_window_take(fxs_window_view *view, void *window, const fxs_window_library *library, fxs_message *why);

/* Takes a scene, or none: null. The caller closes the old one. */
void fxs_window_scene(fxs_window_view *view, fxs_opened *opened);

/* Sets the limits: nanoseconds of a frame (0: no clock), and the largest budget (0: none). */
void fxs_window_pace(fxs_window_view *view, uint32_t frame_nanoseconds, uint32_t budget);

/* Draws the scene and shows it. A lost device is opened again, twice at most. Writes view->state. */
int fxs_window_draw(fxs_window_view *view, const double numbers[FXS_NUMBERS], fxs_message *why);

/* Finds the Gaussian at a pixel of the window; like fxs_renderer_pick. */
int fxs_window_pick(fxs_window_view *view, const double numbers[FXS_NUMBERS], int32_t x, int32_t y,
                    fxs_pick_result *result, fxs_message *why);

/* Halves the budget and the pools on the device. Without a window, closes the device. */
void fxs_window_trim(fxs_window_view *view);

/* Frees the content of the view. */
void fxs_window_end(fxs_window_view *view, const fxs_window_library *library);

#endif
