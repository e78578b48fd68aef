#include "colmap_internal.h"

#include <stdlib.h>
#include <string.h>

#include "src/base/number.h"

uint64_t fxs_colmap_take(fxs_colmap_cursor *in, size_t bytes)
{
    uint64_t value = 0;
    if (in->left < bytes) {
        in->short_of = 1;
        in->left = 0;
        return 0;
    }
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)in->at[i] << 8 * i;
    in->at += bytes;
    in->left -= bytes;
    return value;
}

void fxs_colmap_take_doubles(fxs_colmap_cursor *in, double *out, int count)
{
    for (int i = 0; i < count; i++) {
        uint64_t bits = fxs_colmap_take(in, 8);
        memcpy(&out[i], &bits, 8);
    }
}

void fxs_colmap_skip(fxs_colmap_cursor *in, uint64_t count, size_t bytes)
{
    if (count > in->left / bytes) {
        in->short_of = 1;
        in->left = 0;
        return;
    }
    in->at += (size_t)count * bytes;
    in->left -= (size_t)count * bytes;
}

char *fxs_colmap_line(char **rest)
{
    char *line = *rest;
    if (!*line)
        return NULL;
    size_t length = strcspn(line, "\n");
    *rest = line + length + (line[length] != 0);
    line[length] = 0;
    return line + strspn(line, " \t\r");
}

char *fxs_colmap_entry(char **rest)
{
    char *line;
    do
        line = fxs_colmap_line(rest);
    while (line && (!*line || *line == '#'));
    return line;
}

char *fxs_colmap_word(char **line)
{
    char *word = *line + strspn(*line, " \t\r");
    size_t length = strcspn(word, " \t\r");
    *line = word + length + (word[length] != 0);
    word[length] = 0;
    return word;
}

char *fxs_colmap_rest(char *line)
{
    line += strspn(line, " \t\r");
    for (size_t length = strlen(line); length && strchr(" \t\r", line[length - 1]);)
        line[--length] = 0;
    return line;
}

int fxs_colmap_numbers(char **line, double *out, int count)
{
    for (int i = 0; i < count; i++)
        if (!fxs_read_number(fxs_colmap_word(line), &out[i]))
            return 0;
    return 1;
}
