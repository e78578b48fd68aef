/* The library's access to files. The functions are in port/posix and port/win32; port/web has no files. */
#ifndef FXS_FILES_INTERNAL_H
#define FXS_FILES_INTERNAL_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/fixsplat.h>

#include "system.h"

/* Opens a regular file to be read, and fills in *facts, which may be null. A FIFO or a device is refused before it is
   opened. Returns 0, or an error and a message. */
int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message);

/* The same, but after symbolic links are followed, the file must lie in the folder of `first` or below it. */
int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts,
                         fxs_message *message);

/* Checks that of a file or folder, without opening it. Returns 0, or an error and a message. */
int fxs_file_check_within(const char *first, const char *path, fxs_message *message);

/* Reads `size` bytes at an offset. Returns 0, or -1 where not all could be read. */
int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size);

#endif
