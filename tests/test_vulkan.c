/* Compares the Vulkan back end with the CPU renderer: random frames, real scenes, long lists and small buffers, with
   the validation layer and its synchronisation validation on, where any message is a failure. The layer of
   failing_layer.c simulates device failures. */
#include "check.h"

#ifndef FXS_WITH_VULKAN
static void vulkan(void)
{
    SKIP("built without the headers of Vulkan");
}

int main(void)
{
    RUN(vulkan);
    return check_report();
}
#else

#include "kernels/vulkan/vk.h"
#include "losing_vulkan.h"
typedef fxs_vulkan stream_device;
#include "streamed.h"
#include "port/vulkan/vulkan_device.h"

static fxs_vulkan_device own;
static fxs_vulkan *device;

static int upload(fxs_vulkan *v, const fxs_scene *scene)
{
    const uint64_t most = v->rooms.most;
    v->rooms.most = part_bytes ? part_bytes : most;
    const int error = fxs_vulkan_upload(v, scene, &why);
    v->rooms.most = most;
    return error;
}

static int render_by(fxs_vulkan *v, const fxs_request *request, fxs_stats *stats)
{
    int error = 0;
    for (uint32_t i = 0; i < request->count && !error; i++)
        error = upload(v, request->objects[i].scene);
    error = error ? error : fxs_vulkan_render(v, request, stats, &why);
    for (uint32_t i = 0; i < request->count; i++)
        fxs_vulkan_drop(v, request->objects[i].scene);
    return error;
}

static int render_on_device(const fxs_request *request, fxs_stats *stats)
{
    return render_by(device, request, stats);
}

static uint64_t *device_most(void)
{
    return &device->rooms.most;
}

/* A request for the procedural scene "knot", and its picture by the processor. */
typedef struct knot {
    part part;
    fxs_object object;
    fxs_request request;
    picture wanted, drawn;
} knot;

static int knot_make(knot *k)
{
    if (!part_make(&k->part, "knot", 3000))
        return 0;
    k->object = one_object(&k->part.scene);
    fxs_request_init(&k->request, &k->object, 1);
    k->wanted = picture_new(100, 80, FXS_FORMAT_RGBA8);
    k->drawn = picture_new(100, 80, FXS_FORMAT_RGBA8);
    k->request.targets[0] = k->wanted.targets;
    const int good = look_at(k->request.cameras, 100, 80, 12.8) && CHECK(!render_there(&k->request, 0));
    k->request.targets[0] = k->drawn.targets;
    return good;
}

static void knot_free(knot *k)
{
    picture_free(&k->wanted);
    picture_free(&k->drawn);
    part_free(&k->part);
}

/* Opens a device and a back end, with one function of Vulkan missing. */
static int open_all(fxs_vulkan_device *d, fxs_vulkan **v, const char *without)
{
    *v = 0;
    missing = without;
    int error = fxs_vulkan_find_device(d, losing_load, 0, &why);
    error = error ? error : fxs_vulkan_open_device(d, &why);
    error = error ? error : fxs_vulkan_create(v, &d->options, &why);
    missing = 0;
    return error;
}

static void close_all(fxs_vulkan_device *d, fxs_vulkan *v)
{
    fxs_vulkan_destroy(v);
    fxs_vulkan_close_device(d);
}

static int is_loss(int error)
{
    return error == FXS_ERR_DEVICE || error == FXS_ERR_MEMORY;
}

static const VkResult losses[] = {VK_ERROR_DEVICE_LOST, VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY};

static void opening_fails(void)
{
    fxs_vulkan_device d;
    fxs_vulkan *v;
    CHECK(open_all(&d, &v, "vkCmdDispatchIndirect") == FXS_ERR_UNSUPPORTED && !v);
    CHECK(!strcmp(why.text, "no Vulkan 1.1: no function vkCmdDispatchIndirect"));
    close_all(&d, v);
    CHECK(open_all(&d, &v, "vkGetPhysicalDeviceProperties2") == FXS_ERR_UNSUPPORTED);
    close_all(&d, v);
    lose_at(-1, VK_SUCCESS, 0);
    CHECK(!open_all(&d, &v, 0));
    const long calls = stop_losing();
    close_all(&d, v);
    CHECK(calls > FXS_COMPUTE_PROGRAMS + 8);
    for (int k = 0; k < 3; k++)
        for (long n = 0; n < calls && !check_faults; n += 1 + n / 8) {
            why.text[0] = 0;
            lose_at(n, losses[k], 0);
            const int error = open_all(&d, &v, 0);
            stop_losing();
            if (!CHECK(is_loss(error) && why.text[0] && !v))
                printf("  call %ld: %d, %s\n", n, error, why.text);
            close_all(&d, v);
        }
    fxs_vulkan_options none;
    fxs_vulkan_options_init(&none);
    CHECK(fxs_vulkan_create(&v, &none, &why) == FXS_ERR_ARGUMENT && !v);
    CHECK(fxs_vulkan_find_device(&d, losing_load, 99, &why) == FXS_ERR_DEVICE);
    CHECK(!strncmp(why.text, "there is no device 99: the last is ", 35));
}

