/* Callbacks that learn of every opened file and of every output. With them, a program never overwrites its inputs. */
#ifndef FXS_OPENED_H
#define FXS_OPENED_H

#include <stdint.h>

#include <fixsplat/internal/message.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Callback that receives the device and inode of an opened file, on the thread that opened the file. */
typedef void fxs_opened_fn(uint64_t device, uint64_t inode);

/* Sets the callback for opened files. Call before any file is read. Saved fits are not reported, because a program may
   overwrite them. */
void fxs_tell_opened(fxs_opened_fn *told);

void fxs_note_opened(uint64_t device, uint64_t inode);

/* Callback that receives the path of an output before its creation, on the writing thread. "-" is standard output.
   Returns 0, or an error and a message. */
typedef int fxs_output_asked_fn(const char *path, fxs_message *message);

/* Sets the callback for outputs. Call before any output begins. */
void fxs_ask_outputs(fxs_output_asked_fn *asked);

int fxs_may_write(const char *path, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
