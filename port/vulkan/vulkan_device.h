/* A Vulkan device of the library's own, without a window. */
#ifndef FXS_VULKAN_DEVICE_H
#define FXS_VULKAN_DEVICE_H

#include <fixsplat/vulkan.h>

typedef struct fxs_vulkan_device {
    fxs_vulkan_options options;    /* all handles are set */
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
} fxs_vulkan_device;

/* Finds device number `number` with Vulkan 1.1 and a queue with compute, discrete GPUs first, and writes its name.
   `load` null: Vulkan's loader is loaded at run time. Returns 0 or an FXS_ERR_*. */
int fxs_vulkan_find_device(fxs_vulkan_device *device, PFN_vkGetInstanceProcAddr load, int number, fxs_message *why);

/* Creates the VkDevice. */
int fxs_vulkan_open_device(fxs_vulkan_device *device, fxs_message *why);

/* Destroys device and instance. */
void fxs_vulkan_close_device(fxs_vulkan_device *device);

#endif
