/* What a test tells the layer failing_layer.c, and learns from it: the symbol fxs_failing of the shared library. */
#ifndef FAILING_LAYER_H
#define FAILING_LAYER_H

#include <vulkan/vulkan_core.h>

#define EXPORT __attribute__((visibility("default")))

typedef struct fxs_failing_layer {
    long calls;                    /* number of calls so far that can fail */
    long fails_at;                 /* number of the call that fails, from 0; -1: none */
    int ever;                      /* 1: all later calls fail too */
    VkResult result;
    unsigned long messages;        /* of the validation layer */
    unsigned waits;                /* number of barriers between dispatches */
} fxs_failing_layer;

#endif
