/* What the public headers declare, for languages that call C by its declarations (cffi of Python, FFI of LuaJIT). */
#ifndef FXS_DECLARATIONS_H
#define FXS_DECLARATIONS_H

#ifdef __cplusplus
extern "C" {
#endif

/* All structs, functions and constants of this library as C, preprocessed: one text, static, made from the headers that
   the library is built with (tools/declarations.sh). */
const char *fxs_declarations(void);

#ifdef __cplusplus
}
#endif

#endif
