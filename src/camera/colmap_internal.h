/* Reads the values of COLMAP's files: little-endian numbers, and words in lines. */
#ifndef FXS_COLMAP_INTERNAL_H
#define FXS_COLMAP_INTERNAL_H

#include <stdint.h>

#include "src/base/text_internal.h"

typedef struct fxs_colmap_cursor {
    const unsigned char *at;
    size_t left;
    int short_of;   /* 1: a value past the end was read, as 0 */
} fxs_colmap_cursor;

static inline fxs_colmap_cursor fxs_colmap_begin(const fxs_text *text)
{
    return (fxs_colmap_cursor){(const unsigned char *)text->data, text->size, 0};
}

uint64_t fxs_colmap_take(fxs_colmap_cursor *in, size_t bytes);
void fxs_colmap_take_doubles(fxs_colmap_cursor *in, double *out, int count);

/* Skips `count` records, or all of the rest where there are fewer. */
void fxs_colmap_skip(fxs_colmap_cursor *in, uint64_t count, size_t bytes);

/* Cuts the next line off and returns it without leading blanks; NULL at the end. */
char *fxs_colmap_line(char **rest);

/* The next line that is not a comment or empty. */
char *fxs_colmap_entry(char **rest);

/* Cuts the next word off the line; empty at its end. */
char *fxs_colmap_word(char **line);

/* The rest of a line without blanks around it. */
char *fxs_colmap_rest(char *line);

/* Reads `count` finite numbers. Returns 0 where the next words are not. */
int fxs_colmap_numbers(char **line, double *out, int count);

#endif