/* Each call of Vulkan in an upload and a frame fails once: an error or the complete picture, and the next frame is
   right. */
static void frames_lose(void)
{
    knot k;
    fxs_vulkan_device d;
    fxs_vulkan *v;
    if (!knot_make(&k) || !CHECK(!open_all(&d, &v, 0)))
        return;
    uint32_t *occluder = calloc(100 * 80, 4);
    k.request.targets->occluder = (fxs_image){occluder, 400};
    CHECK(!fxs_vulkan_render(v, &k.request, 0, &why));
    k.request.targets->occluder.pixels = 0;
    fxs_vulkan_drop(v, &k.part.scene);
    fxs_vk_give_back(v);
    lose_at(-1, VK_SUCCESS, 0);
    CHECK(!fxs_vulkan_render(v, &k.request, 0, &why));
    const long calls = stop_losing();
    CHECK(calls > 30 && is_equal(&k.wanted, &k.drawn));
    long fails = 0;
    for (int i = 0; i < 3; i++)
        for (long n = 0; n < calls && !check_faults; n++) {
            fxs_vulkan_drop(v, &k.part.scene);
            fxs_vk_give_back(v);
            CHECK(v->taken == 0);
            picture_clear(&k.drawn);
            why.text[0] = 0;
            lose_at(n, losses[i], 0);
            const int error = fxs_vulkan_render(v, &k.request, 0, &why);
            stop_losing();
            fails += error != 0;
            if (!CHECK(error ? is_loss(error) && why.text[0] : is_equal(&k.wanted, &k.drawn)))
                printf("  call %ld of %ld: %d, %s\n", n, calls, error, why.text);
            picture_clear(&k.drawn);
            CHECK(!fxs_vulkan_render(v, &k.request, 0, &why) && is_equal(&k.wanted, &k.drawn));
        }
    CHECK(fails > 2 * calls);
    close_all(&d, v);
    free(occluder);
    knot_free(&k);
}

/* A device that is lost at some call, and stays so: the frame is an error, nothing is left when the device is closed,
   and a new device draws the frame. */
static void device_stays_lost(void)
{
    knot k;
    fxs_vulkan_device d;
    fxs_vulkan *v;
    if (!knot_make(&k))
        return;
    long calls = 1;
    for (long n = 0; n < calls && !check_faults; n += 1 + n / 8) {
        lose_at(n, VK_ERROR_DEVICE_LOST, 1);
        int error = open_all(&d, &v, 0);
        error = error ? error : fxs_vulkan_render(v, &k.request, 0, &why);
        close_all(&d, v);
        stop_losing();
        CHECK(error == FXS_ERR_DEVICE);
        lose_at(-1, VK_SUCCESS, 0);
        picture_clear(&k.drawn);
        if (CHECK(!open_all(&d, &v, 0)))
            CHECK(!fxs_vulkan_render(v, &k.request, 0, &why) && is_equal(&k.wanted, &k.drawn));
        calls = stop_losing();
        close_all(&d, v);
    }
    CHECK(calls > FXS_COMPUTE_PROGRAMS + 38);
    knot_free(&k);
}

static int yes(void *argument)
{
    (void)argument;
    return 1;
}

static void refusals(void)
{
    knot k;
    if (!knot_make(&k))
        return;
    fxs_request *r = &k.request;
    const fxs_targets good = *r->targets;
    const uint64_t most = device->rooms.most;
    device->rooms.most = 30000;            /* storage buffers that are too small for a frame */
    part_bytes = most;
    CHECK(render_by(device, r, 0) == FXS_ERR_MEMORY && why.bytes_needed > 30000);
    device->rooms.most = most;
    CHECK(!render_by(device, r, 0) && is_equal(&k.wanted, &k.drawn));
    const uint64_t frame = device->taken;
    fxs_vk_give_back(device);
    fxs_vulkan_limit(device, frame);       /* leaves nothing for the scene */
    CHECK(render_by(device, r, 0) == FXS_ERR_MEMORY && why.bytes_needed > frame);
    CHECK(!strcmp(why.text, "the device memory allowed is too small"));
    fxs_vulkan_limit(device, 1000);
    CHECK(render_by(device, r, 0) == FXS_ERR_MEMORY && device->taken == 0);
    fxs_vulkan_limit(device, 0);
    part_bytes = 1000;                     /* less than a chunk (256 Gaussians) has */
    CHECK(render_by(device, r, 0) == FXS_ERR_MEMORY && why.bytes_needed > 1000);
    part_bytes = 0;
    r->options.stop.call = yes;
    CHECK(render_by(device, r, 0) == FXS_ERR_STOPPED);
    r->options.stop.call = 0;
    r->options.sh_degree = 4;
    CHECK(render_by(device, r, 0) == FXS_ERR_ARGUMENT);
    r->options.sh_degree = 3;
    r->targets->format = FXS_FORMAT_BGRA8;
    CHECK(render_by(device, r, 0) == FXS_ERR_UNSUPPORTED);
    fxs_targets_init(r->targets);
    CHECK(render_by(device, r, 0) == FXS_ERR_TARGET);
    *r->targets = good;
    r->eyes = 3;
    CHECK(render_by(device, r, 0) == FXS_ERR_ARGUMENT);
    r->eyes = 1;
    /* puts an invalid value into the field step_shift of the first chunk header */
    ((unsigned char *)k.part.packed.data)[192 + 74] = 77;
    CHECK(render_by(device, r, 0) == FXS_ERR_SCENE);
    knot_free(&k);
}

