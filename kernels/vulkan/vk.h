/* Internal declarations of the Vulkan back end.
 *
 * A frame takes a slot, with its uniforms, table of places and status, until its last command has written its serial
 * number behind the status. Slot 0 is for calls that wait; the others are for frames in flight, in turn. The large
 * buffers are parts of one block, which all frames share: they run in the order of submission to one queue. A block
 * that is replaced is retired, and freed after the last call that may use it has ended.
 *
 * A frame of scenes in parts first copies chunks from its slot to places that it does not draw, for later frames.
 * Earlier frames may draw the chunks that were there: the frame's first barrier makes its copies wait for them. */
#ifndef FXS_VK_H
#define FXS_VK_H

#include <fixsplat/vulkan.h>
#include "kernels/compute/plan.h"
#include "src/core/mirror.h"

/* Lists of the functions of an instance and of a device that the back end calls: F(name without vk). */
#define FXS_VK_INSTANCE_FUNCTIONS(F) \
    F(GetPhysicalDeviceMemoryProperties) F(GetPhysicalDeviceProperties2) \
    F(GetPhysicalDeviceQueueFamilyProperties)
#define FXS_VK_FUNCTIONS(F) \
    F(AllocateCommandBuffers) F(AllocateDescriptorSets) F(AllocateMemory) F(BeginCommandBuffer) F(BindBufferMemory) \
    F(CmdBindDescriptorSets) F(CmdBindPipeline) F(CmdCopyBuffer) F(CmdCopyBufferToImage) F(CmdCopyImageToBuffer) \
    F(CmdDispatch) F(CmdDispatchIndirect) F(CmdFillBuffer) F(CmdPipelineBarrier) F(CmdPushConstants) \
    F(CmdResetQueryPool) F(CmdUpdateBuffer) F(CmdWriteTimestamp) F(CreateBuffer) \
    F(CreateCommandPool) F(CreateComputePipelines) F(CreateDescriptorPool) F(CreateDescriptorSetLayout) \
    F(CreateFence) F(CreatePipelineCache) F(CreatePipelineLayout) F(CreateQueryPool) F(CreateShaderModule) \
    F(DestroyBuffer) F(DestroyCommandPool) F(DestroyDescriptorPool) F(DestroyDescriptorSetLayout) F(DestroyFence) \
    F(DestroyPipeline) F(DestroyPipelineCache) F(DestroyPipelineLayout) F(DestroyQueryPool) F(DestroyShaderModule) \
    F(EndCommandBuffer) F(FreeCommandBuffers) F(FreeMemory) F(GetBufferMemoryRequirements) F(GetPipelineCacheData) \
    F(GetQueryPoolResults) F(MapMemory) F(QueueSubmit) F(QueueWaitIdle) F(ResetFences) F(UpdateDescriptorSets) \
    F(WaitForFences)
#define FXS_VK_MEMBER(name) PFN_vk##name name;
typedef struct fxs_vk_functions {
    FXS_VK_INSTANCE_FUNCTIONS(FXS_VK_MEMBER)
    FXS_VK_FUNCTIONS(FXS_VK_MEMBER)
} fxs_vk_functions;

/* Kinds of memory: on the device; written by the host; read by the host. */
enum fxs_vk_kind { FXS_VK_DEVICE, FXS_VK_UP, FXS_VK_DOWN };

typedef struct fxs_vk_block {
    struct fxs_vk_block *next;     /* in the list of retired blocks */
    VkBuffer buffer;
    fxs_vulkan_memory memory;
    enum fxs_vk_kind kind;
    uint64_t bytes, call;          /* call: number of the last call that may use a retired block */
} fxs_vk_block;

enum { FXS_VK_ALIGNED = 256, FXS_VK_SLOTS = 1 + FXS_VULKAN_FRAMES, FXS_VK_PARTS = 64,
       FXS_VK_SERIAL = FXS_COMPUTE_EYES * FXS_COMPUTE_STATUS, FXS_VK_PICTURE = FXS_VK_SERIAL + 32,
       FXS_VK_CONVERT = FXS_COMPUTE_PROGRAMS, FXS_VK_PROGRAMS };

