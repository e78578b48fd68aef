/* Messages: variants with a va_list, errors of libraries, and texts made safe for a terminal. */
#ifndef FXS_FAIL_LIST_H
#define FXS_FAIL_LIST_H

#include <stdarg.h>

#include <fixsplat/internal/message.h>

/* As fxs_fail_as, with a va_list. */
int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments) FXS_PRINTF(3, 0);

/* As fxs_fail, for a failed call of a library. The caller sets errno to 0 before the call. If errno then reports
   that memory ran out, the error is FXS_ERR_MEMORY. */
int fxs_fail_library(fxs_message *message, const char *path, const char *format, ...) FXS_PRINTF(3, 4);

/* Replaces control characters and characters that change the text direction by ?. */
void fxs_text_make_safe(char *text);

#endif
