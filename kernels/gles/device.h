/* The GLES back end: its objects on the device, and the functions shared by its files. */
#ifndef FXS_GLES_DEVICE_H
#define FXS_GLES_DEVICE_H

#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/stage.h>
#include "kernels/gl/gl_functions.h"
#include <fixsplat/gl.h>

#define FXS_GLES_SIDE 2048         /* texels; every device supports this: 2 M records */
#define FXS_GLES_MOST 8192         /* pixels; a target of this size has 1 GiB, which fits in 32 bits */
/* Entries of a tile per draw, so that drivers do not abort long draws. Mesa on a CPU ends a loop after 65,535
   iterations. */
#define FXS_GLES_LOOP 32768u

/* Programs. A program that writes pixels exists twice: for an integer target (the back end's own) and for a normalised
   target (the caller's). */
enum {
    FXS_GLES_STATE,                /* tiles: T and sums after a part of a list, to continue from */
    FXS_GLES_INTEGER, FXS_GLES_NORMALISED,   /* tiles: pixels */
    FXS_GLES_BLOCKS,               /* tiles: masks */
    FXS_GLES_BLEND,                /* fetch: T and sums */
    FXS_GLES_LIMITED,              /* like BLEND, with an occluder or the square cut-off */
    FXS_GLES_RESOLVED_INTEGER, FXS_GLES_RESOLVED_NORMALISED,   /* fetch: pixels */
    FXS_GLES_TRACED_STATE, FXS_GLES_TRACED,    /* STATE and NORMALISED with depths and ids; made on first use */
    FXS_GLES_PROGRAMS
};
/* Textures, by unit. */
enum {
    FXS_GLES_LISTS, FXS_GLES_RECORDS, FXS_GLES_MASKS,   /* tiles: lists, splats of lists, masks of splats */
    FXS_GLES_CHUNKS,               /* tiles: input for the masks */
    FXS_GLES_OCCLUDER, FXS_GLES_BUFFER, FXS_GLES_BACKDROP,   /* the caller's textures, or copies; BUFFER: GL depths */
    FXS_GLES_CARRIED,              /* T and sums up to now */
    FXS_GLES_IDS, FXS_GLES_TRACES, /* tiles: ids of records; depths, weights and ids up to now */
    FXS_GLES_UNITS,                /* equals FXS_GL_UNITS */
    FXS_GLES_NEXT = FXS_GLES_UNITS,   /* T and sums being drawn; swaps roles with CARRIED */
    FXS_GLES_WHOLE,                /* fetch: T and sums of a window */
    FXS_GLES_NEXT_TRACES,          /* swaps roles with TRACES */
    FXS_GLES_TEXTURES
};
enum {
    FXS_GLES_TARGET,               /* pixels as integers */
    FXS_GLES_FIRST_STATE, FXS_GLES_SECOND_STATE,   /* CARRIED and NEXT */
    FXS_GLES_WHOLE_STATE,          /* WHOLE */
    FXS_GLES_MASKED,               /* MASKS */
    FXS_GLES_FIRST_TRACED, FXS_GLES_SECOND_TRACED,             /* CARRIED and TRACES; NEXT and NEXT_TRACES */
    FXS_GLES_FRAMEBUFFERS
};

typedef struct fxs_gles_program {
    GLuint name;
    GLint place, source, background, mesh, planes, size;   /* uniforms */
} fxs_gles_program;

/* Buffers: ring of uploads, read-back. */
enum { FXS_GLES_UPLOADS = 3, FXS_GLES_DOWNLOAD = FXS_GLES_UPLOADS, FXS_GLES_BUFFERS };

struct fxs_gles {
    fxs_gl gl;
    fxs_gl_use_fn *use;            /* null: the caller makes the context current */
    void *use_argument;
    char renderer[128];
    int32_t shift;                 /* log2 of the width, and of the maximum height, of the texture of records */
    int32_t most;                  /* largest side of a render target in pixels */
    int32_t viewport[2];           /* maximum */
    int points;                    /* 1: points can be as large as a tile */
    char no_fetch[FXS_GLES_MESSAGE];            /* why there is no fetch path; otherwise empty */
    int traced;                    /* depths and ids: 0 not made yet, 1 made, negative: the error */
    int timer, timing;             /* timer: the device can time draws; timing: it is now timing */
    fxs_gles_program programs[FXS_GLES_PROGRAMS];
    GLuint textures[FXS_GLES_TEXTURES], framebuffers[FXS_GLES_FRAMEBUFFERS], renderbuffer, vertex_array;
    GLuint buffers[FXS_GLES_BUFFERS], query;
    GLsizeiptr buffer_bytes[FXS_GLES_BUFFERS];
    unsigned turn;                 /* counter for the ring of uploads */
    int32_t columns, rows;         /* size of the texture of lists */
    int32_t record_rows, mask_rows, id_rows;    /* rows of the textures of records, masks, ids */
    int32_t occluder[2], backdrop[2], whole[2]; /* widths and heights of the textures of these names */
    int32_t width, height;         /* size of FXS_GLES_TARGET */
    const fxs_gles_target *target; /* the caller's target, during fxs_gles_render */
    uint64_t nanoseconds;
};

