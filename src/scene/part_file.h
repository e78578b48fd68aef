/* Part files of a packed scene (src/pack/part.h): writes them, and merges them into the complete .fxs file. */
#ifndef FXS_PART_FILE_H
#define FXS_PART_FILE_H

#include <fixsplat/pack.h>

/* Returns 1 if a file begins like a part, 0 if not or if it is not a regular file; or an error with a message. */
int fxs_part_file_is(const char *path, fxs_message *message);

/* Fills in the checksums of a part made by fxs_pack_part and writes it, by the rules of output.h. Returns 0, or
   FXS_ERR_FILE or FXS_ERR_MEMORY and a message. */
int fxs_part_file_write(const char *path, const fxs_packed_scene *part, fxs_message *message);

typedef struct fxs_part_merge {
    int tree;                    /* 1: parts without levels of detail are an error */
    int (*change)(void *argument, void *header, fxs_message *message);   /* changes the scene's header, or null */
    void *argument;              /* argument of change */
    fxs_progress_fn *progress;   /* null: no callback */
    void *progress_argument;
} fxs_part_merge;

/* Merges `count` files, all parts of one scene in any order, to `out`. The result has the same bytes as the .fxs file
   that packing the whole scene gives. Holds all headers, about 500 bytes a chunk, and the rows of a few chunks; builds
   the tree nodes above the parts. Checks all input and compares every checksum. Returns 0, or an error and a message
   that names a file, with `out` unchanged: FXS_ERR_FILE, FXS_ERR_VERSION, FXS_ERR_MEMORY, FXS_ERR_STOPPED. */
int fxs_part_files_merge(char *const *paths, uint32_t count, const char *out, const fxs_part_merge *how,
                         fxs_message *message);

#endif
