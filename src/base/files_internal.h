/* Opens and reads files. Functions with a message return 0, or an error and the message. */
#ifndef FXS_FILES_INTERNAL_H
#define FXS_FILES_INTERNAL_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/fixsplat.h>

#include "os_calls.h"

/* Opens a regular file for reading. Stores its size, identity and time in *facts, unless `facts` is null. Refuses a
   FIFO or device. */
int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message);

/* Opens a file that must lie in the folder of the file `first` or in a folder below. */
int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts,
                         fxs_message *message);

/* Checks that a path lies in the folder of the file `first` or in a folder below. */
int fxs_file_check_within(const char *first, const char *path, fxs_message *message);

int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size);

#endif
