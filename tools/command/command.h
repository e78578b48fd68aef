/* Shared by all parts of the command: messages, --quiet, progress. */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* Call first in main: at exit, output that could not be written is reported, and the program fails. */
void check_printed_at_exit(void);

/* Prints "fixsplat: ..." on stderr and returns `status`. */
int fail(int status, const char *format, ...) FXS_PRINTF(2, 3);

/* The last message of fail, without the program's name; empty: none yet. */
const char *last_failure(void);

/* Prints like fail, for information. Silent with --quiet. */
void note(const char *format, ...) FXS_PRINTF(1, 2);

/* --quiet: no notes and no progress, here and in child programs. */
void be_quiet(void);
int is_quiet(void);

/* The digits for %.*g of a coordinate: `digits`, or more for large x, to keep three decimals. */
int place_digits(double x, int digits);

void print_version(void);

/* Collects the closest name to a misspelt word over all calls of suggest; null if none is close. */
typedef struct suggestion {
    const char *name;
    size_t distance;
} suggestion;
void suggest(suggestion *s, const char *word, size_t length, const char *name);

/* Writes and returns text about the memory needed, to append to the message; empty if unknown. */
const char *needed_bytes(char text[64], const fxs_message *why);

/* Prints the message with the memory needed, and returns EXIT_FAILED. */
int fail_for(const fxs_message *why);

/* Writes, or prints, a text as a JSON string. */
void write_json_string(FILE *file, const char *text);
void print_json_string(const char *text);

/* Writes a space and the word, quoted for a shell. */
void write_shell_word(FILE *file, const char *word);

/* True if a name has the ending, in any case, after at least one character. */
int ends_with(const char *name, const char *ending);

/* An fxs_progress_fn: a bar on stderr, if that is a terminal, after the label. Call progress_end before other output
   and between two labels. */
int progress_bar(void *label, double done);
void progress_end(void);

/* A line of any text, replaced by the next one; for a stderr that is a terminal. */
void progress_line(const char *text);

#endif
