#include "message.h"

#include <stdarg.h>
#include <stdio.h>

int fxs_fail(fxs_message *message, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message->text, sizeof message->text, format, arguments);
    va_end(arguments);
    for (char *c = message->text; *c; c++)   /* what a file says may be in it */
        *c = (unsigned char)*c < ' ' || *c == 127 ? '?' : *c;
    return -1;
}
