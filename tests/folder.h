/* Creates a temporary folder for a test and writes files into the folder. */
#ifndef FOLDER_H
#define FOLDER_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "check.h"

static char folder[] = "/tmp/fixsplat-test-XXXXXX";

/* Returns the path of a file in the temporary folder. The path is valid until the second call after this call. */
static inline const char *in_folder(const char *name)
{
    static char path[2][1024];
    static int turn;
    turn = !turn;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static inline void put_file(const char *name, const void *data, size_t size)
{
    FILE *stream = fopen(in_folder(name), "wb");
    if (!CHECK(stream != NULL))
        return;
    CHECK(fwrite(data, 1, size, stream) == size);
    CHECK(fclose(stream) == 0);
}

static char text[1 << 16];
static size_t length;

/* Appends formatted text to a buffer, the content of the next file to write. */
static inline void say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    length += (size_t)vsnprintf(text + length, sizeof text - length, format, arguments);
    va_end(arguments);
}

static inline int in_a_folder(void (*tests)(void))
{
    char command[64];
    if (!mkdtemp(folder)) {
        perror(folder);
        return 1;
    }
    tests();
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) != 0 || check_report();
}

#endif
