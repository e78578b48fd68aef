/* Writes a file under a temporary name and renames it when complete. */
#ifndef FXS_OUTPUT_INTERNAL_H
#define FXS_OUTPUT_INTERNAL_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>
#include "try_internal.h"

typedef struct fxs_output {
    FILE *file;                /* never seek: it may be a pipe */
    char *path;                /* as the user named it */
    char *target, *temporary;  /* path with symbolic links resolved, and a temporary name in its folder; null: no
                                  renaming */
    struct fxs_output *next;   /* list of open outputs: an open output must not move in memory */
    int lock;                  /* descriptor with the lock on the temporary file, or -1 */
    uint64_t left;             /* Gaussians announced but not yet written */
    int error;                 /* errno of the first failure, or 0; the caller may set it */
} fxs_output;

/* Begins a file as output.h describes, for `count` Gaussians (0: none). Returns 0, or an error and a message, with
   nothing to close. */
int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message);

/* Converts an errno to an error and a message with the file's name. */
int fxs_output_fail(const char *path, int error, fxs_message *message);

/* Call before writing n Gaussians. Returns 0, or FXS_ERR_ARGUMENT and a message if they exceed the announced number. */
int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message);

/* Returns 0, or an error and a message. The caller may also write to output->file directly. */
int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message);

/* Flushes the complete file to disk and renames it. Returns 0, or an error and a message; then the new file is
   removed and an existing file of that name is unchanged. */
int fxs_output_close(fxs_output *output, fxs_message *message);

#endif
