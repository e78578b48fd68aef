/* The Vulkan back end: whole frames in compute shaders of Vulkan 1.1, on a device of the caller, with the same bytes as
   fxs_render. Functions return 0, or an FXS_ERR_* and a message in `why`, which must not be null: FXS_ERR_DEVICE if the
   device failed or was lost, FXS_ERR_MEMORY if it has too little memory. After either error, the next call may
   succeed. */
#ifndef FXS_VULKAN_H
#define FXS_VULKAN_H

#include <vulkan/vulkan_core.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Creating ---------------------------------------------------------------------------------------------------- */

/* A range of device memory. */
typedef struct fxs_vulkan_memory {
    VkDeviceMemory memory;
    VkDeviceSize offset;
    void *mapped;                  /* address of the range on the host, if VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT was
                                      required */
    void *handle;                  /* for the caller's use */
} fxs_vulkan_memory;

/* Functions of the caller that allocate and free device memory. The memory's type must have the properties `required`,
   and should have `preferred`. */
typedef VkResult fxs_vulkan_allocate_fn(void *argument, const VkMemoryRequirements *needs,
                                        VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred,
                                        fxs_vulkan_memory *memory);
typedef void fxs_vulkan_free_fn(void *argument, const fxs_vulkan_memory *memory);

typedef struct fxs_vulkan_options {
    uint32_t size;
    PFN_vkGetInstanceProcAddr load;     /* finds all functions of Vulkan */
    VkInstance instance;                /* Vulkan 1.1 or later, as the device; they must outlive the back end */
    VkPhysicalDevice physical;
    VkDevice device;                    /* no features or extensions need to be enabled */
    VkQueue queue;                      /* with compute; a call that submits work uses the queue, so no other thread may
                                           use it then */
    uint32_t family;                    /* family of the queue */
    const VkAllocationCallbacks *allocator;     /* null: Vulkan's own */
    fxs_vulkan_allocate_fn *allocate;   /* null: the back end calls vkAllocateMemory; it needs few large blocks */
    fxs_vulkan_free_fn *free;
    void *argument;                     /* first argument of `allocate` and `free` */
    const void *cache;                  /* bytes of fxs_vulkan_cache, from an earlier run with the same driver; may be
                                           null */
    size_t cache_bytes;
    uint64_t max_memory;                /* limit of device memory, bytes; 0: no limit */
} fxs_vulkan_options;
FXS_INIT(fxs_vulkan_options)

typedef struct fxs_vulkan fxs_vulkan;

typedef struct fxs_vulkan_info {
    const char *name;              /* name of the device; valid as long as the back end */
    uint64_t nanoseconds;          /* device time of the last frame that is known to be finished; 0 if the queue has no
                                      timestamps */
    uint64_t memory;               /* device memory of scenes and frames in bytes */
} fxs_vulkan_info;

/* Creates the back end: loads functions and makes the pipelines. A back end belongs to one thread at a time.
   fxs_vulkan_destroy frees *out, which is null after an error: FXS_ERR_ARGUMENT, FXS_ERR_UNSUPPORTED (a Vulkan before
   1.1, a queue without compute, a limit that is too low), FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_vulkan_create(fxs_vulkan **out, const fxs_vulkan_options *options, fxs_message *why);

/* Waits for the queue, and frees the back end with its scenes; null is allowed. */
FXS_EXPERIMENTAL void fxs_vulkan_destroy(fxs_vulkan *vulkan);

FXS_EXPERIMENTAL fxs_vulkan_info fxs_vulkan_get_info(const fxs_vulkan *vulkan);

/* Sets the most bytes of device memory that frames and scenes may use together; 0: no limit. */
FXS_EXPERIMENTAL void fxs_vulkan_limit(fxs_vulkan *vulkan, uint64_t bytes);

/* Writes the driver's compiled shaders to `to`, for fxs_vulkan_options.cache, and their size to *bytes, which is the
   room in `to` before. With a null `to`, only writes the size. */
FXS_EXPERIMENTAL int fxs_vulkan_cache(fxs_vulkan *vulkan, void *to, size_t *bytes, fxs_message *why);

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* Copies a scene to the device and waits. The scene is identified by the address of its fxs_scene; an equal scene that
   is there is not copied again. All rows (Gaussian codes) must be in memory, so `places` must be null. */
FXS_EXPERIMENTAL int fxs_vulkan_upload(fxs_vulkan *vulkan, const fxs_scene *scene, fxs_message *why);

/* Drops the device's copy of a scene; its memory is freed when the frames that read it have ended. Call it before the
   fxs_scene, or the bytes that it points to, change or are freed. */
FXS_EXPERIMENTAL void fxs_vulkan_drop(fxs_vulkan *vulkan, const fxs_scene *scene);

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Renders a request into its targets in host memory, and waits. Missing scenes are uploaded. `stats` may be null.
   Errors: as fxs_render, and FXS_ERR_UNSUPPORTED for the processor-only formats. After an error, the targets of an eye
   are unchanged or complete. */
FXS_EXPERIMENTAL int fxs_vulkan_render(fxs_vulkan *vulkan, const fxs_request *request, fxs_stats *stats,
                                       fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
