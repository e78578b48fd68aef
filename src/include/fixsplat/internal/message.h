/* Reports errors of functions outside the core as a code and one line of text for the user (fxs_message).
 *
 * Stable from version 1.0 on. */
#ifndef FXS_MESSAGE_H
#define FXS_MESSAGE_H

#include <stdint.h>

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__MINGW32__)
#define FXS_PRINTF(text, first) __attribute__((format(gnu_printf, text, first)))
#elif defined(__GNUC__)
#define FXS_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define FXS_PRINTF(text, first)
#endif

/* Writes a printf-formatted error message, truncated to fit, and sets bytes_needed to 0. Control characters become
   question marks. Returns FXS_ERR_FILE, for `return fxs_fail(...)`. */
FXS_EXPERIMENTAL int fxs_fail(fxs_message *message, const char *format, ...) FXS_PRINTF(2, 3);

/* Writes an error message like fxs_fail, but returns `error`. */
FXS_EXPERIMENTAL int fxs_fail_as(int error, fxs_message *message, const char *format, ...) FXS_PRINTF(3, 4);

/* Writes the error message "PATH: out of memory", or "out of memory" if `path` is null. Sets bytes_needed to `bytes`,
   the memory that would suffice, or 0 if unknown. Returns FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_fail_memory(fxs_message *message, const char *path, uint64_t bytes);

/* Writes the error message "PATH: " and the system's text for the errno `number`. Returns FXS_ERR_MEMORY for ENOMEM,
   else FXS_ERR_FILE. */
FXS_EXPERIMENTAL int fxs_fail_errno(fxs_message *message, const char *path, int number);

#ifdef __cplusplus
}
#endif

#endif
