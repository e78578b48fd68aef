/* A WebAssembly module has no files, so opening a file by its path fails with a message. Scenes come from memory. */
#include <fixsplat/internal/message.h>

#include "src/base/files_internal.h"

enum fxs_file_kind fxs_file_kind(const char *path)
{
    (void)path;
    return FXS_FILE_NONE;
}

int fxs_file_is_named(const char *path)
{
    (void)path;
    return 0;
}

int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    (void)facts;
    *file = NULL;
    return fxs_fail(message, "%s: there are no files here", path);
}

int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    (void)first;
    return fxs_file_open(path, file, facts, message);
}

int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size)
{
    (void)file, (void)offset, (void)out, (void)size;
    return -1;
}

/* Stubs of C functions for open files, such as fclose, which are never called. */
int fclose(FILE *stream)
{
    (void)stream;
    return -1;
}

int setvbuf(FILE *restrict stream, char *restrict buffer, int mode, size_t size)
{
    (void)stream, (void)buffer, (void)mode, (void)size;
    return -1;
}

char *strerror(int number)
{
    (void)number;
    return "there are no files here";
}
