/* Files of parts of a packed scene (src/pack/part.h): written, and merged to the .fxs file of the whole. */
#ifndef FXS_PART_FILE_H
#define FXS_PART_FILE_H

#include <fixsplat/pack.h>

/* Returns 1 where a file begins as a part does, 0 where it does not or is no regular file; or an error with a
   message. */
int fxs_part_file_is(const char *path, fxs_message *message);

/* Writes a part of fxs_pack_part, as output.h says, with its checksums, which it fills in. Returns 0, or FXS_ERR_FILE
   or FXS_ERR_MEMORY and a message. */
int fxs_part_file_write(const char *path, const fxs_packed_scene *part, fxs_message *message);

typedef struct fxs_part_merge {
    int tree;                    /* 1: parts without levels of detail are refused */
    int (*change)(void *argument, void *header, fxs_message *message);   /* of the scene's header, or null */
    void *argument;              /* of it */
    fxs_progress_fn *progress;   /* may be null */
    void *progress_argument;
} fxs_part_merge;

/* Merges `count` files, all parts of one scene in any order, to `out`: the bytes of the .fxs that packing the scene at
   once gives. The headers are held, about 500 bytes a chunk, and the rows of a few chunks; what lies above the parts in
   the tree is built. Whatever the files hold, it is checked before it is used, and every checksum is compared. Returns
   0, or an error and a message that names a file, and `out` is as it was: FXS_ERR_FILE, FXS_ERR_VERSION,
   FXS_ERR_MEMORY, FXS_ERR_STOPPED. */
int fxs_part_files_merge(char *const *paths, uint32_t count, const char *out, const fxs_part_merge *how,
                         fxs_message *message);

#endif
