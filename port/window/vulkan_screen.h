/* Vulkan frames in a window, which stay in device memory. Functions return 0, or an FXS_ERR_* and a message. */
#ifndef FXS_VULKAN_SCREEN_H
#define FXS_VULKAN_SCREEN_H

#include <fixsplat/backend.h>
#include "window.h"

typedef struct fxs_screen fxs_screen;

/* Opens device number options->device for a window. FXS_ERR_UNSUPPORTED if the build, SDL or the device cannot show
   Vulkan frames in it. fxs_screen_backend.close closes the screen, before the window. */
int fxs_screen_open(fxs_screen **screen, fxs_window *window, const fxs_backend_options *options, fxs_message *why);

/* The back end of a screen. `render` draws the colours of a request into a hidden picture of the screen instead of the
   request's targets. Its thread may be another than the window's. `device` and `open` are null. */
extern const fxs_backend fxs_screen_backend;

/* Shows the picture of the last `render`, from the next fxs_screen_show on. No `render` may run. */
void fxs_screen_turn(fxs_screen *screen);

/* Like fxs_window_show. If `rendered` is true, shows the screen's picture instead of `picture`. A window without pixels
   shows nothing. */
int fxs_screen_show(fxs_screen *screen, int rendered, const fxs_canvas *picture, uint32_t colour,
                    const fxs_panel *panels, int count, fxs_message *why);

#endif
