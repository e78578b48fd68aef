/* Messages of functions that take printf's arguments themselves. */
#ifndef FXS_FAIL_LIST_H
#define FXS_FAIL_LIST_H

#include <stdarg.h>

#include <fixsplat/message.h>

/* As fxs_fail_as. */
int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments) FXS_PRINTF(3, 0);

#endif
