/* A back end: one way to render frames, which a program chooses by name. The processor is one, a GPU another; one that
 * is written elsewhere fills in this table and is used like them. Not stable: it may change with every version.
 * backends.h (of the port) lists those of the library. */
#ifndef FXS_BACKEND_H
#define FXS_BACKEND_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a back end can do beyond colour. What it cannot is FXS_ERR_UNSUPPORTED, and the processor is there. */
enum fxs_backend_can {
    FXS_CAN_EXACT = 1,             /* the bytes of the processor */
    FXS_CAN_TRACE = 2,             /* depth and id targets */
    FXS_CAN_COMPOSE = 4,           /* occluder, backdrop, coverage target, RGBA16 */
    FXS_CAN_SHARE_EYES = 8,        /* two eyes with one order and one set of colours; else each is a frame */
    FXS_CAN_DEVICES = 16           /* there may be several devices, and each may render on a thread of its own */
};

/* All 0 is a default. */
typedef struct fxs_backend_options {
    int device;                    /* one of those that it lists */
    uint64_t max_memory;           /* bytes, of working memory or the device's; 0: as much as it takes */
    uint32_t threads;              /* of the processor, 1 to 64; 0: one for each processor */
    unsigned without_cpu;          /* instruction sets not to be used: FXS_CPU_* of kernels.h */
} fxs_backend_options;

/* The functions return 0 or an FXS_ERR_*. `why`, which is not null, is filled in where it is an error. */
typedef struct fxs_backend {
    const char *name;              /* as --backend takes it */
    const char *does;              /* in a few words */
    unsigned can;                  /* FXS_CAN_* */

    /* The name of a device, from 0 on, cut to `size` bytes with the final 0. Returns 0, or an error and why where there
       is no such device, or no driver, or the library was built without. */
    int (*device)(int device, char *name, size_t size, fxs_message *why);

    /* Opens a device, on the calling thread. *self is null after an error. Errors: FXS_ERR_ARGUMENT, FXS_ERR_DEVICE,
       FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED. */
    int (*open)(void **self, const fxs_backend_options *options, fxs_message *why);

    /* Renders into the targets, in the processor's memory, and waits until they are written. What a device keeps of the
       objects' scenes is found again by the address of the fxs_scene. *stats may be null; where there are two eyes, it
       is of both. One thread at a time, and for GL that which opened it. Errors as fxs_render. */
    int (*render)(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why);

    /* A scene's bytes have changed or go away: what the device keeps of it is dropped. */
    void (*forget)(void *self, const fxs_scene *scene);

    /* The version of a stage that is used: "avx2", "cuda". */
    const char *(*version)(const void *self, enum fxs_stage stage);

    /* The device's own time for the last frame; 0 where it has none or it is not known. */
    uint64_t (*nanoseconds)(const void *self);

    /* Waits for what is under way and gives everything back; null is allowed. */
    void (*close)(void *self);

    /* What the first eye shows at pixel (x, y): as fxs_pick, and of the targets only what that reads. Null where it
       cannot; the processor can. */
    int (*pick)(void *self, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                fxs_message *why);
} fxs_backend;

#ifdef __cplusplus
}
#endif

#endif