/* Sets the GL state for draws, with all textures bound to their units. */
void fxs_gles_set(const fxs_gles *gles);

/* Format of the pixels that a run is drawn to. */
static inline enum fxs_format fxs_gles_format(const fxs_gles *gles, const fxs_tile_run *run)
{
    return gles->target ? gles->target->format : run->targets->format;
}

/* Returns 0 if this back end supports the run's targets, otherwise FXS_ERR_TARGET or FXS_ERR_UNSUPPORTED. */
int fxs_gles_has(const fxs_gles *gles, const fxs_tile_run *run);

/* Makes the context current. Returns 0 or FXS_ERR_DEVICE. */
int fxs_gles_use(const fxs_gles *gles);

/* Grows FXS_GLES_TARGET to at least this size. Returns 0, FXS_ERR_DEVICE or FXS_ERR_MEMORY. */
int fxs_gles_make_target(fxs_gles *gles, int32_t width, int32_t height);

/* Binds the next buffer for uploads, grows it to at least `bytes`, and maps it for writing. The buffer loses its
   contents. Returns null if the device fails. */
void *fxs_gles_map(fxs_gles *gles, GLsizeiptr bytes);

/* If the device has a timer, fxs_gles_start_timer starts it unless it is running. The second function stops it, waits
   for the device and adds up the time. */
void fxs_gles_start_timer(fxs_gles *gles);
void fxs_gles_stop_timer(fxs_gles *gles);

/* Reads the lower left corner of FXS_GLES_TARGET, `width` x `height` pixels, to the run's pixels at (x, y). Only pixels
   in the run's tiles are written. Returns 0, FXS_ERR_DEVICE or FXS_ERR_MEMORY. */
int fxs_gles_read(fxs_gles *gles, const fxs_tile_run *run, int32_t x, int32_t y, int32_t width, int32_t height);

static inline int fxs_gles_is_traced(const fxs_gles *gles)
{
    return gles->target && gles->target->depths_and_ids;
}

/* Grows the texture of masks to `chunks` chunks, up to the device's limit. Returns 0, FXS_ERR_DEVICE or
   FXS_ERR_MEMORY. */
int fxs_gles_make_masks(fxs_gles *gles, uint64_t chunks);

/* ---- picture.c --------------------------------------------------------------------------------------------------- */

/* A part of the picture that fits in a render target, in pixels and tiles. */
typedef struct fxs_gles_window {
    int32_t x, y, width, height, first_column, first_row, columns, rows;
} fxs_gles_window;

/* A framebuffer that a part of the picture is drawn to, and the mapping from its fragments to the picture's pixels. */
typedef struct fxs_gles_surface {
    GLuint framebuffer;
    int program;
    int32_t x, y, width, height;   /* viewport */
    int32_t pixel_x, pixel_y;      /* pixel of the viewport's lower left fragment */
    int32_t row_step;              /* change of the pixel's row from a row of fragments to the row above: 1 or -1 */
    int32_t first_line, lines;     /* lines of the viewport that the draw covers */
} fxs_gles_surface;

/* The surface for some lines of a window: the back end's target with the program `integer`, or the caller's target with
   the program `normalised`. */
fxs_gles_surface fxs_gles_surface_of(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                                     int32_t first_line, int32_t lines, int integer, int normalised);

/* Grows the texture of records to `texels` texels, up to the device's limit. */
void fxs_gles_make_records(fxs_gles *gles, uint64_t texels);

/* Uploads rows of words to a texture, from `offset` in the bound buffer. */
void fxs_gles_upload(const fxs_gles *gles, int unit, int32_t y, int32_t width, int32_t height, GLenum layout,
                     size_t offset);

/* True if there is an occluder, as depths or as a depth buffer. */
int fxs_gles_has_occluder(const fxs_gles *gles, const fxs_tile_run *run);

/* Sets a program's uniforms for the textures of occluder and backdrop. */
void fxs_gles_set_mesh(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                       const fxs_gles_program *program);

/* Sets framebuffer, viewport, program and uniforms for draws to a surface. `source`: the uniform of that name.
   `carried`: 1 to continue from CARRIED. */
void fxs_gles_aim(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                  const fxs_gles_surface *surface, int carried, const int32_t source[4]);

/* Draws a run with `draw` in windows of at most `most` x `most` pixels. Without a caller's framebuffer, reads the
   pixels back. Returns 0 or an error, like `draw`. */
typedef int fxs_gles_draw_window_fn(fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window);
int fxs_gles_draw_windows(fxs_gles *gles, const fxs_tile_run *run, int32_t most, fxs_gles_draw_window_fn *draw);

#endif
