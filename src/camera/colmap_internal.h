/* Reads values of COLMAP's files: little-endian numbers of binary files, and words of text lines. */
#ifndef FXS_COLMAP_INTERNAL_H
#define FXS_COLMAP_INTERNAL_H

#include <stdint.h>

#include "src/base/text_internal.h"

typedef struct fxs_colmap_cursor {
    const unsigned char *at;
    size_t left;
    int short_of;   /* 1: something was read beyond the end of the file, and was 0 */
} fxs_colmap_cursor;

static inline fxs_colmap_cursor fxs_colmap_begin(const fxs_text *text)
{
    return (fxs_colmap_cursor){(const unsigned char *)text->data, text->size, 0};
}

uint64_t fxs_colmap_take(fxs_colmap_cursor *in, size_t bytes);
void fxs_colmap_take_doubles(fxs_colmap_cursor *in, double *out, int count);

/* Skips `count` records of a file, or all remaining bytes. */
void fxs_colmap_skip(fxs_colmap_cursor *in, uint64_t count, size_t bytes);

/* Returns the number of parameters of a camera model, by its id; 0 for an unknown one. */
int fxs_colmap_params(uint64_t model);

/* Returns the next line of a text without leading blanks; NULL at the end. */
char *fxs_colmap_line(char **rest);

/* Returns the next line of a text, without empty lines and comments; NULL at the end. */
char *fxs_colmap_entry(char **rest);

/* Returns the next word of a text line; an empty word at the end. */
char *fxs_colmap_word(char **line);

/* Returns the rest of a text line without blanks around it. */
char *fxs_colmap_rest(char *line);

/* Reads `count` finite numbers from a text line. Returns 1, or 0 if a word is no number. */
int fxs_colmap_numbers(char **line, double *out, int count);

#endif
