/* Shared by all parts of the fixsplat command: messages, --quiet, progress. */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/message.h>

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* For main to call first: where what was printed does not arrive, the program says so and fails, wherever it ends. */
void check_printed_at_exit(void);

/* Prints "fixsplat: ..." on stderr and returns the status. */
int fail(int status, const char *format, ...) FXS_PRINTF(2, 3);

/* What fail printed last, without the program's name; empty: nothing yet. */
const char *last_failure(void);

/* The same as fail for news that are no error: not printed with --quiet. */
void note(const char *format, ...) FXS_PRINTF(1, 2);

/* --quiet: no notes and no progress, of this program and of the programs that it runs. */
void be_quiet(void);
int is_quiet(void);

/* The digits for %.*g by which a coordinate is printed: `digits`, or far out more, up to the third behind the point. */
int place_digits(double x, int digits);

void print_version(void);

/* The name that a word was probably meant to be, of all that were tried; null where none is near. */
typedef struct suggestion {
    const char *name;
    size_t distance;
} suggestion;
void suggest(suggestion *s, const char *word, size_t length, const char *name);

/* Writes and returns the words on how much memory would do, for behind the message; empty where it does not say. */
const char *needed_bytes(char text[64], const fxs_message *why);

/* Prints the message with those words behind it, and returns EXIT_FAILED. */
int fail_for(const fxs_message *why);

/* Writes, or prints, a text as a JSON string. */
void write_json_string(FILE *file, const char *text);
void print_json_string(const char *text);

/* Writes a space, and a word as a shell takes it. */
void write_shell_word(FILE *file, const char *word);

/* Whether a name has this ending, also in capitals, and something before it. */
int ends_with(const char *name, const char *ending);

/* A bar on stderr where that is a terminal, after a word on what is being done: an fxs_progress_fn. progress_end takes
   it away, before anything else is printed and between two labels. */
int progress_bar(void *label, double done);
void progress_end(void);

/* The same with any text, for a stderr that is a terminal: a line that the next one replaces. */
void progress_line(const char *text);

#endif
