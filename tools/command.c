#include "command.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void say(const char *format, va_list arguments)
{
    progress_end();
    fputs("fixsplat: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
}

int fail(int status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(format, arguments);
    va_end(arguments);
    return status;
}

/* ---- What every command takes ---------------------------------------------------------------------------------- */

/* In the environment, so that the programs of `view` have it too. */
static const char quiet_variable[] = "FIXSPLAT_QUIET";

void be_quiet(void)
{
    setenv(quiet_variable, "1", 1);
}

int is_quiet(void)
{
    return getenv(quiet_variable) != 0;
}

void note(const char *format, ...)
{
    va_list arguments;
    if (is_quiet())
        return;
    va_start(arguments, format);
    say(format, arguments);
    va_end(arguments);
}

void print_version(void)
{
    puts("fixsplat " FXS_VERSION);
}

enum { LONGEST_NAME = 32 };

/* How many letters are to be put in, left out or changed to make one of the other (Levenshtein 1966): row i of the
   table is of i letters of a. */
static size_t edit_distance(const char *a, size_t length, const char *b)
{
    size_t row[LONGEST_NAME + 1];
    const size_t columns = strlen(b);
    for (size_t k = 0; k <= columns; k++)
        row[k] = k;
    for (size_t i = 0; i < length; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t k = 0; k < columns; k++) {
            const size_t changed = diagonal + (a[i] != b[k]);
            const size_t shorter = row[k] < row[k + 1] ? row[k] + 1 : row[k + 1] + 1;
            diagonal = row[k + 1];
            row[k + 1] = changed < shorter ? changed : shorter;
        }
    }
    return row[columns];
}

void suggest(suggestion *s, const char *word, size_t length, const char *name)
{
    if (length > LONGEST_NAME || strlen(name) > LONGEST_NAME)
        return;
    const size_t distance = edit_distance(word, length, name);
    if (distance <= 1 + length / 4 && (!s->name || distance < s->distance)) {
        s->name = name;
        s->distance = distance;
    }
}

/* The word that getopt_long refused: in the middle of several letters it has not gone on to the next one yet. */
static int wrong_word(char **argv)
{
    const char *before = argv[optind - 1];
    const int is_letter = optopt > 0 && optopt < 256;
    return is_letter && (before[0] != '-' || before[strlen(before) - 1] != optopt) ? optind : optind - 1;
}

static void say_wrong_option(char **argv, const char *letters, const struct option *table)
{
    const char *word = argv[wrong_word(argv)], *name = word + strspn(word, "-");
    const int is_letter = optopt > 0 && optopt < 256 && strchr(letters, optopt);
    suggestion s = {0, 0};
    for (; table->name; table++)
        suggest(&s, name, strcspn(name, "="), table->name);
    if (is_letter || (s.name && !s.distance && name == word + 2))
        fail(EXIT_USAGE, "%s: %s: %s; see: fixsplat %s --help", argv[0], word,
             strchr(word, '=') ? "it takes no value" : "its value is missing", argv[0]);
    else if (s.name)
        fail(EXIT_USAGE, "%s: unknown option: %s; did you mean --%s? See: fixsplat %s --help", argv[0], word, s.name,
             argv[0]);
    else
        fail(EXIT_USAGE, "%s: unknown option: %s; see: fixsplat %s --help", argv[0], word, argv[0]);
}

int next_option(int argc, char **argv, const char *letters, const struct option *table, int *index, void (*help)(void))
{
    int option;
    opterr = 0;
    while ((option = getopt_long(argc, argv, letters, table, index)) == OPT_QUIET)
        be_quiet();
    if (option == 'h' || option == 'V') {
        (option == 'h' ? help : print_version)();
        exit(EXIT_OK);
    }
    if (option == '?')
        say_wrong_option(argv, letters, table);
    return option;
}

/* ---- Messages of other parts ------------------------------------------------------------------------------------- */

const char *needed_bytes(char text[64], const fxs_message *why)
{
    text[0] = 0;
    if (why->bytes_needed)
        snprintf(text, 64, ": it needs at least %" PRIu64 " bytes", why->bytes_needed);
    return text;
}

