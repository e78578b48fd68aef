/* Editing by hand in the window: a lasso or a brush, drawn with the left button, selects Gaussians, and so do clicks on
   objects, boxes around them, and the crop box. The editor works on a copy of the scene. It belongs to the renderer's
   thread while requests are queued. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/placements.h>
#include "src/base/os_calls.h"
#include "viewer.h"

enum { BRUSH = 24, STROKE_MOST = 16384 };    /* radius of the brush in points of the screen; most points of a stroke */
enum { HINTS_MOST = 64, STILL = 4 };           /* most clicks and boxes of an object; a click moves less, in points */

/* ---- The renderer's thread --------------------------------------------------------------------------------------- */

void edit_end(editing *e)
{
    fxs_editor_close(&e->editor);
    fxs_edits_free(&e->list);
    fxs_aligned_free(e->copy);
    e->copy = 0;
    e->tool = EDIT_OFF;
    e->stroke_count = 0;
}

/* Copies the scene, without levels of detail, in place of the opened one. */
static int copy_scene(viewer *v, fxs_message *message)
{
    loaded_scene *scene = &v->world.scenes[0];
    editing *e = &v->edit;
    fxs_opened *opened;
    int error = fxs_editor_open(&e->editor, scene->opened->scene, message);
    if (error)
        return error;
    const size_t bytes = fxs_editor_bytes(&e->editor);
    void *copy = fxs_aligned_allocate(bytes);
    if (copy)
        fxs_editor_write(&e->editor, scene->opened->data, copy);
    fxs_editor_close(&e->editor);
    error = copy ? fxs_open_memory(scene->path, copy, bytes, 0, &opened, message)
                 : fxs_fail_memory(message, scene->path, bytes);
    if (error) {
        fxs_aligned_free(copy);
        return error;
    }
    forget_scenes(v);
    fxs_close(scene->opened);
    scene->opened = opened;
    e->copy = copy;
    return fxs_editor_open(&e->editor, opened->scene, message);
}

static int begin(viewer *v, const crop_box *crop, fxs_message *message)
{
    editing *e = &v->edit;
    if (e->copy)
        return 0;
    const int error = copy_scene(v, message);
    crop_world(&v->world, crop);
    if (error)
        return error;
    e->list.gaussians = e->editor.left;
    e->list.checksum = fxs_edit_checksum(&e->editor.scene);
    return 0;
}

static uint32_t first_chosen(const fxs_edits *list)
{
    return list->count ? list->edits[list->count - 1].end : 0;
}

static void clear(editing *e)
{
    fxs_editor_clear(&e->editor);
    fxs_edits_drop_shapes(&e->list, first_chosen(&e->list), e->list.shape_count);
}

/* Puts a click or a box behind those of the object that was selected last, if they are of the same camera. Then returns
   1. Otherwise the object begins another shape; where something else was meant, the shape takes the object out. */
static int join_object(const editing *e, fxs_edit_shape *s, int32_t *points)
{
    const fxs_edit_shape *last = e->list.shape_count > first_chosen(&e->list)
                                     ? &e->list.shapes[e->list.shape_count - 1] : 0;
    const int32_t *hint = s->points;
    s->points = points;
    if (last && last->kind == FXS_EDIT_OBJECT && !last->subtract && last->point_numbers < HINTS_MOST * FXS_EDIT_HINT &&
        !memcmp(&last->camera, &s->camera, sizeof s->camera)) {
        memcpy(points, last->points, last->point_numbers * sizeof *points);
        memcpy(points + last->point_numbers, hint, FXS_EDIT_HINT * sizeof *points);
        s->point_numbers += last->point_numbers;
        return 1;
    }
    memcpy(points, hint, FXS_EDIT_HINT * sizeof *points);
    s->subtract = !points[FXS_EDIT_HINT - 1];
    points[FXS_EDIT_HINT - 1] = 1;
    return 0;
}

