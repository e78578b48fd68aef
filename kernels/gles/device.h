/* The GLES back end: its objects in the device, and the functions that its files have for each other. */
#ifndef FXS_GLES_DEVICE_H
#define FXS_GLES_DEVICE_H

#include <fixsplat/packed.h>
#include <fixsplat/stage.h>
#include "kernels/gl/gl.h"
#include <fixsplat/gles.h>

#define FXS_GLES_SIDE 2048         /* texels, of what every device has: 2 M records */
#define FXS_GLES_MOST 8192         /* pixels: as words, 1 GiB, which 32 bits can count */
/* Entries of a tile in one draw, so that no draw takes long enough to be stopped. Mesa on a processor ends a loop after
   65,535 rounds. */
#define FXS_GLES_LOOP 32768u

/* Programs. Those that write pixels come twice: for a target of integers (the back end's own) and for a normalised one
   (the caller's). */
enum {
    FXS_GLES_STATE,                /* tiles: T and sums of a part of a list, to go on from */
    FXS_GLES_INTEGER, FXS_GLES_NORMALISED,   /* tiles: pixels */
    FXS_GLES_QUADS,                /* the inexact picture */
    FXS_GLES_BLOCKS,               /* tiles: the masks */
    FXS_GLES_BLEND,                /* fetch: T and sums */
    FXS_GLES_LIMITED,              /* the same with an occluder or the square cut-off */
    FXS_GLES_RESOLVED_INTEGER, FXS_GLES_RESOLVED_NORMALISED,   /* fetch: pixels */
    FXS_GLES_TRACED_STATE, FXS_GLES_TRACED,    /* STATE and NORMALISED with depths and ids: made when first asked for */
    FXS_GLES_PROGRAMS
};
/* Textures by their unit. */
enum {
    FXS_GLES_LISTS, FXS_GLES_RECORDS, FXS_GLES_MASKS,   /* tiles: where lists are, their splats, their masks */
    FXS_GLES_CHUNKS,               /* tiles: what masks are made for */
    FXS_GLES_OCCLUDER, FXS_GLES_BUFFER, FXS_GLES_BACKDROP,   /* the caller's, or made from his; BUFFER: GL's depths */
    FXS_GLES_CARRIED,              /* T and sums so far */
    FXS_GLES_IDS, FXS_GLES_TRACES, /* tiles: ids of records; depths, weights and ids so far */
    FXS_GLES_UNITS,                /* FXS_GL_UNITS */
    FXS_GLES_NEXT = FXS_GLES_UNITS,   /* T and sums that are drawn: it takes turns with CARRIED */
    FXS_GLES_WHOLE,                /* fetch: T and sums of a window */
    FXS_GLES_NEXT_TRACES,          /* it takes turns with TRACES */
    FXS_GLES_TEXTURES
};
/* Framebuffers. */
enum {
    FXS_GLES_TARGET,               /* pixels as integers */
    FXS_GLES_BLENDED, FXS_GLES_BYTES,   /* the quads: blended, then as bytes */
    FXS_GLES_TARGETS,
    FXS_GLES_FIRST_STATE = FXS_GLES_TARGETS, FXS_GLES_SECOND_STATE,   /* CARRIED and NEXT */
    FXS_GLES_WHOLE_STATE,          /* WHOLE */
    FXS_GLES_MASKED,               /* MASKS */
    FXS_GLES_FIRST_TRACED, FXS_GLES_SECOND_TRACED,             /* CARRIED and TRACES; NEXT and NEXT_TRACES */
    FXS_GLES_FRAMEBUFFERS
};

typedef struct fxs_gles_program {
    GLuint name;
    GLint place, source, background, mesh, planes, size;   /* uniforms */
} fxs_gles_program;

/* Buffers of the ring of uploads; the one that is read back; the quads' instances. */
enum { FXS_GLES_UPLOADS = 3, FXS_GLES_DOWNLOAD = FXS_GLES_UPLOADS, FXS_GLES_INSTANCES, FXS_GLES_BUFFERS };

struct fxs_gles {
    fxs_gl gl;
    fxs_gl_use_fn *use;            /* null: the caller's part */
    void *use_argument;
    char renderer[128];
    int32_t shift;                 /* log2 of the width, and the greatest height, of the texture of records */
    int32_t most;                  /* pixels, width and height of a render target */
    int32_t viewport[2];           /* the largest */
    int points;                    /* there are points of the size of a tile */
    char no_fetch[FXS_GLES_MESSAGE];            /* why there is no fetch path; else empty */
    int traced;                    /* depths and ids: 0: not made yet; 1: made; else the error why not */
    int timer, timing;             /* the device can time draws; is timing one */
    GLenum blended_format;         /* of the quads' target */
    fxs_gles_program programs[FXS_GLES_PROGRAMS];
    GLuint textures[FXS_GLES_TEXTURES], framebuffers[FXS_GLES_FRAMEBUFFERS], renderbuffers[FXS_GLES_TARGETS],
        vertex_arrays[2];
    GLuint buffers[FXS_GLES_BUFFERS], query;
    GLsizeiptr buffer_bytes[FXS_GLES_BUFFERS];
    unsigned turn;                 /* of the uploads */
    int32_t columns, rows;         /* of the texture of lists */
    int32_t record_rows, mask_rows, id_rows;    /* of those of records, of masks and of ids */
    int32_t occluder[2], backdrop[2], whole[2]; /* width and height of these */
    int32_t width[FXS_GLES_TARGETS], height[FXS_GLES_TARGETS];
    GLenum format[FXS_GLES_TARGETS];
    const fxs_gles_target *target; /* the caller's, during fxs_gles_render */
    uint64_t nanoseconds;
};

