/* Helpers of fixsplat-web, the web server program. */
#ifndef SERVE_H
#define SERVE_H

#include <stddef.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>

/* Closes a temporary file and returns a descriptor (src/base/os_calls.h) of its content. Returns -1 and sets errno if
   the file is null, or writing it failed. */
int keep_written(FILE *file);

/* Writes bytes to a temporary file. Returns a descriptor of the file, or -1 with errno. */
int keep(const void *data, size_t bytes);

/* Formats a string, which the caller frees. Null: out of memory. */
char *text_of(const char *format, ...) FXS_PRINTF(1, 2);

/* Prints the QR code of an address on the terminal. Returns -1 in a build without libqrencode, else 0. */
int print_qr_code(const char *address);

int serve_fit(int argc, char **argv);

#endif
