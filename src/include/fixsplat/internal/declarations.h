/* The declarations of the public headers as text, for languages that call C through declarations (cffi of Python, FFI
 * of LuaJIT).
 *
 * Not stable: may change with every version. */
#ifndef FXS_DECLARATIONS_H
#define FXS_DECLARATIONS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All structs, functions and constants of this library as preprocessed C: one static text, generated from the headers
   of the library's build (tools/scripts/declarations.sh). */
FXS_API const char *fxs_declarations(void);

/* An fxs_stop_fn: stops the frame once the byte at `byte` is nonzero. Another thread or a signal handler may set it. */
FXS_API int fxs_stop_by_byte(void *byte);

#ifdef __cplusplus
}
#endif

#endif
