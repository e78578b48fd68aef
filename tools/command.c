#include "command.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int fail(int status, const char *format, ...)
{
    va_list arguments;
    progress_end();
    fputs("fixsplat: ", stderr);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return status;
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

int wrong_option(char **argv)
{
    return fail(EXIT_USAGE, "%s: unknown option or missing value: %s; see: fixsplat %s --help", argv[0],
                argv[optind - 1], argv[0]);
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

/* Of a file that is not there its folder, and how it is called in it. */
static const char *stat_folder(const char *path, struct stat *status)
{
    char folder[4096];
    const char *slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
    return stat(folder, status) ? 0 : slash ? slash + 1 : path;
}

int same_file(const char *a, const char *b)
{
    struct stat one, other;
    const int there = !stat(a, &one);
    if (there != !stat(b, &other))
        return 0;
    if (there)
        return S_ISREG(one.st_mode) && one.st_dev == other.st_dev && one.st_ino == other.st_ino;
    const char *name_a = stat_folder(a, &one), *name_b = stat_folder(b, &other);
    if (!name_a || !name_b)
        return !strcmp(a, b);
    return one.st_dev == other.st_dev && one.st_ino == other.st_ino && !strcmp(name_a, name_b);
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
    if (percent == percent_shown || !isatty(STDERR_FILENO))
        return 0;
    fprintf(stderr, "\r%-12s [%.*s%*s] %3d %%", (const char *)label, filled, marks, width - filled, "", percent);
    percent_shown = percent;
    return 0;
}

void progress_end(void)
{
    if (percent_shown >= 0)
        fputs("\r\033[K", stderr);
    percent_shown = -1;
}

void progress_line(const char *text)
{
    fprintf(stderr, "\r%s\033[K", text);
    percent_shown = 0;
}
