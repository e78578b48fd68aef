/* Parses options by tables of rows (with getopt_long), prints --help, suggests options for misspelt ones, and
   converts values. */
#include "command_line.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "command.h"

const command *const *all_commands;
static const command *parsed;
static char **words;

/* Parses --help, --help=all and --help all. getopt_long does not parse the separate word `all`, so this function
   does. */
static int take_help(const option_row *row, void *field, const char *value)
{
    const char *next = words[optind];
    (void)field;
    if (value && choice_of(row, value) < 0)
        return wrong_value(row, value);
    print_help(parsed, value || (next && choice_of(row, next) >= 0));
    exit(EXIT_OK);
}

static int take_version(const option_row *row, void *field, const char *value)
{
    (void)row, (void)field, (void)value;
    print_version();
    exit(EXIT_OK);
}

static int take_quiet(const option_row *row, void *field, const char *value)
{
    (void)row, (void)field, (void)value;
    be_quiet();
    return 0;
}

const option_row common_rows[] = {
    {.help = "Options of every command:"},
    {"help", "[=all]", take_help, .choices = WORDS("all"), .letter = 'h', .help =
     "print usage, examples and the most used options; --help all lists every option"},
    {"version", 0, take_version, .help = "print the version of fixsplat", .letter = 'V'},
    {"quiet", 0, take_quiet, .help =
     "print errors only, no progress and no notes; the environment variable FIXSPLAT_QUIET=1 does the same"},
    {0}
};

enum { HELP_COLUMN = 22, HELP_WIDTH = 118, SHORT_ABOVE = 12, SHORT_EXAMPLES = 3 };

/* Prints a text with line breaks before column HELP_WIDTH. Lines begin in column `indent`. */
static void print_wrapped(const char *text, int indent)
{
    int column = indent;
    while (*text) {
        const int length = (int)strcspn(text, " ");
        if (column > indent && column + 1 + length > HELP_WIDTH)
            column = printf("\n%*s", indent, "") - 1;
        else if (column > indent)
            column += printf(" ");
        column += printf("%.*s", length, text);
        text += length + (text[length] == ' ');
    }
    putchar('\n');
}

static void print_row(const option_row *r)
{
    int column = printf("  ");
    if (r->letter)
        column += printf("-%c, ", r->letter);
    column += printf("--%s", r->name);
    if (r->value)
        column += printf(*r->value == '[' ? "%s" : " %s", r->value);
    if (column > HELP_COLUMN - 2) {
        putchar('\n');
        column = 0;
    }
    printf("%*s", HELP_COLUMN - column, "");
    print_wrapped(r->help, HELP_COLUMN);
}

void print_rows(const option_row *rows)
{
    for (; rows->help; rows++)
        if (rows->name) {
            print_row(rows);
        } else {
            putchar('\n');
            print_wrapped(rows->help, 0);
        }
}

static int count_options(const command *c)
{
    int count = 0;
    for (const option_table *t = c->tables; t->rows; t++)
        for (const option_row *r = t->rows; r->help; r++)
            count += r->name != 0;
    return count;
}

/* Returns the number of rows that it prints. */
static int print_basic_rows(const command *c)
{
    int count = 0;
    puts("\nOptions:");
    for (const option_table *t = c->tables; t->rows; t++)
        for (const option_row *r = t->rows; r->help; r++)
            if (r->basic) {
                print_row(r);
                count++;
            }
    return count;
}

static void print_first_examples(const char *examples)
{
    for (int i = 0; i < SHORT_EXAMPLES; i++) {
        const int length = (int)strcspn(examples, "\n") + 1;
        printf("%.*s", length, examples);
        examples += length;
    }
}

void print_help(const command *c, int all)
{
    const int count = count_options(c), is_short = !all && count > SHORT_ABOVE;
    fputs(c->about, stdout);
    const int shown = is_short ? print_basic_rows(c) : 0;
    for (const option_table *t = c->tables; t->rows && !is_short; t++)
        print_rows(t->rows);
    if (c->more)
        c->more();
    puts("\nExamples:");
    if (is_short) {
        print_first_examples(c->examples);
        printf("\nfixsplat %s --help all: %d more options\n", c->name, count - shown);
    } else {
        fputs(c->examples, stdout);
    }
}

void print_table(const command *c)
{
    for (const option_table *t = c->tables; t->rows; t++)
        for (const option_row *r = t->rows; r->help; r++) {
            if (!r->name)
                continue;
            printf("%s\t%s\t%.1s\t%s\t", c->name, r->name, &r->letter, r->value ? r->value : "");
            for (int i = 0; r->choices && r->choices[i]; i++)
                printf(i ? " %s" : "%s", r->choices[i]);
            printf("\t%s\n", r->help);
        }
}

