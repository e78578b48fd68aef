/* The window system of Android's Vulkan, over a driver without one: surfaces are windows of the stand-in, and the
 * images of a swapchain are plain images, which are copied to the window when they are presented. As Android's, a
 * surface has the format R8G8B8A8, the window's size, and no alpha but the window's. */
#include "stand_in.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include <vulkan/vulkan_core.h>
#include <vulkan/vulkan_android.h>

#define IMAGES 3
#define CALLS(F) \
    F(CreateImage) F(DestroyImage) F(GetImageMemoryRequirements) F(AllocateMemory) F(FreeMemory) F(BindImageMemory) \
    F(CreateBuffer) F(DestroyBuffer) F(GetBufferMemoryRequirements) F(BindBufferMemory) F(MapMemory) \
    F(CreateCommandPool) F(DestroyCommandPool) F(AllocateCommandBuffers) F(BeginCommandBuffer) F(EndCommandBuffer) \
    F(CmdPipelineBarrier) F(CmdCopyImageToBuffer) F(QueueSubmit) F(QueueWaitIdle) F(GetDeviceQueue)

typedef struct surface {
    stand_in_window *window;
} surface;

typedef struct swapchain {
    stand_in_window *window;
    VkExtent2D size;
    VkImage images[IMAGES];
    VkDeviceMemory memory[IMAGES + 1];
    VkBuffer buffer;
    void *mapped;
    VkCommandPool pool;
    VkCommandBuffer commands;
    uint32_t next;
} swapchain;

static PFN_vkGetInstanceProcAddr load;
static PFN_vkGetDeviceProcAddr load_of_device;
static VkInstance instance_now;
static VkPhysicalDevice physical_now;

/* The functions of a device: all devices of one driver have the same. */
#define MEMBER(name) PFN_vk##name name;
static struct {
    CALLS(MEMBER)
} vk;

static swapchain *chain_of(VkSwapchainKHR handle)
{
    return (swapchain *)(uintptr_t)handle;
}

/* ---- Surfaces ---------------------------------------------------------------------------------------------------- */

static VkResult VKAPI_CALL list_extensions(const char *layer, uint32_t *count, VkExtensionProperties *list)
{
    const PFN_vkEnumerateInstanceExtensionProperties real =
        (PFN_vkEnumerateInstanceExtensionProperties)load(NULL, "vkEnumerateInstanceExtensionProperties");
    const uint32_t room = *count;
    const VkResult result = real(layer, count, list);
    if (layer || (list && room <= *count))
        return result;
    if (list)
        strcpy(list[*count].extensionName, VK_KHR_ANDROID_SURFACE_EXTENSION_NAME);
    ++*count;
    return result;
}

static VkResult VKAPI_CALL make_instance(const VkInstanceCreateInfo *info, const VkAllocationCallbacks *allocator,
                                         VkInstance *instance)
{
    const PFN_vkCreateInstance real = (PFN_vkCreateInstance)load(NULL, "vkCreateInstance");
    const char *names[16];
    VkInstanceCreateInfo without = *info;
    if (stand_in_fails(NO_VULKAN))
        return VK_ERROR_INCOMPATIBLE_DRIVER;
    without.enabledExtensionCount = 0;
    without.ppEnabledExtensionNames = names;
    for (uint32_t i = 0; i < info->enabledExtensionCount; i++)
        if (strcmp(info->ppEnabledExtensionNames[i], VK_KHR_ANDROID_SURFACE_EXTENSION_NAME))
            names[without.enabledExtensionCount++] = info->ppEnabledExtensionNames[i];
    const VkResult result = real(&without, allocator, instance);
    instance_now = *instance;
    return result;
}

static VkResult VKAPI_CALL make_surface(VkInstance instance, const VkAndroidSurfaceCreateInfoKHR *info,
                                        const VkAllocationCallbacks *allocator, VkSurfaceKHR *made)
{
    stand_in_window *const window = (stand_in_window *)info->window;
    (void)instance, (void)allocator;
    if (window->is_taken)
        return VK_ERROR_NATIVE_WINDOW_IN_USE_KHR;
    surface *const s = malloc(sizeof *s);
    s->window = window;
    window->is_taken = 1;
    *made = (VkSurfaceKHR)(uintptr_t)s;
    return VK_SUCCESS;
}

static void VKAPI_CALL destroy_surface(VkInstance instance, VkSurfaceKHR handle, const VkAllocationCallbacks *allocator)
{
    surface *const s = (surface *)(uintptr_t)handle;
    (void)instance, (void)allocator;
    if (s)
        s->window->is_taken = 0;
    free(s);
}

static VkResult VKAPI_CALL supports(VkPhysicalDevice physical, uint32_t family, VkSurfaceKHR handle, VkBool32 *does)
{
    (void)family, (void)handle;
    physical_now = physical;
    *does = VK_TRUE;
    return VK_SUCCESS;
}

