/* Shared by the parts of fixsplat-web. */
#ifndef SERVE_H
#define SERVE_H

#include <stddef.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>

/* Closes a temporary file and returns a descriptor (src/base/os_calls.h) of its content. Returns -1 and sets errno if
   the file is null, or writing it failed. */
int keep_written(FILE *file);

/* Writes bytes to a temporary file and returns its descriptor, as keep_written does. */
int keep(const void *data, size_t bytes);

/* Formats a string, which the caller frees. Returns null if memory runs out. */
char *text_of(const char *format, ...) FXS_PRINTF(1, 2);

/* Prints the QR code of an address, readable on dark and light terminals. Returns 0, or -1 in a build without
   libqrencode. */
int print_qr_code(const char *address);

/* Runs `fixsplat fit --preview`. Returns its exit status. */
int serve_fit(int argc, char **argv);

#endif
