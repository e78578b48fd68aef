/* What of the command needs libraries that are many, and that the rest does without, is a program beside it. */
#ifndef BESIDE_H
#define BESIDE_H

typedef struct beside_program {
    const char *ending;                     /* of its name, behind "fixsplat"; empty where it was not built, */
    const char *library;                    /* for want of this */
} beside_program;

extern const beside_program window_program, server_program;

/* Runs it in the place of this program, with the same arguments, argv[0] being the name of the command. Returns only
   where it cannot: prints why `shown` cannot be shown and returns EXIT_FAILED. */
int run_beside(const beside_program *program, const char *shown, char **argv);

#endif
