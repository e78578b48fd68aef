/* The views of a camera file as its readers find them: a list that grows, and the checks of each view. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    fxs_file_view *view = &listed->view;
    if (name) {
        snprintf(view->name, sizeof view->name, "%s", name);
        listed->image = malloc(strlen(name) + 1);
        if (!listed->image)
            return fxs_fail_memory(list->message, list->path, 0);
        strcpy(listed->image, name);
    } else {
        snprintf(view->name, sizeof view->name, "%zu", list->count);
    }
    for (char *c = view->name; *c; c++)
        if ((unsigned char)*c < ' ')   /* a message is one line */
            *c = '?';
    list->count++;
    return 0;
}

void fxs_view_list_free(fxs_view_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->views[i].image);
    free(list->views);
    free(list->points);
    list->views = NULL;
    list->points = NULL;
    list->count = list->capacity = 0;
}

static int size_valid(double size)
{
    return size >= 1 && size <= MAX_SIZE && size == floor(size);
}

static int rotation_valid(const double r[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double dot = r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
            if (!(fabs(dot - (i == j)) <= 1e-3))
                return 0;
        }
    double determinant = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                         r[2] * (r[3] * r[7] - r[4] * r[6]);
    return determinant > 0;
}

/* The nearest rotation, by Newton's iteration for the polar decomposition: R = R (3 I - R^T R) / 2. It squares the
   error, so that three steps take 1e-3 to the last bit. */
static void orthonormalise(double r[9])
{
    for (int step = 0; step < 3; step++) {
        double old[9], factor[9];
        memcpy(old, r, sizeof old);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                factor[3 * i + j] = 1.5 * (i == j) -
                                    0.5 * (old[i] * old[j] + old[3 + i] * old[3 + j] + old[6 + i] * old[6 + j]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                r[3 * i + j] = old[3 * i] * factor[j] + old[3 * i + 1] * factor[3 + j] + old[3 * i + 2] * factor[6 + j];
    }
}

int fxs_view_list_finish(fxs_view_list *list, double width, double height)
{
    fxs_file_view *view = &list->views[list->count - 1].view;
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
    if (!rotation_valid(view->rotation))
        return fxs_view_list_fault(list, "rotation not orthonormal within 1e-3 with determinant 1");
    orthonormalise(view->rotation);
    return 0;
}
