/* Loads Vulkan for tests, with the layer of failing_layer.c and below it the validation layer, if that is here. */
#ifndef LOSING_VULKAN_H
#define LOSING_VULKAN_H

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "failing_layer.h"

#define VALIDATION "VK_LAYER_KHRONOS_validation"

static PFN_vkGetInstanceProcAddr real_load;
static PFN_vkGetDeviceProcAddr real_load_of_device;
static const char *missing;                /* name of a function that the loader does not find; null: none */
static fxs_failing_layer *layer;
static int validated;                      /* 1: the validation layer is there */

static void lose_at(long call, VkResult result, int ever)
{
    layer->calls = 0;
    layer->fails_at = call;
    layer->result = result;
    layer->ever = ever;
}

/* Ends the simulated loss. Returns the number of calls since lose_at. */
static long stop_losing(void)
{
    layer->fails_at = -1;
    return layer->calls;
}

static PFN_vkVoidFunction VKAPI_PTR load_of_device(VkDevice device, const char *name)
{
    return missing && !strcmp(missing, name) ? 0 : real_load_of_device(device, name);
}

static PFN_vkVoidFunction VKAPI_PTR losing_load(VkInstance instance, const char *name)
{
    const PFN_vkVoidFunction found = real_load(instance, name);
    if (missing && !strcmp(missing, name))
        return 0;
    if (strcmp(name, "vkGetDeviceProcAddr"))
        return found;
    real_load_of_device = (PFN_vkGetDeviceProcAddr)found;
    return (PFN_vkVoidFunction)load_of_device;
}

static int has_layer(const char *name)
{
    const PFN_vkEnumerateInstanceLayerProperties list =
        (PFN_vkEnumerateInstanceLayerProperties)real_load(0, "vkEnumerateInstanceLayerProperties");
    VkLayerProperties layers[32];
    uint32_t count = 32;
    list(&count, layers);
    while (count && strcmp(layers[count - 1].layerName, name))
        count--;
    return count > 0;
}

/* Loads Vulkan's loader and the layer, from the folder of the test program. Returns 0 if Vulkan's loader is not here.
   The loader ignores the validation layer if it is missing. */
static int load_vulkan(const char *program)
{
    char path[4096], file[4096 + 32];
    const char *slash = strrchr(program, '/');
    snprintf(path, sizeof path, "%.*s/layer", slash ? (int)(slash - program) : 1, slash ? program : ".");
    snprintf(file, sizeof file, "%s/libfailing_layer.so", path);
    strncat(path, ":/usr/share/vulkan/explicit_layer.d", sizeof path - strlen(path) - 1);
    setenv("VK_LAYER_PATH", path, 1);
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_FIXSPLAT_failing:" VALIDATION, 1);
    void *vulkan = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL), *own = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    void *address = vulkan ? dlsym(vulkan, "vkGetInstanceProcAddr") : 0;
    layer = own ? dlsym(own, "fxs_failing") : 0;
    if (!layer)
        printf("%s is missing\n", file);
    memcpy(&real_load, &address, sizeof real_load);
    validated = address && has_layer(VALIDATION);
    return address && layer;
}

#endif
