/* How what is outside the core reports an error: its code, and one line for the person who asked (fxs_message). */
#ifndef FXS_MESSAGE_H
#define FXS_MESSAGE_H

#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define FXS_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define FXS_PRINTF(text, first)
#endif

/* Writes a printf-formatted text, cut to fit, with bytes_needed 0. Returns FXS_ERR_FILE, so that a reader can
   `return fxs_fail(...)`. Control characters, which may come from a file, become question marks. */
int fxs_fail(fxs_message *message, const char *format, ...) FXS_PRINTF(2, 3);

/* The same for another error, which is returned. */
int fxs_fail_as(int error, fxs_message *message, const char *format, ...) FXS_PRINTF(3, 4);

/* "PATH: out of memory", or without the path where that is null. `bytes` is the memory that would do, 0 where that is
   not known. Returns FXS_ERR_MEMORY. */
int fxs_fail_memory(fxs_message *message, const char *path, uint64_t bytes);

/* "PATH: what errno says". Returns FXS_ERR_MEMORY for ENOMEM, else FXS_ERR_FILE. */
int fxs_fail_errno(fxs_message *message, const char *path, int number);

#ifdef __cplusplus
}
#endif

#endif