/* Arguments of the shader `convert`; kinds as in convert.comp. */
enum { FXS_VK_AS_IS, FXS_VK_SWAP, FXS_VK_TO_FLOAT, FXS_VK_FROM_FLOAT, FXS_VK_FROM_16 };
typedef struct fxs_vk_conversion {
    uint32_t kind, count, from, to;        /* number of pixels; words of buffer FXS_COMPUTE_MEMORY */
    int32_t bits;
    float inverse[2];
} fxs_vk_conversion;

typedef struct fxs_vk_scene {
    struct fxs_vk_scene *next;
    const fxs_scene *key;
    fxs_scene here;
    fxs_vk_block *heads, *parts[FXS_VK_PARTS];
    uint32_t part_chunks;
    fxs_mirror *mirror;            /* of a scene in parts: which chunks are on the device; else null */
} fxs_vk_scene;

typedef struct fxs_vk_slot {
    uint64_t serial;               /* number of the frame that is in flight; 0: none */
    fxs_request request;           /* of the plan */
    fxs_plan plan;
    fxs_vk_block *up;              /* uniforms, table of places, planes of the host's images, chunks to upload */
    fxs_vk_block *down;            /* status, serial number, finished picture (at word FXS_VK_PICTURE) */
    uint32_t eyes, chunks;         /* chunks: number of chunks that the frame uploads */
    uint64_t at[FXS_COMPUTE_EYES][FXS_COMPUTE_BUFFERS];    /* offsets of the large buffers in their block */
    int result;                    /* of fxs_plan_look, after the frame has ended */
    fxs_message why;
    VkDescriptorPool pool;
    VkDescriptorSet *sets;
    uint32_t set_count;
    VkCommandBuffer commands;
    VkFence fence;
} fxs_vk_slot;

struct fxs_vulkan {
    fxs_vk_functions vk;
    fxs_vulkan_options options;
    VkPhysicalDeviceMemoryProperties memories;
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    uint64_t most_allocated;       /* largest allocation of memory in bytes */
    uint64_t timestamp_mask;
    double timestamp_nanoseconds;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipelineCache cache;
    VkPipeline programs[FXS_VK_PROGRAMS];
    VkCommandPool commands;
    VkQueryPool queries;
    fxs_vk_slot slots[FXS_VK_SLOTS];
    fxs_vk_block *frame, *retired;
    fxs_vk_scene *scenes;
    uint64_t pool_bytes, upload_bytes;     /* of fxs_vulkan_stream; 0: the default */
    uint32_t turn, missing;        /* number of the frame; chunks that the last one lacked */
    fxs_plan_rooms rooms;
    uint64_t serial;               /* number of frames */
    uint64_t call, ended;          /* number of calls with frames in flight; of those that have ended */
    int late;                      /* an error that the device found in a frame in flight; 0: none */
    fxs_message late_why;
    uint64_t taken, nanoseconds;
    int graphics;                  /* 1: the queue has graphics, and may write depth images */
    void *memory;                  /* host memory of plans */
    size_t memory_bytes;
};

/* Like fxs_vulkan_create. renders 0: without the pipelines of frames, for other work on the device. */
int fxs_vk_create(fxs_vulkan **out, const fxs_vulkan_options *options, int renders, fxs_message *why);

/* Makes a shader module of SPIR-V that tools/scripts/vulkan_shaders.sh -c has packed. */
VkResult fxs_vk_make_module(const fxs_vulkan *v, const uint8_t *packed, size_t bytes, VkShaderModule *module);

/* Returns 0 for VK_SUCCESS, or the error with its message. */
int fxs_vk_said(VkResult result, fxs_message *why);

/* Blocks. fxs_vk_reserve replaces *block by one of at least `bytes` bytes, if it is smaller. fxs_vk_retire frees a
   block when the frames in flight have ended; null is allowed. fxs_vk_collect looks which frames have ended. */
int fxs_vk_reserve(fxs_vulkan *v, fxs_vk_block **block, enum fxs_vk_kind kind, uint64_t bytes, fxs_message *why);
void fxs_vk_retire(fxs_vulkan *v, fxs_vk_block **block);
void fxs_vk_collect(fxs_vulkan *v);

