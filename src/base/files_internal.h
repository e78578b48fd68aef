/* File access of the library. Implemented in port/posix and port/win32; port/web has no files. */
#ifndef FXS_FILES_INTERNAL_H
#define FXS_FILES_INTERNAL_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/fixsplat.h>

#include "os_calls.h"

/* Opens a regular file for reading, and fills in *facts, which may be null. Refuses a FIFO or device without opening
   it. Returns 0, or an error and a message. */
int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message);

/* As fxs_file_open, but the resolved path must lie in the folder of `first` or below. */
int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts,
                         fxs_message *message);

/* Checks that a file or folder lies in the folder of `first` or below, without opening it. Returns 0, or an error and a
   message. */
int fxs_file_check_within(const char *first, const char *path, fxs_message *message);

/* Reads `size` bytes at an offset. Returns 0, or -1 if any is missing. */
int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size);

#endif
