/* Reads the options that a program hands in: structs that begin with their size (fixsplat.h). */
#ifndef FXS_BASE_OPTIONS_H
#define FXS_BASE_OPTIONS_H

#include <fixsplat/fixsplat.h>

/* Copies the program's struct `given` over the defaults in `all`, which is `bytes` long; a null `given` keeps the
   defaults. Returns 0, or FXS_ERR_STRUCT and a message with the struct's name. */
int fxs_options_read(void *all, size_t bytes, const void *given, const char *name, fxs_message *message);

/* fxs_options_read for a struct of a named type. */
#define FXS_OPTIONS_READ(type, all, given, message) fxs_options_read(all, sizeof(type), given, #type, message)

#endif
