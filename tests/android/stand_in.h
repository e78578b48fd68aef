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

/* Number of calls that will fail, for each fault. A call makes a device (the first three faults) or shows a picture. */
extern volatile int stand_in_faults[FAULTS];

/* Counts down a fault. Returns true if the call must fail. */
int stand_in_fails(int fault);

/* Takes a picture; bottom_up: its first row is the lowest. */
void stand_in_show(stand_in_window *window, const void *pixels, int32_t width, int32_t height, int bottom_up);

#endif
