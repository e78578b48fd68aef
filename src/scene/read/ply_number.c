/* Reads numbers of a .ply, text and binary. */
#include <math.h>
#include <stdio.h>
#include <strings.h>

#include "ply_header.h"

enum { MAX_NUMBER = 511 };

static int next_byte(fxs_byte_reader *bytes)
{
    const uint8_t *byte = fxs_bytes_take(bytes, 1);
    return byte ? *byte : EOF;
}

double fxs_ply_load_number(const uint8_t *bytes, int type, fxs_ply_encoding encoding)
{
    int size = fxs_ply_types[type].size;
    uint64_t bits = 0;
    for (int i = 0; i < size; i++)
        bits = bits << 8 | bytes[encoding == FXS_PLY_BIG_ENDIAN ? i : size - 1 - i];
    uint32_t float_bits = (uint32_t)bits;
    float single;
    double real;
    switch (type) {
    case FXS_PLY_CHAR:   return (int8_t)bits;
    case FXS_PLY_SHORT:  return (int16_t)bits;
    case FXS_PLY_INT:    return (int32_t)bits;
    case FXS_PLY_FLOAT:  memcpy(&single, &float_bits, sizeof single); return (double)single;
    case FXS_PLY_DOUBLE: memcpy(&real, &bits, sizeof real); return real;
    case FXS_PLY_HALF:   return (double)fxs_half((uint32_t)bits);
    default:             return (double)bits;
    }
}

/* Returns value * 10^exponent. The result is rounded only once for |exponent| <= 22, because those powers of 10 are
   exact. */
static double scale_by_10(double value, int exponent)
{
    static const double powers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14,
                                    1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    int steps = exponent < -400 || exponent > 400 ? 400 : exponent < 0 ? -exponent : exponent;
    for (; steps > 22; steps -= 22)
        value = exponent < 0 ? value / powers[22] : value * powers[22];
    return exponent < 0 ? value / powers[steps] : value * powers[steps];
}

static int is_digit(int c)
{
    return c >= '0' && c <= '9';
}

static const char *parse_exponent(const char *text, int *exponent)
{
    int sign = *text == '-' ? -1 : 1, value = 0;
    if (*text == '-' || *text == '+')
        text++;
    if (!is_digit(*text))
        return NULL;
    for (; is_digit(*text); text++)
        if (value < 1000)
            value = 10 * value + (*text - '0');
    *exponent += sign * value;
    return text;
}

/* Parses a number like strtod, with a point in every locale. The result may be off by one unit in the last place.
   Returns the end of the number, or null. */
static const char *parse_number(const char *text, double *value)
{
    double sign = *text == '-' ? -1 : 1;
    uint64_t mantissa = 0;
    int exponent = 0, has_digits = 0, has_point = 0;
    if (*text == '-' || *text == '+')
        text++;
    if (strcasecmp(text, "nan") == 0 || strcasecmp(text, "inf") == 0) {
        *value = sign * (strcasecmp(text, "nan") == 0 ? NAN : INFINITY);
        return text + 3;
    }
    for (; is_digit(*text) || (*text == '.' && !has_point); text++) {
        if (*text == '.') {
            has_point = 1;
            continue;
        }
        has_digits = 1;
        if (mantissa < 1000000000000000000u) {
            mantissa = 10 * mantissa + (uint64_t)(*text - '0');
            exponent -= has_point;
        } else {
            exponent += !has_point;
        }
    }
    if (!has_digits)
        return NULL;
    if (*text == 'e' || *text == 'E')
        text = parse_exponent(text + 1, &exponent);
    *value = sign * scale_by_10((double)mantissa, exponent);
    return text;
}

int fxs_ply_parse_number(const char *word, double *value)
{
    const char *end = parse_number(word, value);
    return end && !*end;
}

static int is_blank(int byte)
{
    return byte == ' ' || byte == '\t' || byte == '\r';
}

/* Reads a number from a text .ply and leaves the newline after the number. At the end of the file, the number may be
   cut short. */
static int read_ascii_number(fxs_byte_reader *bytes, double *value)
{
    char text[MAX_NUMBER + 1];
    int length = 0, byte;
    do
        byte = next_byte(bytes);
    while (is_blank(byte));
    for (; byte != EOF && byte != '\n' && !is_blank(byte); byte = next_byte(bytes)) {
        if (length == MAX_NUMBER)
            return fxs_bytes_fail(bytes, "a value is too long");
        text[length++] = (char)byte;
    }
    if (byte == '\n')
        bytes->begin--;
    text[length] = '\0';
    if (length == 0)
        return byte == EOF ? FXS_ERR_FILE : fxs_bytes_fail(bytes, "too few values");
    return parse_number(text, value) == text + length ? 0 : fxs_bytes_fail(bytes, "a value is not a number");
}

int fxs_ply_read_number(fxs_byte_reader *bytes, fxs_ply_encoding encoding, int type, double *value)
{
    if (encoding == FXS_PLY_ASCII)
        return read_ascii_number(bytes, value);
    const uint8_t *number = fxs_bytes_take(bytes, fxs_ply_types[type].size);
    if (!number)
        return FXS_ERR_FILE;
    *value = fxs_ply_load_number(number, type, encoding);
    return 0;
}

void fxs_ply_begin_row(fxs_byte_reader *bytes, fxs_ply_encoding encoding)
{
    int byte = EOF;
    if (encoding != FXS_PLY_ASCII)
        return;
    do
        byte = next_byte(bytes);
    while (is_blank(byte) || byte == '\n');
    if (byte != EOF)
        bytes->begin--;
}

int fxs_ply_end_row(fxs_byte_reader *bytes, fxs_ply_encoding encoding)
{
    int byte = EOF;
    if (encoding != FXS_PLY_ASCII)
        return 0;
    do
        byte = next_byte(bytes);
    while (is_blank(byte));
    return byte == EOF || byte == '\n' ? 0 : fxs_bytes_fail(bytes, "too many values");
}
