/* An OpenGL 3.3 context of Mesa's off-screen library, for kernels/gles: rendered on the processor, without a display.
 * libOSMesa is loaded at run time; Mesa dropped it in version 25.1.
 *
 * Not stable: may change with every version. */
#ifndef FXS_OSMESA_H
#define FXS_OSMESA_H

#include "message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a context and makes it current on this thread. Returns 0, or -1 and a message. */
FXS_API int fxs_osmesa_open(void **osmesa, fxs_message *message);

/* Finds a function of OpenGL by its name: an fxs_gl_load_fn, whose argument is the context of fxs_osmesa_open. */
FXS_API void (*fxs_osmesa_load(void *osmesa, const char *name))(void);

/* Makes the context current on this thread again. Returns 0, or -1. */
FXS_API int fxs_osmesa_use(void *osmesa);

/* Ends the context; null is allowed. */
FXS_API void fxs_osmesa_close(void *osmesa);

#ifdef __cplusplus
}
#endif

#endif
