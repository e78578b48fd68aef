/* Writes a file under a temporary name, and renames it when it is complete. */
#ifndef FXS_OUTPUT_INTERNAL_H
#define FXS_OUTPUT_INTERNAL_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <fixsplat/message.h>
#include "try_internal.h"

typedef struct fxs_output {
    FILE *file;                /* must not be seeked: it may be a pipe */
    char *path;                /* as the user named it */
    char *target, *temporary;  /* path after its symbolic links, and a name beside it; null: no renaming */
    struct fxs_output *next;   /* the next open output: outputs must not move in memory while open */
    int lock;                  /* a descriptor that holds the lock on the temporary file, or -1 */
    uint64_t left;             /* announced Gaussians that are still to be written */
    int error;                 /* errno of the first failure, or 0; the caller may set it */
} fxs_output;

/* Begins a file as output.h says, for `count` Gaussians (0: the file has no Gaussians). Returns 0, or an error and a
   message; then there is nothing to close. */
int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message);

/* The error of an errno, and a message that names the file. */
int fxs_output_fail(const char *path, int error, fxs_message *message);

/* Called before n Gaussians are written. Returns 0, or FXS_ERR_ARGUMENT and a message where more are written than were
   announced. */
int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message);

/* Returns 0, or an error and a message. The caller may also write to output->file directly. */
int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message);

/* Puts the complete file on the disk and gives it its name. Returns 0, or an error and a message: then no new file is
   left behind, and an earlier file of that name is unchanged. */
int fxs_output_close(fxs_output *output, fxs_message *message);

#endif