/* getopt_long returns the letter of an option, or LONG_OPTION + i for option row i. */
enum { ROWS_MOST = 96, LONG_OPTION = 256 };

static struct row_taken {
    const option_row *row;
    char *options;                          /* base address of the struct that the row's offset refers to */
    int given;
} taken[ROWS_MOST];

static void list_rows(const command *c, void *options, struct option table[ROWS_MOST], char letters[2 * ROWS_MOST])
{
    int count = 0;
    assert(!c->tables[TABLES_MOST - 1].rows);
    for (const option_table *t = c->tables; t->rows; t++)
        for (const option_row *r = t->rows; r->help; r++)
            if (r->name) {
                assert(count < ROWS_MOST - 1);
                const int argument = !r->value ? no_argument : *r->value == '[' ? optional_argument : required_argument;
                taken[count] = (struct row_taken){r, (char *)options + t->offset, 0};
                table[count] = (struct option){r->name, argument, 0, LONG_OPTION + count};
                if (r->letter) {
                    *letters++ = r->letter;
                    if (argument == required_argument)
                        *letters++ = ':';
                }
                count++;
            }
    taken[count].row = 0;
    table[count] = (struct option){0};
    *letters = 0;
}

static struct row_taken *find_row(int option)
{
    struct row_taken *t = taken;
    if (option >= LONG_OPTION)
        return taken + (option - LONG_OPTION);
    while (t->row->letter != option)
        t++;
    return t;
}

int is_given(const char *name)
{
    const struct row_taken *t = taken;
    while (t->row && strcmp(t->row->name, name))
        t++;
    return t->row && t->given;
}

static int is_in(const char *list, const char *name)
{
    const size_t wanted = strlen(name);
    for (size_t length; *list; list += length + (list[length] == ' ')) {
        length = strcspn(list, " ");
        if (length == wanted && !strncmp(list, name, length))
            return 1;
    }
    return 0;
}

const char *given_beside(const char *list)
{
    for (const struct row_taken *t = taken; t->row; t++)
        if (t->given && !is_in(list, t->row->name))
            return t->row->name;
    return 0;
}

/* Finds the first option of a list that is given. Returns 0 if none is. */
static int first_given(const char *list, char name[32])
{
    for (size_t length; list && *list; list += length + (list[length] == ' ')) {
        length = strcspn(list, " ");
        snprintf(name, 32, "%.*s", (int)length, list);
        if (is_given(name))
            return 1;
    }
    return 0;
}

/* Prints "--a", or "--a, --b or --c" for a list. */
static void print_options(char *out, size_t room, const char *list)
{
    size_t used = 0;
    for (size_t length; *list; list += length + (list[length] == ' ')) {
        length = strcspn(list, " ");
        const char *between = !used ? "" : strchr(list, ' ') ? ", " : " or ";
        used += (size_t)snprintf(out + used, room - used, "%s--%.*s", between, (int)length, list);
    }
}

int check_rules(const option_rule *rules)
{
    char name[32], other[32], wanted[160];
    for (const option_rule *r = rules; r->options; r++) {
        if (!first_given(r->options, name) || (r->unless && first_given(r->unless, other)))
            continue;
        const char *why = r->why ? r->why : "", *colon = r->why ? ": " : "";
        if (r->with && first_given(r->with, other))
            return fail(EXIT_USAGE, "--%s does not go with --%s%s%s", name, other, colon, why);
        if (r->with)
            continue;
        print_options(wanted, sizeof wanted, r->unless);
        return fail(EXIT_USAGE, "--%s needs %s%s%s", name, wanted, colon, why);
    }
    return 0;
}

static int wrong_word(char **argv)
{
    const char *before = argv[optind - 1];
    const int is_letter = optopt > 0 && optopt < LONG_OPTION;
    return is_letter && (before[0] != '-' || before[strlen(before) - 1] != optopt) ? optind : optind - 1;
}

static const command *command_with(const char *name, size_t length)
{
    for (const command *const *c = all_commands; c && *c; c++)
        for (const option_table *t = (*c)->tables; t->rows; t++)
            for (const option_row *r = t->rows; r->help; r++)
                if (r->name && strlen(r->name) == length && !strncmp(r->name, name, length))
                    return *c;
    return 0;
}

