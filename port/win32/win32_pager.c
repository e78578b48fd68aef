/* Reads parts of a scene from a file, for the pager, which renders scenes larger than memory. */
#include "win32.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/pager.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/pager_more.h>

#include "src/base/opened.h"

typedef struct paged_file {
    HANDLE handle;
    uint64_t size;
    FILETIME modified;
    char path[];
} paged_file;

static void close_file(void *argument)
{
    paged_file *f = argument;
    if (f->handle != INVALID_HANDLE_VALUE)
        CloseHandle(f->handle);
    free(f);
}

static int check(const paged_file *f, fxs_message *message)
{
    fxs_file_facts now;
    FILETIME modified = {0};
    if (win32_look(f->handle, &now) != FXS_FILE_REGULAR || now.size < f->size)
        return fxs_fail(message, "%s: was cut short while it was read", f->path);
    GetFileTime(f->handle, NULL, NULL, &modified);
    if (now.size != f->size || CompareFileTime(&modified, &f->modified))
        return fxs_fail(message, "%s: was written to while it was read", f->path);
    return 0;
}

static int read_file(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message)
{
    const paged_file *f = argument;
    for (size_t done = 0; done < size;) {
        const uint64_t at = offset + done;
        OVERLAPPED place = {.Offset = (DWORD)at, .OffsetHigh = (DWORD)(at >> 32)};
        const size_t left = size - done;
        DWORD got = 0;
        if (!ReadFile(f->handle, (char *)out + done, left < 1u << 30 ? (DWORD)left : 1u << 30, &got, &place) &&
            GetLastError() != ERROR_HANDLE_EOF) {
            win32_failed();
            return fxs_fail_errno(message, f->path, errno);
        }
        if (!got)
            return fxs_fail(message, "%s: was cut short while it was read", f->path);
        done += got;
    }
    return check(f, message);
}

int fxs_pager_file(const char *path, fxs_pager_source *source, fxs_message *message)
{
    const size_t length = strlen(path) + 1;
    fxs_file_facts facts;
    paged_file *f = malloc(sizeof *f + length);
    if (!f)
        return fxs_fail_memory(message, path, sizeof *f + length);
    memcpy(f->path, path, length);
    f->handle = win32_open(path, GENERIC_READ, FILE_FLAG_BACKUP_SEMANTICS);
    int error = 0;
    if (f->handle == INVALID_HANDLE_VALUE)
        error = fxs_fail_errno(message, path, errno);
    else if (win32_look(f->handle, &facts) != FXS_FILE_REGULAR)
        error = fxs_fail(message, "%s: not a regular file", path);
    if (error) {
        close_file(f);
        return error;
    }
    f->size = facts.size;
    GetFileTime(f->handle, NULL, NULL, &f->modified);
    fxs_note_opened(facts.device, facts.inode);
    *source = (fxs_pager_source){.size = f->size, .read = read_file, .close = close_file, .argument = f};
    return 0;
}
