/* Fuzzes the readers of camera files. Byte 0 of an input picks the file format. A reader gets two files. Bytes 1 and
   2 give the size of the first file. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include "src/camera/camera_internal.h"
#include "src/camera/lens_warp.h"

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

static void draw_through(const fxs_lens *lens, const fxs_view *view)
{
    static fxs_lens_warp warp;
    static const uint8_t outside[4];
    fxs_lens_warp_make(&warp, lens, view);
    const size_t bytes = 4 * (size_t)warp.cover.width * (size_t)warp.cover.height;
    if (view->width > 16 || view->height > 16)
        return;
    uint8_t *cover = calloc(bytes, 1), *out = malloc(4 * (size_t)view->width * (size_t)view->height);
    if (!cover || !out)
        abort();
    fxs_lens_warp_rows(&warp, cover, outside, out, 0, view->height);
    free(cover);
    free(out);
}

static void make_cameras(const fxs_view_list *list)
{
    fxs_camera camera;
    fxs_message message;
    for (size_t i = 0; i < list->count; i++) {
        const fxs_listed_view *listed = &list->views[i];
        fxs_view view = listed->view, filled;
        if (fxs_camera_from_view(&camera, &view, &message) && strchr(message.text, '\n'))
            abort();
        if (listed->sizeless)
            fxs_view_set_size(listed, &view, 16, 12);
        if (i < 4 && fxs_lens_fill(&listed->lens, &view, &filled) && !(filled.fx > 0))
            abort();
        if (i < 2)
            draw_through(&listed->lens, &view);
    }
}

enum { JSON, COLMAP_BIN, COLMAP_TXT, CSV, BUNDLER, METASHAPE, FORMATS };

static int parse(fxs_view_list *list, int format, fxs_text *first, fxs_text *second)
{
    switch (format) {
    case JSON: return fxs_camera_json_parse(list, first);
    case CSV: return fxs_camera_csv_parse(list, first);
    case METASHAPE: return fxs_camera_metashape_parse(list, first);
    case BUNDLER: return fxs_camera_bundler_parse(list, first, second);
    default: return fxs_camera_colmap_parse(list, format == COLMAP_BIN, first, second);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 3)
        return 0;
    const int format = data[0] % FORMATS, has_two = format == COLMAP_BIN || format == COLMAP_TXT || format == BUNDLER;
    const size_t rest = size - 3, stated = data[1] | (size_t)data[2] << 8;
    const size_t split = has_two && stated < rest ? stated : rest;
    fxs_message message;
    fxs_view_list list;
    memset(&list, 0, sizeof list);
    list.path = "fuzz";
    list.message = &message;
    fxs_text first = copy("cameras", data + 3, split), second = copy("images", data + 3 + split, rest - split);
    if (!parse(&list, format, &first, &second))
        make_cameras(&list);
    free(first.data);
    free(second.data);
    fxs_view_list_free(&list);
    return 0;
}
