/* An OpenGL ES 3.0 context without a display, for kernels/gles: EGL on a device (EGL_EXT_platform_device), Mesa without
 * a surface (EGL_MESA_platform_surfaceless), or the default display. libEGL and libGLESv2 are loaded at run time.
 *
 * Not stable: may change with every version. */
#ifndef FXS_EGL_H
#define FXS_EGL_H

#include "message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Creates a context with the first of these that works and makes it current on this thread. Returns 0, or -1 and a
   message. */
FXS_API int fxs_egl_open(void **egl, fxs_message *message);

/* Finds a function of OpenGL ES by its name: an fxs_gl_load_fn, whose argument is the context of fxs_egl_open. */
FXS_API void (*fxs_egl_load(void *egl, const char *name))(void);

/* Makes the context current on this thread again. Returns 0, or -1. */
FXS_API int fxs_egl_use(void *egl);

/* Ends the context; null is allowed. The display stays open, as the process may have other contexts on it. */
FXS_API void fxs_egl_close(void *egl);

#ifdef __cplusplus
}
#endif

#endif
