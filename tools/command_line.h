/* Options: each one is a row of a table, and a command has a list of tables. From the rows come the options that are
   taken, the text of --help, the guess at what a wrong option was meant to be, and what a shell completes. */
#ifndef COMMAND_LINE_H
#define COMMAND_LINE_H

#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>

typedef struct option_row option_row;

/* Takes the value of an option, null where it has none, into the field that the row names. Returns 0, or prints what is
   wrong and returns EXIT_USAGE. */
typedef int take_option(const option_row *row, void *field, const char *value);

struct option_row {
    const char *name;                       /* the long one; null: a heading */
    const char *value;                      /* how --help calls the value; null: there is none; [=...]: there may be */
    take_option *take;
    size_t offset;                          /* of the field in the struct of the options */
    double low, high;                       /* range of a number; INFINITY: any */
    const char *expected;                   /* the value in words, for messages; null: by range or choices */
    const char *const *choices;             /* words that the value is one of, and a null; null: any */
    const char *help;                       /* one paragraph, which --help breaks into lines; null: end of the table */
    char letter;                            /* the short name, or 0 */
};

/* Where a member of the struct OPTIONS is. One of another type does not compile: pointers to two types have no
   difference, and no array has -1 members. */
#define FIELD(type, member) (offsetof(OPTIONS, member) + 0 * sizeof(&((OPTIONS *)0)->member - (type *)1))
#define FIELD_OF_INT_SIZE(member) \
    (offsetof(OPTIONS, member) + 0 * sizeof(char[sizeof ((OPTIONS *)0)->member == sizeof(int) ? 1 : -1]))

/* The middle of a row, for a member of OPTIONS: how it is taken, where to, and which values. */
#define FLAG(member) take_flag, FIELD(int, member)                              /* 1 */
#define TEXT(member) take_text, FIELD(const char *, member)
#define OUTPUT(member) take_output, FIELD(const char *, member)                 /* name of a file, given once */
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
#define CHOICE(member, words) CHOICE_FROM(0, member, words)                     /* an enum, whose 0 is the first word */
#define WORDS(...) ((const char *const[]){__VA_ARGS__, 0})
#define ABOVE_0 0x1p-1074                                                       /* the least number above 0 */

/* Fields of VECTOR, COLOUR and POINT. */
typedef double vector_option[3];
typedef uint8_t colour_option[3];
typedef struct point_option {
    int given;
    double at[3];
} point_option;

take_option take_flag, take_text, take_output, take_int, take_uint32, take_uint64, take_size_t, take_bytes, take_real,
            take_vector, take_point, take_colour, take_choice;

/* For those of a command: prints what a row expects, and returns EXIT_USAGE. */
int wrong_value(const option_row *row, const char *value);

/* Which of the row's choices a value is, from 0 on; -1: none. */
int choice_of(const option_row *row, const char *value);

typedef struct option_table {
    const option_row *rows;                 /* up to one that is all 0 */
    size_t offset;                          /* in a command's options, of the struct that the rows are of */
} option_table;

enum { TABLES_MOST = 10 };

typedef struct command {
    const char *name, *does;                /* does: a line in the list of commands */
    int (*run)(int argc, char **argv);      /* argv[0] is the name; returns the exit status */
    const char *about;                      /* --help: usage and what it does, then the options, */
    void (*more)(void);                     /* what follows them, or null, */
    const char *examples;                   /* and lines of examples */
    option_table tables[TABLES_MOST];       /* COMMON_TABLE is the last one; one more without rows ends them */
} command;

extern const command command_render, command_view, command_info, command_convert, command_fit, command_compare,
                     command_publish, command_make_scene, command_bench, command_demo, command_doctor;

/* The commands of the program up to a null, for messages; null: they are not known. */
extern const command *const *all_commands;

/* --help, --version, --quiet. */
extern const option_row common_rows[];
#define COMMON_TABLE {common_rows, 0}

/* Takes the options of argv into the struct `options`; optind is the first of the other arguments then. Returns 0, or
   prints what is wrong and returns EXIT_USAGE; after --help and --version the program ends. */
int take_options(const command *c, void *options, int argc, char **argv);

/* Whether the options that were taken had this one, which the command has. */
int is_given(const char *name);

void print_rows(const option_row *rows);
void print_help(const command *c);

/* The rows for programs, a line each: command, name, letter, value, choices, help; tabs between. */
void print_table(const command *c);

/* Texts as numbers, checked; they return 0 where the text is anything else. */
int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out);
int parse_counts(const char *text, int count, int low, int high, int *out);    /* N,M,... */
int parse_size(const char *text, int *width, int *height);                     /* WxH, */
#define SIZE_EXPECTED "WxH, each 1 to 16384"                                   /* FXS_MAX_SIZE */
int parse_vector(const char *text, int count, double *out);                    /* X,Y,... */

#endif
