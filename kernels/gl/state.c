/* Saves the state of a GL context, sets it for a draw, and restores it. */
#include "gl_functions.h"
#include "src/core/memory.h"

/* GL switches that draws disable, except the scissor test, which draws enable. */
static const GLenum switches[] = {GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_DITHER, GL_RASTERIZER_DISCARD,
                                  GL_SAMPLE_ALPHA_TO_COVERAGE, GL_STENCIL_TEST, GL_SCISSOR_TEST};
enum { SWITCHES = sizeof switches / sizeof *switches };

/* GL pixel-store parameters that are set to 0 for uploads. */
static const GLenum unpack[] = {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS};
enum { UNPACK = sizeof unpack / sizeof *unpack };

static const GLenum blend[] = {GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA, GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB,
                               GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA};
enum { BLEND = sizeof blend / sizeof *blend };

void fxs_gl_save(const fxs_gl *gl, fxs_gl_state *s)
{
    memset(s, 0, sizeof *s);       /* zeros, because a lost GL context returns no values */
    gl->GetIntegerv(GL_CURRENT_PROGRAM, &s->program);
    gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &s->vertex_array);
    gl->GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &s->unpack_buffer);
    gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &s->draw_framebuffer);
    gl->GetIntegerv(GL_VIEWPORT, s->viewport);
    gl->GetIntegerv(GL_SCISSOR_BOX, s->scissor);
    gl->GetBooleanv(GL_COLOR_WRITEMASK, s->colour_mask);
    for (int i = 0; i < SWITCHES; i++)
        s->switches[i] = gl->IsEnabled(switches[i]);
    for (int i = 0; i < UNPACK; i++)
        gl->GetIntegerv(unpack[i], &s->unpack[i]);
    for (int i = 0; i < BLEND; i++)
        gl->GetIntegerv(blend[i], &s->blend[i]);
    gl->GetIntegerv(GL_ACTIVE_TEXTURE, &s->active_texture);
    for (int i = 0; i < FXS_GL_UNITS; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + (GLenum)i);
        gl->GetIntegerv(GL_TEXTURE_BINDING_2D, &s->textures[i]);
        gl->GetIntegerv(GL_SAMPLER_BINDING, &s->samplers[i]);
    }
    gl->ActiveTexture((GLenum)s->active_texture);
}

void fxs_gl_restore(const fxs_gl *gl, const fxs_gl_state *s)
{
    gl->UseProgram((GLuint)s->program);
    gl->BindVertexArray((GLuint)s->vertex_array);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, (GLuint)s->unpack_buffer);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->draw_framebuffer);
    gl->Viewport(s->viewport[0], s->viewport[1], s->viewport[2], s->viewport[3]);
    gl->Scissor(s->scissor[0], s->scissor[1], s->scissor[2], s->scissor[3]);
    gl->ColorMask(s->colour_mask[0], s->colour_mask[1], s->colour_mask[2], s->colour_mask[3]);
    for (int i = 0; i < SWITCHES; i++)
        (s->switches[i] ? gl->Enable : gl->Disable)(switches[i]);
    for (int i = 0; i < UNPACK; i++)
        gl->PixelStorei(unpack[i], s->unpack[i]);
    gl->BlendEquationSeparate((GLenum)s->blend[0], (GLenum)s->blend[1]);
    gl->BlendFuncSeparate((GLenum)s->blend[2], (GLenum)s->blend[3], (GLenum)s->blend[4], (GLenum)s->blend[5]);
    for (int i = 0; i < FXS_GL_UNITS; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + (GLenum)i);
        gl->BindTexture(GL_TEXTURE_2D, (GLuint)s->textures[i]);
        gl->BindSampler((GLuint)i, (GLuint)s->samplers[i]);
    }
    gl->ActiveTexture((GLenum)s->active_texture);
}

void fxs_gl_blend_over(const fxs_gl *gl)
{
    gl->Enable(GL_BLEND);
    gl->BlendEquationSeparate(GL_FUNC_ADD, GL_FUNC_ADD);
    gl->BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

void fxs_gl_set(const fxs_gl *gl, GLuint vertex_array, int count, const GLuint *textures)
{
    for (int i = 0; i < SWITCHES - 1; i++)
        gl->Disable(switches[i]);
    gl->Enable(GL_SCISSOR_TEST);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    for (int i = 0; i < UNPACK; i++)
        gl->PixelStorei(unpack[i], 0);
    gl->BindVertexArray(vertex_array);
    for (int i = 0; i < count; i++) {
        gl->ActiveTexture(GL_TEXTURE0 + (GLenum)i);
        gl->BindTexture(GL_TEXTURE_2D, textures[i]);
        gl->BindSampler((GLuint)i, 0);
    }
}
