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

#define FXS_VULKAN_FRAMES 4        /* largest number of frames in flight */

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
    uint32_t frames;                    /* frames in flight: before a call of fxs_vulkan_record or fxs_vulkan_submit,
                                           the device must have ended the call this number of calls before; 1 to
                                           FXS_VULKAN_FRAMES, 0: 2 */
} fxs_vulkan_options;
FXS_INIT(fxs_vulkan_options)

typedef struct fxs_vulkan fxs_vulkan;

typedef struct fxs_vulkan_info {
    const char *name;              /* name of the device; valid as long as the back end */
    uint64_t nanoseconds;          /* device time of the last call of fxs_vulkan_render, or of the last frame in
                                      flight that was seen to end; 0 if the queue has no timestamps */
    uint64_t memory;               /* device memory of scenes and frames in bytes */
    uint32_t missing;              /* fxs_stats.missing of the last frame: chunks of scenes in parts that it drew
                                      coarser, as they were not on the device */
} fxs_vulkan_info;

/* Creates the back end: loads functions and makes the pipelines. A back end belongs to one thread at a time.
   fxs_vulkan_destroy frees *out, which is null after an error: FXS_ERR_ARGUMENT, FXS_ERR_UNSUPPORTED (a Vulkan before
   1.1, a queue without compute, a limit that is too low), FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_vulkan_create(fxs_vulkan **out, const fxs_vulkan_options *options, fxs_message *why);

/* Waits for the queue, and frees the back end with its scenes; null is allowed. Recorded frames must have ended. */
FXS_EXPERIMENTAL void fxs_vulkan_destroy(fxs_vulkan *vulkan);

FXS_EXPERIMENTAL fxs_vulkan_info fxs_vulkan_get_info(const fxs_vulkan *vulkan);

/* Sets the most bytes of device memory that frames and scenes may use together; 0: no limit. */
FXS_EXPERIMENTAL void fxs_vulkan_limit(fxs_vulkan *vulkan, uint64_t bytes);

/* Writes the driver's compiled shaders to `to`, for fxs_vulkan_options.cache, and their size to *bytes, which is the
   room in `to` before. With a null `to`, only writes the size. */
