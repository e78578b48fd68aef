/* Writes a file under a temporary name and renames the complete file. Functions with a message return 0, or an
   error and the message. */
#ifndef FXS_OUTPUT_INTERNAL_H
#define FXS_OUTPUT_INTERNAL_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>
#include "try_internal.h"

typedef struct fxs_output {
    FILE *file;                /* possibly a pipe, so never seek in this file */
    char *path;
    char *target, *temporary;  /* name with links resolved, and temporary name; null: no renaming */
    struct fxs_output *next;   /* list of open outputs, which must not move in memory */
    int lock;                  /* locked descriptor of the temporary file; -1: none */
    uint64_t left;
    int error;                 /* errno of the first failure; 0: no failure */
} fxs_output;

/* Begins a file for `count` Gaussians. After an error, the output needs no close. */
int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message);

int fxs_output_fail(const char *path, int error, fxs_message *message);

/* Call before writing n Gaussians. Fails if more Gaussians than announced are written. */
int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message);

int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message);

/* Flushes the file to disk and renames it. After an error, an existing file of that name is unchanged. */
int fxs_output_close(fxs_output *output, fxs_message *message);

#endif
