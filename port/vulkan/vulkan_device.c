/* Opens a Vulkan device. Vulkan's loader is loaded at run time. */
#include "vulkan_device.h"

#include <dlfcn.h>
#include <string.h>

#include <fixsplat/internal/message.h>

enum { DEVICES = 16, FAMILIES = 16 };

/* dlsym returns a data pointer; POSIX allows its use as a function pointer. */
int fxs_vulkan_load(PFN_vkGetInstanceProcAddr *load, fxs_message *why)
{
    void *library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    library = library ? library : dlopen("libvulkan.so", RTLD_NOW | RTLD_LOCAL);       /* its name on Android */
    void *address = library ? dlsym(library, "vkGetInstanceProcAddr") : 0;
    memcpy(load, &address, sizeof *load);
    return address ? 0 : fxs_fail_as(FXS_ERR_DEVICE, why, "no Vulkan: %s", dlerror());
}

#define CALL(name) ((PFN_vk##name)d->options.load(d->options.instance, "vk" #name))

static int make_instance(fxs_vulkan_device *d, fxs_message *why)
{
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pEngineName = "fixsplat",
                                           .engineVersion = FXS_VERSION_NUMBER, .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application,
                                       .enabledExtensionCount = d->extension_count,
                                       .ppEnabledExtensionNames = d->extensions};
    const PFN_vkCreateInstance create = CALL(CreateInstance);
    const VkResult result = create ? create(&info, 0, &d->options.instance) : VK_ERROR_INITIALIZATION_FAILED;
    if (result)
        d->options.instance = VK_NULL_HANDLE;
    return result ? fxs_fail_as(FXS_ERR_DEVICE, why, "no driver of Vulkan 1.1 (error %d)", (int)result) : 0;
}

/* Returns the number of the first queue family with compute, or -1. */
static int family_of(const fxs_vulkan_device *d, VkPhysicalDevice device)
{
    VkQueueFamilyProperties families[FAMILIES];
    uint32_t count = FAMILIES;
    CALL(GetPhysicalDeviceQueueFamilyProperties)(device, &count, families);
    for (uint32_t i = 0; i < count; i++)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)
            return (int)i;
    return -1;
}

static int rank_of(const VkPhysicalDeviceProperties *properties)
{
    return properties->deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU     ? 0
           : properties->deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ? 1
           : properties->deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU            ? 3 : 2;
}

static int choose(fxs_vulkan_device *d, int number, fxs_message *why)
{
    VkPhysicalDevice devices[DEVICES];
    VkPhysicalDeviceProperties properties;
    uint32_t count = DEVICES;
    int found = 0;
    const VkResult result = CALL(EnumeratePhysicalDevices)(d->options.instance, &count, devices);
    for (int rank = 0; rank < 4 && result >= 0; rank++)
        for (uint32_t i = 0; i < count; i++) {
            CALL(GetPhysicalDeviceProperties)(devices[i], &properties);
            const int family = family_of(d, devices[i]);
            if (rank_of(&properties) != rank || properties.apiVersion < VK_API_VERSION_1_1 || family < 0 ||
                found++ != number)
                continue;
            d->options.physical = devices[i];
            d->options.family = (uint32_t)family;
            memcpy(d->name, properties.deviceName, sizeof d->name);
            return 0;
        }
    return found ? fxs_fail_as(FXS_ERR_DEVICE, why, "there is no device %d: the last is %d", number, found - 1)
                 : fxs_fail_as(FXS_ERR_DEVICE, why, "no device with Vulkan 1.1");
}

int fxs_vulkan_find_device(fxs_vulkan_device *d, PFN_vkGetInstanceProcAddr load, int number, fxs_message *why)
{
    memset(d, 0, sizeof *d);
    d->options.load = load;
    return fxs_vulkan_choose_device(d, number, why);
}

int fxs_vulkan_choose_device(fxs_vulkan_device *d, int number, fxs_message *why)
{
    d->options.size = sizeof d->options;
    int error = d->options.load ? 0 : fxs_vulkan_load(&d->options.load, why);
    error = error ? error : make_instance(d, why);
    error = error ? error : choose(d, number, why);
    if (error)
        fxs_vulkan_close_device(d);
    return error;
}

int fxs_vulkan_open_device(fxs_vulkan_device *d, fxs_message *why)
{
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = d->options.family, .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue, .enabledExtensionCount = d->extension != 0,
                                     .ppEnabledExtensionNames = &d->extension};
    const VkResult result = CALL(CreateDevice)(d->options.physical, &info, 0, &d->options.device);
    if (result) {
        d->options.device = VK_NULL_HANDLE;
        return fxs_fail_as(FXS_ERR_DEVICE, why, "%s cannot be opened (error %d)", d->name, (int)result);
    }
    CALL(GetDeviceQueue)(d->options.device, d->options.family, 0, &d->options.queue);
    return 0;
}

void fxs_vulkan_close_device(fxs_vulkan_device *d)
{
    if (d->options.device)
        CALL(DestroyDevice)(d->options.device, 0);
    if (d->options.instance)
        CALL(DestroyInstance)(d->options.instance, 0);
    d->options.device = VK_NULL_HANDLE;
    d->options.instance = VK_NULL_HANDLE;
}