/* Images that fxs_vulkan_record refuses, by their descriptions: nothing is recorded, so the handles are not used. */
static void images_refused(void)
{
    static const VkImageUsageFlags out = VK_IMAGE_USAGE_TRANSFER_DST_BIT, in = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    static const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
    const VkImage some = (VkImage)(uintptr_t)64;
    const VkCommandBuffer none = 0;
    const fxs_vulkan_image good = {some, VK_FORMAT_R8G8B8A8_UNORM, out, 100, 80, 1, 0, 0, 0, general, general};
    const fxs_vulkan_image depth = {some, VK_FORMAT_D32_SFLOAT, in, 100, 80, 1, 0, 0, 0, general, general};
    knot k;
    if (!knot_make(&k))
        return;
    CHECK(!fxs_vulkan_upload(device, &k.part.scene, &why));
    const struct {
        const char *says;
        int error;
        fxs_vulkan_target target;
    } cases[] = {
#define COLOUR(says, ...) {"the colour image: " says, FXS_ERR_TARGET, \
                           {.colour = {some, __VA_ARGS__, 0, 0, general, general}}}
        COLOUR("its format is not supported", VK_FORMAT_R16G16B16A16_SFLOAT, out, 100, 80, 1, 0),
        COLOUR("its usage lacks VK_IMAGE_USAGE_TRANSFER_DST_BIT", VK_FORMAT_R8G8B8A8_UNORM, in, 100, 80, 1, 0),
        COLOUR("the picture does not fit in it", VK_FORMAT_R8G8B8A8_UNORM, out, 99, 80, 1, 0),
        COLOUR("it has no such layer", VK_FORMAT_R8G8B8A8_UNORM, out, 100, 80, 2, 2),
        {"a target needs a colour image or a depth image", FXS_ERR_TARGET, {.depth_bits = 0}},
        {"plane_0 and plane_1 must be positive and differ", FXS_ERR_TARGET,
         {.colour = good, .occluder = depth, .plane_0 = 1, .plane_1 = 1}},
        {"a backdrop needs the format RGBA8", FXS_ERR_TARGET,
         {.format = FXS_FORMAT_RGBA8_COVERAGE, .colour = good, .backdrop = {some, VK_FORMAT_R8G8B8A8_UNORM, in, 100, 80,
                                                                            1, 0, 0, 0, general, general}}},
        {"a target's format is RGBA8 or RGBA8_COVERAGE", FXS_ERR_UNSUPPORTED,
         {.format = FXS_FORMAT_RGB565, .colour = good}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        why.text[0] = 0;
        if (!CHECK(fxs_vulkan_record(device, &k.request, &cases[i].target, none, &why) == cases[i].error) ||
            !CHECK(!strcmp(why.text, cases[i].says)))
            printf("  %s\n", why.text);
    }
    const uint64_t most = *device_most();
    *device_most() = 30000;                /* a recorded frame is not divided */
    CHECK(fxs_vulkan_record(device, &k.request, &(fxs_vulkan_target){.colour = good}, none, &why) == FXS_ERR_MEMORY);
    CHECK(strstr(why.text, "can hold: set a budget of at most 512 Gaussians"));
    *device_most() = most;
    fxs_vulkan_drop(device, &k.part.scene);
    CHECK(fxs_vulkan_record(device, &k.request, &(fxs_vulkan_target){.colour = good}, none, &why) ==
          FXS_ERR_ARGUMENT);
    CHECK(!strcmp(why.text, "a scene was not uploaded"));
    knot_free(&k);
}

/* An image of the caller, and its memory. image_put and image_get copy its picture of 100x80 texels. */
typedef struct image {
    fxs_vulkan_image of;
    VkDeviceMemory memory;
} image;

#define IMAGE_CALL(name) ((PFN_vk##name)(uintptr_t)own.options.load(own.options.instance, "vk" #name))

