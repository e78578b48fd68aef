#include "window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <SDL2/SDL.h>

#ifndef SDL_HINT_VIDEODRIVER        /* before SDL 2.0.22 */
#define SDL_HINT_VIDEODRIVER "SDL_VIDEODRIVER"
#endif

struct fxs_window {
    SDL_Window *window;
    char *dropped;
};

static int fail(fxs_message *message)
{
    return fxs_fail(message, "no window: %s", SDL_GetError());
}

/* Without a display SDL would fall back to drivers that show nothing. Wayland's library writes lines of its own where
   it has no folder for its socket. A driver asked for by SDL_VIDEODRIVER is taken as it is. */
static void choose_drivers(void)
{
    char list[256] = "";
    const int wayland = SDL_getenv("XDG_RUNTIME_DIR") || SDL_getenv("WAYLAND_DISPLAY");
    if (SDL_GetHint(SDL_HINT_VIDEODRIVER))
        return;
    for (int i = 0; i < SDL_GetNumVideoDrivers(); i++) {
        const char *name = SDL_GetVideoDriver(i);
        if (!strcmp(name, "offscreen") || !strcmp(name, "dummy") || !strcmp(name, "evdev") ||
            (!wayland && !strcmp(name, "wayland")))
            continue;
        SDL_strlcat(list, *list ? "," : "", sizeof list);
        SDL_strlcat(list, name, sizeof list);
    }
    SDL_SetHint(SDL_HINT_VIDEODRIVER, list);
}

int fxs_window_open(fxs_window **window, fxs_message *message)
{
    /* Pictures are copied to the window without OpenGL, whose context a back end may need for itself. */
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    *window = calloc(1, sizeof **window);
    if (!*window)
        return fxs_fail(message, "no window: out of memory");
    choose_drivers();
    if (!SDL_InitSubSystem(SDL_INIT_VIDEO)) {
        (*window)->window = SDL_CreateWindow("fixsplat", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 1, 1,
                                             SDL_WINDOW_HIDDEN | SDL_WINDOW_RESIZABLE);
        SDL_StopTextInput();
    }
    if ((*window)->window)
        return 0;
    fail(message);
    fxs_window_close(*window);
    *window = 0;
    return -1;
}

void fxs_window_close(fxs_window *window)
{
    if (window->window)
        SDL_DestroyWindow(window->window);
    SDL_free(window->dropped);
    SDL_Quit();
    free(window);
}

void fxs_window_resize(fxs_window *window, int width, int height)
{
    SDL_Rect room;
    if (!SDL_GetDisplayUsableBounds(SDL_GetWindowDisplayIndex(window->window), &room)) {
        double scale = fmin(1, fmin((double)room.w / width, (double)room.h / height));
        width = (int)fmax(1, width * scale);
        height = (int)fmax(1, height * scale);
    }
    SDL_SetWindowSize(window->window, width, height);
    SDL_SetWindowPosition(window->window, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED);
    SDL_ShowWindow(window->window);
}

void fxs_window_size(const fxs_window *window, int *width, int *height)
{
    SDL_GetWindowSize(window->window, width, height);
}

void fxs_window_title(fxs_window *window, const char *title)
{
    SDL_SetWindowTitle(window->window, title);
}

/* Returns 0 for what the viewer has no use for. */
static int translate(fxs_window *window, const SDL_Event *in, fxs_window_event *out)
{
    *out = (fxs_window_event){FXS_EVENT_NONE, 0, 0, 0, 0, 0, 0};
    switch (in->type) {
    case SDL_QUIT:
        out->type = FXS_EVENT_QUIT;
        break;
    case SDL_KEYDOWN:
        out->type = in->key.repeat ? FXS_EVENT_NONE : FXS_EVENT_KEY;
        out->key = in->key.keysym.sym;
        break;
    case SDL_MOUSEMOTION:
        out->type = FXS_EVENT_POINTER;
        out->left = (in->motion.state & SDL_BUTTON_LMASK) != 0;
        out->other = (in->motion.state & (SDL_BUTTON_MMASK | SDL_BUTTON_RMASK)) != 0;
        out->dx = in->motion.xrel;
        out->dy = in->motion.yrel;
        break;
    case SDL_MOUSEWHEEL:
        out->type = FXS_EVENT_WHEEL;
        out->dy = (double)in->wheel.preciseY;
        break;
    case SDL_DROPFILE:
        SDL_free(window->dropped);
        out->type = FXS_EVENT_DROP;
        out->path = window->dropped = in->drop.file;
        break;
    case SDL_WINDOWEVENT:
        if (in->window.event == SDL_WINDOWEVENT_EXPOSED || in->window.event == SDL_WINDOWEVENT_SIZE_CHANGED)
            out->type = FXS_EVENT_CHANGED;
        break;
    default:
        break;
    }
    return out->type != FXS_EVENT_NONE;
}

int fxs_window_wait(fxs_window *window, int milliseconds, fxs_window_event *event)
{
    SDL_Event in;
    while (milliseconds < 0 ? SDL_WaitEvent(&in) : SDL_WaitEventTimeout(&in, milliseconds))
        if (translate(window, &in, event))
            return 1;
    return 0;
}

int fxs_window_holds(int key)
{
    const Uint8 *state = SDL_GetKeyboardState(0);
    if (key == FXS_KEY_SHIFT)
        return (SDL_GetModState() & KMOD_SHIFT) != 0;
    return state[key == ' ' ? SDL_SCANCODE_SPACE : SDL_SCANCODE_A + (key - 'a')];
}

static SDL_Surface *surface_of(const fxs_picture *picture)
{
    return SDL_CreateRGBSurfaceWithFormatFrom(picture->rgba, picture->width, picture->height, 32, 4 * picture->width,
                                              SDL_PIXELFORMAT_RGBA32);
}

int fxs_window_show(fxs_window *window, const fxs_picture *picture, const fxs_picture *overlay, fxs_message *message)
{
    SDL_Surface *target = SDL_GetWindowSurface(window->window), *below = surface_of(picture);
    SDL_Surface *above = overlay ? surface_of(overlay) : 0;
    int result = !target || !below || (overlay && !above);
    if (!result) {
        SDL_SetSurfaceBlendMode(below, SDL_BLENDMODE_NONE);
        result = SDL_BlitScaled(below, 0, target, 0) || (above && SDL_BlitSurface(above, 0, target, 0)) ||
                 SDL_UpdateWindowSurface(window->window);
    }
    SDL_FreeSurface(below);
    SDL_FreeSurface(above);
    return result ? fail(message) : 0;
}
