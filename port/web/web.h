/* Declarations of the C modules that fixsplat.js calls. A function exported to JavaScript receives and returns numbers
   in the array `numbers`. The comment of the function lists these numbers as In and Out. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <fixsplat/fixsplat.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* The capacity of the array `numbers`. The largest input, an object with 8 crop boxes, needs 72 numbers. */
enum { NUMBERS = 80 };

/* Runs jobs on the threads of web_pool.c; the callback fxs_config.workers.run. Null in a module without threads. The
   calling thread runs job 0, since only that thread can call functions imported from JavaScript. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

/* A packed scene in the memory of the module. The members from `coarse` on are for streamed scenes. `data` of a
   streamed scene has the header, all tables, and a pool of chunks (256 Gaussians each). */
typedef struct fxs_web_scene {
    /* must be the first member: the callback of fxs_options.want gets the address of this scene */
    fxs_scene scene;
    const void *data;              /* packed scene, which begins with the header of the file */
    double low[3], high[3];

    fxs_scene coarse;              /* coarsest chunks of the scene, used to choose a first view */
    /* for each place in the pool of chunks, the last frame or prefetch that wanted the chunk there */
    uint32_t *stamps;
    uint32_t *wanted;
    uint32_t wanted_count, turn;
    struct fxs_mirror *mirror;     /* the scene's pool on the device of the Screen that draws; null: a whole scene */
} fxs_web_scene;

/* The callback fxs_options.want of a streamed scene: a frame wants a chunk (256 Gaussians). Stamps a loaded chunk as
   used, and lists a missing chunk. */
void fxs_web_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

/* Return the array `numbers`, and the error message of the module (export `words`). */
double *fxs_web_numbers(void);
struct fxs_message *fxs_web_message(void);

/* Return the context of the module, and the first camera of the frame that was begun. */
const fxs_context *fxs_web_context(void);
const fxs_camera *fxs_web_eye(void);

/* Reads facts of a scene from the header in `data`. Out: number of Gaussians, SH degree, profile, low and high corner
   of the box, 1 with levels of detail; of a moving scene, duration in seconds, frames a second (0: none), 1 if it
   loops. */
void fxs_web_describe(fxs_web_scene *scene);

typedef struct fxs_web_frame {
    const fxs_context *context;
    fxs_request request;
    void *memory;
    size_t bytes;
    fxs_stats stats;
} fxs_web_frame;

void fxs_web_request(fxs_request *request, uint32_t background, int sh_degree, int square, uint32_t budget,
                     uint32_t detail_q8);

/* Returns the crop boxes of the objects as one block of memory. The caller frees the block. */
void *fxs_web_take_crops(void);

/* Begins a frame with at most `limit` bytes of working memory (0: no limit). fxs_web_frame_end frees the memory. After
   a trap of WebAssembly, the next frame frees the memory. */
int fxs_web_frame_begin(fxs_web_frame *frame, uint32_t background, int sh_degree, int square, uint32_t budget,
                        uint32_t detail_q8, size_t limit);

/* Ends the frame and frees its working memory. Returns the given error code. Out: number of drawn Gaussians, number of
   missing chunks. */
int fxs_web_frame_end(const fxs_web_frame *frame, int error);

/* Allocates memory aligned to 64 bytes. If memory ran out, returns null and sets the error message. */
void *fxs_web_allocate(size_t bytes);


#endif
