/* Files, folders, links, file descriptors and terminals on POSIX systems. */
#define _XOPEN_SOURCE 700   /* declares realpath */

#include "src/base/files_internal.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/internal/message.h>

#include "src/base/try_internal.h"

static enum fxs_file_kind kind_of(const struct stat *status, fxs_file_facts *facts)
{
    *facts = (fxs_file_facts){(uint64_t)status->st_size, (uint64_t)status->st_dev, (uint64_t)status->st_ino,
                              (uint64_t)status->st_mtim.tv_sec * 1000000000 + (uint64_t)status->st_mtim.tv_nsec};
    return S_ISREG(status->st_mode) ? FXS_FILE_REGULAR : S_ISDIR(status->st_mode) ? FXS_FILE_FOLDER : FXS_FILE_OTHER;
}

enum fxs_file_kind fxs_file_look(const char *path, fxs_file_facts *facts)
{
    struct stat status;
    return stat(path, &status) ? FXS_FILE_NONE : kind_of(&status, facts);
}

enum fxs_file_kind fxs_file_look_at_name(const char *path, fxs_file_facts *facts)
{
    struct stat status;
    return lstat(path, &status) ? FXS_FILE_NONE : kind_of(&status, facts);
}

enum fxs_file_kind fxs_stream_look(FILE *file, fxs_file_facts *facts)
{
    struct stat status;
    return fstat(fileno(file), &status) ? FXS_FILE_NONE : kind_of(&status, facts);
}

enum fxs_file_kind fxs_file_kind(const char *path)
{
    fxs_file_facts unused;
    return fxs_file_look(path, &unused);
}

int fxs_file_is_named(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0;
}

int fxs_file_remove(const char *path)
{
    return unlink(path);
}

int fxs_file_rename(const char *from, const char *to)
{
    return rename(from, to);
}

int fxs_folder_remove(const char *path)
{
    return rmdir(path);
}

const char *fxs_path_fault(const char *path)
{
    (void)path;
    return NULL;
}

int fxs_file_may_be_written(const char *path)
{
    return access(path, fxs_file_kind(path) == FXS_FILE_FOLDER ? W_OK | X_OK : W_OK);
}

int fxs_file_link(const char *target, const char *name)
{
    return symlink(target, name);
}

int fxs_links_folders(void)
{
    return 1;
}

void fxs_file_unlink(const char *name)
{
    struct stat status;
    if (!lstat(name, &status) && S_ISLNK(status.st_mode))
        unlink(name);
}

/* Locks a file until the process ends, by a descriptor that stays open. Child programs do not inherit the lock. */
int fxs_file_lock(const char *path)
{
    const int descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0)
        return -1;
    if (!flock(descriptor, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK)
        return 0;
    close(descriptor);
    return 1;
}

char *fxs_path_whole(const char *path)
{
    return realpath(path, NULL);
}

int fxs_folder_make(const char *path, fxs_message *message)
{
    return mkdir(path, 0777) == 0 || (errno == EEXIST && fxs_file_kind(path) == FXS_FILE_FOLDER)
               ? 0 : fxs_fail_errno(message, path, errno);
}

int fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument)
{
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;)
        each(argument, entry->d_name);
    return folder ? closedir(folder) : -1;
}

FILE *fxs_stream_open(const char *path, const char *mode)
{
    return fopen(path, mode);
}

FILE *fxs_stream_temporary(void)
{
    return tmpfile();
}

int fxs_stream_fault(FILE *file)
{
    (void)file;
    return errno ? errno : EIO;
}

int fxs_stream_empty(FILE *file)
{
    return ftruncate(fileno(file), 0);
}

int fxs_terminal_ends_with_this(void)
{
    return 0;
}

const char fxs_erase_line[] = "\r\033[K";

int fxs_is_terminal(FILE *file)
{
    return isatty(fileno(file));
}

int fxs_terminal_takes_codes(FILE *file)
{
    (void)file;
    return 1;
}

int fxs_descriptor_open(const char *path)
{
    return open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
}

int fxs_descriptor_again(int descriptor)
{
    return fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
}

int fxs_descriptor_of(FILE *file)
{
    return fxs_descriptor_again(fileno(file));
}

enum fxs_file_kind fxs_descriptor_look(int descriptor, fxs_file_facts *facts)
{
    struct stat status;
    return fstat(descriptor, &status) ? FXS_FILE_NONE : kind_of(&status, facts);
}

int fxs_descriptor_read(int descriptor, void *out, size_t size)
{
    return pread(descriptor, out, size, 0) == (ssize_t)size ? 0 : -1;
}

void fxs_descriptor_close(int descriptor)
{
    close(descriptor);
}

static int open_name(const char *name, int flags, const char *path, FILE **file, fxs_file_facts *facts,
                     fxs_message *message)
{
    struct stat status;
    *file = NULL;
    if (stat(name, &status) != 0)
        return fxs_fail_errno(message, path, errno);
    /* the kind of file is checked before open, because opening a device may have effects */
    if (!S_ISREG(status.st_mode))
        return fxs_fail(message, "%s: not a regular file", path);
    /* O_NONBLOCK: open does not wait for the writer of a pipe */
    int descriptor = open(name, O_RDONLY | O_NONBLOCK | O_CLOEXEC | flags);
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
        kind_of(&status, facts);
    *file = stream;
    return 0;
}

int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    return open_name(path, 0, path, file, facts, message);
}

/* Returns the real path (without symbolic links) of a file's folder, or null on failure. The caller calls free(). */
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

/* Stores the real path (without symbolic links) of `path` in *real. Fails if it lies outside the folder of the file
   `first`. The caller frees *real. */
static int follow_within(const char *first, const char *path, char **real, fxs_message *message)
{
    char *folder = real_folder(first);
    int result = 0;
    *real = folder ? realpath(path, NULL) : NULL;
    if (!*real)
        result = fxs_fail_errno(message, path, errno);
    else if (!is_within(folder, *real))
        result = fxs_fail(message, "%s: leaves the folder of %s", path, first);
    free(folder);
    return result;
}

int fxs_file_check_within(const char *first, const char *path, fxs_message *message)
{
    char *real;
    const int result = follow_within(first, path, &real, message);
    free(real);
    return result;
}

int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    char *real;
    int result = follow_within(first, path, &real, message);
    *file = NULL;
    if (!result)
        result = open_name(real, O_NOFOLLOW, path, file, facts, message);
    free(real);
    return result;
}

int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size)
{
    return fseeko(file, (off_t)offset, SEEK_SET) == 0 && fread(out, 1, size, file) == size ? 0 : -1;
}
