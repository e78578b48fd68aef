/* A desktop context of OpenGL 3.3 in Mesa's off-screen library, for kernels/gles: drawn by the processor, without a
   display. libOSMesa is loaded at run time; Mesa dropped it in version 25.1. */
#ifndef FXS_OSMESA_H
#define FXS_OSMESA_H

#include "message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a context and makes it current on this thread. Returns 0, or -1 and why not. */
int fxs_osmesa_open(void **osmesa, fxs_message *message);

/* Finds a function: an fxs_gl_load_fn, with what fxs_osmesa_open gave as argument. */
void (*fxs_osmesa_load(void *osmesa, const char *name))(void);

/* Makes the context current on this thread again. Returns 0, or -1. */
int fxs_osmesa_use(void *osmesa);

/* Ends the context; null is allowed. */
void fxs_osmesa_close(void *osmesa);

#ifdef __cplusplus
}
#endif

#endif
