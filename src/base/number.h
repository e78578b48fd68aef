/* Prints and reads numbers with a decimal point in every locale. */
#ifndef FXS_NUMBER_H
#define FXS_NUMBER_H

#include <stdio.h>

/* Prints a number with up to `digits` significant digits. 9 digits restore a float exactly, 17 digits a double. */
void fxs_print_number(FILE *file, int digits, double value);

/* Prints numbers as a list of JSON, with `between`, such as ",", between two: [1,2,3]. */
void fxs_print_list(FILE *file, int digits, const char *between, const double *values, int count);

/* Reads a finite decimal number. Returns 1, or 0 if `word` is no such number. */
int fxs_read_number(const char *word, double *value);

#endif
