/* The common declarations of the two modules that fixsplat.js calls. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <fixsplat/fixsplat.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* The array for numbers in and out, in the order that each function states; an object with 8 crops has 71. */
enum { NUMBERS = 80 };

/* Functions of web_pool.c; null in a module without it. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

/* A frame of the objects and the camera that were set before. */
typedef struct fxs_web_frame {
    const fxs_context *context;
    fxs_request request;
    void *memory;
    size_t bytes;
    fxs_stats stats;
} fxs_web_frame;

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
