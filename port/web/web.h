/* What the two modules share with fixsplat.js. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <fixsplat/fixsplat.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* Numbers go in and come out at one place, in the order that each function says; an object with 8 crops has 71. */
enum { NUMBERS = 80 };

/* Of pool.c; null in a module without it. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

/* A frame of the objects and the camera that were set. */
typedef struct fxs_web_frame {
    const fxs_context *context;
    fxs_request request;
    void *memory;
    size_t bytes;
} fxs_web_frame;

/* With working memory, at most `limit` bytes where that is not 0, which _end frees, or the next frame where this one
   trapped. Errors: FXS_ERR_MEMORY. */
int fxs_web_frame_begin(fxs_web_frame *frame, uint32_t background, int sh_degree, int square, size_t limit);

/* Returns the frame's error, which `words` says. */
int fxs_web_frame_end(int error);

/* Aligned to 64, as malloc is here; null, and words, where there is no memory. */
void *fxs_web_allocate(size_t bytes);

/* Where `words` are: room for what FXS_GLES_MESSAGE says. */
char *fxs_web_text(void);

#endif
