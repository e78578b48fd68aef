/* SDL2 window: translates SDL events to events of window.h, and copies pictures and panels to the window. */
#include "window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <SDL2/SDL.h>

#include "src/base/os_calls.h"

#ifndef SDL_HINT_VIDEODRIVER        /* SDL before 2.0.22 does not define this macro */
#define SDL_HINT_VIDEODRIVER "SDL_VIDEODRIVER"
#endif

struct fxs_window {
    SDL_Window *window;
    char *dropped;
    int moved;   /* distance that the mouse has moved since its button went down, in points of the screen */
};

static int fail(fxs_message *message)
{
    return fxs_fail(message, "no window: %s", SDL_GetError());
}

/* Lists the SDL video drivers to try. Excludes drivers that show nothing or take over the console, and Wayland without
   a socket folder. */
static void choose_drivers(void)
{
    char list[256] = "";
    const int wayland = SDL_getenv("XDG_RUNTIME_DIR") || SDL_getenv("WAYLAND_DISPLAY");
    if (SDL_GetHint(SDL_HINT_VIDEODRIVER))
        return;
    for (int i = 0; i < SDL_GetNumVideoDrivers(); i++) {
        const char *name = SDL_GetVideoDriver(i);
        if (!strcmp(name, "offscreen") || !strcmp(name, "dummy") || !strcmp(name, "evdev") ||
            !strcmp(name, "KMSDRM") || (!wayland && !strcmp(name, "wayland")))
            continue;
        SDL_strlcat(list, *list ? "," : "", sizeof list);
        SDL_strlcat(list, name, sizeof list);
    }
    SDL_SetHint(SDL_HINT_VIDEODRIVER, list);
}