/* Frees what a slot holds. Its command buffer must not be pending. */
void fxs_vk_drop_slot(fxs_vulkan *v, fxs_vk_slot *slot);

/* Waits for the queue, and frees the slots and large buffers that no frame in flight uses: after a failure, and at the
   end. */
void fxs_vk_give_back(fxs_vulkan *v);

/* fxs_vk_begin begins the command buffer of a slot, and fxs_vk_run submits that and waits. */
int fxs_vk_begin(fxs_vulkan *v, fxs_vk_slot *slot, fxs_message *why);
int fxs_vk_run(fxs_vulkan *v, fxs_vk_slot *slot, fxs_message *why);

/* Makes later commands of the stages `to` wait for all commands of the stages `from`. */
void fxs_vk_barrier(const fxs_vulkan *v, VkCommandBuffer commands, VkPipelineStageFlags from, VkPipelineStageFlags to);

/* Counts or records the steps of a frame. The steps of equal buffers in a row share a descriptor set. */
typedef struct fxs_vk_walk {
    fxs_vulkan *v;
    fxs_vk_slot *slot;
    VkCommandBuffer commands;      /* null: only counts the descriptor sets */
    fxs_vk_scene *const *copies;
    const fxs_vulkan_target *targets;      /* images of the caller, of each eye; null: images of the host */
    fxs_stats *stats;              /* of fxs_vulkan_render, as are the next two */
    uint64_t nanoseconds;
    uint32_t windows;              /* number of windows of the frame that were drawn */
    fxs_step last;
    uint32_t sets;
} fxs_vk_walk;

/* The stages that use the large buffers. */
enum { FXS_VK_STEPS = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
       FXS_VK_ALL = FXS_VK_STEPS | VK_PIPELINE_STAGE_TRANSFER_BIT };

void fxs_vk_take_step(void *walk, const fxs_step *step);

/* Checks a request, and finds the copies of its scenes; uploads missing ones if `upload` is true. */
int fxs_vk_begin_request(fxs_vulkan *v, const fxs_request *request, int upload, fxs_vk_scene ***copies,
                         fxs_message *why);

/* fxs_vk_prepare begins the plan of the slot's request, and lays the frame out; fxs_vk_record records it. Nothing
   between the two can fail. */
int fxs_vk_prepare(fxs_vk_walk *w, fxs_message *why);
void fxs_vk_record(fxs_vk_walk *w);

/* Requests the planes (colours, depths) that the caller's images need: an image of the host marks a plane as wanted. */
void fxs_vk_ask_planes(fxs_targets *to, const fxs_vulkan_target *target);

/* The caller's images: copies from and to them, and the conversion of pixels before and after the frame. */
void fxs_vk_copy_in(const fxs_vk_walk *w);
void fxs_vk_convert_in(fxs_vk_walk *w);
void fxs_vk_convert_out(fxs_vk_walk *w);
void fxs_vk_copy_out(const fxs_vk_walk *w);

/* Uploads of chunks that the scenes in parts of `copies` lack. fxs_vk_staged returns the most bytes that a frame
   uploads, 0 without such scenes. fxs_vk_record_chunks records copies of at most `bytes` bytes, through the slot's
   block `up` at `at`; if the device does not run them, fxs_vk_forget_chunks must follow, which empties all pools.
   fxs_vk_put_chunks uploads without a frame, and waits. */
uint64_t fxs_vk_staged(const fxs_vulkan *v, fxs_vk_scene *const *copies, uint32_t count);
void fxs_vk_record_chunks(const fxs_vk_walk *w, uint32_t count, uint64_t at, uint64_t bytes);
void fxs_vk_forget_chunks(fxs_vulkan *v);
int fxs_vk_put_chunks(fxs_vk_walk *w, uint32_t count, fxs_message *why);

/* Finds the copy of a scene; null: none. */
fxs_vk_scene *fxs_vk_find(const fxs_vulkan *v, const fxs_scene *scene);

#endif
