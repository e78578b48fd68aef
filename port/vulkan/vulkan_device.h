/* A Vulkan device of the library's own. */
#ifndef FXS_VULKAN_DEVICE_H
#define FXS_VULKAN_DEVICE_H

#include <fixsplat/vulkan.h>

typedef struct fxs_vulkan_device {
    fxs_vulkan_options options;    /* all handles are set */
    const char *const *extensions; /* of the instance; the caller keeps them until the device is found */
    uint32_t extension_count;
    const char *extension;         /* of the device; null: none */
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
} fxs_vulkan_device;

/* Loads Vulkan's loader at run time. Returns 0 or FXS_ERR_DEVICE. */
int fxs_vulkan_load(PFN_vkGetInstanceProcAddr *load, fxs_message *why);

/* Finds device number `number` with Vulkan 1.1 and a queue with compute, discrete GPUs first, and writes its name.
   `load` null: Vulkan's loader is loaded at run time. Returns 0 or an FXS_ERR_*. After an error, nothing is open. */
int fxs_vulkan_find_device(fxs_vulkan_device *device, PFN_vkGetInstanceProcAddr load, int number, fxs_message *why);

/* Like fxs_vulkan_find_device, with options.load and the extensions of *device. Its other fields must be 0. */
int fxs_vulkan_choose_device(fxs_vulkan_device *device, int number, fxs_message *why);

/* Creates the VkDevice. */
int fxs_vulkan_open_device(fxs_vulkan_device *device, fxs_message *why);

/* Destroys device and instance. */
void fxs_vulkan_close_device(fxs_vulkan_device *device);

#endif
