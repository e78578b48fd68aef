/* Fuzzes the camera readers on memory: the first byte picks the format, the next two the size of the cameras file of a
   COLMAP model. Every view that is read is made a camera. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include "src/camera/camera_internal.h"

static fxs_text copy(const char *path, const uint8_t *data, size_t size)
{
    fxs_text text = {path, malloc(size + 1), size};
    if (!text.data)
        abort();
    memcpy(text.data, data, size);
    text.data[size] = 0;
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void make_cameras(const fxs_view_list *list)
{
    fxs_camera camera;
    fxs_message message;
    for (size_t i = 0; i < list->count; i++)
        if (fxs_camera_from_view(&camera, &list->views[i].view, &message) && strchr(message.text, '\n'))
            abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    int status;
    if (size < 3)
        return 0;
    fxs_message message;
    fxs_view_list list;
    memset(&list, 0, sizeof list);
    list.path = "fuzz";
    list.message = &message;
    size_t rest = size - 3, split = data[1] | (size_t)data[2] << 8;
    if (data[0] % 3 == 0) {
        fxs_text json = copy("cameras.json", data + 3, rest);
        status = fxs_camera_json_parse(&list, &json);
        free(json.data);
    } else {
        split = split < rest ? split : rest;
        fxs_text cameras = copy("cameras", data + 3, split), images = copy("images", data + 3 + split, rest - split);
        status = fxs_camera_colmap_parse(&list, data[0] % 3 == 1, &cameras, &images);
        free(cameras.data);
        free(images.data);
    }
    if (!status)
        make_cameras(&list);
    fxs_view_list_free(&list);
    return 0;
}