static image image_make(VkFormat format, VkImageUsageFlags usage, uint32_t border, uint32_t layers)
{
    const VkDevice d = own.options.device;
    image i = {.of = {0, format, usage, 100 + 2 * border, 80 + 2 * border, layers, layers - 1, border, border,
                      VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL}};
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .extent = {i.of.width, i.of.height, 1}, .format = format, .mipLevels = 1, .arrayLayers = layers,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    VkMemoryAllocateInfo room = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    VkMemoryRequirements needs;
    CHECK(!IMAGE_CALL(CreateImage)(d, &info, 0, &i.of.image));
    IMAGE_CALL(GetImageMemoryRequirements)(d, i.of.image, &needs);
    room.allocationSize = needs.size;
    while (!(needs.memoryTypeBits >> room.memoryTypeIndex & 1))
        room.memoryTypeIndex++;
    CHECK(!device->vk.AllocateMemory(d, &room, 0, &i.memory));
    CHECK(!IMAGE_CALL(BindImageMemory)(d, i.of.image, i.memory, 0));
    return i;
}

static void image_free(const image *i)
{
    IMAGE_CALL(DestroyImage)(own.options.device, i->of.image, 0);
    device->vk.FreeMemory(own.options.device, i->memory, 0);
}

static uint32_t texel_bytes(const image *i)
{
    return i->of.format == VK_FORMAT_D16_UNORM ? 2 : 4;
}

static VkBufferImageCopy region_of(const image *i)
{
    const int is_depth = i->of.format == VK_FORMAT_D16_UNORM || i->of.format == VK_FORMAT_D32_SFLOAT;
    const VkImageAspectFlags aspect = is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    return (VkBufferImageCopy){.imageSubresource = {aspect, 0, i->of.layer, 1},
                               .imageOffset = {(int32_t)i->of.x, (int32_t)i->of.y, 0}, .imageExtent = {100, 80, 1}};
}

static void image_put(image *i, const void *texels)
{
    const VkBufferImageCopy region = region_of(i);
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .newLayout = VK_IMAGE_LAYOUT_GENERAL, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = i->of.image,
        .subresourceRange = {region.imageSubresource.aspectMask, 0, 1, 0, i->of.layers}};
    fxs_vk_block *block = 0;
    CHECK(!fxs_vk_reserve(device, &block, FXS_VK_UP, texel_bytes(i) * 8000, &why));
    memcpy(block->memory.mapped, texels, texel_bytes(i) * 8000);
    CHECK(!fxs_vk_begin(device, device->slots, &why));
    const VkCommandBuffer commands = device->slots->commands;
    device->vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, 0,
                                  0, 0, 1, &barrier);
    device->vk.CmdCopyBufferToImage(commands, block->buffer, i->of.image, barrier.newLayout, 1, &region);
    CHECK(!fxs_vk_run(device, device->slots, &why));
    i->of.before = barrier.newLayout;
    fxs_vk_retire(device, &block);
    fxs_vk_collect(device);
}

static void image_get(const image *i, void *texels)
{
    const VkBufferImageCopy region = region_of(i);
    fxs_vk_block *block = 0;
    CHECK(!fxs_vk_reserve(device, &block, FXS_VK_DOWN, texel_bytes(i) * 8000, &why));
    CHECK(!fxs_vk_begin(device, device->slots, &why));
    const VkCommandBuffer commands = device->slots->commands;
    device->vk.CmdCopyImageToBuffer(commands, i->of.image, VK_IMAGE_LAYOUT_GENERAL, block->buffer, 1, &region);
    fxs_vk_barrier(device, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT);
    CHECK(!fxs_vk_run(device, device->slots, &why));
    memcpy(texels, block->memory.mapped, texel_bytes(i) * 8000);
    fxs_vk_retire(device, &block);
    fxs_vk_collect(device);
}

static int is_bgra(VkFormat format)
{
    return format == VK_FORMAT_B8G8R8A8_UNORM || format == VK_FORMAT_B8G8R8A8_SRGB;
}

static void swap_channels(unsigned char *texels)
{
    for (int i = 0; i < 8000; i++, texels += 4) {
        const unsigned char red = texels[0];
        texels[0] = texels[2];
        texels[2] = red;
    }
}

static int has_colours(const image *i, const picture *wanted)
{
    unsigned char texels[4 * 8000];
    image_get(i, texels);
    if (is_bgra(i->of.format))
        swap_channels(texels);
    return !memcmp(texels, wanted->targets.colour.pixels, 400 * (size_t)wanted->height);
}

