#include "map.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

int fxs_map(const char *path, void **data, size_t *bytes, fxs_message *message)
{
    struct stat status;
    int descriptor = open(path, O_RDONLY);
    if (descriptor < 0)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    int fits = !fstat(descriptor, &status) && S_ISREG(status.st_mode) && status.st_size > 0 &&
               (uintmax_t)status.st_size <= SIZE_MAX;
    *bytes = fits ? (size_t)status.st_size : 0;
    *data = fits ? mmap(0, *bytes, PROT_READ, MAP_PRIVATE, descriptor, 0) : MAP_FAILED;
    close(descriptor);
    if (*data == MAP_FAILED)
        return fxs_fail(message, "%s: cannot be mapped into memory", path);
    return 0;
}

void fxs_unmap(void *data, size_t bytes)
{
    munmap(data, bytes);
}
