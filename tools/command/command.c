/* Helpers of all subcommands: messages, --quiet, suggestions, quoting, the progress bar. */
#include "command.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/fail_list.h"
#include "src/base/os_calls.h"

static fxs_message failure;

static void say(const fxs_message *message)
{
    progress_end();
    fprintf(stderr, "fixsplat: %s\n", message->text);
}

int fail(int status, const char *format, ...)
{
    fxs_message message;
    va_list arguments;
    va_start(arguments, format);
    fxs_fail_list(status, &message, format, arguments);
    va_end(arguments);
    say(&message);
    failure = message;
    return status;
}

const char *last_failure(void)
{
    return failure.text;
}

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

/* --quiet sets an environment variable, which child programs inherit. */
static const char quiet_variable[] = "FIXSPLAT_QUIET";

void be_quiet(void)
{
    fxs_program_set(quiet_variable, "1");
}

int is_quiet(void)
{
    return getenv(quiet_variable) != 0;
}

void note(const char *format, ...)
{
    fxs_message message;
    va_list arguments;
    if (is_quiet())
        return;
    va_start(arguments, format);
    fxs_fail_list(0, &message, format, arguments);
    va_end(arguments);
    say(&message);
}

int place_digits(double x, int digits)
{
    int whole = 1;
    for (double rest = fabs(x); rest >= 10 && whole < 12; rest /= 10)
        whole++;
    return fabs(x) >= 4096 && whole + 3 > digits ? whole + 3 : digits;
}

void print_vector_json(const double v[3])
{
    for (int i = 0; i < 3; i++)
        printf("%s%.*g", i ? ", " : "[", place_digits(v[i], 9), v[i]);
    printf("]");
}

void print_box_json(const double low[3], const double high[3])
{
    printf("[");
    print_vector_json(low);
    printf(", ");
    print_vector_json(high);
    printf("]");
}

void print_place(const double v[3])
{
    for (int i = 0; i < 3; i++)
        printf(" %.*g", place_digits(v[i], 6), v[i]);
}

void print_box(const double low[3], const double high[3])
{
    print_place(low);
    printf(" to");
    print_place(high);
    putchar('\n');
}

void print_version(void)
{
    puts("fixsplat " FXS_VERSION);
}

enum { LONGEST_NAME = 32 };

/* Computes the Levenshtein distance (1966) of two words. Row i of its table belongs to the first i letters of `a`. */
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

void write_json_string(FILE *file, const char *text)
{
    putc('"', file);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        fprintf(file, c < ' ' ? "\\u%04x" : c == '"' || c == '\\' ? "\\%c" : "%c", c);
    }
    putc('"', file);
}

void print_json_string(const char *text)
{
    write_json_string(stdout, text);
}

void write_shell_word(FILE *file, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=,+-";
    if (*word && strspn(word, plain) == strlen(word)) {
        fprintf(file, " %s", word);
        return;
    }
    fprintf(file, " %c", FXS_SHELL_QUOTE);
    for (size_t doubled = 0; *word; word++) {
        const int is_end = !word[1] || word[1] == FXS_SHELL_QUOTE;
        if (*word == FXS_SHELL_QUOTE)
            fputs(FXS_SHELL_QUOTED_QUOTE, file);
        else
            fputc(*word, file);
        doubled = *word == FXS_SHELL_DOUBLED ? doubled + 1 : 0;
        for (; doubled && is_end; doubled--)
            fputc(FXS_SHELL_DOUBLED, file);
    }
    fputc(FXS_SHELL_QUOTE, file);
}

static void check_printed(void)
{
    if (fflush(stdout) || ferror(stdout))
        _Exit(fail(EXIT_FAILED, "cannot write to standard output"));
}

void check_printed_at_exit(void)
{
    atexit(check_printed);
}

int ends_with(const char *name, const char *ending)
{
    return fxs_ends_in(name, ending);
}

int is_pattern(const char *name)
{
    const char *percent = strchr(name, '%');
    if (!percent || strchr(percent + 1, '%'))
        return 0;
    return percent[1 + strspn(percent + 1, "0123456789")] == 'd' && strspn(percent + 1, "0123456789") <= 2;
}

void name_numbered(char *name, size_t size, const char *pattern, long index)
{
    const char *percent = strchr(pattern, '%');
    if (is_pattern(pattern))
        snprintf(name, size, "%.*s%0*ld%s", (int)(percent - pattern), pattern, atoi(percent + 1), index,
                 strchr(percent, 'd') + 1);
    else
        snprintf(name, size, "%s", pattern);
}

static int percent_shown = -1;   /* percentage that the progress bar last printed; -1: no bar */

int progress_bar(void *label, double done)
{
    static const char marks[] = "########################################";
    int width = (int)(sizeof marks - 1), filled = (int)(done * width), percent = (int)(done * 100);
    if (percent == percent_shown || !fxs_is_terminal(stderr) || is_quiet())
        return 0;
    fprintf(stderr, "\r%-12s [%.*s%*s] %3d %%", (const char *)label, filled, marks, width - filled, "", percent);
    percent_shown = percent;
    return 0;
}

void progress_end(void)
{
    if (percent_shown < 0)
        return;
    fputs(fxs_erase_line, stderr);
    percent_shown = -1;
}

void progress_line(const char *text)
{
    fprintf(stderr, "%s%s", fxs_erase_line, text);
    percent_shown = 0;
}
