/* Tables of command-line options, with a row per option. The rows drive parsing, --help, suggestions for misspelt
   options, and shell completion. */
#ifndef COMMAND_LINE_H
#define COMMAND_LINE_H

#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct option_row option_row;

/* Parses the text of an option's value and stores the result in `field`. */
typedef int take_option(const option_row *row, void *field, const char *value);

struct option_row {
    const char *name;                       /* long name of the option; null: the row is a heading */
    const char *value;                      /* placeholder of the value in --help; null: no value */
    take_option *take;
    size_t offset;
    double low, high;
    const char *expected;                   /* description of the expected value, for error messages; null: automatic */
    const char *const *choices;
    const char *help;                       /* help text of the option; null: end of the table of options */
    char letter;
    int basic;                              /* 1: the short help lists the option, one of at most ten of a command */
};

/* Offset of a member in the struct OPTIONS. If the member is not of type `type`, the program does not compile. */
#define FIELD(type, member) (offsetof(OPTIONS, member) + 0 * sizeof(&((OPTIONS *)0)->member - (type *)1))
#define FIELD_OF_INT_SIZE(member) \
    (offsetof(OPTIONS, member) + 0 * sizeof(char[sizeof ((OPTIONS *)0)->member == sizeof(int) ? 1 : -1]))

/* Each macro fills in the parser, offset and allowed values of an option row. */
#define FLAG(member) take_flag, FIELD(int, member)
#define TEXT(member) take_text, FIELD(const char *, member)
#define OUTPUT(member) take_output, FIELD(const char *, member)
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
#define CHOICE(member, words) CHOICE_FROM(0, member, words)
#define WORDS(...) ((const char *const[]){__VA_ARGS__, 0})
#define ABOVE_0 0x1p-1074

typedef double vector_option[3];
typedef uint8_t colour_option[3];
typedef struct point_option {
    int given;
    double at[3];
} point_option;

take_option take_flag, take_text, take_output, take_int, take_uint32, take_uint64, take_size_t, take_bytes, take_real,
            take_vector, take_point, take_colour, take_choice;

/* Prints an error that says which value the option expects. Returns EXIT_USAGE. */
int wrong_value(const option_row *row, const char *value);

int choice_of(const option_row *row, const char *value);

typedef struct option_table {
    const option_row *rows;
    size_t offset;                          /* offset of the table's fields in the command's struct of options */
} option_table;

enum { TABLES_MOST = 12 };

typedef struct command {
    const char *name, *does;
    int (*run)(int argc, char **argv);
    const char *about;
    void (*more)(void);                     /* callback that prints more help after the list of options */
    const char *examples;                   /* example commands at the end of the help */
    option_table tables[TABLES_MOST];
} command;

extern const command command_render, command_view, command_info, command_convert, command_fit, command_compare,
                     command_mesh, command_collide, command_select, command_publish, command_make_scene, command_bench,
                     command_demo, command_doctor, command_associate;

/* Null-terminated array of all subcommands. */
extern const command *const *all_commands;

extern const option_row common_rows[];
#define COMMON_TABLE {common_rows, 0}

/* Parses the command line into the struct `options`. optind becomes the index of the first argument that is no
   option. --help and --version end the program. */
int take_options(const command *c, void *options, int argc, char **argv);

/* True if the command line has this option. Another command may have another option of that name. */
int is_given(const char *name);

/* Finds an option that is given and not in the list, which is separated by blanks. Returns its name; null: none. */
const char *given_beside(const char *list);

/* Writes the options of the command line with their values, as words for a shell, except the options in the list
   `left_out`, which is separated by blanks. */
void write_options_without(FILE *file, const char *left_out);

/* A rule about options of the command line. Lists of options are separated by blanks. */
typedef struct option_rule {
    const char *options;                    /* these options ... */
    const char *with;                       /* ... do nothing with any of these; null: in any case, */
    const char *unless;                     /* unless one of these is given */
    const char *why;                        /* end of the error message; null: none */
} option_rule;

/* Refuses an option that does nothing together with the others. The last rule has null `options`. */
int check_rules(const option_rule *rules);

void print_rows(const option_row *rows);

/* Prints a command's help. Commands with more than 12 options get a short help, unless `all` is nonzero. */
void print_help(const command *c, int all);

/* Prints a command's options as tab-separated lines, for shell completion. */
void print_table(const command *c);

/* Each function that parses numbers returns 1, or 0 for invalid text. */
int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out);
int parse_counts(const char *text, int count, int low, int high, int *out);
int parse_size(const char *text, int *width, int *height);
#define SIZE_EXPECTED "WxH, each 1 to 16384"
int parse_vector(const char *text, int count, double *out);

#endif
