/* Reports the files that are opened for reading, for a program that must not overwrite any of them. */
#ifndef FXS_OPENED_H
#define FXS_OPENED_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A function that gets the device and inode of a file, on the thread that opened it. */
typedef void fxs_opened_fn(uint64_t device, uint64_t inode);

/* A program calls this once, before it reads. From then on, `told` is called for each scene file and the files that
   belong to it, for camera files, pictures and photographs; but not for a saved fit, which may be saved over itself. */
void fxs_tell_opened(fxs_opened_fn *told);

/* Called by each function that opens a file. */
void fxs_note_opened(uint64_t device, uint64_t inode);

#ifdef __cplusplus
}
#endif

#endif
