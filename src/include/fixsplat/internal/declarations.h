/* The declarations of the public headers as text, for foreign function interfaces that parse C: cffi of Python, FFI
 * of LuaJIT.
 *
 * Not stable: may change with every version. */
#ifndef FXS_DECLARATIONS_H
#define FXS_DECLARATIONS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns all structs, functions and constants of the library as preprocessed C. The text is static. */
FXS_API const char *fxs_declarations(void);

/* An fxs_stop_fn that stops a frame once the byte at `byte` is nonzero. Another thread or a signal handler may set
   the byte. */
FXS_API int fxs_stop_by_byte(void *byte);

#ifdef __cplusplus
}
#endif

#endif
