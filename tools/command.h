/* The fixsplat command: what its sub-commands share. */
#ifndef COMMAND_H
#define COMMAND_H

#include <getopt.h>
#include <stdint.h>
#include <stdio.h>

#include <fixsplat/fixsplat.h>

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* The sub-commands; argv[0] is their name. They return the exit status. */
int command_render(int argc, char **argv);
int command_view(int argc, char **argv);
int command_bench(int argc, char **argv);
int command_info(int argc, char **argv);
int command_convert(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_fit(int argc, char **argv);
int command_make_scene(int argc, char **argv);

/* For main to call first: where what was printed does not arrive, the program says so and fails, wherever it ends. */
void check_printed_at_exit(void);

/* Prints "fixsplat: ..." on stderr and returns the status. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int fail(int status, const char *format, ...);

/* Prints "fixsplat: ..." on stderr too, but not with --quiet: what is worth knowing and no error. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void note(const char *format, ...);

/* --quiet: no notes and no progress, of this program and of those that it runs. */
void be_quiet(void);
int is_quiet(void);

void print_version(void);

/* The name that a word was probably meant to be, of all that were tried; null where none is near. */
typedef struct suggestion {
    const char *name;
    size_t distance;
} suggestion;
void suggest(suggestion *s, const char *word, size_t length, const char *name);

/* Writes and returns what is printed behind a message: how much memory it says is needed, or nothing. */
const char *needed_bytes(char text[64], const fxs_message *why);

/* Prints the message with that behind it, and returns EXIT_FAILED. */
int fail_for(const fxs_message *why);

/* What getopt_long returns for the options that several commands take; a command's own follow. */
enum { OPT_CAMERAS = 256, OPT_VIEW, OPT_EYE, OPT_LOOK, OPT_UP, OPT_FOV, OPT_ORTHO, OPT_NEAR, OPT_SIZE, OPT_BG,
       OPT_CUTOFF, OPT_SH_DEGREE, OPT_CPU, OPT_THREADS, OPT_MAX_MEMORY, OPT_BACKEND, OPT_DEVICE, OPT_LOD,
       OPT_PROFILE, OPT_STEREO, OPT_STEREO_EXACT, OPT_TANGENTS, OPT_FOVEATE, OPT_MAX_GAUSSIANS, OPT_IMPORT_MEMORY,
       OPT_AXES, OPT_SCENE, OPT_PLACE, OPT_QUIET, OPT_OWN };

/* What every command takes: the end of its getopt_long table, and letters. */
#define COMMON_OPTIONS \
    {"help", no_argument, 0, 'h'}, {"version", no_argument, 0, 'V'}, {"quiet", no_argument, 0, OPT_QUIET}, {0, 0, 0, 0}
#define COMMON_LETTERS "hV"

/* getopt_long, but for those, which are done here: `help` prints the help. Returns what that does; of a wrong option
   '?', when it has said so. */
int next_option(int argc, char **argv, const char *letters, const struct option *table, int *index, void (*help)(void));

/* Whole numbers and lists of numbers, checked; they return 0 where the text is anything else. */
int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out);
int parse_counts(const char *text, int count, int low, int high, int *out);   /* N,M,... */
int parse_bytes(const char *text, size_t *out);                     /* 1 or more; 64K, 3M, 2G: times 2^10, 2^20, 2^30 */
int parse_size(const char *text, int *width, int *height);          /* WxH, each 1 to 16384 */
int parse_vector(const char *text, int count, double *out);         /* X,Y,... */
int parse_colour(const char *text, uint8_t rgb[3]);                 /* RRGGBB */

/* Takes a whole number, the value of the option of that name. Returns 0, or prints what is wrong and returns
   EXIT_USAGE. */
int take_number(const char *name, const char *value, uint64_t low, uint64_t high, uint64_t *out);

/* The same for other types. */
int take_int(const char *name, const char *value, int low, int high, int *out);
int take_uint32(const char *name, const char *value, uint32_t low, uint32_t high, uint32_t *out);

/* Takes a size WxH in pixels. Returns as above. */
int take_size(const char *name, const char *value, int *width, int *height);

/* Takes the name of an output, the value of the option of that name, once. Returns as above. */
int take_output(const char *name, const char *value, const char **out);

/* Prints a text as a JSON string. */
void print_json_string(const char *text);

/* Whether a name has this ending, and something before it. */
int ends_with(const char *name, const char *ending);

/* A bar on stderr where that is a terminal, after a word on what is being done: an fxs_progress_fn. progress_end takes
   it away, before anything else is printed and between two labels. */
int progress_bar(void *label, double done);
void progress_end(void);

/* The same with any text, for a stderr that is a terminal: a line that the next one replaces. */
void progress_line(const char *text);

#endif
