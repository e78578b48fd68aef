/* Reads Bundler v0.3 camera files and their list of photographs. */
#include "camera_internal.h"
#include "colmap_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/files_internal.h"
#include "src/base/number.h"

enum { SIZE = 800 };

/* Finds the list of photographs, by the names that Bundler, VisualSFM, COLMAP and RealityCapture give to it. */
static int find_list(const char *model, char path[FXS_CAMERA_PATH])
{
    static const struct {
        const char *ending, *name;
    } lists[] = {{".bundle.out", ".list.txt"}, {".out", ".list.txt"}, {"", ".list.txt"}, {".out", ".txt"},
                 {"/", "list.txt"}, {"/", "../list.txt"}};
    const char *slash = strrchr(model, '/');
    const size_t length = strlen(model), folder = slash ? (size_t)(slash + 1 - model) : 0;
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        const size_t ending = strlen(lists[i].ending);
        const int in_folder = *lists[i].ending == '/';
        if (!in_folder && (length < ending || strcmp(model + length - ending, lists[i].ending)))
            continue;
        const size_t kept = in_folder ? folder : length - ending;
        const int written = snprintf(path, FXS_CAMERA_PATH, "%.*s%s", (int)kept, model, lists[i].name);
        if (written < FXS_CAMERA_PATH && fxs_file_kind(path) == FXS_FILE_REGULAR)
            return 1;
    }
    return 0;
}

/* Cuts off the "0 FOCAL" that Bundler writes after a photograph's name in its list. */
static void cut_focal(char *line)
{
    double numbers[2];
    char *ends[2] = {NULL, NULL};
    for (int i = 0; i < 2; i++) {
        size_t length = strlen(line);
        while (length && strchr(" \t\r", line[length - 1]))
            line[--length] = 0;
        while (length && !strchr(" \t", line[length - 1]))
            length--;
        if (!length || !fxs_read_number(line + length, &numbers[i]))
            break;
        ends[i] = line + length;
        line[length - 1] = 0;
    }
    if (ends[0] && !ends[1])
        ends[0][-1] = ' ';
}

/* Adds a camera to the list of views. The rotation r and translation t map world to camera, with y up and z
   backwards. */
static int add_view(fxs_view_list *list, const char *name, const double camera[3], const double r[9], const double t[3])
{
    fxs_listed_view *listed;
    FXS_TRY(fxs_view_list_add(list, name, &listed));
    fxs_view *view = &listed->view;
    for (int i = 0; i < 3; i++) {
        view->rotation[i] = r[i];
        view->rotation[3 + i] = -r[3 + i];
        view->rotation[6 + i] = -r[6 + i];
        view->position[i] = -(r[i] * t[0] + r[3 + i] * t[1] + r[6 + i] * t[2]);
    }
    view->fx = view->fy = camera[0];
    view->cx = view->cy = SIZE / 2.0;
    listed->sizeless = FXS_SIZE_OF_PIXELS;
    listed->lens.k[0] = camera[1];
    listed->lens.k[1] = camera[2];
    view->bends = !fxs_lens_is_pinhole(&listed->lens);
    return fxs_view_list_finish(list, SIZE, SIZE);
}

static int read_numbers(char **rest, double *out, int lines, int a_line)
{
    for (int i = 0; i < lines; i++) {
        char *line = fxs_colmap_entry(rest);
        if (!line || !fxs_colmap_numbers(&line, out + i * a_line, a_line))
            return 0;
    }
    return 1;
}

/* Skips cameras with focal length 0: Bundler could not locate them. */
int fxs_camera_bundler_parse(fxs_view_list *list, const fxs_text *model, const fxs_text *photographs)
{
    char *rest = fxs_text_begin(model), *names = fxs_text_begin(photographs);
    double counts[2];
    if (strlen(model->data) < model->size || strlen(photographs->data) < photographs->size)
        return fxs_fail(list->message, "%s: zero bytes in this text or in its list of photographs", list->path);
    if (!read_numbers(&rest, counts, 1, 2))
        return fxs_fail(list->message, "%s: does not begin with the numbers of cameras and of points", list->path);
    for (double i = 0; i < counts[0]; i++) {
        double camera[3], rotation[9], translation[3];
        char *name = fxs_colmap_entry(&names);
        if (!name)
            return fxs_fail(list->message, "%s: only %.0f photographs, but %.0f cameras in %s", photographs->path, i,
                            counts[0], list->path);
        if (!read_numbers(&rest, camera, 1, 3) || !read_numbers(&rest, rotation, 3, 3) ||
            !read_numbers(&rest, translation, 1, 3))
            return fxs_fail(list->message, "%s: camera %.0f: not five lines of three numbers", list->path, i);
        cut_focal(name);
        if (camera[0] != 0)
            FXS_TRY(add_view(list, fxs_without_drive(name), camera, rotation, translation));
    }
    return 0;
}

int fxs_camera_bundler_read(fxs_view_list *list, const fxs_text *model)
{
    char path[FXS_CAMERA_PATH];
    fxs_text photographs;
    if (!find_list(list->path, path))
        return fxs_fail(list->message, "%s: no list of its photographs: expected list.txt beside it", list->path);
    FXS_TRY(fxs_text_load(path, &photographs, list->message));
    const int error = fxs_camera_bundler_parse(list, model, &photographs);
    free(photographs.data);
    return error;
}
