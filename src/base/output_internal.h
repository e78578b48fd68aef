/* Writes an output file under a temporary name and renames the complete file. Functions with a message return 0, or an
   error and the message. */
#ifndef FXS_OUTPUT_INTERNAL_H
#define FXS_OUTPUT_INTERNAL_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>
#include "try_internal.h"

typedef struct fxs_output {
    FILE *file;                /* stream of the output; never seek, because the stream may be a pipe */
    char *path;
    char *target, *temporary;  /* final name with links resolved, and temporary name; null if the file is not renamed */
    struct fxs_output *next;   /* next in the list of open outputs, so an open output must not move in memory */
    int lock;                  /* descriptor that locks the temporary file; -1: none */
    uint64_t left;
    int error;                 /* errno of the first failure; 0: no failure */
} fxs_output;

/* Begins an output file for `count` Gaussians. After an error, do not close the output. */
int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message);

int fxs_output_fail(const char *path, int error, fxs_message *message);

/* Announces that n Gaussians will be written next. Fails if these exceed the count given to fxs_output_open. */
int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message);

int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message);

/* Lets another program write the output until fxs_output_take_back: returns the name of the temporary file; null if the
   output is none that is renamed, such as a FIFO. */
const char *fxs_output_lend(fxs_output *output);
void fxs_output_take_back(fxs_output *output);

/* Writes the output to disk and gives the file its final name. After an error, an existing file of that name is
   unchanged. */
int fxs_output_close(fxs_output *output, fxs_message *message);

#endif
