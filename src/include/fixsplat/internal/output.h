/* Finds the names of output files and removes temporary ones after a signal, for the command. */
#ifndef FXS_INTERNAL_OUTPUT_H
#define FXS_INTERNAL_OUTPUT_H

#include <fixsplat/system.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes signals remove temporary files. A program may call it once at its start: SIGHUP, SIGINT, SIGPIPE, SIGTERM,
   SIGXCPU and SIGXFSZ then remove this process's temporary files before they end the process as usual. A signal that is
   already ignored or handled is left alone. The library never calls this; without it, or at any other signal, the
   temporary files stay. Does nothing on Windows, which deletes the files however a process ends. */
FXS_EXPERIMENTAL void fxs_output_remove_at_signals(void);

/* Returns the name of the file that an output to `path` writes: `path` with its symbolic links followed, whether or not
   the file exists. The caller frees it with free(). Returns null, with errno set, if the path has too many links or
   memory ran out. */
FXS_EXPERIMENTAL char *fxs_output_target(const char *path);

#ifdef __cplusplus
}
#endif

#endif
