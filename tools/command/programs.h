/* Starts the separate programs that run subcommands with heavy libraries (SDL, libmicrohttpd). */
#ifndef PROGRAMS_H
#define PROGRAMS_H

typedef struct separate_program {
    const char *ending;                     /* last part of the program's file name; empty: the program was not built */
    const char *library;
} separate_program;

extern const separate_program window_program, server_program;

/* Replaces this process by `program`, with the same arguments. Returns only on failure, and then prints that `shown`
   cannot be shown. */
int run_separate(const separate_program *program, const char *shown, char **argv);

#endif