static VkResult VKAPI_CALL abilities(VkPhysicalDevice physical, VkSurfaceKHR handle, VkSurfaceCapabilitiesKHR *to)
{
    const stand_in_window *const window = ((surface *)(uintptr_t)handle)->window;
    const VkExtent2D size = {(uint32_t)window->width, (uint32_t)window->height};
    physical_now = physical;
    *to = (VkSurfaceCapabilitiesKHR){
        2, IMAGES, size, {1, 1}, {4096, 4096}, 1, VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR,
        VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR, VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
        VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT};
    return VK_SUCCESS;
}

static VkResult VKAPI_CALL formats(VkPhysicalDevice physical, VkSurfaceKHR handle, uint32_t *count,
                                   VkSurfaceFormatKHR *list)
{
    (void)physical, (void)handle;
    if (list)
        *list = (VkSurfaceFormatKHR){VK_FORMAT_R8G8B8A8_UNORM, VK_COLOR_SPACE_SRGB_NONLINEAR_KHR};
    *count = 1;
    return VK_SUCCESS;
}

static VkResult VKAPI_CALL modes(VkPhysicalDevice physical, VkSurfaceKHR handle, uint32_t *count,
                                 VkPresentModeKHR *list)
{
    (void)physical, (void)handle;
    if (list)
        *list = VK_PRESENT_MODE_FIFO_KHR;
    *count = 1;
    return VK_SUCCESS;
}

/* ---- Swapchains -------------------------------------------------------------------------------------------------- */

static uint32_t type_of(uint32_t allowed, VkMemoryPropertyFlags wanted)
{
    VkPhysicalDeviceMemoryProperties all;
    uint32_t i = 0;
    ((PFN_vkGetPhysicalDeviceMemoryProperties)load(instance_now, "vkGetPhysicalDeviceMemoryProperties"))(physical_now,
                                                                                                         &all);
    while (!(allowed >> i & 1 && (all.memoryTypes[i].propertyFlags & wanted) == wanted))
        i++;
    return i;
}

static void allocate(VkDevice device, const VkMemoryRequirements *needs, VkMemoryPropertyFlags wanted,
                     VkDeviceMemory *memory)
{
    const VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, NULL, needs->size,
                                       type_of(needs->memoryTypeBits, wanted)};
    vk.AllocateMemory(device, &info, NULL, memory);
}

static void make_images(VkDevice device, swapchain *c, const VkSwapchainCreateInfoKHR *info)
{
    const VkImageCreateInfo image = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D, .format = info->imageFormat,
        .extent = {info->imageExtent.width, info->imageExtent.height, 1}, .mipLevels = 1, .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT, .usage = info->imageUsage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    VkMemoryRequirements needs;
    for (int i = 0; i < IMAGES; i++) {
        vk.CreateImage(device, &image, NULL, &c->images[i]);
        vk.GetImageMemoryRequirements(device, c->images[i], &needs);
        allocate(device, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &c->memory[i]);
        vk.BindImageMemory(device, c->images[i], c->memory[i], 0);
    }
    const VkBufferCreateInfo buffer = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                       .size = (VkDeviceSize)c->size.width * c->size.height * 4,
                                       .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    vk.CreateBuffer(device, &buffer, NULL, &c->buffer);
    vk.GetBufferMemoryRequirements(device, c->buffer, &needs);
    allocate(device, &needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
             &c->memory[IMAGES]);
    vk.BindBufferMemory(device, c->buffer, c->memory[IMAGES], 0);
    vk.MapMemory(device, c->memory[IMAGES], 0, VK_WHOLE_SIZE, 0, &c->mapped);
}

static VkResult VKAPI_CALL make_swapchain(VkDevice device, const VkSwapchainCreateInfoKHR *info,
                                          const VkAllocationCallbacks *allocator, VkSwapchainKHR *made)
{
    stand_in_window *const window = ((surface *)(uintptr_t)info->surface)->window;
    (void)allocator;
    if (stand_in_fails(SURFACE_LOST))
        return VK_ERROR_SURFACE_LOST_KHR;
    swapchain *const c = calloc(1, sizeof *c);
    c->window = window;
    c->size = info->imageExtent;
    make_images(device, c, info);
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    vk.CreateCommandPool(device, &pool, NULL, &c->pool);
    const VkCommandBufferAllocateInfo one = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, NULL, c->pool,
                                             VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    vk.AllocateCommandBuffers(device, &one, &c->commands);
    *made = (VkSwapchainKHR)(uintptr_t)c;
    return VK_SUCCESS;
}

static void VKAPI_CALL destroy_swapchain(VkDevice device, VkSwapchainKHR handle, const VkAllocationCallbacks *allocator)
{
    swapchain *const c = chain_of(handle);
    (void)allocator;
    if (!c)
        return;
    vk.DestroyCommandPool(device, c->pool, NULL);
    vk.DestroyBuffer(device, c->buffer, NULL);
    for (int i = 0; i < IMAGES; i++)
        vk.DestroyImage(device, c->images[i], NULL);
    for (int i = 0; i <= IMAGES; i++)
        vk.FreeMemory(device, c->memory[i], NULL);
    free(c);
}

static VkResult VKAPI_CALL list_images(VkDevice device, VkSwapchainKHR handle, uint32_t *count, VkImage *list)
{
    (void)device;
    if (list)
        memcpy(list, chain_of(handle)->images, sizeof chain_of(handle)->images);
    *count = IMAGES;
    return VK_SUCCESS;
}

