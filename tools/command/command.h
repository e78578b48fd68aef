/* Helpers for all parts of the command line program: messages, --quiet, progress. */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/message.h>

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* Makes the program fail at exit if stdout could not be written. */
void check_printed_at_exit(void);

/* Prints "fixsplat: ..." on stderr and returns `status`. */
int fail(int status, const char *format, ...) FXS_PRINTF(2, 3);

/* Returns the last message of fail, without the program's name. Empty: no failure yet. */
const char *last_failure(void);

/* Prints information to stderr, unless --quiet. */
void note(const char *format, ...) FXS_PRINTF(1, 2);

/* Turns off notes and progress, also in child programs (--quiet). */
void be_quiet(void);
int is_quiet(void);

/* Returns the digits for printing a coordinate with %.*g: at least `digits`, and enough for three decimals. */
int place_digits(double x, int digits);

void print_version(void);

/* The closest name to a misspelt word, over all calls of suggest. Null: no name is close. */
typedef struct suggestion {
    const char *name;
    size_t distance;
} suggestion;
void suggest(suggestion *s, const char *word, size_t length, const char *name);

/* Returns the memory that a failed call needed, as text to append to a message; empty: unknown. */
const char *needed_bytes(char text[64], const fxs_message *why);

/* Prints the message and the memory that was needed. Returns EXIT_FAILED. */
int fail_for(const fxs_message *why);

/* Output a text as a JSON string. */
void write_json_string(FILE *file, const char *text);
void print_json_string(const char *text);

/* Writes a space, then the word quoted for a shell. */
void write_shell_word(FILE *file, const char *word);

/* Tests for a file ending, in any case, after at least one character. */
int ends_with(const char *name, const char *ending);

/* An fxs_progress_fn that draws a progress bar if stderr is a terminal. Call progress_end before other output and
   before a new label. */
int progress_bar(void *label, double done);
void progress_end(void);

/* Replaces the last line of a terminal on stderr. */
void progress_line(const char *text);

#endif