/* Sets what every draw wants, with the textures of the tiles' shader at their units. */
void fxs_gles_set(const fxs_gles *gles);

/* Of the pixels that a run is drawn to. */
static inline enum fxs_format fxs_gles_format(const fxs_gles *gles, const fxs_tile_run *run)
{
    return gles->target ? gles->target->format : run->targets->format;
}

/* Whether the run asks for what this back end has. Returns 0, FXS_ERR_TARGET or FXS_ERR_UNSUPPORTED. */
int fxs_gles_has(const fxs_gles *gles, const fxs_tile_run *run);

/* Makes the context current. Returns 0 or FXS_ERR_DEVICE. */
int fxs_gles_use(const fxs_gles *gles);

/* Makes a target of the back end's own at least so large. Errors: FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
int fxs_gles_make_target(fxs_gles *gles, int target, GLenum format, int32_t width, int32_t height);

/* Binds a buffer, at least so large, and maps it for writing; what was in it is lost. Null where the device fails. */
void *fxs_gles_map(fxs_gles *gles, GLenum target, int buffer, GLsizeiptr bytes);

/* Where there is a timer: starts it if it does not run yet; stops it, waits for the device and adds the time up. */
void fxs_gles_start_timer(fxs_gles *gles);
void fxs_gles_stop_timer(fxs_gles *gles);

/* Reads the lower left corner of FXS_GLES_TARGET or FXS_GLES_BYTES, `width` x `height` pixels, as the run's pixels at
   (x, y); those of its tiles only. Errors: FXS_ERR_DEVICE, FXS_ERR_MEMORY. */
int fxs_gles_read(fxs_gles *gles, const fxs_tile_run *run, int target, int32_t x, int32_t y, int32_t width,
                  int32_t height);

/* Whether depths and ids are drawn too. */
static inline int fxs_gles_is_traced(const fxs_gles *gles)
{
    return gles->target && gles->target->depths_and_ids;
}

/* Makes the texture of masks larger, so that it holds as many chunks, if the device can. Returns 0, FXS_ERR_DEVICE or
   FXS_ERR_MEMORY. */
int fxs_gles_make_masks(fxs_gles *gles, uint64_t chunks);

/* ---- picture.c --------------------------------------------------------------------------------------------------- */

/* A part of the picture that a render target can hold, in pixels and tiles. */
typedef struct fxs_gles_window {
    int32_t x, y, width, height, first_column, first_row, columns, rows;
} fxs_gles_window;

/* A framebuffer to which a part of the picture is drawn, and how its fragments are the picture's pixels. */
typedef struct fxs_gles_surface {
    GLuint framebuffer;
    int program;
    int32_t x, y, width, height;   /* the viewport */
    int32_t pixel_x, pixel_y;      /* the pixel of the viewport's lowest left fragment */
    int32_t row_step;              /* from a row of fragments to the next one above, in rows of pixels: 1 or -1 */
    int32_t first_line, lines;     /* the lines of the viewport that the draw covers */
} fxs_gles_surface;

/* The surface for some lines of a window: on the back end's target, drawn by the program `integer`, or on the caller's,
   by `normalised`. */
fxs_gles_surface fxs_gles_surface_of(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                                     int32_t first_line, int32_t lines, int integer, int normalised);

/* Makes the texture of records larger, so that it holds as many texels, if the device can. */
void fxs_gles_make_records(fxs_gles *gles, uint64_t texels);

/* Uploads rows of words to a texture, from `offset` in the bound buffer. */
void fxs_gles_upload(const fxs_gles *gles, int unit, int32_t y, int32_t width, int32_t height, GLenum layout,
                     size_t offset);

/* Whether there is an occluder, of depths or as a depth buffer. */
int fxs_gles_has_occluder(const fxs_gles *gles, const fxs_tile_run *run);

/* Tells a program where the occluder and the backdrop are in their textures. */
void fxs_gles_set_mesh(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                       const fxs_gles_program *program);

/* Sets the framebuffer, the viewport and the program for draws to a surface. `source`: the program's uniform of that
   name. `carried`: whether it goes on from CARRIED. */
void fxs_gles_aim(const fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window,
                  const fxs_gles_surface *surface, int carried, const int32_t source[4]);

/* Draws a run by `draw`, in windows at most `most` pixels wide and high, and reads back pixels that are not drawn to
   the caller's framebuffer. Returns 0 or an error, as `draw` does. */
typedef int fxs_gles_draw_window_fn(fxs_gles *gles, const fxs_tile_run *run, const fxs_gles_window *window);
int fxs_gles_draw_windows(fxs_gles *gles, const fxs_tile_run *run, int32_t most, fxs_gles_draw_window_fn *draw);

#endif