static int is_old(const swapchain *c)
{
    return c->size.width != (uint32_t)c->window->width || c->size.height != (uint32_t)c->window->height;
}

static VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR handle, uint64_t patience, VkSemaphore semaphore,
                                   VkFence fence, uint32_t *image)
{
    swapchain *const c = chain_of(handle);
    VkQueue queue;
    (void)patience;
    if (stand_in_fails(OUT_OF_DATE) || is_old(c))
        return VK_ERROR_OUT_OF_DATE_KHR;
    vk.GetDeviceQueue(device, 0, 0, &queue);
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .signalSemaphoreCount = semaphore != 0,
                                 .pSignalSemaphores = &semaphore};
    *image = c->next++ % IMAGES;
    return vk.QueueSubmit(queue, 1, &submit, fence);
}

static void move(VkCommandBuffer commands, VkImage image, VkImageLayout before, VkImageLayout after)
{
    const VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                          .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                          .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT, .oldLayout = before,
                                          .newLayout = after, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = image,
                                          .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL,
                          0, NULL, 1, &barrier);
}

static void copy_image(swapchain *c, VkImage image)
{
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    const VkBufferImageCopy all = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {c->size.width, c->size.height, 1}};
    vk.BeginCommandBuffer(c->commands, &begin);
    move(c->commands, image, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vk.CmdCopyImageToBuffer(c->commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, c->buffer, 1, &all);
    move(c->commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
    vk.EndCommandBuffer(c->commands);
}

static VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR *info)
{
    static const VkPipelineStageFlags all[] = {VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT};
    swapchain *const c = chain_of(*info->pSwapchains);
    if (stand_in_fails(DEVICE_LOST))
        return VK_ERROR_DEVICE_LOST;
    copy_image(c, c->images[*info->pImageIndices]);
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .waitSemaphoreCount = info->waitSemaphoreCount,
                                 .pWaitSemaphores = info->pWaitSemaphores, .pWaitDstStageMask = all,
                                 .commandBufferCount = 1, .pCommandBuffers = &c->commands};
    vk.QueueSubmit(queue, 1, &submit, VK_NULL_HANDLE);
    vk.QueueWaitIdle(queue);
    if (is_old(c))
        return VK_ERROR_OUT_OF_DATE_KHR;
    stand_in_show(c->window, c->mapped, (int32_t)c->size.width, (int32_t)c->size.height, 0);
    return VK_SUCCESS;
}

/* ---- Loading ----------------------------------------------------------------------------------------------------- */

static PFN_vkVoidFunction VKAPI_CALL find_of_device(VkDevice device, const char *name);

static VkResult VKAPI_CALL make_device(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                                       const VkAllocationCallbacks *allocator, VkDevice *device)
{
    const PFN_vkCreateDevice real = (PFN_vkCreateDevice)load(instance_now, "vkCreateDevice");
    const VkResult result = real(physical, info, allocator, device);
    load_of_device = (PFN_vkGetDeviceProcAddr)load(instance_now, "vkGetDeviceProcAddr");
#define LOAD(name) vk.name = (PFN_vk##name)load_of_device(*device, "vk" #name);
    if (!result) {
        CALLS(LOAD)
    }
    return result;
}

#define OWN(name, function) {"vk" name, (PFN_vkVoidFunction)function}
static const struct {
    const char *name;
    PFN_vkVoidFunction function;
} own[] = {OWN("EnumerateInstanceExtensionProperties", list_extensions), OWN("CreateInstance", make_instance),
           OWN("CreateDevice", make_device), OWN("GetDeviceProcAddr", find_of_device),
           OWN("CreateAndroidSurfaceKHR", make_surface), OWN("DestroySurfaceKHR", destroy_surface),
           OWN("GetPhysicalDeviceSurfaceSupportKHR", supports),
           OWN("GetPhysicalDeviceSurfaceCapabilitiesKHR", abilities),
           OWN("GetPhysicalDeviceSurfaceFormatsKHR", formats), OWN("GetPhysicalDeviceSurfacePresentModesKHR", modes),
           OWN("CreateSwapchainKHR", make_swapchain), OWN("DestroySwapchainKHR", destroy_swapchain),
           OWN("GetSwapchainImagesKHR", list_images), OWN("AcquireNextImageKHR", acquire),
           OWN("QueuePresentKHR", present)};

static PFN_vkVoidFunction find_own(const char *name)
{
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (!strcmp(own[i].name, name))
            return own[i].function;
    return NULL;
}

static PFN_vkVoidFunction VKAPI_CALL find_of_device(VkDevice device, const char *name)
{
    const PFN_vkVoidFunction found = find_own(name);
    return found ? found : load_of_device(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance, const char *name)
{
    if (!load) {
        void *const library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
        void *const address = dlsym(library, "vkGetInstanceProcAddr");
        memcpy(&load, &address, sizeof load);
    }
    const PFN_vkVoidFunction found = find_own(name);
    return found ? found : load(instance, name);
}
