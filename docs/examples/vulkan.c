/* Draws a Gaussian splatting scene around a mesh with Vulkan, on the program's own VkDevice, two frames in flight. The
 * mesh hides the Gaussians behind it, and Gaussians in front cover the mesh. To keep the example short, the mesh is a
 * card that vkCmdClearAttachments draws.
 *
 *     cc vulkan.c -o vulkan $(pkg-config --cflags --libs fixsplat vulkan)
 *     ./vulkan SCENE PICTURE            writes the last of ten frames to a file */
#include <stdio.h>
#include <stdlib.h>

#include <vulkan/vulkan.h>

#include <fixsplat/renderer.h>
#include <fixsplat/vulkan.h>

#define CHECK(call) do { const VkResult result = (call); if (result) exit(printf(#call ": %d\n", result)); } while (0)
enum { WIDTH = 640, HEIGHT = 360, FRAMES = 2, COLOUR = 0, DEPTH = 1 };
static const float near_plane = 0.2f, far_plane = 100, card = 12;      /* distances */

static VkInstance instance;
static VkPhysicalDevice physical;
static VkDevice device;
static VkQueue queue;
static VkImage images[FRAMES][2];
static VkFramebuffer framebuffers[FRAMES];
static VkRenderPass pass;
static VkCommandBuffer commands[FRAMES];
static VkFence fences[FRAMES];
static VkBuffer buffer;
static unsigned char *pixels;

static VkDeviceMemory allocate(VkMemoryRequirements needs, VkMemoryPropertyFlags flags)
{
    VkPhysicalDeviceMemoryProperties all;
    VkDeviceMemory memory;
    uint32_t type = 0;
    vkGetPhysicalDeviceMemoryProperties(physical, &all);
    while (!(needs.memoryTypeBits >> type & 1) || (all.memoryTypes[type].propertyFlags & flags) != flags)
        type++;
    const VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, 0, needs.size, type};
    CHECK(vkAllocateMemory(device, &info, 0, &memory));
    return memory;
}

static VkImageView make_image(VkImage *image, int of)
{
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D, .extent = {WIDTH, HEIGHT, 1},
        .format = of == DEPTH ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R8G8B8A8_UNORM, .mipLevels = 1, .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT, .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
        (of == DEPTH ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
    VkMemoryRequirements needs;
    VkImageView view;
    CHECK(vkCreateImage(device, &info, 0, image));
    vkGetImageMemoryRequirements(device, *image, &needs);
    CHECK(vkBindImageMemory(device, *image, allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT), 0));
    const VkImageViewCreateInfo of_image = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = *image, .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = info.format, .subresourceRange = {of == DEPTH ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
                                                    0, 1, 0, 1}};
    CHECK(vkCreateImageView(device, &of_image, 0, &view));
    return view;
}

static void make_device(void)
{
    const VkApplicationInfo app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &app};
    const float priority = 1;
    uint32_t one = 1;
    CHECK(vkCreateInstance(&info, 0, &instance));
    if (vkEnumeratePhysicalDevices(instance, &one, &physical) < 0 || !one)
        exit(puts("no device of Vulkan"));
    const VkDeviceQueueCreateInfo of_queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1,
                                              .pQueuePriorities = &priority};  /* family 0 has graphics, compute */
    const VkDeviceCreateInfo of_device = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1,
                                          .pQueueCreateInfos = &of_queue};
    CHECK(vkCreateDevice(physical, &of_device, 0, &device));
    vkGetDeviceQueue(device, 0, 0, &queue);
}

static void make_pass(void)
{
    const VkImageLayout layouts[2] = {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                      VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference references[2] = {{COLOUR, layouts[COLOUR]}, {DEPTH, layouts[DEPTH]}};
    const VkSubpassDescription subpass = {.colorAttachmentCount = 1, .pColorAttachments = &references[COLOUR],
                                          .pDepthStencilAttachment = &references[DEPTH]};
    VkAttachmentDescription attachments[2];
    for (int i = 0; i < 2; i++)
        attachments[i] = (VkAttachmentDescription){
            .format = i == DEPTH ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R8G8B8A8_UNORM, .samples = VK_SAMPLE_COUNT_1_BIT,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR, .finalLayout = layouts[i]};
    const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO, .attachmentCount = 2,
                                         .pAttachments = attachments, .subpassCount = 1, .pSubpasses = &subpass};
    CHECK(vkCreateRenderPass(device, &info, 0, &pass));
}

