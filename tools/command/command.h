/* Helper functions of all subcommands: messages, --quiet, progress. In the folder tools, a function that can fail
   returns 0, or prints the error and returns an exit status, unless its comment says otherwise. */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/internal/message.h>

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* Makes the program fail at exit if standard output could not be written. */
void check_printed_at_exit(void);

/* Prints "fixsplat: ..." to stderr and returns `status`. */
int fail(int status, const char *format, ...) FXS_PRINTF(2, 3);

const char *last_failure(void);

void note(const char *format, ...) FXS_PRINTF(1, 2);

void be_quiet(void);
int is_quiet(void);

/* Returns the number of digits for printing a coordinate: at least `digits`, and enough for three decimals. */
int place_digits(double x, int digits);

/* Print a point or a box to standard output, as text after a blank, or as JSON. The text of a box ends its line. */
void print_place(const double v[3]);
void print_box(const double low[3], const double high[3]);
void print_vector_json(const double v[3]);
void print_box_json(const double low[3], const double high[3]);

void print_version(void);

/* Finds the known name that is closest to a misspelt word, over several calls of suggest. A null name: none is
   close. */
typedef struct suggestion {
    const char *name;
    size_t distance;
} suggestion;
void suggest(suggestion *s, const char *word, size_t length, const char *name);

/* Describes how much memory a failed call needed, as text for an error message. */
const char *needed_bytes(char text[64], const fxs_message *why);

/* Prints the message of a failed library call. Returns EXIT_FAILED. */
int fail_for(const fxs_message *why);

void write_json_string(FILE *file, const char *text);
void print_json_string(const char *text);

/* Writes a space and a word, quoted for a shell. */
void write_shell_word(FILE *file, const char *word);

/* True if a file name has the ending, in upper or lower case. */
int ends_with(const char *name, const char *ending);

/* True if a file name has exactly one % conversion, %d with an optional zero-padded width. */
int is_pattern(const char *name);

/* Writes the file name of number `index`; a name that is no pattern stays as it is. */
void name_numbered(char *name, size_t size, const char *pattern, long index);

/* Draws a progress bar if stderr is a terminal. Call progress_end before other output and before a new label. */
int progress_bar(void *label, double done);
void progress_end(void);

void progress_line(const char *text);

#endif
