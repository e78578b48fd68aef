/* Opens and reads files. Functions with a message return 0, or an error and the message. */
#ifndef FXS_FILES_INTERNAL_H
#define FXS_FILES_INTERNAL_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/fixsplat.h>

#include "system.h"

/* Opens a regular file and stores its facts, which may be null. A FIFO or device is refused unopened. */
int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message);

/* Opens a file whose resolved path lies in the folder of the file `first` or below. */
int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts,
                         fxs_message *message);

/* Checks without opening that a path lies in the folder of the file `first` or below. */
int fxs_file_check_within(const char *first, const char *path, fxs_message *message);

/* Returns 0, or -1 if the file ends early. */
int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size);

#endif
