#include "fail_list.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* Returns the length in bytes of a character that a message must not contain, else 0. Such characters control a
   terminal, end a line or change the text direction: C0, C1, U+2028 to U+202E and U+2066 to U+2069. */
static size_t unsafe_bytes(const unsigned char *c)
{
    if (*c < ' ' || *c == 127)
        return 1;
    if (c[0] == 0xc2)
        return c[1] >= 0x80 && c[1] < 0xa0 ? 2 : 0;
    if (c[0] != 0xe2 || !c[1])
        return 0;
    return (c[1] == 0x80 && c[2] >= 0xa8 && c[2] <= 0xae) || (c[1] == 0x81 && c[2] >= 0xa6 && c[2] <= 0xa9) ? 3 : 0;
}

static int bytes_behind(unsigned char lead)
{
    return lead < 0xc2 || lead > 0xf4 ? 0 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
}

void fxs_text_make_safe(char *text)
{
    unsigned char *to = (unsigned char *)text;
    int behind = 0;
    for (const unsigned char *from = to; *from;) {
        const size_t unsafe = unsafe_bytes(from);
        const int continues = behind && (*from & 0xc0) == 0x80;
        const int is_stray = !continues && *from >= 0x80 && *from < 0xa0;
        behind = continues ? behind - 1 : unsafe ? 0 : bytes_behind(*from);
        *to++ = unsafe || is_stray ? '?' : *from;
        from += unsafe ? unsafe : 1;
    }
    *to = 0;
}

int fxs_fail_list(int error, fxs_message *message, const char *format, va_list arguments)
{
    vsnprintf(message->text, sizeof message->text, format, arguments);
    fxs_text_make_safe(message->text);
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

int fxs_fail_library(fxs_message *message, const char *path, const char *format, ...)
{
    va_list arguments;
    if (errno == ENOMEM)
        return fxs_fail_memory(message, path, 0);
    va_start(arguments, format);
    const int error = fxs_fail_list(FXS_ERR_FILE, message, format, arguments);
    va_end(arguments);
    return error;
}

int fxs_fail_errno(fxs_message *message, const char *path, int number)
{
    return fxs_fail_as(number == ENOMEM ? FXS_ERR_MEMORY : FXS_ERR_FILE, message, "%s: %s", path, strerror(number));
}
