/* Writes output files. Windows deletes an incomplete file whenever the process ends, so signals need no handling. */
#include "win32.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/output.h>
#include "src/base/opened.h"
#include "src/base/output_internal.h"

enum { NAME_ROOM = 64,
       WRITERS_MOST = 100 };

void fxs_output_remove_at_signals(void)
{
}

char *fxs_output_target(const char *path)
{
    char *whole = fxs_path_whole(path);
    return whole ? whole : _strdup(path);
}

static char standard_output[] = "standard output";

static void release(fxs_output *output)
{
    if (output->path != standard_output)
        free(output->path);
    free(output->target);
    free(output->temporary);
}

static void name_temporary(fxs_output *output, int i)
{
    const char *slash = strrchr(output->target, '/'), *name = slash ? slash + 1 : output->target;
    const int folder = (int)(name - output->target);
    uint32_t hash = 0x811c9dc5u;
    for (const char *c = name; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 0x01000193u;
    snprintf(output->temporary, (size_t)folder + NAME_ROOM, "%.*s.fixsplat-%08" PRIx32 "-%d.tmp", folder,
             output->target, hash, i);
}

static int set_delete(HANDLE handle, int is_deleted)
{
    FILE_DISPOSITION_INFO disposition = {.DeleteFile = (BOOLEAN)is_deleted};
    return SetFileInformationByHandle(handle, FileDispositionInfo, &disposition, sizeof disposition);
}

/* Opens a file that no other process can open. Windows deletes the file when its handle is closed, unless the mark for
   deletion is removed before. */
static HANDLE open_named(const char *name, DWORD how)
{
    wchar_t *wide = win32_path(name);
    if (!wide)
        return INVALID_HANDLE_VALUE;
    const DWORD access = GENERIC_WRITE | DELETE;
    const HANDLE handle = CreateFileW(wide, access, 0, NULL, how, FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle != INVALID_HANDLE_VALUE)
        set_delete(handle, 1);
    else
        win32_failed();
    free(wide);
    return handle;
}

static HANDLE create_beside(fxs_output *output)
{
    HANDLE handle = INVALID_HANDLE_VALUE;
    output->temporary = malloc(strlen(output->target) + NAME_ROOM);
    for (int i = 0; output->temporary && i < WRITERS_MOST && handle == INVALID_HANDLE_VALUE; i++) {
        name_temporary(output, i);
        handle = open_named(output->temporary, CREATE_ALWAYS);
        if (handle == INVALID_HANDLE_VALUE && errno != EBUSY && errno != EACCES)
            break;
    }
    return handle;
}

static FILE *open_standard_output(void)
{
    const int descriptor = _dup(_fileno(stdout));
    if (descriptor < 0)
        return NULL;
    _setmode(descriptor, _O_BINARY);
    return _fdopen(descriptor, "wb");
}

static FILE *open_file(fxs_output *output)
{
    if (output->path == standard_output)
        return open_standard_output();
    const enum fxs_file_kind kind = fxs_file_kind(output->path);
    if (kind == FXS_FILE_FOLDER) {
        errno = EISDIR;
        return NULL;
    }
    HANDLE handle;
    if (kind == FXS_FILE_OTHER) {
        handle = win32_open(output->path, GENERIC_WRITE, 0);
    } else {
        output->target = fxs_output_target(output->path);
        handle = output->target ? create_beside(output) : INVALID_HANDLE_VALUE;
    }
    return handle == INVALID_HANDLE_VALUE ? NULL : win32_stream(handle, "wb");
}

int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message)
{
    const char *fault = strcmp(path, "-") ? fxs_path_fault(path) : NULL;
    FXS_TRY(fxs_may_write(path, message));
    if (fault)
        return fxs_fail(message, "%s: cannot be written: it %s", path, fault);
    memset(output, 0, sizeof *output);
    output->left = count;
    output->path = strcmp(path, "-") ? _strdup(path) : standard_output;
    output->file = output->path ? open_file(output) : NULL;
    if (output->file)
        return 0;
    const int error = fxs_output_fail(output->path ? output->path : path, errno, message);
    release(output);
    return error;
}

enum { TRIES_MOST = 40, PAUSE_MILLISECONDS = 50 };

static int put_in_place(fxs_output *output)
{
    const HANDLE handle = (HANDLE)_get_osfhandle(_fileno(output->file));
    wchar_t *wide = win32_whole_path(output->target);
    const size_t bytes = wide ? wcslen(wide) * sizeof *wide : 0;
    FILE_RENAME_INFO *rename = wide ? calloc(1, sizeof *rename + bytes) : NULL;
    int error = ENOMEM;
    if (rename) {
        rename->ReplaceIfExists = TRUE;
        rename->FileNameLength = (DWORD)bytes;
        memcpy(rename->FileName, wide, bytes);
        error = 0;
        if (!FlushFileBuffers(handle) || !set_delete(handle, 0) ||
            !SetFileInformationByHandle(handle, FileRenameInfo, rename, (DWORD)(sizeof *rename + bytes))) {
            win32_failed();
            error = errno;
            set_delete(handle, 1);
        }
    }
    free(rename);
    free(wide);
    return error;
}

/* Returns the error of a failed replacement of the target file. Changes EACCES to EBUSY if another program has the
   target open. */
static int why_not_replaced(const fxs_output *output, int error)
{
    const DWORD access = GENERIC_WRITE | DELETE;
    wchar_t *wide = error == EACCES ? win32_path(output->target) : NULL;
    const HANDLE handle = wide ? CreateFileW(wide, access, 0, NULL, OPEN_EXISTING, 0, NULL) : INVALID_HANDLE_VALUE;
    if (wide && (handle != INVALID_HANDLE_VALUE || GetLastError() == ERROR_SHARING_VIOLATION))
        error = EBUSY;
    if (handle != INVALID_HANDLE_VALUE)
        CloseHandle(handle);
    free(wide);
    return error;
}

/* Gives a complete output its final name. Retries while a server or virus scanner briefly has the target file open. */
static int put_when_free(fxs_output *output)
{
    int error, tries = 0;
    while ((error = why_not_replaced(output, put_in_place(output))) == EBUSY && ++tries < TRIES_MOST)
        Sleep(PAUSE_MILLISECONDS);
    return error;
}

const char *fxs_output_lend(fxs_output *output)
{
    if (output->temporary) {
        set_delete((HANDLE)_get_osfhandle(_fileno(output->file)), 0);
        fclose(output->file);
    }
    return output->temporary;
}

void fxs_output_take_back(fxs_output *output)
{
    const HANDLE handle = open_named(output->temporary, OPEN_EXISTING);
    output->file = handle == INVALID_HANDLE_VALUE ? NULL : win32_stream(handle, "wb");
    if (output->file)
        return;
    output->error = output->error ? output->error : errno;
    output->file = fopen("NUL", "wb");
}

int fxs_output_close(fxs_output *output, fxs_message *message)
{
    int result = 0;
    errno = 0;
    if ((fflush(output->file) || ferror(output->file)) && !output->error)
        output->error = fxs_stream_fault(output->file);
    if (!output->error && !output->left && output->temporary)
        output->error = put_when_free(output);
    errno = 0;
    if (fclose(output->file) && !output->error)
        output->error = errno ? errno : EIO;
    if (output->error)
        result = fxs_output_fail(output->path, output->error, message);
    else if (output->left)
        result = fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: %" PRIu64 " Gaussians fewer than announced", output->path,
                             output->left);
    release(output);
    return result;
}