/* The statistics of a submitted frame are those of the same frame rendered to the host. */
static void statistics(const fxs_request *request)
{
    fxs_stats submitted = {0}, rendered = {0};
    CHECK(!fxs_vulkan_stats(device, &submitted, &why));
    CHECK(!fxs_vulkan_render(device, request, &rendered, &why));
    CHECK(submitted.gaussians == rendered.gaussians && submitted.drawn == rendered.drawn && rendered.drawn > 0);
    CHECK(submitted.visible == rendered.visible && submitted.entries == rendered.entries && rendered.entries > 0);
    fxs_vk_give_back(device);
    CHECK(fxs_vulkan_stats(device, &submitted, &why) == FXS_ERR_ARGUMENT);
}

/* Submits frames into a layer of a BGRA image of the caller, and reads the image back. */
static void frames_in_flight(void)
{
    const fxs_vk_functions *vk = &device->vk;
    const VkFenceCreateInfo of_fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    const VkDevice d = own.options.device;
    VkFence fence;
    knot k;
    if (!knot_make(&k))
        return;
    const image colour = image_make(VK_FORMAT_B8G8R8A8_UNORM, VK_IMAGE_USAGE_TRANSFER_DST_BIT, 5, 2);
    const fxs_vulkan_target target = {.colour = colour.of};
    CHECK(!vk->CreateFence(d, &of_fence, 0, &fence));
    CHECK(!fxs_vulkan_upload(device, &k.part.scene, &why));
    for (int i = 0; i < 5; i++) {
        const fxs_vulkan_sync sync = {.fence = fence};
        CHECK(!fxs_vulkan_submit(device, &k.request, &target, &sync, &why));
        CHECK(!vk->WaitForFences(d, 1, &fence, VK_TRUE, UINT64_MAX));
        CHECK(!vk->ResetFences(d, 1, &fence));
    }
    fxs_vulkan_idle(device);
    CHECK(has_colours(&colour, &k.wanted));
    statistics(&k.request);
    image_free(&colour);
    vk->DestroyFence(d, fence, 0);
    fxs_vulkan_drop(device, &k.part.scene);
    knot_free(&k);
}

/* Submits frames of a moving scene at two times each, which are in flight together. */
static void moments_in_flight(void)
{
    knot k;
    size_t bytes;
    fxs_scene scene;
    image colours[2];
    state = 20268;
    if (!knot_make(&k))
        return;
    unsigned char *data = make_moving(&k.part.scene, 3, FXS_MOTION_TURNS | FXS_MOTION_FADES, 1, &bytes);
    if (!CHECK(!fxs_scene_open(&scene, data, bytes) && !fxs_vulkan_upload(device, &scene, &why)))
        return;
    k.object.scene = &scene;
    for (int i = 0; i < 2; i++)
        colours[i] = image_make(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_TRANSFER_DST_BIT, 0, 1);
    for (int i = 0; i < 6; i++) {
        picture *const wanted[] = {&k.wanted, &k.drawn};
        for (int n = 0; n < 2; n++) {
            const fxs_vulkan_target target = {.colour = colours[n].of};
            k.request.options.time_q32 = random_time();
            k.request.targets[0] = wanted[n]->targets;
            CHECK(!render_there(&k.request, 0));
            CHECK(!fxs_vulkan_submit(device, &k.request, &target, 0, &why));
        }
        fxs_vulkan_idle(device);
        CHECK(has_colours(&colours[0], &k.wanted) && has_colours(&colours[1], &k.drawn));
    }
    CHECK(memcmp(k.wanted.block, k.drawn.block, k.wanted.bytes) != 0);
    image_free(&colours[0]);
    image_free(&colours[1]);
    fxs_vulkan_drop(device, &scene);
    free(data);
    knot_free(&k);
}

/* Submits a frame that must end, and waits for it. */
static int submit_frame(const fxs_request *request, const image *to)
{
    const fxs_vulkan_target target = {.colour = to->of};
    const int error = fxs_vulkan_submit(device, request, &target, 0, &why);
    device->vk.QueueWaitIdle(own.options.queue);
    fxs_vulkan_idle(device);
    return error;
}

/* Each call of Vulkan in a submitted frame fails once: an error or the picture, and the next frame is right. */
static void submissions_lose(void)
{
    knot k;
    if (!knot_make(&k))
        return;
    const image colour = image_make(VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_TRANSFER_DST_BIT, 0, 1);
    CHECK(!fxs_vulkan_upload(device, &k.part.scene, &why));
    long calls = 1, fails = 0;
    for (long n = 0; n < 3 * calls && !check_faults; n++) {
        fxs_vk_give_back(device);
        lose_at(n / 3, losses[n % 3], 0);
        const int error = submit_frame(&k.request, &colour);
        stop_losing();
        fails += error != 0;
        if (!CHECK(error ? is_loss(error) : has_colours(&colour, &k.wanted)))
            printf("  call %ld: %d, %s\n", n / 3, error, why.text);
        fxs_vk_give_back(device);
        lose_at(-1, VK_SUCCESS, 0);
        CHECK(!submit_frame(&k.request, &colour));
        calls = stop_losing();
        CHECK(has_colours(&colour, &k.wanted));
    }
    CHECK(calls > 15 && fails > 2 * calls);
    image_free(&colour);
    fxs_vulkan_drop(device, &k.part.scene);
    knot_free(&k);
}

