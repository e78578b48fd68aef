/* Starts the separate programs that run subcommands with heavy libraries (SDL, libmicrohttpd). */
#ifndef BESIDE_H
#define BESIDE_H

typedef struct beside_program {
    const char *ending;                     /* last part of the program's file name; empty: the program was not built */
    const char *library;
} beside_program;

extern const beside_program window_program, server_program;

/* Replaces this process by `program`, with the same arguments. Returns only on failure, and then prints that `shown`
   cannot be shown. */
int run_beside(const beside_program *program, const char *shown, char **argv);

#endif