static SDL_Window *make_window(Uint32 flags)
{
    return SDL_CreateWindow("fixsplat", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 1, 1,
                            flags | SDL_WINDOW_HIDDEN | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
}

int fxs_window_open(fxs_window **window, int vulkan, fxs_message *message)
{
    /* Makes SDL draw without OpenGL, because a renderer may need the OpenGL context. */
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
/* SDL has this hint since 2.24; without the hint, Windows enlarges the pixels */
#ifdef SDL_HINT_WINDOWS_DPI_AWARENESS
    SDL_SetHint(SDL_HINT_WINDOWS_DPI_AWARENESS, "permonitorv2");
#endif
    *window = calloc(1, sizeof **window);
    if (!*window)
        return fxs_fail(message, "no window: out of memory");
    choose_drivers();
    if (!SDL_InitSubSystem(SDL_INIT_VIDEO)) {
        (*window)->window = vulkan ? make_window(SDL_WINDOW_VULKAN) : 0;
        if (!(*window)->window)
            (*window)->window = make_window(0);
        SDL_StopTextInput();
    }
    if ((*window)->window)
        return 0;
    fxs_fail(message, "no window: %s; without a display, view --web shows scenes in a browser", SDL_GetError());
    fxs_window_close(*window);
    *window = 0;
    return -1;
}

/* Hides the window and waits for X11 events that are under way. Arriving after the window is closed, they would end the
   program. */
static void let_wakes_arrive(fxs_window *window)
{
    SDL_HideWindow(window->window);
    if (!strcmp(SDL_GetCurrentVideoDriver(), "x11"))
        SDL_Delay(20);
}

void fxs_window_close(fxs_window *window)
{
    if (window->window) {
        let_wakes_arrive(window);
        SDL_DestroyWindow(window->window);
    }
    SDL_free(window->dropped);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    if (!SDL_WasInit(0))
        SDL_Quit();
    free(window);
}

void *fxs_window_handle(const fxs_window *window)
{
    return window->window;
}

void fxs_window_size(const fxs_window *window, int *width, int *height)
{
#if SDL_VERSION_ATLEAST(2, 26, 0)
    SDL_GetWindowSizeInPixels(window->window, width, height);
#else
    SDL_GetWindowSize(window->window, width, height);
#endif
}

static double pixels_in_point(const fxs_window *window)
{
    int width, height, points;
    fxs_window_size(window, &width, &height);
    SDL_GetWindowSize(window->window, &points, 0);
    return points > 0 ? fmax(1, (double)width / points) : 1;
}

/* Returns the pixels per point of the screen. On Windows, SDL's positions are in pixels, and a point is 1/96 inch. */
double fxs_window_scale(const fxs_window *window)
{
    float across;
    if (!strcmp(SDL_GetCurrentVideoDriver(), "windows") &&
        !SDL_GetDisplayDPI(SDL_GetWindowDisplayIndex(window->window), 0, &across, 0))
        return fmax(1, (double)across / 96);
    return pixels_in_point(window);
}

void fxs_window_resize(fxs_window *window, int width, int height)
{
    SDL_Rect room;
    double scale = 1 / pixels_in_point(window);
    if (!SDL_GetDisplayUsableBounds(SDL_GetWindowDisplayIndex(window->window), &room))
        scale = fmin(scale, fmin((double)room.w / width, (double)room.h / height));
    SDL_SetWindowSize(window->window, (int)fmax(1, width * scale), (int)fmax(1, height * scale));
    SDL_SetWindowPosition(window->window, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED);
    SDL_ShowWindow(window->window);
}

void fxs_window_title(fxs_window *window, const char *title)
{
    SDL_SetWindowTitle(window->window, title);
}

/* Translates a mouse button event of SDL. Motion of up to three points of the screen counts as a click, because hands
   shake. */
static void translate_button(fxs_window *window, const SDL_MouseButtonEvent *in, fxs_window_event *out)
{
    const double scale = pixels_in_point(window);
    if (in->button != SDL_BUTTON_LEFT)
        return;
    if (in->type == SDL_MOUSEBUTTONDOWN)
        out->type = FXS_EVENT_PRESS;
    else
        out->type = window->moved <= 3 ? FXS_EVENT_CLICK : FXS_EVENT_RELEASE;
    window->moved = 0;
    out->count = in->clicks;
    out->x = in->x * scale;
    out->y = in->y * scale;
}

static void translate_motion(fxs_window *window, const SDL_MouseMotionEvent *in, fxs_window_event *out)
{
    const double scale = pixels_in_point(window);
    out->type = FXS_EVENT_POINTER;
    out->left = (in->state & SDL_BUTTON_LMASK) != 0;
    out->other = (in->state & (SDL_BUTTON_MMASK | SDL_BUTTON_RMASK)) != 0;
    out->dx = in->xrel * scale;
    out->dy = in->yrel * scale;
    out->x = in->x * scale;
    out->y = in->y * scale;
    window->moved += abs(in->xrel) + abs(in->yrel);
}

static int translate(fxs_window *window, const SDL_Event *in, fxs_window_event *out)
{
    *out = (fxs_window_event){.type = FXS_EVENT_NONE};
    switch (in->type) {
    case SDL_QUIT:
        out->type = FXS_EVENT_QUIT;
        break;
    case SDL_KEYDOWN:
        out->type = in->key.repeat ? FXS_EVENT_NONE : FXS_EVENT_KEY;
        out->key = in->key.keysym.sym == SDLK_KP_ENTER ? FXS_KEY_ENTER : in->key.keysym.sym;
        break;
    case SDL_MOUSEMOTION:
        translate_motion(window, &in->motion, out);
        break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        translate_button(window, &in->button, out);
        break;
    case SDL_MOUSEWHEEL:
        out->type = FXS_EVENT_WHEEL;
        out->dy = (double)in->wheel.preciseY;
        break;
    case SDL_DROPFILE:
        SDL_free(window->dropped);
        out->type = FXS_EVENT_DROP;
        out->path = window->dropped = in->drop.file;
        fxs_path_take(window->dropped);
        break;
    case SDL_USEREVENT:
        out->type = FXS_EVENT_WOKEN;
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

void fxs_window_wake(void)
{
    SDL_Event event;
    SDL_zero(event);
    event.type = SDL_USEREVENT;
    SDL_PushEvent(&event);
}

int fxs_window_holds(int key)
{
    const Uint8 *state = SDL_GetKeyboardState(0);
    if (key == FXS_KEY_SHIFT || key == FXS_KEY_ALT)
        return (SDL_GetModState() & (key == FXS_KEY_SHIFT ? KMOD_SHIFT : KMOD_ALT | KMOD_CTRL)) != 0;
    if (key >= FXS_KEY_LEFT && key <= FXS_KEY_DOWN)
        return state[(const int[]){SDL_SCANCODE_LEFT, SDL_SCANCODE_RIGHT, SDL_SCANCODE_UP, SDL_SCANCODE_DOWN}
                     [key - FXS_KEY_LEFT]];
    return state[key == ' ' ? SDL_SCANCODE_SPACE : SDL_SCANCODE_A + (key - 'a')];
}

static SDL_Surface *surface_of(const fxs_canvas *picture)
{
    return SDL_CreateRGBSurfaceWithFormatFrom(picture->rgba, picture->width, picture->height, 32, 4 * picture->width,
                                              SDL_PIXELFORMAT_RGBA32);
}

static int show_panel(SDL_Surface *target, const fxs_panel *panel)
{
    SDL_Surface *surface = surface_of(&panel->picture);
    SDL_Rect place = {panel->x, panel->y, 0, 0};
    const int result = !surface || SDL_BlitSurface(surface, 0, target, &place);
    SDL_FreeSurface(surface);
    return result;
}

int fxs_window_show(fxs_window *window, const fxs_canvas *picture, uint32_t colour, const fxs_panel *panels, int count,
                    fxs_message *message)
{
    SDL_Surface *target = SDL_GetWindowSurface(window->window), *below = picture ? surface_of(picture) : 0;
    int result = !target || (picture && !below);
    if (!result && picture) {
        SDL_SetSurfaceBlendMode(below, SDL_BLENDMODE_NONE);
        result = SDL_BlitScaled(below, 0, target, 0);
    } else if (!result) {
        result = SDL_FillRect(target, 0, SDL_MapRGB(target->format, (Uint8)(colour >> 24), (Uint8)(colour >> 16),
                                                    (Uint8)(colour >> 8)));
    }
    for (int i = 0; i < count && !result; i++)
        result = show_panel(target, &panels[i]);
    result = result || SDL_UpdateWindowSurface(window->window);
    SDL_FreeSurface(below);
    return result ? fail(message) : 0;
}
