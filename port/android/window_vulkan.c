/* Draws into a window of Android by Vulkan, with a window of the library's own (vulkan.h). */
#include "window_way.h"

#include <stdlib.h>

#include <fixsplat/vulkan.h>
#include <fixsplat/internal/message.h>
#include <vulkan/vulkan_android.h>

typedef struct vulkan_way {
    fxs_vulkan_window *shown;
    void *window;
    PFN_vkGetInstanceProcAddr load;
} vulkan_way;

static VkResult make_surface(void *argument, VkInstance instance, VkSurfaceKHR *surface)
{
    const vulkan_way *const way = argument;
    const VkAndroidSurfaceCreateInfoKHR info = {.sType = VK_STRUCTURE_TYPE_ANDROID_SURFACE_CREATE_INFO_KHR,
                                                .window = way->window};
    const PFN_vkCreateAndroidSurfaceKHR make =
        (PFN_vkCreateAndroidSurfaceKHR)way->load(instance, "vkCreateAndroidSurfaceKHR");
    return make ? make(instance, &info, NULL, surface) : VK_ERROR_EXTENSION_NOT_PRESENT;
}

static fxs_vulkan *back_end(const vulkan_way *way)
{
    return fxs_vulkan_window_get_info(way->shown).vulkan;
}

static void close_way(void *self)
{
    vulkan_way *const way = self;
    fxs_vulkan_window_close(way->shown);
    free(way);
}

static int open_way(void **self, void *window, uint64_t pool_bytes, fxs_message *why)
{
    static const char *const extensions[] = {VK_KHR_SURFACE_EXTENSION_NAME, VK_KHR_ANDROID_SURFACE_EXTENSION_NAME};
    fxs_vulkan_window_options options;
    vulkan_way *const way = calloc(1, sizeof *way);
    if (!way)
        return fxs_fail_as(FXS_ERR_MEMORY, why, "no memory to open Vulkan");
    way->window = window;
    if (!fxs_system_function("libvulkan.so", "vkGetInstanceProcAddr", &way->load)) {
        free(way);
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "no Vulkan: there is no libvulkan.so");
    }
    fxs_vulkan_window_options_init(&options);
    options.load = way->load;
    options.extensions = extensions;
    options.extension_count = 2;
    options.surface = make_surface;
    options.argument = way;
    const int error = fxs_vulkan_window_open(&way->shown, &options, why);
    if (error) {
        free(way);
        return error;
    }
    fxs_vulkan_stream(back_end(way), pool_bytes, 0);
    *self = way;
    return 0;
}

static int take_window(void *self, void *window, fxs_message *why)
{
    vulkan_way *const way = self;
    way->window = window;
    return fxs_vulkan_window_renew(way->shown, window != NULL, why);
}

static int draw(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    return fxs_vulkan_window_draw(((vulkan_way *)self)->shown, request, stats, why);
}

static int show(void *self, fxs_message *why)
{
    vulkan_way *const way = self;
    fxs_vulkan_window_turn(way->shown);
    return fxs_vulkan_window_show(way->shown, 1, 0x000000ff, NULL, NULL, why);
}

static void drop(void *self, const fxs_scene *scene)
{
    fxs_vulkan_drop(back_end(self), scene);
}

static void limit(void *self, uint64_t pool_bytes)
{
    fxs_vulkan_stream(back_end(self), pool_bytes, 0);
}

static const char *name(const void *self)
{
    (void)self;
    return "vulkan";
}

const fxs_window_way fxs_window_vulkan = {open_way, take_window, draw, show, drop, limit, name, close_way};