/* Inverse of the distance that a value of a depth image stands for. */
static double inverse_of(const fxs_vulkan_target *t, double depth)
{
    return (1 - depth) / (double)t->plane_0 + depth / (double)t->plane_1;
}

/* An occluder in blocks of 16x16 texels: 8 distances about the knot's, and the far plane, whose value is `far`. Writes
   the texels in a format, and the depths that they are for the processor. */
static void make_occluder(const fxs_vulkan_target *t, VkFormat format, uint32_t far, void *texels, uint32_t *depths)
{
    for (uint32_t i = 0; i < 8000; i++) {
        const uint32_t block = (i % 100 / 16 + i / 1600 * 3) % 9;
        const double inverse = 1 / (10.5 + 0.6 * block), low = inverse_of(t, 0), high = inverse_of(t, 1);
        const uint32_t code = block == 8 ? far : (uint32_t)((inverse - low) / (high - low) * 65535);
        const float value = (float)code / 65535;
        depths[i] = block == 8 ? FXS_NOTHING : (uint32_t)(65536 / inverse_of(t, code / 65535.0));
        if (format == VK_FORMAT_D16_UNORM)
            ((uint16_t *)texels)[i] = (uint16_t)code;
        else
            memcpy((uint32_t *)texels + i, format == VK_FORMAT_R32_UINT ? (const void *)&depths[i] : &value, 4);
    }
}

/* Compares a depth image with the processor's depths: numbers exactly, floats within the error that vulkan.h states. */
static int has_depths(const image *i, const fxs_vulkan_target *t, const picture *wanted)
{
    const uint32_t *depths = (const uint32_t *)wanted->targets.median_depth.pixels;
    const double low = inverse_of(t, 0), high = inverse_of(t, 1);
    static uint32_t texels[8000];
    double worst = 0;
    image_get(i, texels);
    if (i->of.format == VK_FORMAT_R32_UINT)
        return !memcmp(texels, depths, sizeof texels);
    for (int k = 0; k < 8000; k++) {
        const double inverse = depths[k] == FXS_NOTHING ? fmin(low, high) : 65536.0 / depths[k];
        float value;
        memcpy(&value, &texels[k], 4);
        worst = fmax(worst, fabs((double)value - fmin(fmax((inverse - low) / (high - low), 0), 1)));
    }
    return worst <= ldexp(1, -19);
}

/* Draws with images in all formats, and compares with the processor's picture of the same occluder and backdrop. */
static void image_formats(void)
{
    static const VkFormat colours[] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM,
                                       VK_FORMAT_B8G8R8A8_SRGB};
    static const VkFormat depths[] = {VK_FORMAT_R32_UINT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_D32_SFLOAT,
                                      VK_FORMAT_D16_UNORM};
    static unsigned char texels[4 * 8000], under[4 * 8000];
    static uint32_t occluder[8000];
    const VkImageUsageFlags out = VK_IMAGE_USAGE_TRANSFER_DST_BIT, in = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    knot k;
    if (!knot_make(&k))
        return;
    picture plain = picture_new(100, 80, FXS_FORMAT_RGBA8);
    memcpy(plain.block, k.wanted.block, plain.bytes);
    CHECK(!fxs_vulkan_upload(device, &k.part.scene, &why));
    for (int i = 0; i < 12 && !check_faults; i++) {
        image images[] = {image_make(colours[i % 4], out, 3, 1), image_make(depths[i % 3], out, 0, 1),
                          image_make(depths[i / 3], in, 1, 2), image_make(colours[(i + 1) % 4], in, 0, 1)};
        fxs_vulkan_target t = {.plane_0 = i & 1 ? (float)INFINITY : 1, .plane_1 = i & 1 ? 0.5f : 100};
        make_occluder(&t, depths[i / 3], i & 1 ? 0 : 65535, texels, occluder);
        image_put(&images[2], texels);
        for (int n = 0; n < 4 * 8000; n++)
            texels[n] = under[n] = n % 4 == 3 ? 255 : (unsigned char)(n * 7 / 3);
        if (is_bgra(images[3].of.format))
            swap_channels(texels);
        image_put(&images[3], texels);
        k.request.targets[0] = k.wanted.targets;
        k.request.targets[0].occluder = (fxs_image){(unsigned char *)occluder, 400};
        k.request.targets[0].backdrop = (fxs_image){under, 400};
        CHECK(!render_there(&k.request, 0) && memcmp(k.wanted.block, plain.block, plain.bytes));
        t.colour = images[0].of, t.depth = images[1].of, t.occluder = images[2].of, t.backdrop = images[3].of;
        CHECK(!fxs_vulkan_submit(device, &k.request, &t, 0, &why) && !device->vk.QueueWaitIdle(own.options.queue));
        fxs_vulkan_idle(device);
        if (!CHECK(has_colours(&images[0], &k.wanted) && has_depths(&images[1], &t, &k.wanted)))
            printf("  formats %d\n", i);
        for (int n = 0; n < 4; n++)
            image_free(&images[n]);
    }
    fxs_vulkan_drop(device, &k.part.scene);
    picture_free(&plain);
    knot_free(&k);
}

