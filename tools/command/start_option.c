/* Start views of packed scenes, by the option --start-view. */
#include "start_option.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "command.h"
#include "file_guard.h"
#include "views.h"

int take_direction(const option_row *row, void *field, const char *value)
{
    const double *n = field;
    return parse_vector(value, 3, field) && (n[0] != 0 || n[1] != 0 || n[2] != 0) ? 0 : wrong_value(row, value);
}

/* Takes a view of a camera file, CAMERAS:VIEW. */
static int take_camera(start_option *o, const char *value)
{
    const char *colon = strrchr(value, ':');
    char file[4096];
    fxs_view *views;
    fxs_message message;
    snprintf(file, sizeof file, "%.*s", colon ? (int)(colon - value) : -1, value);
    files_read(file);
    const long count = fxs_camera_file_read(file, &views, &message);
    if (count < 0)
        return fail(EXIT_FAILED, "--start-view: %s", message.text);
    const long index = find_view(&(frame_options){.cameras = file, .view = colon ? colon + 1 : 0}, views, count);
    if (index >= 0)
        o->view = views[index];
    free(views);
    return index < 0 ? EXIT_FAILED : 0;
}

int take_start(const option_row *row, void *field, const char *value)
{
    static const double up[3] = {0, -1, 0};
    start_option *o = field;
    double n[7] = {[6] = 50};
    fxs_message message;
    o->given = 1;
    o->is_level = parse_vector(value, 6, n) || parse_vector(value, 7, n);
    if (!*value || (o->is_level && !(n[6] >= 1 && n[6] <= 170)))
        return wrong_value(row, value);
    if (!o->is_level)
        return take_camera(o, value);
    return fxs_view_look_at(&o->view, n, n + 3, up, &(fxs_picture){n[6], 1280, 720}, &message)
               ? fail(EXIT_USAGE, "--start-view %s: %s", value, message.text) : 0;
}

int start_store(const start_option *o, void *data, fxs_message *message)
{
    fxs_view view = o->view;
    fxs_start start;
    fxs_start_of(&start, data);
    if (o->is_level)
        fxs_view_level(&view, start.up);
    return fxs_view_to_start(data, &view, message);
}

int find_up(const fxs_opened *opened, double up[3], fxs_message *message)
{
    double box[2][3];
    fxs_object object;
    fxs_view view;
    fxs_object_init(&object, opened->scene);
    fxs_inner_box(opened->data, box[0], box[1]);
    memset(up, 0, 3 * sizeof *up);
    return fxs_first_view(&object, 1, box, up, &(fxs_picture){50, 96, 64}, &view, message);
}
