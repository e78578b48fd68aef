/* The common part of the back ends that use the processor: context, threads, working memory. */
#ifndef FXS_PROCESSOR_INTERNAL_H
#define FXS_PROCESSOR_INTERNAL_H

#include <fixsplat/backend.h>
#include <fixsplat/message.h>
#include <fixsplat/pool.h>

typedef struct fxs_processor {
    fxs_context context;
    fxs_pool *pool;                /* null: one thread */
    void *memory, *allocation;     /* memory: aligned, memory_bytes long; it grows with the frames */
    size_t memory_bytes;
    size_t max_memory;             /* 0: no limit */
} fxs_processor;

/* Starts the threads and chooses the kernels for this processor, except those that the options exclude. draw,
   draw_argument and draw_unlisted are taken from `drawing`. Returns 0, or an error with nothing to close. */
int fxs_processor_open(fxs_processor *p, const fxs_backend_options *options, const fxs_config *drawing,
                       fxs_message *why);

/* The same as render and pick of fxs_backend. */
int fxs_processor_render(fxs_processor *p, const fxs_request *request, fxs_stats *stats, fxs_message *why);
int fxs_processor_pick(fxs_processor *p, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                       fxs_message *why);

void fxs_processor_close(fxs_processor *p);

#endif
