/* Options as tables with one row per option. The rows drive parsing, --help, suggestions for misspelt options, and
   shell completion. */
#ifndef COMMAND_LINE_H
#define COMMAND_LINE_H

#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>

typedef struct option_row option_row;

/* Parses the value of an option (null: no value) into its field. Returns 0, or prints the error and returns
   EXIT_USAGE. */
typedef int take_option(const option_row *row, void *field, const char *value);

struct option_row {
    const char *name;                       /* null: the row is a heading */
    const char *value;                      /* placeholder in --help; null: no value; [=...]: optional */
    take_option *take;
    size_t offset;                          /* offset of the field in the struct of options */
    double low, high;                       /* range of a number; INFINITY: no limit */
    const char *expected;                   /* in words, for messages; null: derived from range or choices */
    const char *const *choices;             /* allowed words, ended by null; null: any */
    const char *help;                       /* a paragraph without line breaks; null: end of the table */
    char letter;                            /* short name or 0 */
    int basic;                              /* 1: also in the short help */
};

/* Returns the offset of a member of OPTIONS. A member of another type fails to compile. */
#define FIELD(type, member) (offsetof(OPTIONS, member) + 0 * sizeof(&((OPTIONS *)0)->member - (type *)1))
#define FIELD_OF_INT_SIZE(member) \
    (offsetof(OPTIONS, member) + 0 * sizeof(char[sizeof ((OPTIONS *)0)->member == sizeof(int) ? 1 : -1]))

/* Each macro fills the parser, offset and allowed values of an option row. */
#define FLAG(member) take_flag, FIELD(int, member)
#define TEXT(member) take_text, FIELD(const char *, member)
#define OUTPUT(member) take_output, FIELD(const char *, member)                 /* path; may be given once */
#define INT(member, low, high) take_int, FIELD(int, member), low, high
#define UINT32(member, low, high) take_uint32, FIELD(uint32_t, member), low, high
#define UINT64(member, low, high) take_uint64, FIELD(uint64_t, member), low, high
#define SIZE_T(member, low, high) take_size_t, FIELD(size_t, member), low, high
#define BYTES(member) \
    take_bytes, FIELD(size_t, member), .expected = "bytes, or a number with K, M or G"
#define REAL(member, low, high, expected) take_real, FIELD(double, member), low, high, expected
#define VECTOR(member, expected) take_vector, FIELD(vector_option, member), 0, 0, expected
#define POINT(member) take_point, FIELD(point_option, member), .expected = "three numbers X,Y,Z"
#define COLOUR(member) take_colour, FIELD(colour_option, member), .expected = "six hex digits RRGGBB"
#define CHOICE_FROM(first, member, words) take_choice, FIELD_OF_INT_SIZE(member), first, .choices = words
#define CHOICE(member, words) CHOICE_FROM(0, member, words)                     /* an enum; the first word is 0 */
#define WORDS(...) ((const char *const[]){__VA_ARGS__, 0})
#define ABOVE_0 0x1p-1074                                                       /* smallest positive double */

/* Field types of VECTOR, COLOUR and POINT. */
typedef double vector_option[3];
typedef uint8_t colour_option[3];
typedef struct point_option {
    int given;
    double at[3];
} point_option;

take_option take_flag, take_text, take_output, take_int, take_uint32, take_uint64, take_size_t, take_bytes, take_real,
            take_vector, take_point, take_colour, take_choice;

/* Prints the value that the option expects, and returns EXIT_USAGE. */
int wrong_value(const option_row *row, const char *value);

/* Returns the index of a value in the row's choices; -1: not found. */
int choice_of(const option_row *row, const char *value);

typedef struct option_table {
    const option_row *rows;                 /* ended by a row of zeros */
    size_t offset;                          /* offset of the table's struct in the command's options */
} option_table;

enum { TABLES_MOST = 10 };

typedef struct command {
    const char *name, *does;                /* `does`: a line for the list of commands */
    int (*run)(int argc, char **argv);      /* argv[0] is the subcommand; returns the exit status */
    const char *about;                      /* start of --help */
    void (*more)(void);                     /* prints help after the options, or null */
    const char *examples;                   /* end of --help; the short help has three lines */
    option_table tables[TABLES_MOST];       /* ends with COMMON_TABLE */
} command;

extern const command command_render, command_view, command_info, command_convert, command_fit, command_compare,
                     command_publish, command_make_scene, command_bench, command_demo, command_doctor;

/* Commands of the program, ended by null. Null: unknown. */
extern const command *const *all_commands;

extern const option_row common_rows[];
#define COMMON_TABLE {common_rows, 0}

/* Parses argv into the struct `options`. optind becomes the index of the first argument that is no option. Returns
   0, or prints the error and returns EXIT_USAGE. --help and --version end the program. */
int take_options(const command *c, void *options, int argc, char **argv);

/* Tests whether the command line had an option. The command must define the option. */
int is_given(const char *name);

void print_rows(const option_row *rows);

/* Prints a command's help. Commands with more than 25 options get a short help, unless `all` is nonzero. */
void print_help(const command *c, int all);

/* Prints a tab-separated line per option: command, name, letter, value, choices, help. */
void print_table(const command *c);

/* The parsers of numbers return 1, or 0 for any other text. */
int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out);
int parse_counts(const char *text, int count, int low, int high, int *out);    /* N,M,... */
int parse_size(const char *text, int *width, int *height);                     /* WxH */
#define SIZE_EXPECTED "WxH, each 1 to 16384"                                   /* FXS_MAX_SIZE */
int parse_vector(const char *text, int count, double *out);                    /* X,Y,... */

#endif