/* ---- Scenes in parts --------------------------------------------------------------------------------------------- */

static void stream_set(fxs_vulkan *v, uint64_t pool_bytes, uint64_t upload_bytes)
{
    fxs_vulkan_stream(v, pool_bytes, upload_bytes);
}

static int stream_upload(streamed *s, fxs_vulkan *v, const fxs_scene *scene)
{
    const int error = upload(v, scene);
    const fxs_vk_scene *copy = error ? 0 : fxs_vk_find(v, scene);
    CHECK(!copy || !part_bytes == !copy->parts[1]);
    s->mirror = copy ? copy->mirror : 0;
    return error;
}

static int stream_render(fxs_vulkan *v, const fxs_request *request, fxs_stats *stats)
{
    return fxs_vulkan_render(v, request, stats, &why);
}

static void stream_drop(streamed *s, fxs_vulkan *v)
{
    fxs_vulkan_drop(v, &s->part);
    CHECK(!fxs_vk_find(v, &s->part));
    s->mirror = 0;
}

/* Only the first window of a divided frame uploads chunks. */
static void fly_divided(void)
{
    const uint64_t most = *device_most();
    divided = 0;
    *device_most() = 250000;
    fly(device, FXS_PROFILE_SMALL, 1, 2, 1);
    *device_most() = most;
    CHECK(divided > 80);
}

static void streams(void)
{
    fly(device, FXS_PROFILE_DEFAULT, 1, 1, 0);
    fly(device, FXS_PROFILE_SMALL, 2, 2, 1);
    fly_divided();
    fly_in_time(device);
    two_scenes(device);
    stopped_frames(device);
    pools(device, fxs_vulkan_limit);
}

/* Each call of Vulkan in a frame that uploads chunks fails once. Later frames draw what is on the device. */
static void streams_lose(void)
{
    streamed s;
    fxs_vulkan_device d;
    fxs_vulkan *v;
    fxs_stats stats;
    uint32_t uploaded, came = 0, fails = 0;
    if (!streamed_make(&s, FXS_PROFILE_SMALL) || !CHECK(!open_all(&d, &v, 0)))
        return;
    stream_set(v, 40 * bytes_of_chunk(&s), 2 * bytes_of_chunk(&s));
    for (int n = 0; n < 20 && !check_faults; n++) {
        lose_at(n, losses[n % 3], 0);
        const int error = stream_upload(&s, v, &s.part);
        stop_losing();
        CHECK(!error || (is_loss(error) && !v->scenes));
        stream_drop(&s, v);
    }
    CHECK(!stream_upload(&s, v, &s.part));
    for (int n = 0; n < 66 && !check_faults; n++) {
        CHECK(!streamed_draw(&s, v, 5, n * 0.3, &stats, &uploaded));
        came += uploaded;
        fxs_vk_give_back(v);       /* so that the next frame makes all of its objects */
        lose_at(n / 3, losses[n % 3], 0);
        const int error = streamed_draw(&s, v, 5, n * 0.3, &stats, &uploaded);
        stop_losing();
        CHECK(!error || is_loss(error));
        fails += error != 0;
    }
    CHECK(came > 20 && fails > 40);
    stream_drop(&s, v);
    close_all(&d, v);
    streamed_free(&s);
}

/* Frames in flight of a scene in parts. If `loses` is not 0, some are not submitted, since a call fails or the program
   drops its command buffer: the pool is empty then, and later frames are right. */
