/* Shared by tiles.c and fetch.c: windows of a picture, the caller's pictures as textures, draws to a surface. */
#include <fixsplat/internal/fixed.h>
#include "device.h"

void fxs_gles_set(const fxs_gles *g)
{
    fxs_gl_set(&g->gl, g->vertex_array, FXS_GLES_UNITS, g->textures);
    if (g->target && g->target->over)
        fxs_gl_blend_over(&g->gl);   /* blending has no effect on integer framebuffers */
}

int fxs_gles_has_occluder(const fxs_gles *g, const fxs_tile_run *run)
{
    return g->target ? g->target->occluder || g->target->depth_buffer : run->targets->occluder.pixels != 0;
}

void fxs_gles_set_mesh(const fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w, const fxs_gles_program *p)
{
    enum { OCCLUDER = 256, BUFFER = 512, BACKDROP = 1024 };
    const fxs_gl_target *t = g->target;
    const fxs_targets *targets = run->targets;
    const fxs_gl *gl = &g->gl;
    if (!t) {
        gl->Uniform4i(p->mesh, -w->x, -w->y, 1,
                      (targets->depth_bits ? targets->depth_bits : 16) + (targets->occluder.pixels ? OCCLUDER : 0) +
                          (targets->backdrop.pixels ? BACKDROP : 0));
        return;
    }
    gl->Uniform4i(p->mesh, 0, t->top_down ? 0 : run->view->height - 1, t->top_down ? 1 : -1,
                  (t->depth_bits ? t->depth_bits : 16) + (t->occluder ? OCCLUDER : 0) +
                      (t->depth_buffer ? BUFFER : 0) + (t->backdrop ? BACKDROP : 0));
    gl->Uniform2f(p->planes, 1 / t->plane_0, 1 / t->plane_1);
}

void fxs_gles_aim(const fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w, const fxs_gles_surface *s,
                  int carried, const int32_t source[4])
{
    const fxs_gl *gl = &g->gl;
    const fxs_gles_program *p = &g->programs[s->program];
    const uint8_t *background = run->options->background;
    const int clear = fxs_is_premultiplied(fxs_gles_format(g, run));
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, s->framebuffer);
    gl->Viewport(s->x, s->y, s->width, s->height);
    gl->Scissor(s->x, s->y + s->first_line, s->width, s->lines);
    gl->UseProgram(p->name);
    /* gl_FragCoord counts from the corner of the framebuffer, not of the drawn part */
    gl->Uniform4i(p->place, s->pixel_x - s->x, s->pixel_y - s->row_step * s->y, s->row_step, carried);
    gl->Uniform4i(p->source, source[0], source[1], source[2], source[3]);
    gl->Uniform4i(p->background, clear ? 0 : fxs_background_q13(background[0]),
                  clear ? 0 : fxs_background_q13(background[1]), clear ? 0 : fxs_background_q13(background[2]), clear);
    fxs_gles_set_mesh(g, run, w, p);
}

fxs_gles_surface fxs_gles_surface_of(const fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w,
                                     int32_t first_line, int32_t lines, int integer, int normalised)
{
    const fxs_gl_target *t = g->target;
    if (!t)
        return (fxs_gles_surface){g->framebuffers[FXS_GLES_TARGET], integer, 0, 0, w->width, w->height, w->x, w->y, 1,
                                  first_line, lines};
    if (t->top_down)
        return (fxs_gles_surface){t->framebuffer, normalised, t->x + w->x, t->y + w->y, w->width, w->height, w->x, w->y,
                                  1, first_line, lines};
    return (fxs_gles_surface){t->framebuffer, normalised, t->x + w->x,
                              t->y + run->view->height - w->y - w->height, w->width, w->height, w->x,
                              w->y + w->height - 1, -1, w->height - first_line - lines, lines};
}

void fxs_gles_make_records(fxs_gles *g, uint64_t texels)
{
    const uint64_t wanted = (texels >> g->shift) + 1, most = UINT64_C(1) << g->shift;
    const int32_t rows = (int32_t)(wanted < most ? wanted : most);
    if (rows <= g->record_rows)
        return;
    g->record_rows = rows;
    g->gl.ActiveTexture(GL_TEXTURE0 + FXS_GLES_RECORDS);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    g->gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32UI, 1 << g->shift, rows, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 0);
}

