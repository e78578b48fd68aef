/* Reports the files that are opened for reading, and asks before a file is written, for a program that must not
   overwrite what it reads. */
#ifndef FXS_OPENED_H
#define FXS_OPENED_H

#include <stdint.h>

#include <fixsplat/message.h>

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

/* A function that gets the name of an output (- is standard output) before anything of it is there, on the thread that
   writes. It returns 0, or an error and a message where the output is refused. */
typedef int fxs_output_asked_fn(const char *path, fxs_message *message);

/* A program calls this once, before it writes. From then on, `asked` is called for every output. */
void fxs_ask_outputs(fxs_output_asked_fn *asked);

/* Called by fxs_output_open, which begins every output. */
int fxs_may_write(const char *path, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
