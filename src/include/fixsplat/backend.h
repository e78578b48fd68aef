/* Back ends: ways to render frames on the processor or on a GPU, chosen by name. */
#ifndef FXS_BACKEND_H
#define FXS_BACKEND_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- A back end -------------------------------------------------------------------------------------------------- */

/* A back end: one way to render frames, on the processor or on a GPU, which a program selects by name. backend.h lists
   the library's back ends. Other programs may fill in the struct fxs_backend for their own. */

/* Features of a back end besides colour pictures. A request that needs a missing feature ends with FXS_ERR_UNSUPPORTED.
   Every other request gets the same bytes as on the processor. The processor has all features except
   FXS_CAN_DEVICES. */
enum fxs_backend_can {
    FXS_CAN_TRACE = 1,             /* can write targets (output pictures) of depths and of Gaussians' ids */
    FXS_CAN_COMPOSE = 2,           /* accepts an occluder (a picture of depths that hide Gaussians) and a backdrop (a
                                      picture behind the scene), and can write coverage and 16-bit RGBA */
    FXS_CAN_DEVICES = 4,           /* has several devices; each may render on its own thread */
    FXS_CAN_PART = 8,              /* can draw scenes with only a part of their Gaussians in memory
                                      (fxs_scene.places) */
    FXS_CAN_RATES = 16             /* accepts a map of rates (fxs_targets.rates) */
};

/* Options for opening a back end. A field of 0 stands for its default. */
typedef struct fxs_backend_options {
    uint32_t size;
    int device;                    /* number of the device to open, from 0 on */
    uint64_t max_memory;           /* limit of working memory or device memory, bytes; 0: no limit */
    uint32_t threads;              /* number of threads on the processor, 1 to 64; 0: one thread per processor */
    unsigned without_cpu;          /* instruction sets that the back end must not use: flags FXS_CPU_* of
                                      internal/kernels.h */
} fxs_backend_options;
FXS_INIT(fxs_backend_options)

/* A back end as a table of functions. Unless stated otherwise, a function returns 0 or an FXS_ERR_*. After an error,
   `why` has a message; the pointer must not be null. */
typedef struct fxs_backend {
    const char *name;              /* name of the back end, as in fxs_backend_find and the command's option --backend */
    const char *does;              /* description of the back end in a few words */
    unsigned can;                  /* FXS_CAN_* */

    /* Writes the name of device number `device`, from 0 on. The name is cut to `size` bytes with the final 0. Returns
       0, or an error if the device or the driver does not exist, or the library was built without this back end. */
    int (*device)(int device, char *name, size_t size, fxs_message *why);

    /* Opens a device, on the calling thread. *self is null after an error. Errors: FXS_ERR_ARGUMENT,
       FXS_ERR_DEVICE, FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED. */
    int (*open)(void **self, const fxs_backend_options *options, fxs_message *why);

    /* Renders a request into its targets (output pictures), which are in host memory, and waits until they are written.
       A device may keep copies of the objects' scenes, identified by the address of the fxs_scene. `stats` may be null;
       for two eyes, it covers both. One thread at a time may call this function; with OpenGL, only the thread that
       called `open`. Errors: as fxs_render. */
    int (*render)(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why);

    /* Drops the device's copy of a scene. The program calls it when the scene's bytes have changed or will be freed. */
    void (*forget)(void *self, const fxs_scene *scene);

    /* Returns the kernel version that computes a rendering stage, such as "avx2" or "cuda". */
    const char *(*version)(const void *self, enum fxs_stage stage);

    /* Returns the time of the last frame on the device, in nanoseconds. Returns 0 without a clock, or if the time is
       unknown. */
    uint64_t (*nanoseconds)(const void *self);

    /* Waits for unfinished work and frees the back end; null is allowed. */
    void (*close)(void *self);

    /* Finds the Gaussian that the first eye shows at pixel (x, y), as fxs_pick does, with the targets that fxs_pick
       reads. The function pointer is null if the back end cannot pick; the processor's back end can. */
    int (*pick)(void *self, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                fxs_message *why);
} fxs_backend;

/* ---- The list of back ends --------------------------------------------------------------------------------------- */

/* The library's back ends, by name. A program that renders on the processor:

       const fxs_backend *cpu = fxs_backend_find("cpu");
       void *self;
       if (cpu->open(&self, &options, &why)) ...            options: all fields 0
       cpu->render(self, &request, NULL, &why);
       cpu->close(self); */

/* The error message of the back end "cuda" if the library was built without nvcc, NVIDIA's compiler. */
#ifdef _WIN32
#define FXS_WITHOUT_CUDA "not in the build for Windows"
#else
#define FXS_WITHOUT_CUDA "this build is without nvcc, the compiler of the CUDA toolkit"
#endif


/* Returns a back end by its number in the list, from 0 on: the processor is first. Returns null beyond the last. The
   list is the same in every build: for a back end that the build lacks, its functions `device` and `open` report the
   reason. */
FXS_API const fxs_backend *fxs_backend_at(int index);

/* Returns a back end by its name: cpu, auto (here the processor), gles, gles-fetch, gles-compute, osmesa, vulkan, cuda.
   Returns null for other names. */
FXS_API const fxs_backend *fxs_backend_find(const char *name);

#ifdef __cplusplus
}
#endif

#endif