int fail_for(const fxs_message *why)
{
    char needed[64];
    return fail(EXIT_FAILED, "%s%s", why->text, needed_bytes(needed, why));
}

/* ---- Values ------------------------------------------------------------------------------------------------------ */

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

int parse_bytes(const char *text, size_t *out)
{
    static const char units[] = "KMG";
    size_t digits = strspn(text, "0123456789");
    const char *unit = text[digits] ? strchr(units, text[digits]) : 0;
    int shift = unit ? 10 * (int)(unit - units + 1) : 0;
    char number[24];
    uint64_t value;
    if (digits >= sizeof number || (text[digits] && (!unit || text[digits + 1])))
        return 0;
    memcpy(number, text, digits);
    number[digits] = 0;
    if (!parse_count(number, 1, SIZE_MAX >> shift, &value))
        return 0;
    *out = (size_t)value << shift;
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

int parse_colour(const char *text, uint8_t rgb[3])
{
    if (strlen(text) != 6 || strspn(text, "0123456789abcdefABCDEF") != 6)
        return 0;
    unsigned long value = strtoul(text, 0, 16);
    for (int i = 0; i < 3; i++)
        rgb[i] = (uint8_t)(value >> (16 - 8 * i));
    return 1;
}

int take_number(const char *name, const char *value, uint64_t low, uint64_t high, uint64_t *out)
{
    return parse_count(value, low, high, out)
               ? 0 : fail(EXIT_USAGE, "--%s %s: expected a whole number from %" PRIu64 " to %" PRIu64, name, value, low,
                          high);
}

int take_int(const char *name, const char *value, int low, int high, int *out)
{
    uint64_t number;
    const int status = take_number(name, value, (uint64_t)low, (uint64_t)high, &number);
    *out = (int)number;
    return status;
}

int take_uint32(const char *name, const char *value, uint32_t low, uint32_t high, uint32_t *out)
{
    uint64_t number;
    const int status = take_number(name, value, low, high, &number);
    *out = (uint32_t)number;
    return status;
}

int take_size(const char *name, const char *value, int *width, int *height)
{
    return parse_size(value, width, height)
               ? 0 : fail(EXIT_USAGE, "--%s %s: expected WxH, each 1 to %d", name, value, FXS_MAX_SIZE);
}

int take_output(const char *name, const char *value, const char **out)
{
    if (*out)
        return fail(EXIT_USAGE, "--%s %s: --%s %s is given before", name, value, name, *out);
    *out = value;
    return 0;
}

void print_json_string(const char *text)
{
    putchar('"');
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        printf(c < ' ' ? "\\u%04x" : c == '"' || c == '\\' ? "\\%c" : "%c", c);
    }
    putchar('"');
}

/* What was printed has to have arrived, wherever the program ends. */
static void check_printed(void)
{
    if (fflush(stdout) || ferror(stdout))
        _exit(fail(EXIT_FAILED, "cannot write to standard output"));
}

void check_printed_at_exit(void)
{
    atexit(check_printed);
}

int ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), tail = strlen(ending);
    return length > tail && !strcmp(name + length - tail, ending);
}

static int percent_shown = -1;   /* -1: no bar */

int progress_bar(void *label, double done)
{
    static const char marks[] = "########################################";
    int width = (int)(sizeof marks - 1), filled = (int)(done * width), percent = (int)(done * 100);
    if (percent == percent_shown || !isatty(STDERR_FILENO) || is_quiet())
        return 0;
    fprintf(stderr, "\r%-12s [%.*s%*s] %3d %%", (const char *)label, filled, marks, width - filled, "", percent);
    percent_shown = percent;
    return 0;
}

void progress_end(void)
{
    if (percent_shown < 0)
        return;
    fputs("\r\033[K", stderr);
    percent_shown = -1;
}

void progress_line(const char *text)
{
    fprintf(stderr, "\r%s\033[K", text);
    percent_shown = 0;
}
