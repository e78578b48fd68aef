/* Reads the structs of options that a program passes to the library. Such a struct begins with its size
   (fixsplat.h). */
#ifndef FXS_BASE_OPTIONS_H
#define FXS_BASE_OPTIONS_H

#include <fixsplat/fixsplat.h>

/* Copies the program's struct `given` over the defaults in `all`, which has `bytes` bytes. If `given` is null, the
   defaults stay. Returns 0, or FXS_ERR_STRUCT and a message with the struct's name. */
int fxs_options_read(void *all, size_t bytes, const void *given, const char *name, fxs_message *message);

/* Calls fxs_options_read for a struct, with the size and name of the struct's type. */
#define FXS_OPTIONS_READ(type, all, given, message) fxs_options_read(all, sizeof(type), given, #type, message)

#endif
