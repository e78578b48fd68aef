/* Grows the list of views (cameras) that camera file readers fill, and checks views. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/fail_list.h"
#include "camera_internal.h"

#define MAX_VIEWS 1000000
#define MAX_SIZE 16384   /* pixels */

int fxs_view_list_fault(const fxs_view_list *list, const char *fault)
{
    return fxs_fail(list->message, "%s: view %s: %s", list->path, list->views[list->count - 1].view.name, fault);
}

static int enlarge(fxs_view_list *list)
{
    const size_t capacity = 2 * list->capacity + 16;
    fxs_listed_view *views = realloc(list->views, capacity * sizeof *views);
    if (!views)
        return fxs_fail_memory(list->message, list->path, capacity * sizeof *views);
    list->views = views;
    list->capacity = capacity;
    return 0;
}

int fxs_view_list_add(fxs_view_list *list, const char *name, fxs_listed_view **added)
{
    if (list->count == MAX_VIEWS)
        return fxs_fail(list->message, "%s: more than %d views", list->path, MAX_VIEWS);
    if (list->count == list->capacity)
        FXS_TRY(enlarge(list));
    fxs_listed_view *listed = *added = memset(&list->views[list->count], 0, sizeof *listed);
    fxs_view *view = &listed->view;
    listed->time = NAN;
    if (name) {
        snprintf(view->name, sizeof view->name, "%s", name);
        listed->image = malloc(strlen(name) + 1);
        if (!listed->image)
            return fxs_fail_memory(list->message, list->path, 0);
        strcpy(listed->image, name);
    } else {
        snprintf(view->name, sizeof view->name, "%zu", list->count);
    }
    fxs_text_make_safe(view->name);
    list->count++;
    return 0;
}

int fxs_view_list_mask(const fxs_view_list *list, fxs_listed_view *view, const char *mask)
{
    if (!mask)
        return 0;
    view->mask = malloc(strlen(mask) + 1);
    if (!view->mask)
        return fxs_fail_memory(list->message, list->path, 0);
    strcpy(view->mask, mask);
    return 0;
}

void fxs_listed_view_free(fxs_listed_view *view)
{
    free(view->image);
    free(view->mask);
}

void fxs_view_list_free(fxs_view_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        fxs_listed_view_free(&list->views[i]);
    free(list->views);
    free(list->points);
    list->views = NULL;
    list->points = NULL;
    list->count = list->capacity = 0;
}

const char *fxs_without_drive(const char *name)
{
    const int drive = ((*name | 32) >= 'a' && (*name | 32) <= 'z') && name[1] == ':';
    const char *last = drive || *name == '\\' ? strrchr(name, '\\') : NULL, *slash = drive ? strrchr(name, '/') : NULL;
    if (slash && (!last || slash > last))
        last = slash;
    return last ? last + 1 : name;
}

void fxs_view_set_size(const fxs_listed_view *listed, fxs_view *view, int width, int height)
{
    const int longer = width > height ? width : height;
    const double factor = listed->sizeless == FXS_SIZE_OF_WIDTH  ? (double)width / view->width :
                          listed->sizeless == FXS_SIZE_OF_LONGER ? (double)longer / view->width : 1;
    const double off = listed->sizeless == FXS_SIZE_OF_LONGER ? factor : 0;
    view->fx *= factor;
    view->fy = view->fx;
    view->cx = width / 2.0 + off * (view->cx - view->width / 2.0);
    view->cy = height / 2.0 + off * (view->cy - view->height / 2.0);
    view->width = width;
    view->height = height;
}

static int size_valid(double size)
{
    return size >= 1 && size <= MAX_SIZE && size == floor(size);
}

/* Replaces a matrix by the nearest rotation. A uniform scale of the matrix is accepted. */
static int make_rotation(double r[9])
{
    double squares = 0, divided[9];
    if (fxs_to_rotation(r))
        return 1;
    for (int i = 0; i < 9; i++)
        squares += r[i] * r[i] / 3;
    for (int i = 0; i < 9; i++)
        divided[i] = r[i] / sqrt(squares);
    if (!fxs_to_rotation(divided))
        return 0;
    memcpy(r, divided, sizeof divided);
    return 1;
}

int fxs_view_list_finish(fxs_view_list *list, double width, double height)
{
    fxs_view *view = &list->views[list->count - 1].view;
    if (!size_valid(width) || !size_valid(height))
        return fxs_view_list_fault(list, "width and height are not whole numbers from 1 to 16384");
    view->width = (int)width;
    view->height = (int)height;
    if (!(view->fx > 0 && view->fy > 0 && isfinite(view->fx) && isfinite(view->fy)))
        return fxs_view_list_fault(list, "no focal length above 0");
    if (!isfinite(view->cx) || !isfinite(view->cy))
        return fxs_view_list_fault(list, "principal point not finite");
    if (!isfinite(view->position[0]) || !isfinite(view->position[1]) || !isfinite(view->position[2]))
        return fxs_view_list_fault(list, "position not finite");
    return make_rotation(view->rotation)
               ? 0 : fxs_view_list_fault(list, "rotation not orthonormal within 1e-3 with determinant 1, nor so times "
                                               "a scale: mirrored, sheared or stretched");
}
