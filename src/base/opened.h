/* Hooks for a program that must not overwrite its inputs: reports every file opened for reading, and asks before
   every output. */
#ifndef FXS_OPENED_H
#define FXS_OPENED_H

#include <stdint.h>

#include <fixsplat/internal/message.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Gets the device and inode of a file, on the thread that opened it. */
typedef void fxs_opened_fn(uint64_t device, uint64_t inode);

/* Sets the hook, once, before anything is read. It is called for scene files and their companion files, camera
   files, pictures and photographs. It is not called for a saved fit, because that may be saved over itself. */
void fxs_tell_opened(fxs_opened_fn *told);

/* Called by every function that opens a file. */
void fxs_note_opened(uint64_t device, uint64_t inode);

/* Gets the name of an output (-: standard output) before it is created, on the writing thread. Returns 0, or an
   error and a message to refuse the output. */
typedef int fxs_output_asked_fn(const char *path, fxs_message *message);

/* Sets the hook, once, before anything is written. */
void fxs_ask_outputs(fxs_output_asked_fn *asked);

/* Called by fxs_output_open, which begins every output. */
int fxs_may_write(const char *path, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
