/* The C library's printf functions, as far as messages need: %s %d %u %c %f %g, with h, l, ll, z and t, and a precision
   for strings. JavaScript converts numbers to text. */
#include <limits.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__attribute__((import_module("env"), import_name("number"))) size_t fxs_web_number(double x, char *out, size_t room);
__attribute__((import_module("env"), import_name("real"))) double fxs_web_real(const char *text, size_t length);

typedef struct writer {
    char *out;
    /* `length` of the whole text; at most `room` bytes of it are written to `out`, with the final 0 */
    size_t room, length;
} writer;

static void put(writer *w, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++, w->length++)
        if (w->length + 1 < w->room)
            w->out[w->length] = text[i];
}

static void put_number(writer *w, double x)
{
    char digits[32];
    put(w, digits, fxs_web_number(x, digits, sizeof digits));
}

static void put_integer(writer *w, va_list *arguments, int is_long, int is_signed)
{
    if (is_long)
        put_number(w, is_signed ? (double)va_arg(*arguments, long long)
                                : (double)va_arg(*arguments, unsigned long long));
    else
        put_number(w, is_signed ? (double)va_arg(*arguments, int) : (double)va_arg(*arguments, unsigned));
}

static void put_string(writer *w, const char *text, int most)
{
    size_t length = 0;
    while ((most < 0 || length < (size_t)most) && text[length])
        length++;
    put(w, text, length);
}

static int take_precision(const char **format, va_list *arguments)
{
    int precision = 0;
    if (*++*format == '*') {
        ++*format;
        return va_arg(*arguments, int);
    }
    for (; **format >= '0' && **format <= '9'; ++*format)
        precision = 10 * precision + (**format - '0');
    return precision;
}

static const char *put_one(writer *w, const char *format, va_list *arguments)
{
    int precision = -1, longs = 0;
    while (*format >= '0' && *format <= '9')
        format++;
    if (*format == '.')
        precision = take_precision(&format, arguments);
    for (; *format == 'l' || *format == 'z' || *format == 't' || *format == 'h'; format++)
        longs += *format == 'l';
    switch (*format) {
    case 's': put_string(w, va_arg(*arguments, const char *), precision); break;
    case 'd': put_integer(w, arguments, longs > 1, 1); break;
    case 'u': put_integer(w, arguments, longs > 1, 0); break;
    case 'c': put(w, &(char){(char)va_arg(*arguments, int)}, 1); break;
    case 'f': case 'g': put_number(w, va_arg(*arguments, double)); break;
    default: put(w, format, 1);
    }
    return format + 1;
}

int vsnprintf(char *out, size_t room, const char *format, va_list arguments)
{
    writer w = {out, room, 0};
    va_list rest;
    va_copy(rest, arguments);
    while (*format)
        if (*format++ == '%')
            format = put_one(&w, format, &rest);
        else
            put(&w, format - 1, 1);
    va_end(rest);
    if (room)
        out[w.length < room ? w.length : room - 1] = 0;
    return (int)w.length;
}

int snprintf(char *out, size_t room, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(out, room, format, arguments);
    va_end(arguments);
    return length;
}

int sprintf(char *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(out, INT_MAX, format, arguments);
    va_end(arguments);
    return length;
}

static const char *skip_digits(const char *text)
{
    while (*text >= '0' && *text <= '9')
        text++;
    return text;
}

double strtod(const char *text, char **end)
{
    const char *begin = text + (*text == '-' || *text == '+'), *at = skip_digits(begin);
    size_t digits = (size_t)(at - begin);
    if (*at == '.') {
        const char *fraction = at + 1;
        at = skip_digits(fraction);
        digits += (size_t)(at - fraction);
    }
    if (digits > 0 && (*at == 'e' || *at == 'E')) {
        const char *exponent = at + 1 + (at[1] == '-' || at[1] == '+'), *behind = skip_digits(exponent);
        at = behind > exponent ? behind : at;
    }
    if (end)
        *end = (char *)(digits > 0 ? at : text);
    return digits > 0 ? fxs_web_real(text, (size_t)(at - text)) : 0;
}