static void streams_in_flight(int loses)
{
    streamed s;
    fxs_stats expected = {0};
    fxs_object objects[2];
    uint32_t lost = 0;
    if (!streamed_make(&s, FXS_PROFILE_DEFAULT))
        return;
    const image colour = image_make(VK_FORMAT_B8G8R8A8_UNORM, VK_IMAGE_USAGE_TRANSFER_DST_BIT, 5, 2);
    const fxs_vulkan_target target = {.colour = colour.of};
    stream_set(device, 60 * bytes_of_chunk(&s), 8 * bytes_of_chunk(&s));
    CHECK(!stream_upload(&s, device, &s.part));
    for (int frame = 0; frame < 40 && !check_faults; frame++) {
        const int way = frame < 20 ? frame : 20, is_lost = loses && frame % 5 == 3;
        fxs_request request = streamed_view(&s, objects, &s.part, 5, way * 0.2);
        request.options.want = (fxs_want){note_wanted, &s};
        note_device(&s);
        if (is_lost && frame % 2) {
            CHECK(!fxs_vk_begin(device, device->slots, &why));
            CHECK(!fxs_vulkan_record(device, &request, &target, device->slots->commands, &why));
            CHECK(!device->vk.EndCommandBuffer(device->slots->commands));
            lost += note_device(&s) > 0;
            fxs_vulkan_idle(device);
        } else if (is_lost) {
            fxs_vulkan_idle(device);
            lose_at(2, VK_ERROR_OUT_OF_DEVICE_MEMORY, 0);     /* after vkResetFences and vkBeginCommandBuffer */
            CHECK(submit_frame(&request, &colour) == FXS_ERR_MEMORY);
            lost += stop_losing() > 2;
        } else {
            CHECK(!fxs_vulkan_submit(device, &request, &target, 0, &why));
            note_device(&s);
            CHECK(!submit_frame(&request, &colour));       /* the frame before may still run */
            streamed_expect(&s, 5, way * 0.2, &expected);
            CHECK(has_colours(&colour, &s.expected[0]));
            CHECK(fxs_vulkan_get_info(device).missing == expected.missing);
        }
        CHECK(!is_lost || s.mirror->pool.there == 0);
        streamed_page(&s);
    }
    CHECK(loses ? lost == 8 : !expected.missing);
    fxs_vulkan_idle(device);
    stream_drop(&s, device);
    stream_set(device, 0, 0);
    image_free(&colour);
    streamed_free(&s);
}

static void streams_submitted(void)
{
    streams_in_flight(0);
    streams_in_flight(1);
}

static void count_wait(void *argument, const fxs_step *step)
{
    *(unsigned *)argument += step->waits;
}

/* Two eyes, a scene that changes, and the compiled shaders kept for the next back end. */
static void eyes_and_cache(void)
{
    knot k;
    fxs_stats one, two;
    fxs_vulkan *v;
    if (!knot_make(&k))
        return;
    CHECK(!fxs_vulkan_upload(device, &k.part.scene, &why) && !fxs_vulkan_render(device, &k.request, 0, &why));
    unsigned wanted = 0;
    layer->waits = 0;
    CHECK(!fxs_vulkan_render(device, &k.request, &one, &why));
    fxs_plan_steps(&device->slots[0].plan, count_wait, &wanted);
    CHECK(layer->waits == wanted && wanted > 9);
    picture right = picture_new(100, 80, FXS_FORMAT_RGBA8);
    k.request.eyes = 2;
    k.request.cameras[1] = k.request.cameras[0];
    k.request.targets[1] = right.targets;
    CHECK(!fxs_vulkan_render(device, &k.request, &two, &why));
    CHECK(two.visible == 2 * one.visible && is_equal(&k.wanted, &k.drawn) && is_equal(&k.wanted, &right));
    CHECK(fxs_vulkan_get_info(device).nanoseconds > 0 && fxs_vulkan_get_info(device).memory == device->taken);
    size_t bytes = 0;
    CHECK(!fxs_vulkan_cache(device, 0, &bytes, &why) && bytes > 0);
    void *cache = malloc(bytes + 1);
    CHECK(!fxs_vulkan_cache(device, cache, &bytes, &why));
    fxs_vulkan_options options = own.options;
    options.cache = cache;
    options.cache_bytes = bytes;
    if (CHECK(!fxs_vulkan_create(&v, &options, &why)))
        CHECK(!render_by(v, &k.request, 0) && is_equal(&k.wanted, &k.drawn));
    fxs_vulkan_destroy(v);
    fxs_vulkan_drop(device, &k.part.scene);
    free(cache);
    picture_free(&right);
    knot_free(&k);
}

static void validation(void)
{
    if (!validated)
        SKIP("no validation layer is here");
    CHECK(layer->messages == 0);
}

int main(int count, char **arguments)
{
    (void)count;
    if (!load_vulkan(arguments[0]) || open_all(&own, &device, 0)) {
        printf("%s\n", why.text);
        printf("skip vulkan\n");
        check_skipped++;
        return check_report();
    }
    device_frames();
    RUN(refusals);
    RUN(images_refused);
    RUN(frames_in_flight);
    RUN(moments_in_flight);
    RUN(image_formats);
    RUN(eyes_and_cache);
    RUN(streams);
    RUN(streams_submitted);
    RUN(streams_lose);
    RUN(opening_fails);
    RUN(frames_lose);
    RUN(device_stays_lost);
    RUN(submissions_lose);
    close_all(&own, device);
    RUN(validation);
    return check_report();
}
#endif
