/* Writes messages for failed calls of libraries, and makes texts safe for a terminal. */
#ifndef FXS_FAIL_LIST_H
#define FXS_FAIL_LIST_H

#include <stdarg.h>

#include <fixsplat/internal/message.h>

int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments) FXS_PRINTF(3, 0);

/* Writes the message of a failed library call. Set errno to 0 before the library call. Returns FXS_ERR_MEMORY if errno
   is ENOMEM. */
int fxs_fail_library(fxs_message *message, const char *path, const char *format, ...) FXS_PRINTF(3, 4);

/* Replaces control characters and characters that change the text direction by question marks. */
void fxs_text_make_safe(char *text);

#endif
