/* The declarations of the public headers as text, for languages that call C through declarations.
 *
 * Not stable: may change with every version. */
#ifndef FXS_DECLARATIONS_H
#define FXS_DECLARATIONS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns all structs, functions and constants of the library as preprocessed C, in static memory. */
FXS_EXPERIMENTAL const char *fxs_declarations(void);

/* Stops a frame once a byte is nonzero: an fxs_stop_fn whose argument is that byte. Any thread or signal handler may
   set the byte. */
FXS_EXPERIMENTAL int fxs_stop_by_byte(void *byte);

#ifdef __cplusplus
}
#endif

#endif
