/* The library's access to files. The functions are in port/posix; port/web has no files. */
#ifndef FXS_FILES_INTERNAL_H
#define FXS_FILES_INTERNAL_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/fixsplat.h>

enum fxs_file_kind { FXS_FILE_NONE, FXS_FILE_REGULAR, FXS_FILE_FOLDER, FXS_FILE_OTHER };

/* The kind of a file, after its symbolic links are followed. */
enum fxs_file_kind fxs_file_kind(const char *path);

/* 1 where the name exists, even as a symbolic link to a missing file, else 0. */
int fxs_file_is_named(const char *path);

/* Makes a folder, unless it is there. Returns 0, or an error and a message. */
int fxs_folder_make(const char *path, fxs_message *message);

/* Calls a function with the name of each file in a folder, in no order; of a folder that cannot be read, with none. */
void fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument);

typedef struct fxs_file_facts {
    uint64_t size, device, inode;
} fxs_file_facts;

/* Opens a regular file to be read, and fills in *facts, which may be null. A FIFO or a device is refused before it is
   opened. Returns 0, or an error and a message. */
int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message);

/* The same, but after symbolic links are followed, the file must lie in the folder of `first` or below it. */
int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts,
                         fxs_message *message);

/* Reads `size` bytes at an offset. Returns 0, or -1 where not all could be read. */
int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size);

#endif
