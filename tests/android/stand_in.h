/* Stand-ins for libandroid, libEGL and libvulkan of Android: windows that keep the picture shown last, and faults that
 * a test asks for. */
#ifndef STAND_IN_H
#define STAND_IN_H

#include <stdint.h>

typedef struct stand_in_window {
    int32_t width, height, refs;       /* refs: of ANativeWindow_fromSurface */
    int32_t shown_width, shown_height; /* of the picture; 0: none */
    uint32_t *pixels;                  /* RGBA, from the top */
    uint64_t shown;                    /* pictures */
    int is_taken;                      /* 1: a surface of EGL or Vulkan uses it */
} stand_in_window;

/* Faults, by number as in StandIn.java. */
enum { NO_VULKAN, NO_COMPUTE, NO_EGL, OUT_OF_DATE, SURFACE_LOST, DEVICE_LOST, FAULTS };

/* How many calls will fail: those that make a device for the first three, else those that show a picture. */
extern volatile int stand_in_faults[FAULTS];

/* Takes one of the faults that are left. Returns whether there was one. */
int stand_in_fails(int fault);

/* Takes a picture; bottom_up: its first row is the lowest. */
void stand_in_show(stand_in_window *window, const void *pixels, int32_t width, int32_t height, int bottom_up);

#endif