FXS_EXPERIMENTAL int fxs_vulkan_cache(fxs_vulkan *vulkan, void *to, size_t *bytes, fxs_message *why);

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* Settings of scenes in parts (fxs_scene.places is not null, as in a pager's scene). Drops those on the device.
   `pool_bytes` is the size of the pool on the device for a scene's chunks (256 Gaussians each), at least 16 chunks; 0:
   256 MiB. It is capped at the scene's size, and at half of the limit of device memory. `upload_bytes` is the most
   bytes that a frame uploads to all pools together, at least one chunk; 0: 8 MiB. Each frame in flight has as many
   bytes of memory that the host writes, besides the limit. */
FXS_EXPERIMENTAL void fxs_vulkan_stream(fxs_vulkan *vulkan, uint64_t pool_bytes, uint64_t upload_bytes);

/* Copies a scene to the device and waits. The scene is identified by the address of its fxs_scene; a scene that is
   already on the device is copied again only if its fxs_scene has changed. Of a scene in parts, only the coarsest
   chunks are copied. Each frame then copies chunks that it lacks and that are in memory, for the next frames; the least
   recently drawn chunks on the device make room. The frame draws the nearest ancestors that are on the device, as
   fxs_render does with the same chunks in memory. options.want tells, as in fxs_render, if a wanted chunk is in
   memory. */
FXS_EXPERIMENTAL int fxs_vulkan_upload(fxs_vulkan *vulkan, const fxs_scene *scene, fxs_message *why);

/* Drops the device's copy of a scene; its memory is freed when the frames that read it have ended. Call it before the
   fxs_scene, or the bytes that it points to, change or are freed. */
FXS_EXPERIMENTAL void fxs_vulkan_drop(fxs_vulkan *vulkan, const fxs_scene *scene);

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Renders a request into its targets in host memory, and waits. Missing scenes are uploaded. `stats` may be null. A
   stopped frame (FXS_ERR_STOPPED) uploads chunks too. Frames of scenes in parts that were recorded must have been
   submitted.
   A frame that exceeds a storage buffer of the device is drawn in windows of the pictures, one after the other. The
   bytes are the same.
   Errors: as fxs_render, and FXS_ERR_UNSUPPORTED for the processor-only formats. After an error, the targets of an eye
   are unchanged or complete, except that FXS_ERR_STOPPED, FXS_ERR_DEVICE, or FXS_ERR_MEMORY because the device ran out
   of memory, may leave some windows drawn. */
FXS_EXPERIMENTAL int fxs_vulkan_render(fxs_vulkan *vulkan, const fxs_request *request, fxs_stats *stats,
                                       fxs_message *why);

/* An image of the caller, with one sample a texel. The back end writes a picture's bytes also to an sRGB format without
   a conversion. */
typedef struct fxs_vulkan_image {
    VkImage image;                 /* VK_NULL_HANDLE: none */
    VkFormat format;
    VkImageUsageFlags usage;       /* with VK_IMAGE_USAGE_TRANSFER_DST_BIT to be written, _SRC_BIT to be read */
    uint32_t width, height, layers;     /* size of the image; layers 0: 1 */
    uint32_t layer;                /* array layer to use */
    uint32_t x, y;                 /* texel of the picture's upper left pixel */
    VkImageLayout before, after;   /* layouts before and after the frame. VK_IMAGE_LAYOUT_UNDEFINED before it discards
                                      the content outside of the picture */
} fxs_vulkan_image;

/* Images that one eye draws to and reads. The camera's picture must lie within each. */
typedef struct fxs_vulkan_target {
    enum fxs_format format;        /* RGBA8, or RGBA8_COVERAGE with alpha and without a backdrop */
    int depth_bits;                /* fraction bits of depths; 0: 16 */
    float plane_0, plane_1;        /* distances at the values 0 and 1 of a depth image of floats or 16 bits, world
                                      units; either may be infinite. R32_UINT is exact. The device converts the other
                                      formats in floats, so their last bits depend on it. If one plane is at least
                                      twice as far as the other, n, a written value is off by at most 2^-19, and a
                                      distance z that an occluder gives by at most 2^-20 z^2 / n */
    fxs_vulkan_image colour;       /* output: R8G8B8A8 or B8G8R8A8, UNORM or SRGB */
    fxs_vulkan_image depth;        /* output, the median depth: R32_UINT with the bytes of fxs_targets, R32_SFLOAT, or
                                      D32_SFLOAT, which needs a queue with graphics. Without a Gaussian: the far plane,
                                      or FXS_NOTHING */
    fxs_vulkan_image occluder;     /* input, depths that hide Gaussians: R32_UINT, R32_SFLOAT, D32_SFLOAT, D16_UNORM */
    fxs_vulkan_image backdrop;     /* input, the picture under the Gaussians, in a format of `colour` */
} fxs_vulkan_target;

/* Records the eyes of a request into a command buffer of the caller, outside of a render pass. The call does not submit
   and does not wait. targets[i] has the images of eye i. The request's own targets are ignored, except for their
   maps of rates. The scenes must have been uploaded. Submit the command buffers to the queue of the options, in the
   order of the calls. The images are used after all earlier commands of the queue, and before all later ones. The
   call changes the bound pipeline, descriptor sets and push constants of compute.
   Later frames draw the chunks of scenes in parts that a recorded frame uploads. So if a recorded frame is not
   submitted, do not submit those recorded after it, and call fxs_vulkan_idle, which forgets the chunks on the device.
   The rows of the chunks are read only during the call. A stopped frame uploads nothing.
   Errors: as fxs_render; FXS_ERR_TARGET and FXS_ERR_UNSUPPORTED for an image (format, usage, size, layout) or
   planes; FXS_ERR_ARGUMENT for a scene that was not uploaded, or too many frames in flight; FXS_ERR_MEMORY, also if
   the frame exceeds a storage buffer of the device (then a budget helps); FXS_ERR_DEVICE. After an error, nothing was
   recorded. An error that the device finds in a frame (FXS_ERR_SCENE) is returned by a later call. If a frame's lists
   exceed the device's buffers, the frame takes longer, and later frames get larger buffers. */
FXS_EXPERIMENTAL int fxs_vulkan_record(fxs_vulkan *vulkan, const fxs_request *request,
                                       const fxs_vulkan_target *targets, VkCommandBuffer commands, fxs_message *why);

/* The semaphores that a submission waits for, and the ones that it signals. Timeline semaphores have values; if the
   array of values is null, all semaphores are binary. */
typedef struct fxs_vulkan_sync {
    const VkSemaphore *waits, *signals;
    const uint64_t *wait_values, *signal_values;
    uint32_t wait_count, signal_count;
    VkFence fence;                 /* may be VK_NULL_HANDLE */
} fxs_vulkan_sync;

/* Does what fxs_vulkan_record does in a command buffer of its own, and submits it to the queue; does not wait. `sync`
   may be null. */
FXS_EXPERIMENTAL int fxs_vulkan_submit(fxs_vulkan *vulkan, const fxs_request *request,
                                       const fxs_vulkan_target *targets, const fxs_vulkan_sync *sync,
                                       fxs_message *why);

/* Writes the statistics of the last frame that was submitted. Returns 0; the error that the device found in this frame,
   which no later call returns then; or FXS_ERR_ARGUMENT if the frame has not ended, or none was submitted since the
   last error. */
FXS_EXPERIMENTAL int fxs_vulkan_stats(fxs_vulkan *vulkan, fxs_stats *stats, fxs_message *why);

/* Tells that no frame is in flight: the device is idle, and recorded frames that were not submitted never will be. If
   these uploaded chunks of scenes in parts, all pools are empty again. */
FXS_EXPERIMENTAL void fxs_vulkan_idle(fxs_vulkan *vulkan);

/* ---- Windows ----------------------------------------------------------------------------------------------------- */

/* Creates a surface of the caller's window, for example by vkCreateAndroidSurfaceKHR. */
typedef VkResult fxs_vulkan_surface_fn(void *argument, VkInstance instance, VkSurfaceKHR *surface);

typedef struct fxs_vulkan_window_options {
    uint32_t size;
    uint32_t device;                    /* number of the device; discrete GPUs come first */
    PFN_vkGetInstanceProcAddr load;     /* null: Vulkan's loader is loaded at run time */
    const char *const *extensions;      /* instance extensions that `surface` needs, VK_KHR_surface among them; used
                                           during the call */
    uint32_t extension_count;
    uint32_t width, height;             /* size in pixels for surfaces without a size of their own */
    fxs_vulkan_surface_fn *surface;     /* called when the window is opened, and after a surface was lost */
    void *argument;                     /* first argument of `surface` */
    const void *cache;                  /* as in fxs_vulkan_options */
    size_t cache_bytes;
    uint64_t max_memory;                /* as in fxs_vulkan_options */
} fxs_vulkan_window_options;
FXS_INIT(fxs_vulkan_window_options)

/* A window that shows frames by a swapchain, on a Vulkan device of the library's own. Frames stay in device memory. */
typedef struct fxs_vulkan_window fxs_vulkan_window;

typedef struct fxs_vulkan_window_info {
    fxs_vulkan *vulkan;            /* the window's back end, for scenes, limits, the cache and statistics; the window's
                                      functions alone draw by it */
    PFN_vkGetInstanceProcAddr load;
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkRenderPass pass;             /* render pass of overlays, with the swapchain's image as its only attachment */
    uint32_t width, height;        /* size of the swapchain's images; 0 before the first fxs_vulkan_window_show */
} fxs_vulkan_window_info;

/* Opens a window. fxs_vulkan_window_close frees *out, which is null after an error: FXS_ERR_UNSUPPORTED if the device
   cannot show frames on the surface, or the errors of fxs_vulkan_create. Null is allowed in fxs_vulkan_window_close. */
FXS_EXPERIMENTAL int fxs_vulkan_window_open(fxs_vulkan_window **out, const fxs_vulkan_window_options *options,
                                            fxs_message *why);
FXS_EXPERIMENTAL void fxs_vulkan_window_close(fxs_vulkan_window *window);

FXS_EXPERIMENTAL fxs_vulkan_window_info fxs_vulkan_window_get_info(const fxs_vulkan_window *window);

/* Destroys the surface, and with `make` true creates it anew by options.surface. Without a surface, the window shows
   nothing, and keeps its device and scenes. Call it with `make` 0 before the system destroys the surface's window. */
FXS_EXPERIMENTAL int fxs_vulkan_window_renew(fxs_vulkan_window *window, int make, fxs_message *why);

/* Draws the colours of a request into a hidden picture; two eyes stand side by side. The request's own targets are
   ignored, except for their maps of rates. Missing scenes are uploaded. If `stats` is null, the call does not wait for
   the device. Else it waits for the frame and writes its statistics. */
FXS_EXPERIMENTAL int fxs_vulkan_window_draw(fxs_vulkan_window *window, const fxs_request *request, fxs_stats *stats,
                                            fxs_message *why);

/* Shows the picture that was drawn last, from the next fxs_vulkan_window_show on. No fxs_vulkan_window_draw may run. */
FXS_EXPERIMENTAL void fxs_vulkan_window_turn(fxs_vulkan_window *window);

/* Records drawing commands over the picture, inside the window's render pass. The commands of the last
   fxs_vulkan_window_show have ended. */
typedef void fxs_vulkan_overlay_fn(void *argument, VkCommandBuffer commands, uint32_t width, uint32_t height);

/* Shows a picture, scaled to the window, or with `drawn` 0 a colour, 0xrrggbbaa, and an overlay, which may be null. It
   waits until the commands of the last call have ended, and until the system has a free image. Another thread may
   draw meanwhile. A window without pixels shows nothing. A lost surface is renewed. */
FXS_EXPERIMENTAL int fxs_vulkan_window_show(fxs_vulkan_window *window, int drawn, uint32_t colour,
                                            fxs_vulkan_overlay_fn *overlay, void *argument, fxs_message *why);

/* Sets the size in pixels of a surface without a size of its own. */
FXS_EXPERIMENTAL void fxs_vulkan_window_resize(fxs_vulkan_window *window, uint32_t width, uint32_t height);

#ifdef __cplusplus
}
#endif

#endif
