/* What the parts of fixsplat-web share. */
#ifndef SERVE_H
#define SERVE_H

#include <stddef.h>
#include <stdio.h>

#include <fixsplat/message.h>

/* The descriptor (src/base/system.h) of what was written to a temporary file, which it closes. Returns -1, with errno,
   where that or the file (null) failed. */
int keep_written(FILE *file);

/* The same of bytes. */
int keep(const void *data, size_t bytes);

/* A text of a format, for free; null: out of memory. */
char *text_of(const char *format, ...) FXS_PRINTF(1, 2);

/* Prints the QR code of an address, for terminals of either brightness. Returns 0, or -1 where this was built without
   libqrencode. */
int print_qr_code(const char *address);

/* `fixsplat fit --preview`: returns its exit status. */
int serve_fit(int argc, char **argv);

#endif
