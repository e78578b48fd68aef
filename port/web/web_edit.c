/* Edits of a scene by hand, for the class Editor of fixsplat.js. Lassos, brushes and marks are for the first camera of
   the frame that was begun. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/edits.h>
#include <fixsplat/internal/packed.h>
#include "web.h"

typedef struct web_editor {
    fxs_editor editor;
    const void *data;
} web_editor;

/* Begins to edit a scene, which loses its levels of detail. Out: number of Gaussians, checksum. */
EXPORT(edit_open) web_editor *fxs_web_edit_open(fxs_web_scene *s)
{
    web_editor *e = fxs_web_allocate(sizeof *e);
    if (!e || fxs_editor_open(&e->editor, &s->scene, fxs_web_message())) {
        free(e);
        return NULL;
    }
    e->data = s->data;
    s->scene = e->editor.scene;
    fxs_web_numbers()[0] = e->editor.left;
    fxs_web_numbers()[1] = fxs_edit_checksum(&s->scene);
    return e;
}

EXPORT(edit_close) void fxs_web_edit_close(web_editor *e)
{
    fxs_editor_close(&e->editor);
    free(e);
}

/* Out: numbers of Gaussians that are left and that are selected, edits that are done, and all edits. */
EXPORT(edit_facts) void fxs_web_edit_facts(const web_editor *e)
{
    const uint32_t facts[] = {e->editor.left, e->editor.chosen, e->editor.done, e->editor.last};
    for (int i = 0; i < 4; i++)
        fxs_web_numbers()[i] = facts[i];
}

/* Selects by a shape, with `again` in place of the last shape. In: the 6 numbers of a box, or the 4 of a sphere. */
EXPORT(edit_select) int fxs_web_edit_select(web_editor *e, int kind, int subtract, int front, const int32_t *points,
                                            uint32_t point_numbers, int again)
{
    fxs_edit_shape shape = {.kind = (enum fxs_edit_kind)kind, .subtract = subtract, .front = front,
                            .camera = *fxs_web_eye(), .points = points, .point_numbers = point_numbers};
    memcpy(shape.numbers, fxs_web_numbers(), sizeof shape.numbers);
    return (again ? fxs_editor_replace : fxs_editor_select)(&e->editor, fxs_web_context(), &shape, fxs_web_message());
}

EXPORT(edit_clear) void fxs_web_edit_clear(web_editor *e)
{
    fxs_editor_clear(&e->editor);
}

EXPORT(edit_act) int fxs_web_edit_act(web_editor *e, int keep)
{
    return fxs_editor_act(&e->editor, keep, fxs_web_message());
}

EXPORT(edit_go) void fxs_web_edit_go(web_editor *e, uint32_t done)
{
    fxs_editor_go(&e->editor, done);
}

EXPORT(edit_mark) void fxs_web_edit_mark(const web_editor *e, uint32_t *pixels, uint32_t colour)
{
    fxs_editor_mark(&e->editor, fxs_web_eye(), pixels, colour);
}

/* Out: fx, fy, cx, cy, rotation (world to camera, in rows), position, depth of the near plane. These are the numbers of
   fxs_web_eye, as the renderer rounds them. */
EXPORT(edit_camera) void fxs_web_edit_camera(void)
{
    const fxs_camera *c = fxs_web_eye();
    double *out = fxs_web_numbers();
    const int32_t lens[] = {c->fx_q12, c->fy_q12, c->cx_q12, c->cy_q12};
    for (int i = 0; i < 4; i++)
        *out++ = lens[i] * 0x1p-12;
    for (int i = 0; i < 9; i++)
        *out++ = c->rotation_q30[i] * 0x1p-30;
    for (int i = 0; i < 3; i++)
        *out++ = (double)c->position_q32[i] * 0x1p-32;
    *out = (double)c->near_q32 * 0x1p-32;
}

EXPORT(edit_bytes) size_t fxs_web_edit_bytes(const web_editor *e)
{
    return fxs_editor_bytes(&e->editor);
}

EXPORT(edit_write) void fxs_web_edit_write(const web_editor *e, void *out)
{
    fxs_editor_write(&e->editor, e->data, out);
}
