#include "number.h"
#include <fixsplat/fixsplat.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

void fxs_print_number(FILE *file, int digits, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.*g", digits, value);
    const size_t length = isfinite(value) ? strspn(text, "-0123456789") : strlen(text);
    const char *rest = text + length;
    if (!*rest || *rest == 'e')
        fputs(text, file);
    else
        fprintf(file, "%.*s.%s", (int)length, text, rest + strcspn(rest, "0123456789"));
}

void fxs_print_list(FILE *file, int digits, const char *between, const double *values, int count)
{
    fputc('[', file);
    for (int i = 0; i < count; i++) {
        fputs(i ? between : "", file);
        fxs_print_number(file, digits, values[i]);
    }
    fputc(']', file);
}

int fxs_read_number(const char *word, double *value)
{
    char text[512], half[16], *end;
    const char *point = strchr(word, '.');
    const size_t length = strlen(word);
    if (!length || length > 256 || strspn(word, "+-.0123456789eE") != length)
        return 0;
    snprintf(half, sizeof half, "%.1f", 0.5);                  /* prints 0.5 to learn the locale's decimal point */
    half[strlen(half) - 1] = 0;
    if (point)
        snprintf(text, sizeof text, "%.*s%s%s", (int)(point - word), word, half + 1, point + 1);
    else
        memcpy(text, word, length + 1);
    *value = strtod(text, &end);
    return !*end && isfinite(*value);
}
