/* Reads structs of options that a program passes. If the struct's size is not set, the error message names the function
   that initialises the struct. */
#include "options.h"

#include <fixsplat/internal/message.h>

#include "src/core/sized.h"

int fxs_options_read(void *all, size_t bytes, const void *given, const char *name, fxs_message *message)
{
    const int error = given ? fxs_sized_read(all, bytes, given) : 0;
    return error ? fxs_fail_as(error, message, "%s.size is not set: call %s_init first", name, name) : 0;
}
