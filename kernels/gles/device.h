/* Internal declarations of the OpenGL ES back end. tiles.c draws with per-tile lists of splats (projected Gaussians),
 * fetch.c without lists. The state of a pixel is its transmittance and its sums of colours. */
#ifndef FXS_GLES_DEVICE_H
#define FXS_GLES_DEVICE_H

#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>
#include "kernels/gl/gl_functions.h"
#include <fixsplat/gl.h>

#define FXS_GLES_SIDE 2048
#define FXS_GLES_MOST 8192
/* Largest number of a tile's splats per draw, because drivers abort long draws. */
#define FXS_GLES_LOOP 32768u

/* GL programs. Programs that write finished pixels exist twice: for the back end's own integer framebuffer and for the
   caller's normalised framebuffer. */
enum {
    FXS_GLES_STATE,
    FXS_GLES_INTEGER, FXS_GLES_NORMALISED,
    FXS_GLES_BLOCKS,
    FXS_GLES_BLEND,
    FXS_GLES_LIMITED,
    FXS_GLES_RESOLVED_INTEGER, FXS_GLES_RESOLVED_NORMALISED,
    FXS_GLES_TRACED_STATE, FXS_GLES_TRACED,
    FXS_GLES_PROGRAMS
};
/* Textures. The number of a texture is its texture unit. */
enum {
    /* textures of tiles.c. LISTS: each tile's list; RECORDS: splats of the lists; MASKS: which pixels the splats
       touch */
    FXS_GLES_LISTS, FXS_GLES_RECORDS, FXS_GLES_MASKS,
    FXS_GLES_CHUNKS,
    /* textures of the caller: depths that hide splats, GL depth buffer, colours behind the splats */
    FXS_GLES_OCCLUDER, FXS_GLES_BUFFER, FXS_GLES_BACKDROP,
    FXS_GLES_CARRIED,
    FXS_GLES_IDS, FXS_GLES_TRACES, /* IDS: ids of splats; TRACES: depths, weights and ids of the pixels so far */
    FXS_GLES_UNITS,
    FXS_GLES_NEXT = FXS_GLES_UNITS,
    FXS_GLES_WHOLE,
    FXS_GLES_NEXT_TRACES,
    FXS_GLES_TEXTURES
};
enum {
    FXS_GLES_TARGET,
    FXS_GLES_FIRST_STATE, FXS_GLES_SECOND_STATE,
    FXS_GLES_WHOLE_STATE,
    FXS_GLES_MASKED,
    FXS_GLES_FIRST_TRACED, FXS_GLES_SECOND_TRACED,
    FXS_GLES_FRAMEBUFFERS
};

#define FXS_GLES_MESSAGE 512       /* size of fxs_message.text in bytes */

typedef struct fxs_gles_program {
    GLuint name;
    GLint place, source, background, mesh, planes, size;
} fxs_gles_program;

enum { FXS_GLES_UPLOADS = 3, FXS_GLES_DOWNLOAD = FXS_GLES_UPLOADS, FXS_GLES_BUFFERS };

struct fxs_gles {
    fxs_gl gl;
    fxs_gl_use_fn *use;            /* callback that makes the GL context current; null: the caller does */
    void *use_argument;
    char renderer[128];
    int32_t shift;
    int32_t most;
    int32_t viewport[2];
    int points;                    /* 1: GL points may be as large as a tile */
    char no_fetch[FXS_GLES_MESSAGE];            /* reason why fetch.c is unsupported; empty: supported */
    int traced;                 /* whether the GL objects for depths and ids are made: 0: no, 1: yes, negative: error */
    int timer, timing;
    fxs_gles_program programs[FXS_GLES_PROGRAMS];
    GLuint textures[FXS_GLES_TEXTURES], framebuffers[FXS_GLES_FRAMEBUFFERS], renderbuffer, vertex_array;
    GLuint buffers[FXS_GLES_BUFFERS], query;
    GLsizeiptr buffer_bytes[FXS_GLES_BUFFERS];
    unsigned turn;
    int32_t columns, rows;
    int32_t record_rows, mask_rows, id_rows;
    int32_t occluder[2], backdrop[2], whole[2];
    int32_t width, height;
    const fxs_gl_target *target;
    uint64_t nanoseconds;
};

void fxs_gles_set(const fxs_gles *gles);

static inline enum fxs_format fxs_gles_format(const fxs_gles *gles, const fxs_tile_run *run)
{
    return gles->target ? gles->target->format : run->targets->format;
}

/* Returns 0 if the back end supports the images of a run (range of tiles to draw), otherwise FXS_ERR_TARGET or
   FXS_ERR_UNSUPPORTED. */
int fxs_gles_has(const fxs_gles *gles, const fxs_tile_run *run);

int fxs_gles_use(const fxs_gles *gles);

int fxs_gles_make_target(fxs_gles *gles, int32_t width, int32_t height);

/* Maps the next upload buffer for writing, with at least `bytes` bytes. Returns null if the device fails. */
void *fxs_gles_map(fxs_gles *gles, GLsizeiptr bytes);

/* Start and stop the GPU timer, if the device has one. Stopping waits for the GPU. */
void fxs_gles_start_timer(fxs_gles *gles);
void fxs_gles_stop_timer(fxs_gles *gles);

int fxs_gles_read(fxs_gles *gles, const fxs_tile_run *run, int32_t x, int32_t y, int32_t width, int32_t height);

static inline int fxs_gles_is_traced(const fxs_gles *gles)
{
    return gles->target && gles->target->depths_and_ids;
}

/* Grows texture MASKS for `chunks` groups of 32 splats, up to the device's limit. The texture says which pixels each
   splat touches. Returns 0 or an error. */
int fxs_gles_make_masks(fxs_gles *gles, uint64_t chunks);

typedef struct fxs_gles_window {
    int32_t x, y, width, height, first_column, first_row, columns, rows;
} fxs_gles_window;

typedef struct fxs_gles_surface {
    GLuint framebuffer;
    int program;
    int32_t x, y, width, height;
    int32_t pixel_x, pixel_y;
    int32_t row_step;
    int32_t first_line, lines;
} fxs_gles_surface;

/* Returns the surface (framebuffer, program and pixels of a draw) for `lines` lines of a window, a part of the picture.
   `integer` is the program for the back end's own framebuffer, `normalised` for the caller's. */
fxs_gles_surface fxs_gles_surface_of(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                                     int32_t first_line, int32_t lines, int integer, int normalised);

void fxs_gles_make_records(fxs_gles *gles, uint64_t texels);

void fxs_gles_upload(const fxs_gles *gles, int unit, int32_t y, int32_t width, int32_t height, GLenum layout,
                     size_t offset);

int fxs_gles_has_occluder(const fxs_gles *gles, const fxs_tile_run *run);

void fxs_gles_set_mesh(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                       const fxs_gles_program *program);

/* Prepares draws to a surface, a part of a framebuffer. `source` is the value of the shaders' uniform of that name. If
   `carried` is 1, the shaders continue from the pixels in texture CARRIED. */
void fxs_gles_aim(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                  const fxs_gles_surface *surface, int carried, const int32_t source[4]);

/* Calls `draw` for windows (parts of the picture) of at most `most` x `most` pixels. Reads the pixels back unless the
   caller has a framebuffer. */
typedef int fxs_gles_draw_window_fn(fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window);
int fxs_gles_draw_windows(fxs_gles *gles, const fxs_tile_run *run, int32_t most, fxs_gles_draw_window_fn *draw);

#endif
