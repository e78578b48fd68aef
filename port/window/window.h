/* A window (SDL2): what the person does, as events, and pictures to look at. One thread, the one that opened it, but
   for fxs_window_wake. Positions and sizes are pixels, which may be finer than the screen's points. */
#ifndef FXS_WINDOW_H
#define FXS_WINDOW_H

#include <fixsplat/message.h>
#include "overlay.h"

typedef struct fxs_window fxs_window;

enum fxs_window_event_type {
    FXS_EVENT_NONE,
    FXS_EVENT_QUIT,
    FXS_EVENT_KEY,              /* pressed, not repeated */
    FXS_EVENT_POINTER,          /* moved */
    FXS_EVENT_PRESS,            /* the left button goes down */
    FXS_EVENT_CLICK,            /* the left button, down and up at one place */
    FXS_EVENT_WHEEL,
    FXS_EVENT_DROP,             /* a file was dropped on the window */
    FXS_EVENT_CHANGED,          /* shown, uncovered or resized: to be shown anew */
    FXS_EVENT_WOKEN             /* by fxs_window_wake */
};

enum { FXS_KEY_ENTER = 13, FXS_KEY_ESCAPE = 27, FXS_KEY_SHIFT = 128 };

typedef struct fxs_window_event {
    enum fxs_window_event_type type;
    int key;                    /* the character on the key, small letters, FXS_KEY_ENTER or _ESCAPE */
    int left, other;            /* pointer: whether the left, or the middle or right button is down */
    double dx, dy;              /* pointer: pixels, y down; wheel: steps away from the person in dy */
    double x, y;                /* pointer, press and click: where, from the window's top left corner */
    int count;                  /* click: 2 is a double click */
    const char *path;           /* of the file dropped; the window's, until the next event */
} fxs_window_event;

/* Opens a window that is not shown yet. Returns 0 and a window for fxs_window_close, or -1, null and a message. */
int fxs_window_open(fxs_window **window, fxs_message *message);
void fxs_window_close(fxs_window *window);

/* Shows the window with width x height pixels, made smaller in proportion where the screen cannot hold them. */
void fxs_window_resize(fxs_window *window, int width, int height);
void fxs_window_size(const fxs_window *window, int *width, int *height);

/* Pixels a point of the screen, 1 or more: what words are to be larger by. */
double fxs_window_scale(const fxs_window *window);

void fxs_window_title(fxs_window *window, const char *title);

/* Waits up to so many milliseconds, or for ever where negative. Returns 1 and an event, or 0. */
int fxs_window_wait(fxs_window *window, int milliseconds, fxs_window_event *event);

/* Makes that return FXS_EVENT_WOKEN. For any thread, while a window is open. */
void fxs_window_wake(void);

/* Whether a key is down: 'a' to 'z' (by its place on a US keyboard), ' ' or FXS_KEY_SHIFT. */
int fxs_window_holds(int key);

/* Shows a picture, stretched to the window, or a plain colour (0xRRGGBBFF) where that is null, and panels over it, each
   over the ones before. Returns 0, or -1 and a message. */
int fxs_window_show(fxs_window *window, const fxs_picture *picture, uint32_t colour, const fxs_panel *panels, int count,
                    fxs_message *message);

#endif