static int say_wrong_option(char **argv, const char *letters)
{
    const char *word = argv[wrong_word(argv)], *name = word + strspn(word, "-");
    const char *own = parsed->name;          /* the command's name; argv[0] may be a path instead */
    const size_t length = strcspn(name, "=");
    const int is_letter = optopt > 0 && optopt < LONG_OPTION && strchr(letters, optopt);
    suggestion s = {0, 0};
    if (is_letter || optopt >= LONG_OPTION)
        return fail(EXIT_USAGE, "%s: %s: %s; see: fixsplat %s --help", own, word,
                    strchr(word, '=') ? "it takes no value" : "its value is missing", own);
    const command *other = name == word + 2 ? command_with(name, length) : 0;
    if (other)
        return fail(EXIT_USAGE, "%s: unknown option: %s, which fixsplat %s has; see: fixsplat %s --help", own, word,
                    other->name, own);
    for (const struct row_taken *t = taken; t->row; t++)
        suggest(&s, name, length, t->row->name);
    if (s.name)
        return fail(EXIT_USAGE, "%s: unknown option: %s; did you mean --%s? See: fixsplat %s --help", own, word,
                    s.name, own);
    return fail(EXIT_USAGE, "%s: unknown option: %s; see: fixsplat %s --help", own, word, own);
}

/* Finds the option that a word of the command line gives: a letter, a name or the beginning of one. Null: none. */
static const option_row *row_of_word(const char *word)
{
    const option_row *found = 0;
    const int is_long = !strncmp(word, "--", 2);
    const size_t length = is_long ? strcspn(word + 2, "=") : 0;
    for (const struct row_taken *t = taken; t->row && *word == '-'; t++) {
        const int begins = length && !strncmp(t->row->name, word + 2, length);
        if (is_long ? begins && (!found || !t->row->name[length]) : t->row->letter && t->row->letter == word[1])
            found = t->row;
    }
    return found;
}

void write_options_without(FILE *file, const char *left_out)
{
    for (char **word = words + 1; word < words + optind; word++) {
        const option_row *row = row_of_word(*word);
        const int is_whole = strncmp(*word, "--", 2) ? (*word)[1] && (*word)[2] : strchr(*word, '=') != 0;
        const int count = row && row->value && row->value[0] != '[' && !is_whole ? 2 : 1;
        for (int i = 0; i < count && row && !is_in(left_out, row->name); i++)
            write_shell_word(file, word[i]);
        word += count - 1;
    }
}

/* Converts an option's value, if it is a file path, from the operating system's form. */
static void take_path(const option_row *r, char *value)
{
    if (value && strcmp(r->value, "TEXT"))
        fxs_path_take(value);
}

int take_options(const command *c, void *options, int argc, char **argv)
{
    struct option table[ROWS_MOST];
    char letters[2 * ROWS_MOST];
    parsed = c;
    words = argv;
    list_rows(c, options, table, letters);
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, letters, table, 0)) != -1;) {
        if (option == '?')
            return say_wrong_option(argv, letters);
        struct row_taken *t = find_row(option);
        t->given = 1;
        take_path(t->row, optarg);
        if (t->row->take(t->row, t->options + t->row->offset, optarg))
            return EXIT_USAGE;
    }
    for (char **word = argv + optind; word < argv + argc; word++)
        fxs_path_take(*word);
    return 0;
}

static void join_choices(char *text, size_t room, const char *const *choices)
{
    size_t used = 0;
    for (int i = 0; choices[i] && used < room; i++)
        used += (size_t)snprintf(text + used, room - used, "%s%s",
                                 !i ? "" : choices[i + 1] ? ", " : " or ", choices[i]);
}

int wrong_value(const option_row *r, const char *value)
{
    char expected[256];
    if (r->expected)
        snprintf(expected, sizeof expected, "%s", r->expected);
    else if (r->choices)
        join_choices(expected, sizeof expected, r->choices);
    else if (isinf(r->high))
        snprintf(expected, sizeof expected, "a whole number from %.0f on", r->low);
    else
        snprintf(expected, sizeof expected, "a whole number from %.0f to %.0f", r->low, r->high);
    return fail(EXIT_USAGE, "--%s%c%s: expected %s", r->name, r->value[0] == '[' ? '=' : ' ', value, expected);
}

int take_flag(const option_row *row, void *field, const char *value)
{
    (void)row, (void)value;
    *(int *)field = 1;
    return 0;
}

int take_text(const option_row *row, void *field, const char *value)
{
    (void)row;
    *(const char **)field = value;
    return 0;
}

