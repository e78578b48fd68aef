/* Messages: functions that take printf's arguments themselves, and texts of files for a terminal. */
#ifndef FXS_FAIL_LIST_H
#define FXS_FAIL_LIST_H

#include <stdarg.h>

#include <fixsplat/message.h>

/* As fxs_fail_as. */
int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments) FXS_PRINTF(3, 0);

/* Puts ? in the place of characters that steer a terminal or change the direction of the text. */
void fxs_text_make_safe(char *text);

#endif
