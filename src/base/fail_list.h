/* Messages: functions that take printf's arguments themselves, and texts of files for a terminal. */
#ifndef FXS_FAIL_LIST_H
#define FXS_FAIL_LIST_H

#include <stdarg.h>

#include <fixsplat/message.h>

/* As fxs_fail_as. */
int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments) FXS_PRINTF(3, 0);

/* As fxs_fail, of a library's call that failed, before which errno was 0: where an allocation of the library found no
   memory, which errno tells, the error is that. */
int fxs_fail_library(fxs_message *message, const char *path, const char *format, ...) FXS_PRINTF(3, 4);

/* Puts ? in the place of characters that steer a terminal or change the direction of the text. */
void fxs_text_make_safe(char *text);

#endif
