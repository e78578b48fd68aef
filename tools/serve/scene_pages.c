#include "scene_pages.h"

#include <stdarg.h>
#include <string.h>

void print_html(FILE *file, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    for (; *format; format++) {
        if (format[0] != '%' || format[1] != 's') {
            fputc(*format, file);
            continue;
        }
        for (const char *text = va_arg(arguments, const char *); *text; text++)
            if (strchr("<>&\"'", *text))
                fprintf(file, "&#%d;", *text);
            else
                fputc(*text, file);
        format++;
    }
    va_end(arguments);
}

void print_page_head(FILE *file, const char *title)
{
    static const char head[] =
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1, viewport-fit=cover\">\n"
        "<meta name=\"color-scheme\" content=\"dark light\">\n<link rel=\"icon\" href=\"data:,\">\n"
        "<title>%s</title>\n<meta property=\"og:title\" content=\"%s\">\n";
    print_html(file, head, title, title);
}

void print_list_head(FILE *file, const char *title, const char *viewer)
{
    print_page_head(file, title);
    print_html(file, "<link rel=\"stylesheet\" href=\"%s/list.css\">\n<h1>%s</h1>\n<main>\n", viewer, title);
}

void print_listed(FILE *file, const char *address, const char *picture, const char *title)
{
    static const char none[] = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7";
    print_html(file, "<a href=\"%s\"><img src=\"%s\" alt=\"\" loading=\"lazy\">%s</a>\n", address,
               picture ? picture : none, title);
}
