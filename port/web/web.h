/* The common declarations of the modules that fixsplat.js calls. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <fixsplat/fixsplat.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* The array for numbers in and out, in the order that each function states; an object with 8 crops has 71. */
enum { NUMBERS = 80 };

/* Functions of web_pool.c; null in a module without it. The calling thread runs job 0: helpers cannot call what
   fixsplat.js provides, as the packing does to read. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

/* A scene in the memory of the module. Of one whose chunks come in parts (web_paged.c), `data` holds the header of the
   file, all tables and a pool of rows. */
typedef struct fxs_web_scene {
    fxs_scene scene;               /* the first, as fxs_options.want gets its address */
    const void *data;              /* begins with the header of the file */
    double low[3], high[3];        /* bounds of its visible part */

    fxs_scene coarse;              /* what a first view is chosen by */
    uint32_t *stamps;              /* of each place in the pool, the last turn that wanted it */
    uint32_t *wanted;              /* chunks that were not there, what is needed most first */
    uint32_t wanted_count, turn;
} fxs_web_scene;

/* An fxs_want_fn of these scenes, without an argument. */
void fxs_web_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

/* The array for numbers, and the message of `words`. */
double *fxs_web_numbers(void);
struct fxs_message *fxs_web_message(void);

/* Fills in the bounds by the header in `data`, and puts count, SH degree, profile, low, high and whether there are
   levels of detail into the numbers. */
void fxs_web_describe(fxs_web_scene *scene);

/* A frame of the objects and the camera that were set before. */
typedef struct fxs_web_frame {
    const fxs_context *context;
    fxs_request request;
    void *memory;
    size_t bytes;
    fxs_stats stats;
} fxs_web_frame;

/* Fills in a request by the objects and the camera that were set before. */
void fxs_web_request(fxs_request *request, uint32_t background, int sh_degree, int square, uint32_t budget,
                     uint32_t detail_q8);

/* The crop boxes of the objects, which the caller frees from now on. */
void *fxs_web_take_crops(void);

/* Begins a frame with working memory, at most `limit` bytes unless that is 0. _end frees the memory, or the next frame
   where this one trapped. Errors: FXS_ERR_MEMORY. */
int fxs_web_frame_begin(fxs_web_frame *frame, uint32_t background, int sh_degree, int square, uint32_t budget,
                        uint32_t detail_q8, size_t limit);

/* Ends the frame and returns its error, with the message in `words`. Out: the Gaussians that were drawn, and the chunks
   that were missing. */
int fxs_web_frame_end(const fxs_web_frame *frame, int error);

/* Allocates memory aligned to 64, as malloc is here; null and a message where memory ran out. */
void *fxs_web_allocate(size_t bytes);

/* The buffer of `words`, FXS_GLES_MESSAGE bytes long. */
char *fxs_web_text(void);

#endif