void fxs_gles_upload(const fxs_gles *g, int unit, int32_t y, int32_t width, int32_t height, GLenum layout,
                     size_t offset)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    if (height)
        g->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, width, height, layout, GL_UNSIGNED_INT, (const void *)offset);
}

static void put_image(fxs_gles *g, int unit, int32_t size[2], const fxs_image *image, const fxs_gles_window *w)
{
    const int is_depth = unit == FXS_GLES_OCCLUDER;
    const GLenum layout = is_depth ? GL_RED_INTEGER : GL_RGBA, type = is_depth ? GL_UNSIGNED_INT : GL_UNSIGNED_BYTE;
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    g->gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (w->width > size[0] || w->height > size[1]) {
        size[0] = w->width > size[0] ? w->width : size[0];
        size[1] = w->height > size[1] ? w->height : size[1];
        g->gl.TexImage2D(GL_TEXTURE_2D, 0, is_depth ? GL_R32UI : GL_RGBA8, size[0], size[1], 0, layout, type, 0);
    }
    for (int32_t y = 0; y < w->height; y++)
        g->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, w->width, 1, layout, type,
                            (const unsigned char *)image->pixels + (w->y + y) * image->stride + 4 * (ptrdiff_t)w->x);
}

static void bind_texture(const fxs_gles *g, int unit, GLuint texture)
{
    g->gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    g->gl.BindTexture(GL_TEXTURE_2D, texture ? texture : g->textures[unit]);
}

static void put_mesh(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w)
{
    if (g->target) {
        bind_texture(g, FXS_GLES_OCCLUDER, g->target->occluder);
        bind_texture(g, FXS_GLES_BUFFER, g->target->depth_buffer);
        bind_texture(g, FXS_GLES_BACKDROP, g->target->backdrop);
        return;
    }
    if (run->targets->occluder.pixels)
        put_image(g, FXS_GLES_OCCLUDER, g->occluder, &run->targets->occluder, w);
    if (run->targets->backdrop.pixels)
        put_image(g, FXS_GLES_BACKDROP, g->backdrop, &run->targets->backdrop, w);
}

static int32_t tiles_across(int32_t pixels)
{
    return (pixels + FXS_TILE - 1) / FXS_TILE;
}

static int draw_window(fxs_gles *g, const fxs_tile_run *run, const fxs_gles_window *w, fxs_gles_draw_window_fn *draw)
{
    put_mesh(g, run, w);
    int error = draw(g, run, w);
    fxs_gles_stop_timer(g);
    error = error ? error : fxs_gl_check(&g->gl);
    return error || g->target ? error : fxs_gles_read(g, run, w->x, w->y, w->width, w->height);
}

int fxs_gles_draw_windows(fxs_gles *g, const fxs_tile_run *run, int32_t most, fxs_gles_draw_window_fn *draw)
{
    const fxs_stage_view *v = run->view;
    const int32_t top = (int32_t)run->first_tile / v->tiles_x * FXS_TILE;
    const int32_t bottom = fxs_min(((int32_t)run->last_tile / v->tiles_x + 1) * FXS_TILE, v->height);
    int error = fxs_gles_has(g, run);
    error = error ? error : fxs_gles_use(g);
    if (!error && !g->target)
        error = fxs_gles_make_target(g, fxs_min(v->width, most), fxs_min(v->height, most));
    if (error)
        return error;
    g->nanoseconds = run->first_tile ? g->nanoseconds : 0;
    fxs_gles_set(g);
    for (int32_t y = top; y < bottom && !error; y += most)
        for (int32_t x = 0; x < v->width && !error; x += most) {
            fxs_gles_window w = {x, y, fxs_min(v->width - x, most), fxs_min(bottom - y, most), x / FXS_TILE,
                                 y / FXS_TILE, 0, 0};
            w.columns = tiles_across(w.width);
            w.rows = tiles_across(w.height);
            error = draw_window(g, run, &w, draw);
        }
    return error;
}
