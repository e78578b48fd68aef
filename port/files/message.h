/* One line about what went wrong with a file, for the person who asked for it. */
#ifndef FXS_MESSAGE_H
#define FXS_MESSAGE_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_message {
    char text[512];   /* zero-terminated, no newline; names the file and the fault */
} fxs_message;

/* Writes a printf-formatted text, cut to fit, and returns -1, so that a reader can `return fxs_fail(...)`. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int fxs_fail(fxs_message *message, const char *format, ...);

#ifdef __cplusplus
}
#endif

#endif