int take_output(const option_row *row, void *field, const char *value)
{
    const char **name = field;
    if (*name)
        return fail(EXIT_USAGE, "--%s %s: --%s %s is given before", row->name, value, row->name, *name);
    *name = value;
    return 0;
}

int take_uint64(const option_row *row, void *field, const char *value)
{
    uint64_t number;
    if (!parse_count(value, 0, UINT64_MAX, &number) || (double)number < row->low || (double)number > row->high)
        return wrong_value(row, value);
    *(uint64_t *)field = number;
    return 0;
}

int take_uint32(const option_row *row, void *field, const char *value)
{
    uint64_t number = *(uint32_t *)field;
    const int status = take_uint64(row, &number, value);
    *(uint32_t *)field = (uint32_t)number;
    return status;
}

int take_int(const option_row *row, void *field, const char *value)
{
    uint64_t number = 0;
    const int status = take_uint64(row, &number, value);
    *(int *)field = (int)number;
    return status;
}

int take_size_t(const option_row *row, void *field, const char *value)
{
    uint64_t number = 0;
    const int status = take_uint64(row, &number, value);
    *(size_t *)field = (size_t)number;
    return status;
}

int take_real(const option_row *row, void *field, const char *value)
{
    double *number = field;
    return parse_vector(value, 1, number) && *number >= row->low && *number <= row->high ? 0 : wrong_value(row, value);
}

int take_choice(const option_row *row, void *field, const char *value)
{
    const int choice = choice_of(row, value);
    *(int *)field = (int)row->low + choice;
    return choice < 0 ? wrong_value(row, value) : 0;
}

int choice_of(const option_row *row, const char *value)
{
    for (int i = 0; row->choices[i]; i++)
        if (!strcmp(value, row->choices[i]))
            return i;
    return -1;
}

int take_bytes(const option_row *row, void *field, const char *value)
{
    static const char units[] = "KMG";
    char *end;
    errno = 0;
    const unsigned long long number = strtoull(value, &end, 10);
    const char *unit = *end ? strchr(units, *end) : 0;
    const int shift = unit ? 10 * (int)(unit - units + 1) : 0;
    if (*value < '0' || *value > '9' || errno || !number || number > SIZE_MAX >> shift || (*end && (!unit || end[1])))
        return wrong_value(row, value);
    *(size_t *)field = (size_t)number << shift;
    return 0;
}

int take_vector(const option_row *row, void *field, const char *value)
{
    return parse_vector(value, 3, field) ? 0 : wrong_value(row, value);
}

int take_point(const option_row *row, void *field, const char *value)
{
    point_option *point = field;
    point->given = 1;
    return take_vector(row, point->at, value);
}

int take_colour(const option_row *row, void *field, const char *value)
{
    uint8_t *rgb = field;
    if (strlen(value) != 6 || strspn(value, "0123456789abcdefABCDEF") != 6)
        return wrong_value(row, value);
    const unsigned long number = strtoul(value, 0, 16);
    for (int i = 0; i < 3; i++)
        rgb[i] = (uint8_t)(number >> (16 - 8 * i));
    return 0;
}

int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out)
{
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    *out = value;
    return text[0] >= '0' && text[0] <= '9' && !*end && !errno && value >= low && value <= high;
}

int parse_counts(const char *text, int count, int low, int high, int *out)
{
    for (int i = 0; i < count; i++) {
        char number[24];
        uint64_t value;
        const size_t length = strcspn(text, ",");
        if (length >= sizeof number || (text[length] == ',') != (i < count - 1))
            return 0;
        memcpy(number, text, length);
        number[length] = 0;
        if (!parse_count(number, (uint64_t)low, (uint64_t)high, &value))
            return 0;
        out[i] = (int)value;
        text += length + 1;
    }
    return 1;
}

int parse_size(const char *text, int *width, int *height)
{
    uint64_t w, h;
    char first[16];
    const char *x = strchr(text, 'x');
    size_t length = x ? (size_t)(x - text) : 0;
    if (!length || length >= sizeof first)
        return 0;
    memcpy(first, text, length);
    first[length] = 0;
    if (!parse_count(first, 1, FXS_MAX_SIZE, &w) || !parse_count(x + 1, 1, FXS_MAX_SIZE, &h))
        return 0;
    *width = (int)w;
    *height = (int)h;
    return 1;
}

int parse_vector(const char *text, int count, double *out)
{
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || !isfinite(out[i]) || *end != (i < count - 1 ? ',' : 0))
            return 0;
        text = end + 1;
    }
    return 1;
}
