/* Reads parts of a scene from a file, for the pager, which renders scenes larger than memory. Each read also checks
 * that size and modification time have not changed. */
#include <fixsplat/pager.h>

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/pager_more.h>

#include "src/base/opened.h"

typedef struct paged_file {
    int descriptor;
    struct stat opened;
    char path[];
} paged_file;

static void close_file(void *argument)
{
    paged_file *f = argument;
    if (f->descriptor >= 0)
        close(f->descriptor);
    free(f);
}

static int check(const paged_file *f, fxs_message *message)
{
    struct stat now;
    if (fstat(f->descriptor, &now))
        return fxs_fail_errno(message, f->path, errno);
    if (now.st_size < f->opened.st_size)
        return fxs_fail(message, "%s: was cut short while it was read", f->path);
    if (now.st_size != f->opened.st_size || now.st_mtim.tv_sec != f->opened.st_mtim.tv_sec ||
        now.st_mtim.tv_nsec != f->opened.st_mtim.tv_nsec)
        return fxs_fail(message, "%s: was written to while it was read", f->path);
    return 0;
}

static int read_file(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message)
{
    const paged_file *f = argument;
    for (size_t done = 0; done < size;) {
        const ssize_t got = pread(f->descriptor, (char *)out + done, size - done, (off_t)(offset + done));
        if (got < 0 && errno != EINTR)
            return fxs_fail_errno(message, f->path, errno);
        if (got == 0)
            return fxs_fail(message, "%s: was cut short while it was read", f->path);
        done += got > 0 ? (size_t)got : 0;
    }
    return check(f, message);
}

int fxs_pager_file(const char *path, fxs_pager_source *source, fxs_message *message)
{
    const size_t length = strlen(path) + 1;
    paged_file *f = malloc(sizeof *f + length);
    if (!f)
        return fxs_fail_memory(message, path, sizeof *f + length);
    memcpy(f->path, path, length);
    f->descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    int error = 0;
    if (f->descriptor < 0 || fstat(f->descriptor, &f->opened))
        error = fxs_fail_errno(message, path, errno);
    else if (!S_ISREG(f->opened.st_mode))
        error = fxs_fail(message, "%s: not a regular file", path);
    if (error) {
        close_file(f);
        return error;
    }
    fxs_note_opened((uint64_t)f->opened.st_dev, (uint64_t)f->opened.st_ino);
    *source = (fxs_pager_source){.size = (uint64_t)f->opened.st_size, .read = read_file, .close = close_file,
                                 .argument = f};
    return 0;
}
