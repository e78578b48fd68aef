/* Numbers in files, whose decimal point is a point in every locale of the program. */
#ifndef FXS_NUMBER_H
#define FXS_NUMBER_H

#include <stdio.h>

/* Prints a number with up to so many significant digits: 9 read back as the same float, 17 as the same double. */
void fxs_print_number(FILE *file, int digits, double value);

/* 1 where the word is a finite decimal number of at most 256 characters, and nothing else; else 0. */
int fxs_read_number(const char *word, double *value);

#endif
