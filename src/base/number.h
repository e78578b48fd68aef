/* Numbers in files: the decimal point is a point in every locale. */
#ifndef FXS_NUMBER_H
#define FXS_NUMBER_H

#include <stdio.h>

/* Prints a number with up to `digits` significant digits. 9 read back as the same float, 17 as the same double. */
void fxs_print_number(FILE *file, int digits, double value);

/* Reads a word that is a finite decimal number of at most 256 characters and nothing else. Returns 1, else 0. */
int fxs_read_number(const char *word, double *value);

#endif
