/* Files that are being written: pictures, packed scenes, .ply, .splat and .spz. Each has a temporary name, beside its
   own and with the process's number in it, until it is complete and on the disk. A file that exists keeps its
   permissions. Of a symbolic link the target is written, whether it exists or not. A FIFO or a device is written to as
   the bytes come, and so is standard output, as "-" or by another name (/dev/stdout): what has gone there before an
   error has gone. Several threads may write files at the same time, each its own. */
#ifndef FXS_OUTPUT_H
#define FXS_OUTPUT_H

#ifdef __cplusplus
extern "C" {
#endif

/* For a program to call once, as it begins: SIGHUP, SIGINT, SIGPIPE, SIGTERM, SIGXCPU and SIGXFSZ remove the temporary
   files of this process, then end it as they would have. A signal that is ignored or handled already stays so. The
   library never does this by itself: without it, or at any other signal, the temporary files stay behind. */
void fxs_output_remove_at_signals(void);

/* The name of the file that an output of this name becomes: where its symbolic links end, whether there is such a file
   or not. For free(); null and errno where they do not end, or there is no memory. */
char *fxs_output_target(const char *path);

#ifdef __cplusplus
}
#endif

#endif
