/* Contexts of OpenGL without a window, for the library's back ends, tests and examples. */
#ifndef FXS_INTERNAL_GL_CONTEXTS_H
#define FXS_INTERNAL_GL_CONTEXTS_H

#include <fixsplat/gl.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Contexts of EGL --------------------------------------------------------------------------------------------- */

/* Makes an OpenGL ES 3.0 context without a display: by EGL on a device (EGL_EXT_platform_device), by Mesa without a
   surface (EGL_MESA_platform_surfaceless), or on the default display. libEGL and libGLESv2 are loaded at run time. */

/* Creates an OpenGL ES context in the first of several ways that works (EGL device, no surface, default display), and
   makes it current on this thread. Returns 0, or -1 and a message. */
FXS_EXPERIMENTAL int fxs_egl_open(void **egl, fxs_message *message);

/* Finds a function of OpenGL ES by its name. It is an fxs_gl_load_fn; its argument is the context of fxs_egl_open. */
FXS_EXPERIMENTAL void (*fxs_egl_load(void *egl, const char *name))(void);

/* Makes an OpenGL ES context current on this thread again. Returns 0, or -1. */
FXS_EXPERIMENTAL int fxs_egl_use(void *egl);

/* Ends an OpenGL ES context; null is allowed. The display stays open, as the process may have other contexts on it. */
FXS_EXPERIMENTAL void fxs_egl_close(void *egl);

/* ---- Contexts of OSMesa ------------------------------------------------------------------------------------------ */

/* Makes an OpenGL 3.3 context of Mesa's off-screen library OSMesa: it renders on the processor, without a display.
   libOSMesa is loaded at run time; Mesa dropped it in version 25.1. */

/* Makes an OSMesa context and makes it current on this thread. Returns 0, or -1 and a message. */
FXS_EXPERIMENTAL int fxs_osmesa_open(void **osmesa, fxs_message *message);

/* Finds a function of OpenGL by its name. It is an fxs_gl_load_fn; its argument is the context of fxs_osmesa_open. */
FXS_EXPERIMENTAL void (*fxs_osmesa_load(void *osmesa, const char *name))(void);

/* Makes an OSMesa context current on this thread again. Returns 0, or -1. */
FXS_EXPERIMENTAL int fxs_osmesa_use(void *osmesa);

/* Ends an OSMesa context; null is allowed. */
FXS_EXPERIMENTAL void fxs_osmesa_close(void *osmesa);

#ifdef __cplusplus
}
#endif

#endif
