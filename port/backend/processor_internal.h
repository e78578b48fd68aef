/* Rendering context, threads and working memory of back ends that use the processor. */
#ifndef FXS_PROCESSOR_INTERNAL_H
#define FXS_PROCESSOR_INTERNAL_H

#include <fixsplat/backend.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/stage.h>

typedef struct fxs_processor {
    fxs_context context;
    fxs_kernels kernels;
    fxs_pool *pool;                /* thread pool; null: only the calling thread works */
    void *memory, *allocation;
    size_t memory_bytes;
    size_t max_memory;             /* most bytes of working memory; 0: no limit */
} fxs_processor;

/* Starts the threads and chooses the fastest functions for this processor. Functions that draw pixels come from
   `drawing`. After an error, nothing needs to be closed. */
int fxs_processor_open(fxs_processor *p, const fxs_backend_options *options, const fxs_config *drawing,
                       fxs_message *why);

int fxs_processor_render(fxs_processor *p, const fxs_request *request, fxs_stats *stats, fxs_message *why);
int fxs_processor_pick(fxs_processor *p, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                       fxs_message *why);

void fxs_processor_close(fxs_processor *p);

#endif
