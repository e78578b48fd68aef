/* A module has no files: opening one by its path fails with a message. Scenes come from memory. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int none(void)
{
    errno = ENOENT;
    return -1;
}

int open(const char *path, int flags, ...)
{
    (void)path, (void)flags;
    return none();
}

int stat(const char *restrict path, struct stat *restrict status)
{
    (void)path, (void)status;
    return none();
}

int lstat(const char *restrict path, struct stat *restrict status)
{
    (void)path, (void)status;
    return none();
}

int fstat(int file, struct stat *status)
{
    (void)file, (void)status;
    return none();
}

int close(int file)
{
    (void)file;
    return none();
}

char *realpath(const char *path, char *resolved)
{
    (void)path, (void)resolved;
    none();
    return NULL;
}

FILE *fdopen(int file, const char *mode)
{
    (void)file, (void)mode;
    none();
    return NULL;
}

int fclose(FILE *stream)
{
    (void)stream;
    return none();
}

size_t fread(void *restrict out, size_t size, size_t count, FILE *restrict stream)
{
    (void)out, (void)size, (void)count, (void)stream;
    return 0;
}

int fseeko(FILE *stream, off_t offset, int from)
{
    (void)stream, (void)offset, (void)from;
    return none();
}

int setvbuf(FILE *restrict stream, char *restrict buffer, int mode, size_t size)
{
    (void)stream, (void)buffer, (void)mode, (void)size;
    return none();
}

char *strerror(int number)
{
    (void)number;
    return "there are no files here";
}
