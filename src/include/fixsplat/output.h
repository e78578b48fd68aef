/* How the library writes files. Until a file is complete and on the disk, it has a temporary name in the same folder. A
 * process that is killed leaves it there, and the next that writes the same file removes it. An existing file keeps its
 * permissions. For a symbolic link, its target is written, even where that does not exist yet. A FIFO, a device or
 * standard output ("-", or another name such as /dev/stdout) gets the bytes as they come, so bytes written before an
 * error stay there. Several threads may write at the same time, each a file of its own.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_OUTPUT_H
#define FXS_OUTPUT_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A program may call this once, when it begins: SIGHUP, SIGINT, SIGPIPE, SIGTERM, SIGXCPU and SIGXFSZ then remove the
   temporary files of this process before they end it as usual. A signal that is already ignored or handled stays so.
   The library never calls this: without it, or at any other signal, the temporary files stay behind. Windows deletes
   them however a process ends, and there this does nothing. */
FXS_API void fxs_output_remove_at_signals(void);

/* The name of the file that an output to `path` writes: the end of its symbolic links, whether that file exists or not.
   The caller frees it with free(). Null, with errno set, where there are too many links or memory ran out. */
FXS_API char *fxs_output_target(const char *path);

#ifdef __cplusplus
}
#endif

#endif
