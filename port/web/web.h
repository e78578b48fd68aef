/* Declarations of the C modules that fixsplat.js calls. An export passes numbers by the array `numbers`, which its
   comment lists as In and Out. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <fixsplat/fixsplat.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* The capacity of the array `numbers`. An object with 8 crop boxes needs 71. */
enum { NUMBERS = 80 };

/* The fxs_config.run of web_pool.c; null in a module without threads. The calling thread runs job 0, since only that
   thread can call imports. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

/* A scene in the memory of the module. The members from `coarse` on are for streamed scenes, with the header, all
   tables and a pool of chunks in `data`. */
typedef struct fxs_web_scene {
    fxs_scene scene;               /* must be the first member: fxs_options.want gets its address */
    const void *data;              /* packed scene, which begins with the header of the file */
    double low[3], high[3];

    fxs_scene coarse;              /* coarsest chunks of the scene, to choose a first view */
    uint32_t *stamps;              /* for each place in the pool, the last frame or prefetch that wanted its chunk */
    uint32_t *wanted;
    uint32_t wanted_count, turn;
} fxs_web_scene;

/* The fxs_want_fn of a streamed scene stamps a loaded chunk as used, and lists a missing chunk. */
void fxs_web_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

/* Return the array `numbers`, and the message that the export `words` returns. */
double *fxs_web_numbers(void);
struct fxs_message *fxs_web_message(void);

/* Reads the bounds of a scene from the header in `data`. Out: count, SH degree, profile, low, high, 1 with levels of
   detail. */
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

/* Hands over the crop boxes of the objects. The caller frees them. */
void *fxs_web_take_crops(void);

/* Begins a frame with at most `limit` bytes of working memory (0: no limit). fxs_web_frame_end frees the memory;
   after a trap, the next frame does. */
int fxs_web_frame_begin(fxs_web_frame *frame, uint32_t background, int sh_degree, int square, uint32_t budget,
                        uint32_t detail_q8, size_t limit);

/* Ends the frame and returns its error. Out: number of drawn Gaussians, number of missing chunks. */
int fxs_web_frame_end(const fxs_web_frame *frame, int error);

/* Allocates memory aligned to 64 bytes. Returns null with a message if memory ran out. */
void *fxs_web_allocate(size_t bytes);


#endif
