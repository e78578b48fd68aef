/* Fuzzes the reading of photographs and their EXIF. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "src/image/photograph.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int file = -1;
    static char path[32];
    uint8_t *rgba = NULL;
    int width = 0, height = 0;
    fxs_message message;
    fxs_exif exif;
    if (file < 0) {
        file = memfd_create("fuzz", 0);
        snprintf(path, sizeof path, "/dev/fd/%d", file);
    }
    if (file < 0 || ftruncate(file, 0) || pwrite(file, data, size, 0) != (ssize_t)size)
        abort();
    if (fxs_photograph_read(path, &rgba, &width, &height, &exif, &message) == 0) {
        unsigned sum = 0;
        for (size_t i = 0; i < 4 * (size_t)width * (size_t)height; i += 509)
            sum += rgba[i];
        if (width < 1 || height < 1 || sum == UINT32_MAX ||
            exif.orientation < 1 || exif.orientation > 8 || !(exif.exposure >= 0 && exif.exposure < 1e14) ||
            strchr(exif.lens, '\n'))
            abort();
    } else if (rgba || strncmp(message.text, path, strlen(path)) != 0 || strchr(message.text, '\n')) {
        abort();
    }
    free(rgba);
    return 0;
}
