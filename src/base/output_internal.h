/* A file that is written under a temporary name, and takes its own when it is complete. */
#ifndef FXS_OUTPUT_INTERNAL_H
#define FXS_OUTPUT_INTERNAL_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <fixsplat/message.h>
#include "try_internal.h"

typedef struct fxs_output {
    FILE *file;                /* cannot be sought */
    char *path;                /* as the user named it */
    char *target, *temporary;  /* path without symbolic links, and a name beside that; null where path is written to */
    struct fxs_output *next;   /* of those under way: an output stays where it is between open and close */
    uint64_t left;             /* Gaussians announced that have not come yet */
    int error;                 /* errno of the first failure, or 0; the user may set it */
} fxs_output;

/* Begins a file as output.h says, for `count` Gaussians (0 where it holds something else). Returns 0, or an error
   and a message, with nothing to close. */
int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message);

/* Before n Gaussians are written: returns 0, or FXS_ERR_ARGUMENT and a message where these are more than
   announced. */
int fxs_output_expect(fxs_output *output, size_t n, fxs_message *message);

/* Returns 0, or an error and a message. To write to output->file directly is as good. */
int fxs_output_write(fxs_output *output, const void *bytes, size_t size, fxs_message *message);

/* Gives the file its name, where it is complete and on the disk. Returns 0, or an error and a message: then nothing is
   left behind, and an earlier file of that name is as it was. */
int fxs_output_close(fxs_output *output, fxs_message *message);

#endif
