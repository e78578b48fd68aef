/* The common declarations of the modules that fixsplat.js calls. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <fixsplat/fixsplat.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* The capacity of the array for numbers in and out. Each function states their order. An object with 8 crops has 71. */
enum { NUMBERS = 80 };

/* The fxs_config.run of web_pool.c; null in a module without threads. The calling thread runs job 0: job 0 of packing
   reads files by imports of fixsplat.js, and helpers cannot call these. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

/* A scene in the memory of the module. The members from `coarse` on are for streamed scenes (web_paged.c); their `data`
   holds the header of the file, all tables and a pool of rows. */
typedef struct fxs_web_scene {
    fxs_scene scene;               /* must be first: fxs_options.want gets its address */
    const void *data;              /* begins with the header of the file */
    double low[3], high[3];        /* bounds of the visible part */

    fxs_scene coarse;              /* coarsest chunks, to choose a first view */
    uint32_t *stamps;              /* for each place in the pool, the last turn that wanted its chunk */
    uint32_t *wanted;              /* missing chunks, the most important first */
    uint32_t wanted_count, turn;
} fxs_web_scene;

/* The fxs_want_fn of fxs_web_scene; `argument` is ignored. Stamps a loaded chunk, lists a missing one. */
void fxs_web_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

/* The array for numbers, and the message that the export `words` returns. */
double *fxs_web_numbers(void);
struct fxs_message *fxs_web_message(void);

/* Reads the bounds from the header in `data`. Out: count, SH degree, profile, low, high, 1 with levels of detail. */
void fxs_web_describe(fxs_web_scene *scene);

/* A frame of the present objects and cameras. */
typedef struct fxs_web_frame {
    const fxs_context *context;
    fxs_request request;
    void *memory;
    size_t bytes;
    fxs_stats stats;
} fxs_web_frame;

/* Fills in a request with the present objects and cameras. */
void fxs_web_request(fxs_request *request, uint32_t background, int sh_degree, int square, uint32_t budget,
                     uint32_t detail_q8);

/* Hands over the crop boxes of the objects; the caller frees them. */
void *fxs_web_take_crops(void);

/* Begins a frame and allocates its working memory, at most `limit` bytes (0: no limit). fxs_web_frame_end frees the
   memory; after a trap, the next frame does. Errors: FXS_ERR_MEMORY. */
int fxs_web_frame_begin(fxs_web_frame *frame, uint32_t background, int sh_degree, int square, uint32_t budget,
                        uint32_t detail_q8, size_t limit);

/* Ends the frame and returns its error, with the message in `words`. Out: drawn Gaussians, missing chunks. */
int fxs_web_frame_end(const fxs_web_frame *frame, int error);

/* Allocates memory aligned to 64 bytes. Null and a message if memory ran out. */
void *fxs_web_allocate(size_t bytes);

/* The buffer of `words`, FXS_GLES_MESSAGE bytes long. */
char *fxs_web_text(void);

#endif
