/* Subcommands with heavy libraries (SDL, libmicrohttpd) are separate programs in the same folder, started here. */
#ifndef BESIDE_H
#define BESIDE_H

typedef struct beside_program {
    const char *ending;                     /* name of the program after "fixsplat"; empty: not built */
    const char *library;                    /* the library that it needs */
} beside_program;

extern const beside_program window_program, server_program;

/* Replaces this process by the program, with the same arguments; argv[0] is the command's name. Returns only on
   failure: prints why `shown` cannot be shown and returns EXIT_FAILED. */
int run_beside(const beside_program *program, const char *shown, char **argv);

#endif