static int select_shape(viewer *v, request *r)
{
    editing *e = &v->edit;
    int32_t points[(HINTS_MOST + 1) * FXS_EDIT_HINT];
    fxs_edit_shape shape = r->shape;
    fxs_kernels fastest;
    fxs_context context;
    fxs_kernels_choose(&fastest, ~0u);
    fxs_context_init(&context, &(fxs_config){.size = sizeof(fxs_config), .kernels = &fastest});
    if (!r->adds)
        clear(e);
    int error = renderer_camera(&v->renderer, &r->view, &shape.camera);
    const int joins = !error && shape.kind == FXS_EDIT_OBJECT && join_object(e, &shape, points);
    if (!error)
        error = (joins ? fxs_editor_replace : fxs_editor_select)(&e->editor, &context, &shape, &r->message);
    if (!error && joins)
        fxs_edits_drop_shapes(&e->list, e->list.shape_count - 1, e->list.shape_count);
    if (!error && (error = fxs_edits_add_shape(&e->list, &shape, &r->message)) != 0)
        clear(e);
    return error;
}

static int act(viewer *v, int keep, fxs_message *message)
{
    editing *e = &v->edit;
    const uint32_t done = e->editor.done;
    const int deleted = fxs_editor_act(&e->editor, keep, message);
    const int error = deleted < 0 ? deleted : fxs_edits_add(&e->list, done, keep, message);
    if (error && deleted >= 0) {
        fxs_editor_go(&e->editor, done);
        e->editor.last = done;
    }
    return error;
}

static int write_edits(viewer *v, request *r)
{
    const editing *e = &v->edit;
    const size_t bytes = fxs_editor_bytes(&e->editor);
    void *scene = fxs_aligned_allocate(bytes);
    int error = scene ? 0 : fxs_fail_memory(&r->message, 0, bytes);
    if (!error && !(error = name_beside(v, r, "edits", ".json")))
        error = fxs_edits_write(&e->list, e->editor.done, r->path, &r->message);
    if (!error && !(error = name_beside(v, r, "edited", ".fxs"))) {
        fxs_editor_write(&e->editor, e->copy, scene);
        error = fxs_file_write(r->path, scene, bytes, &r->message);
    }
    fxs_aligned_free(scene);
    return error;
}

static int do_edit(viewer *v, request *r)
{
    editing *e = &v->edit;
    const uint32_t done = e->editor.done;
    switch (r->edit) {
    case EDIT_SELECT: return select_shape(v, r);
    case EDIT_CLEAR: return clear(e), 0;
    case EDIT_DELETE: return act(v, 0, &r->message);
    case EDIT_KEEP: return act(v, 1, &r->message);
    case EDIT_UNDO: return clear(e), fxs_editor_go(&e->editor, done - (done > 0)), 0;
    case EDIT_REDO: return clear(e), fxs_editor_go(&e->editor, done + 1), 0;
    case EDIT_WRITE: return write_edits(v, r);
    }
    return 0;
}

static void work(viewer *v, request *r)
{
    if (r->edit <= EDIT_KEEP)
        r->unwritten = begin(v, &r->crop, &r->message);
    else if (!v->edit.copy)
        r->unwritten = fxs_fail(&r->message, "no edits yet");
    if (!r->unwritten)
        r->unwritten = do_edit(v, r);
    free((void *)(uintptr_t)r->shape.points);
    forget_scenes(v);
}

int is_edited(const viewer *v)
{
    return v->edit.copy && v->edit.editor.done;
}

void edit_mark(const viewer *v, const request *r, const picture *p)
{
    static const uint8_t orange[4] = {255, 125, 61, 255};
    fxs_camera camera;
    uint32_t colour;
    memcpy(&colour, orange, sizeof colour);
    if (v->edit.copy && v->edit.editor.chosen && !renderer_camera(&v->renderer, &r->view, &camera))
        fxs_editor_mark(&v->edit.editor, &camera, (uint32_t *)(void *)p->pixels, colour);
}

/* ---- The window's thread ----------------------------------------------------------------------------------------- */

