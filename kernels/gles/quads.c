/* The inexact picture: one instance of a quad per splat, farthest first, blended over the background by the hardware: C
 * = C' (1 - alpha) + colour alpha. */
#include <fixsplat/fixed.h>
#include "src/core/memory.h"
#include "device.h"

#define INSTANCE 32                /* bytes */
#define PARTS 64u                  /* jobs that fill the instances */
#define AHEAD 16                   /* prefetch distance, in instances */

typedef struct filling {
    const fxs_tile_run *run;
    uint32_t *instances;
} filling;

/* Fills a part of the instances; instance 0 is the farthest splat. */
static void fill_part(void *argument, uint32_t part)
{
    const filling *f = argument;
    const fxs_tile_run *run = f->run;
    const uint32_t end = fxs_part(run->visible, PARTS, part + 1);
    for (uint32_t i = fxs_part(run->visible, PARTS, part); i < end; i++) {
        const uint32_t slot = FXS_KEY_SLOT(run->keys[run->visible - 1 - i]);
        const fxs_splat *s = &run->splats[slot];
        const fxs_bounds *b = &run->bounds[slot];
        const int veil = b->half_width_q8 == FXS_EVERYWHERE_Q8;      /* if so, u and v replace the centre */
        const uint32_t words[INSTANCE / 4] = {
            veil ? s->u0_q24 : (uint32_t)b->cx_q14, veil ? s->v0_q24 : (uint32_t)b->cy_q14,
            (uint32_t)s->ux_q24, (uint32_t)s->uy_q24, (uint32_t)s->vy_q24,
            s->offset_q11 | (uint32_t)s->colour_q13[0] << 16,
            (uint32_t)s->colour_q13[1] | (uint32_t)s->colour_q13[2] << 16, (uint32_t)veil};
        if (i + AHEAD < end) {
            const uint32_t next = FXS_KEY_SLOT(run->keys[run->visible - 1 - i - AHEAD]);
            FXS_PREFETCH(&run->splats[next]);
            FXS_PREFETCH(&run->bounds[next]);
        }
        memcpy(f->instances + INSTANCE / 4 * (size_t)i, words, sizeof words);
    }
}

static int upload(fxs_gles *g, const fxs_tile_run *run)
{
    const GLsizeiptr bytes = (GLsizeiptr)run->visible * INSTANCE;
    filling f = {run, 0};
    f.instances = fxs_gles_map(g, GL_ARRAY_BUFFER, FXS_GLES_INSTANCES, bytes);
    if (!f.instances)
        return fxs_gl_failure(&g->gl);
    fxs_run(run->config, fill_part, &f, PARTS);
    return g->gl.UnmapBuffer(GL_ARRAY_BUFFER) ? 0 : FXS_ERR_DEVICE;
}

static void draw(const fxs_gles *g, const fxs_tile_run *run)
{
    const fxs_gl *gl = &g->gl;
    const fxs_view *v = run->view;
    gl->UseProgram(g->programs[FXS_GLES_QUADS].name);
    gl->Uniform4i(g->programs[FXS_GLES_QUADS].size, v->width, v->height, v->cut_q11, 0);
    gl->BindVertexArray(g->vertex_arrays[1]);
    for (GLuint i = 0; i < 2; i++) {
        gl->EnableVertexAttribArray(i);
        gl->VertexAttribDivisor(i, 1);
        gl->VertexAttribIPointer(i, 4, i ? GL_UNSIGNED_INT : GL_INT, INSTANCE,
                                 (const void *)(INSTANCE / 2 * (size_t)i));
    }
    fxs_gl_blend_over(gl);
    gl->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)run->visible);
}

/* Converts the blended picture to bytes, on the back end's target or the caller's, flipped if its rows go up. */
static void blit(const fxs_gles *g, int32_t width, int32_t height)
{
    const fxs_gl *gl = &g->gl;
    const fxs_gles_target *t = g->target;
    const int32_t x = t ? t->x : 0, y = t ? t->y : 0;
    const int up = t && !t->top_down;
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, g->framebuffers[FXS_GLES_BLENDED]);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, t ? t->framebuffer : g->framebuffers[FXS_GLES_BYTES]);
    gl->Scissor(x, y, width, height);
    gl->BlitFramebuffer(0, 0, width, height, x, up ? y + height : y, x + width, up ? y : y + height,
                        GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

int fxs_gles_draw_quads(void *argument, const fxs_tile_run *run)
{
    fxs_gles *g = argument;
    const fxs_gl *gl = &g->gl;
    const fxs_options *o = run->options;
    const int32_t width = run->view->width, height = run->view->height;
    int error = fxs_gles_has(g, run);
    if (error)
        return error;
    const int opaque = !fxs_is_premultiplied(fxs_gles_format(g, run));
    GLfloat background[4] = {0, 0, 0, (GLfloat)opaque};
    for (int c = 0; c < 3; c++)
        background[c] = opaque ? (GLfloat)o->background[c] / 255 : 0;
    const uint32_t tiles = (uint32_t)run->view->tiles_x * (uint32_t)run->view->tiles_y;
    if (width > g->most || height > g->most || run->last_tile - run->first_tile + 1 != tiles)
        return FXS_ERR_UNSUPPORTED;
    error = fxs_gles_use(g);
    if (error)
        return error;
    g->nanoseconds = 0;
    fxs_gles_set(g);
    if (!g->target)
        error = fxs_gles_make_target(g, FXS_GLES_BYTES, GL_RGBA8, width, height);
    if (!error)
        error = fxs_gles_make_target(g, FXS_GLES_BLENDED, opaque || g->blended_format == GL_RGBA16F ?
                                     g->blended_format : GL_RGBA8, width, height);
    if (!error && run->visible)
        error = upload(g, run);
    if (error)
        return error;
    fxs_gles_start_timer(g);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, g->framebuffers[FXS_GLES_BLENDED]);
    gl->Viewport(0, 0, width, height);
    gl->Scissor(0, 0, width, height);
    gl->ClearBufferfv(GL_COLOR, 0, background);
    if (run->visible)
        draw(g, run);
    blit(g, width, height);
    fxs_gles_stop_timer(g);
    return g->target ? fxs_gl_check(&g->gl) : fxs_gles_read(g, run, FXS_GLES_BYTES, 0, 0, width, height);
}
