/* Internal declarations of the fit through Vulkan.
 *
 * A step is recorded into the command buffer of a turn and submitted; the host waits for it when its turn comes again.
 * If the lists of a step outgrow their memory, that step and all later ones change nothing; they are then made again
 * with more memory. The host decides which Gaussians are added, moved or removed, with the functions of src/fit, and
 * the device copies the Gaussians accordingly. */
#ifndef FXS_VF_H
#define FXS_VF_H

#include <fixsplat/fit.h>
#include "kernels/vulkan/vk.h"
#include "fit_order.h"
#include "port/vulkan/vulkan_device.h"
#include "src/fit/engine.h"

#define VF_SHADERS(F) \
    F(project) F(add_parts) F(scan_parts) F(put_bases) F(cover) F(cover_large) F(place_lists) F(append_slots) \
    F(sort_lists) F(blend_splats) F(reduce) F(find_derivatives) F(find_gradient) F(report_rows) F(sum_gain_rows) \
    F(backward_tiles) F(gather_view) F(gather_large) F(sum_pose_parts) F(plane_splats) F(compare_depths) \
    F(update_shapes) F(update_sh) F(add_noise) F(smooth_scales) F(quantise_shapes) F(quantise_sh) F(rebuild) F(test)
#define VF_NUMBER(name) VF_##name,
enum { VF_SHADERS(VF_NUMBER) VF_COUNT };

enum { VF_BUFFERS = 9, VF_SETS = 4, VF_TURNS = 4, VF_VIEW_PLANES = FXS_FIT_SUMS + 1, VF_STAGES = 6,
       VF_ALIGNED = 256 };             /* largest alignment of storage buffers that a device may ask for */

/* The blocks in the order of the shaders' bindings. The last binding is the order, behind the status. */
enum { VF_ORDER, VF_PARAMETERS, VF_MOMENTS, VF_MASTERS, VF_GAUSSIANS, VF_SLOTS, VF_PIXELS, VF_PHOTOGRAPH, VF_SOURCES,
       VF_BLOCKS };

typedef struct vf_memory {
    fit_status status;
    char unused[VF_ALIGNED - sizeof(fit_status)];
    fit_order order;
} vf_memory;

/* A step that is recorded, and not yet known to be complete. */
typedef struct vf_turn {
    fxs_vk_slot slot;              /* `up` holds the photographs; `down` the status, then rows of a report */
    fxs_fit_photograph photographs[FXS_FIT_BATCH];
    uint32_t count;
    fxs_fit_step_options options;
    int has_report;
} vf_turn;

typedef struct vf_engine {
    fxs_vulkan_device device;
    fxs_vulkan *v;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkDescriptorPool pool;
    VkDescriptorSet sets[VF_SETS];
    VkQueryPool queries;           /* times of a step with a report; null: the queue has no timestamps */
    VkPipeline programs[VF_COUNT];
    fxs_vk_block *blocks[VF_BLOCKS];
    fxs_vk_slot carrier;           /* of transfers that the host waits for */
    fxs_fit_model *model;
    fxs_run_fn *run;
    void *workers;
    uint32_t batch;                /* largest number of photographs of a step */
    size_t most;                   /* largest number of Gaussians that the device fits right */
    uint32_t stride, capacity;     /* Gaussians and slots that fit */
    int has_masters, has_surfaces;
    fit_order order;               /* the parts of an order that stay */
    vf_turn turns[VF_TURNS];
    uint32_t first, pending;       /* the oldest pending turn, and their number */
    uint64_t entries_most;
} vf_engine;

/* Opens the device, makes the pipelines and tests the arithmetic. vf_close frees all that there is. */
int vf_open(vf_engine *e, int number, uint64_t max_memory, fxs_message *why);
void vf_close(vf_engine *e);

/* Points a descriptor set at blocks; null blocks are replaced by the first. */
void vf_bind(const vf_engine *e, uint32_t set, fxs_vk_block *const blocks[VF_BUFFERS]);
void vf_bind_step(const vf_engine *e);

/* vf_start chooses the set and the view of the next shaders; is_surface 1: for planes instead of colours. vf_next
   records a shader, which waits for the commands before it; x 0: for work on slots. */
void vf_start(const vf_engine *e, VkCommandBuffer commands, uint32_t set, uint32_t view, uint32_t is_surface);
void vf_next(const vf_engine *e, VkCommandBuffer commands, int shader, uint32_t x, uint32_t y, uint32_t z);

/* A list of copies between host memory and blocks, through staging memory. */
typedef struct vf_copy {
    int block;
    uint64_t at;                   /* bytes from the block's start */
    void *host;
    uint64_t bytes;
} vf_copy;
int vf_send(vf_engine *e, const vf_copy *copies, size_t count, fxs_message *why);
int vf_fetch(vf_engine *e, const vf_copy *copies, size_t count, fxs_message *why);

/* Sets the status to 0. */
int vf_clear_status(vf_engine *e, fxs_message *why);

/* Takes `count` words, rounded up to 16, at the end of *words. Returns their place. */
uint32_t vf_take(uint64_t *words, uint64_t count);

/* vf_make_room makes room for `count` Gaussians, and sets the places of the order. A block that is too small is
   replaced, and drops its data. */
int vf_reserve(vf_engine *e, int block, uint64_t words, fxs_message *why);
uint32_t vf_stride_for(const vf_engine *e, size_t count);
int vf_make_room(vf_engine *e, size_t count, fxs_message *why);
int vf_make_slots(vf_engine *e, uint64_t capacity, fxs_message *why);

/* Sends the cameras that limit scales, if there are any. */
int vf_send_cameras(vf_engine *e, fxs_message *why);

/* The plane `plane` of a block of planes: bytes from its start. */
uint64_t vf_plane(const vf_engine *e, uint64_t plane);

/* Copies the Gaussians on the device as the origins of a part say, and then the planes of the part. */
int vf_rebuild(vf_engine *e, const fxs_fit_model *part, fxs_message *why);

/* vf_step starts a step; vf_finish completes all steps. vf_quantise quantises the exact parameters. */
int vf_step(vf_engine *e, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
            fxs_fit_report *report, fxs_message *why);
int vf_finish(vf_engine *e, fxs_message *why);
int vf_quantise(vf_engine *e, fxs_message *why);

#endif