static void tell_edit(viewer *v, request *r)
{
    const fxs_editor *e = &v->edit.editor;
    if (r->unwritten)
        tell(v, r->message.text);
    else if (r->edit == EDIT_WRITE)
        tell_written(v, r);
    else
        snprintf(v->note, sizeof v->note, "%u selected of %u%s", (unsigned)e->chosen, (unsigned)e->left,
                 e->done < e->last ? ", some edits undone" : "");
    v->world.gaussians = v->edit.copy ? e->left : v->world.gaussians;
    v->changed = v->exposed = 1;
}

static request *ask_edit(viewer *v, enum edit_act edit)
{
    request *r = ask(v, work, tell_edit, 1);
    if (r)
        r->edit = edit;
    return r;
}

static int can_edit(const viewer *v)
{
    const fxs_placement *p = v->world.placed.objects;
    return v->world.count == 1 && fxs_placement_is_plain(p) && p->visible && !p->crop_count && eyes_of(v) == 1 &&
           !world_is_paged(&v->world);
}

void edit_tool(viewer *v)
{
    static const char *const notes[] = {[EDIT_LASSO] = "lasso: drag around Gaussians; h lists the keys",
                                        [EDIT_BRUSH] = "brush: drag over Gaussians; h lists the keys",
                                        [EDIT_OBJECT] = "object: click it, or drag a box around it; alt: not this"};
    editing *e = &v->edit;
    if (play_moves(v)) {
        tell(v, "no edits of a scene that moves: convert --time writes a moment");
        return;
    }
    if (!can_edit(v)) {
        tell(v, "no edits: only of one scene, whole and where it is");
        return;
    }
    e->stroke_count = 0;
    e->tool = e->tool == EDIT_OBJECT ? EDIT_OFF : e->tool + 1;
    if (!e->stroke)
        e->stroke = malloc(STROKE_MOST * sizeof *e->stroke);
    if (!e->stroke)
        e->tool = EDIT_OFF;
    if (e->tool == EDIT_OFF)
        ask_edit(v, EDIT_CLEAR);
    else
        tell(v, notes[e->tool]);
}

int edit_leave(viewer *v)
{
    if (v->edit.tool == EDIT_OFF)
        return 0;
    v->edit.tool = EDIT_OFF;
    v->edit.stroke_count = 0;
    ask_edit(v, EDIT_CLEAR);
    return 1;
}

/* Selects what the crop box holds, if there is no tool. */
static void select_crop(viewer *v)
{
    request *r = ask_edit(v, EDIT_SELECT);
    if (!r)
        return;
    r->shape.kind = FXS_EDIT_BOX;
    memcpy(r->shape.numbers, v->crop.low, sizeof v->crop.low);
    memcpy(r->shape.numbers + 3, v->crop.high, sizeof v->crop.high);
}

void edit_delete(viewer *v)
{
    if (v->edit.tool == EDIT_OFF && !v->crop.on)
        return;
    if (!can_edit(v)) {
        tell(v, "no edits: only of one scene, whole and where it is");
        return;
    }
    if (v->edit.tool == EDIT_OFF)
        select_crop(v);
    ask_edit(v, fxs_window_holds(FXS_KEY_SHIFT) ? EDIT_KEEP : EDIT_DELETE);
}

void edit_undo(viewer *v)
{
    ask_edit(v, fxs_window_holds(FXS_KEY_SHIFT) ? EDIT_REDO : EDIT_UNDO);
}

int edit_write(viewer *v)
{
    if (v->edit.tool == EDIT_OFF)
        return 0;
    ask_edit(v, EDIT_WRITE);
    return 1;
}

void edit_front(viewer *v)
{
    v->edit.front = !v->edit.front;
    tell(v, v->edit.front ? "front only" : "through the scene");
}

void edit_press(viewer *v, double x, double y)
{
    editing *e = &v->edit;
    e->stroke_count = 1;
    e->stroke[0][0] = x;
    e->stroke[0][1] = y;
    v->exposed = 1;
}

