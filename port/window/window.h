/* A window (SDL2) that reports the user's actions as events and shows pictures. Only the thread that opened the
 * window may call these functions, except fxs_window_wake. Positions and sizes are in pixels; a point of the screen
 * may be several pixels. */
#ifndef FXS_WINDOW_H
#define FXS_WINDOW_H

#include <fixsplat/internal/message.h>
#include "overlay.h"

typedef struct fxs_window fxs_window;

enum fxs_window_event_type {
    FXS_EVENT_NONE,
    FXS_EVENT_QUIT,
    FXS_EVENT_KEY,              /* a key went down; repeats of a held key give no event */
    FXS_EVENT_POINTER,
    FXS_EVENT_PRESS,
    FXS_EVENT_CLICK,            /* the left button went down and up at one place */
    FXS_EVENT_RELEASE,          /* the left button went up at another place */
    FXS_EVENT_WHEEL,
    FXS_EVENT_DROP,
    FXS_EVENT_CHANGED,          /* the window's content must be drawn again */
    FXS_EVENT_WOKEN
};

enum { FXS_KEY_BACKSPACE = 8, FXS_KEY_ENTER = 13, FXS_KEY_ESCAPE = 27, FXS_KEY_DELETE = 127, FXS_KEY_SHIFT,
       FXS_KEY_ALT, FXS_KEY_LEFT, FXS_KEY_RIGHT, FXS_KEY_UP, FXS_KEY_DOWN };

typedef struct fxs_window_event {
    enum fxs_window_event_type type;
    int key;                    /* key event: character on the key in lower case, FXS_KEY_ENTER or FXS_KEY_ESCAPE */
    int left, other;   /* mouse motion event: 1 if the left button is down; 1 if the middle or right one is down */
    /* mouse motion event: motion in pixels, y down; wheel event: steps in dy, positive away from the user */
    double dx, dy;
    double x, y;
    int count;                  /* click event: number of clicks; 2: a double click */
    const char *path;           /* drop event: path of the dropped file, valid until the next event */
} fxs_window_event;

/* Opens a hidden window; with `vulkan`, one for Vulkan frames, if SDL has Vulkan. Returns 0 and the window, or -1, a
   null window and a message. */
int fxs_window_open(fxs_window **window, int vulkan, fxs_message *message);

/* Returns the SDL_Window. */
void *fxs_window_handle(const fxs_window *window);

void fxs_window_close(fxs_window *window);

/* Shows the window with width x height pixels. If the screen is smaller, scales the window down in proportion. */
void fxs_window_resize(fxs_window *window, int width, int height);
void fxs_window_size(const fxs_window *window, int *width, int *height);

/* Returns the pixels per point of the screen, 1 or more. */
double fxs_window_scale(const fxs_window *window);

void fxs_window_title(fxs_window *window, const char *title);

/* Waits up to `milliseconds` for an event of the window; negative: without limit. Returns 1 and an event, or 0. */
int fxs_window_wait(fxs_window *window, int milliseconds, fxs_window_event *event);

/* Makes fxs_window_wait return with the event FXS_EVENT_WOKEN. Any thread may call this function while a window is
   open. */
void fxs_window_wake(void);

/* Returns 1 if a key is held down. Keys are 'a' to 'z' (by position on a US keyboard), ' ', FXS_KEY_SHIFT, the
   arrows, and FXS_KEY_ALT (Alt or Ctrl, since some desktops keep Alt for themselves). */
int fxs_window_holds(int key);

/* Shows a picture stretched to the window, and panels over the picture. If `picture` is null, fills the window with the
   colour 0xRRGGBBFF. Returns 0, or -1 and a message. */
int fxs_window_show(fxs_window *window, const fxs_canvas *picture, uint32_t colour, const fxs_panel *panels, int count,
                    fxs_message *message);

#endif