static void make_frames(void)
{
    const VkCommandPoolCreateInfo of_pool = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, 0,
                                             VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT, 0};
    const VkFenceCreateInfo signalled = {VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, 0, VK_FENCE_CREATE_SIGNALED_BIT};
    const VkBufferCreateInfo of_buffer = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 4 * WIDTH * HEIGHT,
                                          .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkMemoryRequirements needs;
    VkCommandPool pool;
    CHECK(vkCreateCommandPool(device, &of_pool, 0, &pool));
    const VkCommandBufferAllocateInfo two = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, 0, pool,
                                             VK_COMMAND_BUFFER_LEVEL_PRIMARY, FRAMES};
    CHECK(vkAllocateCommandBuffers(device, &two, commands));
    CHECK(vkCreateBuffer(device, &of_buffer, 0, &buffer));
    vkGetBufferMemoryRequirements(device, buffer, &needs);
    const VkDeviceMemory memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                                  VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    CHECK(vkBindBufferMemory(device, buffer, memory, 0));
    CHECK(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, (void **)&pixels));
    for (int i = 0; i < FRAMES; i++) {
        const VkImageView views[2] = {make_image(&images[i][COLOUR], COLOUR), make_image(&images[i][DEPTH], DEPTH)};
        const VkFramebufferCreateInfo info = {VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, 0, 0, pass, 2, views, WIDTH,
                                              HEIGHT, 1};
        CHECK(vkCreateFramebuffer(device, &info, 0, &framebuffers[i]));
        CHECK(vkCreateFence(device, &signalled, 0, &fences[i]));
    }
}

/* Draws a rectangle at the distance `card`, left of the middle. */
static void draw_mesh(int i)
{
    const float depth = (1 / card - 1 / near_plane) / (1 / far_plane - 1 / near_plane);
    const VkClearValue empty[2] = {{.color = {{0, 0, 0, 1}}}, {.depthStencil = {1, 0}}};
    const VkClearAttachment of_card[2] = {{VK_IMAGE_ASPECT_COLOR_BIT, COLOUR, {.color = {{0.8f, 0.4f, 0.2f, 1}}}},
                                          {VK_IMAGE_ASPECT_DEPTH_BIT, DEPTH, {.depthStencil = {depth, 0}}}};
    const VkClearRect rectangle = {{{107, 73}, {213, 214}}, 0, 1};
    const VkRenderPassBeginInfo info = {VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, 0, pass, framebuffers[i],
                                        {{0, 0}, {WIDTH, HEIGHT}}, 2, empty};
    vkCmdBeginRenderPass(commands[i], &info, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdClearAttachments(commands[i], 2, of_card, 1, &rectangle);
    vkCmdEndRenderPass(commands[i]);
}

static void draw_frame(fxs_vulkan *vulkan, const fxs_request *request, int i)
{
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    const VkBufferImageCopy whole = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                     .imageExtent = {WIDTH, HEIGHT, 1}};
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                                 .pCommandBuffers = &commands[i]};
    const VkImageUsageFlags copies = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const fxs_vulkan_image colour = {images[i][COLOUR], VK_FORMAT_R8G8B8A8_UNORM, copies, WIDTH, HEIGHT, 1, 0, 0, 0,
                                     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    const fxs_vulkan_image depth = {images[i][DEPTH], VK_FORMAT_D32_SFLOAT, copies, WIDTH, HEIGHT, 1, 0, 0, 0,
                                    VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                                    VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    fxs_vulkan_target target = {.plane_0 = near_plane, .plane_1 = far_plane, .colour = colour, .backdrop = colour,
                                .occluder = depth};
    fxs_message why;
    target.backdrop.after = colour.before;         /* the colour image is read, then written */
    CHECK(vkWaitForFences(device, 1, &fences[i], VK_TRUE, UINT64_MAX));
    CHECK(vkResetFences(device, 1, &fences[i]));
    CHECK(vkBeginCommandBuffer(commands[i], &begin));
    draw_mesh(i);
    if (fxs_vulkan_record(vulkan, request, &target, commands[i], &why))
        exit(puts(why.text));
    vkCmdCopyImageToBuffer(commands[i], images[i][COLOUR], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &whole);
    CHECK(vkEndCommandBuffer(commands[i]));
    CHECK(vkQueueSubmit(queue, 1, &submit, fences[i]));
}

int main(int argc, char **argv)
{
    static const double view[16] = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, -12, 1};
    static const double projection[16] = {1024.0 / WIDTH, 0, 0, 0, 0, 1024.0 / HEIGHT, 0, 0, 0, 0, -1, -1, 0, 0, -1, 0};
    fxs_message why = {.text = "usage: vulkan SCENE PICTURE"};
    fxs_vulkan_options options;
    fxs_vulkan *vulkan;
    fxs_opened *opened;
    fxs_object object;
    fxs_request request;
    if (argc != 3 || fxs_open(argv[1], NULL, &opened, &why))
        return puts(why.text), 1;
    make_device();
    make_pass();
    make_frames();
    fxs_vulkan_options_init(&options);
    options.load = vkGetInstanceProcAddr;
    options.instance = instance;
    options.physical = physical;
    options.device = device;
    options.queue = queue;
    fxs_object_init(&object, opened->scene);
    fxs_request_init(&request, &object, 1);
    if (fxs_camera_from_matrices(&request.cameras[0], view, projection, WIDTH, HEIGHT, &why) ||
        fxs_vulkan_create(&vulkan, &options, &why) || fxs_vulkan_upload(vulkan, opened->scene, &why))
        return puts(why.text), 1;
    for (int i = 0; i < 10; i++)
        draw_frame(vulkan, &request, i % FRAMES);
    CHECK(vkDeviceWaitIdle(device));
    fxs_vulkan_idle(vulkan);
    fxs_vulkan_destroy(vulkan);
    return fxs_image_file_write(argv[2], pixels, WIDTH, HEIGHT, &why) ? puts(why.text), 1 : 0;
}
