/* Which files are opened to be read: for a program that is not to write over one of them. */
#ifndef FXS_OPENED_H
#define FXS_OPENED_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Is told the device and inode of a file, on the thread that has opened it. */
typedef void fxs_opened_fn(uint64_t device, uint64_t inode);

/* For a program to call once, before it reads: from then on `told` is told of each scene file, with all that belongs to
   it, of camera files, pictures and photographs. Not of a saved fit, which may be saved over itself. */
void fxs_tell_opened(fxs_opened_fn *told);

/* For what opens files to call. */
void fxs_opened(uint64_t device, uint64_t inode);

#ifdef __cplusplus
}
#endif

#endif