int edit_drag(viewer *v, const fxs_window_event *event)
{
    editing *e = &v->edit;
    if (e->tool == EDIT_OFF || !e->stroke_count || !event->left)
        return 0;
    const double *last = e->stroke[e->stroke_count - 1];
    if (e->stroke_count < STROKE_MOST && hypot(event->x - last[0], event->y - last[1]) >= 3) {
        e->stroke[e->stroke_count][0] = event->x;
        e->stroke[e->stroke_count++][1] = event->y;
    }
    v->exposed = 1;
    return 1;
}

double edit_brush(const viewer *v)
{
    return BRUSH * fxs_window_scale(v->window);
}

/* Lists the numbers of a click or a box, from the first to the last point of the stroke. */
static uint32_t list_hint(const viewer *v, int32_t *out)
{
    const editing *e = &v->edit;
    if (!e->stroke_count)
        return 0;
    const double *a = e->stroke[0], *b = e->stroke[e->stroke_count - 1];
    const double *end = hypot(b[0] - a[0], b[1] - a[1]) < STILL * fxs_window_scale(v->window) ? a : b;
    for (int k = 0; k < 2 && out; k++) {
        const int32_t last = (k ? v->view.height : v->view.width) - 1;
        const double low = floor(fmin(a[k], end[k])), high = floor(fmax(a[k], end[k]));
        out[k] = (int32_t)fmin(fmax(low, 0), last);
        out[2 + k] = (int32_t)fmin(fmax(high, 0), last);
    }
    if (out)
        out[4] = !fxs_window_holds(FXS_KEY_ALT);
    return FXS_EDIT_HINT;
}

/* Lists the numbers of a shape: the corners of a lasso, or a brush's discs along the stroke, half a radius apart.
   Returns their number. Without `out`, only counts. */
static uint32_t list_points(const viewer *v, int32_t *out)
{
    const editing *e = &v->edit;
    if (e->tool == EDIT_OBJECT)
        return list_hint(v, out);
    const int radius = (int)edit_brush(v);
    uint32_t n = 0;
    for (int i = 0; i < e->stroke_count; i++) {
        const double *a = e->stroke[i ? i - 1 : 0], *b = e->stroke[i];
        const int steps = e->tool == EDIT_BRUSH ? (int)(hypot(b[0] - a[0], b[1] - a[1]) / radius * 2) + 1 : 1;
        for (int k = 1; k <= steps; k++) {
            const int numbers[3] = {(int)floor(a[0] + (b[0] - a[0]) * k / steps),
                                    (int)floor(a[1] + (b[1] - a[1]) * k / steps), radius};
            for (int c = 0; c < (e->tool == EDIT_BRUSH ? 3 : 2); c++, n++)
                if (out)
                    out[n] = numbers[c];
        }
    }
    return n < FXS_EDIT_NUMBERS_MOST ? n : 0;
}

void edit_release(viewer *v)
{
    editing *e = &v->edit;
    const uint32_t count = e->tool == EDIT_OFF ? 0 : list_points(v, 0);
    int32_t *points = count ? malloc(count * sizeof *points) : 0;
    request *r = points ? ask_edit(v, EDIT_SELECT) : 0;
    if (r) {
        static const enum fxs_edit_kind kinds[] = {[EDIT_LASSO] = FXS_EDIT_LASSO, [EDIT_BRUSH] = FXS_EDIT_BRUSH,
                                                   [EDIT_OBJECT] = FXS_EDIT_OBJECT};
        const int is_object = e->tool == EDIT_OBJECT, is_less = fxs_window_holds(FXS_KEY_ALT);
        list_points(v, points);
        r->adds = is_object || is_less || fxs_window_holds(FXS_KEY_SHIFT);
        r->shape.kind = kinds[e->tool];
        r->shape.subtract = !is_object && is_less;
        r->shape.front = !is_object && e->front;
        if (is_object)
            tell(v, "looking for the object ...");
        r->shape.points = points;
        r->shape.point_numbers = count;
    } else {
        free(points);
    }
    e->stroke_count = 0;
    v->exposed = 1;
}
