#define _XOPEN_SOURCE 700   /* realpath */

#include "src/base/files_internal.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/message.h>

#include "src/base/try_internal.h"

enum fxs_file_kind fxs_file_kind(const char *path)
{
    struct stat status;
    if (stat(path, &status))
        return FXS_FILE_NONE;
    return S_ISREG(status.st_mode) ? FXS_FILE_REGULAR : S_ISDIR(status.st_mode) ? FXS_FILE_FOLDER : FXS_FILE_OTHER;
}

int fxs_file_is_named(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0;
}

int fxs_folder_make(const char *path, fxs_message *message)
{
    return mkdir(path, 0777) == 0 || (errno == EEXIST && fxs_file_kind(path) == FXS_FILE_FOLDER)
               ? 0 : fxs_fail_errno(message, path, errno);
}

void fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument)
{
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;)
        each(argument, entry->d_name);
    if (folder)
        closedir(folder);
}

/* `path` is for messages. */
static int open_name(const char *name, int flags, const char *path, FILE **file, fxs_file_facts *facts,
                     fxs_message *message)
{
    struct stat status;
    *file = NULL;
    if (stat(name, &status) != 0)
        return fxs_fail_errno(message, path, errno);
    if (!S_ISREG(status.st_mode))   /* checked before: opening a device may have effects */
        return fxs_fail(message, "%s: not a regular file", path);
    int descriptor = open(name, O_RDONLY | O_NONBLOCK | O_CLOEXEC | flags);   /* does not wait for a pipe's writer */
    FILE *stream = descriptor < 0 ? NULL : fdopen(descriptor, "rb");
    if (!stream) {
        const int error = fxs_fail_errno(message, path, errno);
        if (descriptor >= 0)
            close(descriptor);
        return error;
    }
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        fclose(stream);
        return fxs_fail(message, "%s: not a regular file", path);
    }
    if (facts)
        *facts = (fxs_file_facts){(uint64_t)status.st_size, (uint64_t)status.st_dev, (uint64_t)status.st_ino};
    *file = stream;
    return 0;
}

int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    return open_name(path, 0, path, file, facts, message);
}

/* The realpath of the folder of a path; the caller frees it. NULL: an error. */
static char *real_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash + 1 - path) : 0;
    char *folder = malloc(length + 2);
    if (!folder)
        return NULL;
    memcpy(folder, path, length);
    memcpy(folder + length, length ? "" : ".", length ? 1 : 2);
    char *real = realpath(folder, NULL);
    free(folder);
    return real;
}

static int is_within(const char *folder, const char *path)
{
    const size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 &&
           (path[length] == '/' || path[length] == '\0' || folder[length - 1] == '/');
}

int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    char *folder = real_folder(first), *real = folder ? realpath(path, NULL) : NULL;
    int result;
    *file = NULL;
    if (!real)
        result = fxs_fail_errno(message, path, errno);
    else if (!is_within(folder, real))
        result = fxs_fail(message, "%s: leaves the folder of %s", path, first);
    else
        result = open_name(real, O_NOFOLLOW, path, file, facts, message);
    free(folder);
    free(real);
    return result;
}

int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size)
{
    return fseeko(file, (off_t)offset, SEEK_SET) == 0 && fread(out, 1, size, file) == size ? 0 : -1;
}
