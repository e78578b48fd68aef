/* Writes part files (pieces of a packed scene), and merges all parts into an .fxs file. */
#ifndef FXS_PART_FILE_H
#define FXS_PART_FILE_H

#include <fixsplat/pack.h>

/* Returns 1 if a file begins like a part file (a piece of a packed scene), else 0. Returns an error and a message if
   the file cannot be read. */
int fxs_part_file_is(const char *path, fxs_message *message);

/* Fills in the checksums of a part (a piece of a packed scene made by fxs_pack_part), and writes the part to a file.
   Returns 0, or FXS_ERR_FILE or FXS_ERR_MEMORY and a message. */
int fxs_part_file_write(const char *path, const fxs_packed_scene *part, fxs_message *message);

typedef struct fxs_part_merge {
    int tree;                    /* 1: merging fails if the parts have no levels of detail */
    int (*change)(void *argument, void *header, fxs_message *message);
    void *argument;
    fxs_progress progress;
} fxs_part_merge;

/* Merges all part files (pieces of a packed scene) into the file `out`. The bytes equal the bytes of the scene packed
   as a whole. Memory: about 500 bytes per chunk of 256 Gaussians. Returns 0, or FXS_ERR_FILE, FXS_ERR_VERSION,
   FXS_ERR_MEMORY or FXS_ERR_STOPPED and a message, with `out` unchanged. */
int fxs_part_files_merge(char *const *paths, uint32_t count, const char *out, const fxs_part_merge *how,
                         fxs_message *message);

#endif
