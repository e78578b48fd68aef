#include "fail_list.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments)
{
    vsnprintf(message->text, sizeof message->text, format, arguments);
    for (char *c = message->text; *c; c++)   /* the text may quote a file */
        *c = (unsigned char)*c < ' ' || *c == 127 ? '?' : *c;
    message->bytes_needed = 0;
    return error;
}

int fxs_fail(fxs_message *message, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int error = fxs_fail_list(FXS_ERR_FILE, message, format, arguments);
    va_end(arguments);
    return error;
}

int fxs_fail_as(int error, fxs_message *message, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fxs_fail_list(error, message, format, arguments);
    va_end(arguments);
    return error;
}

int fxs_fail_memory(fxs_message *message, const char *path, uint64_t bytes)
{
    fxs_fail_as(FXS_ERR_MEMORY, message, "%s%sout of memory", path ? path : "", path ? ": " : "");
    message->bytes_needed = bytes;
    return FXS_ERR_MEMORY;
}

int fxs_fail_errno(fxs_message *message, const char *path, int number)
{
    return fxs_fail_as(number == ENOMEM ? FXS_ERR_MEMORY : FXS_ERR_FILE, message, "%s: %s", path, strerror(number));
}
