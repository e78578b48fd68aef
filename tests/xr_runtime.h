/* What tests read of xr_runtime.c, in the same process, by the exported function xr_runtime. */
#ifndef XR_RUNTIME_H
#define XR_RUNTIME_H

#include <openxr/openxr.h>

enum { XR_RUNTIME_COLOUR, XR_RUNTIME_DEPTH };

typedef struct xr_runtime_seen {
    uint64_t frames, shown;            /* ended frames; those with a layer */
    int width, height;                 /* rectangle of the last layer */
    int full_width, full_height;
    XrView views[2];                   /* eyes of the last frame */
    XrPosef hands[2];
    const void *pixels[2][2];          /* [colour or depth][eye]: rows of full_width words, from the top (Vulkan) or
                                          the bottom (OpenGL ES); null: none */
    int blends;                        /* 1: the last layer was blended by alpha over the room */
    uint64_t hash;                     /* FNV-1a of all colours that were shown */
} xr_runtime_seen;

typedef const xr_runtime_seen *xr_runtime_fn(void);

#endif
