#include "win32.h"

#include <errno.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>

#include "src/base/opened.h"

/* Does nothing: Windows never cuts a mapped file short, so mapped files need no guard. */
void fxs_map_guard(void)
{
}

/* Returns the handle of a mapped file, which is stored as an int. A Windows handle fits into 32 bits. */
static HANDLE handle_of(const fxs_mapping *mapping)
{
    return (HANDLE)(intptr_t)mapping->descriptor;
}

static int64_t modified(HANDLE handle)
{
    FILETIME time = {0};
    GetFileTime(handle, NULL, NULL, &time);
    return (int64_t)((uint64_t)time.dwHighDateTime << 32 | time.dwLowDateTime);
}

static int map_opened(fxs_mapping *mapping, HANDLE handle, const char *path, fxs_message *message)
{
    fxs_file_facts facts;
    if (win32_look(handle, &facts) != FXS_FILE_REGULAR || facts.size < 1 || facts.size > SIZE_MAX)
        return fxs_fail(message, "%s: cannot be mapped into memory", path);
    const HANDLE section = CreateFileMappingW(handle, NULL, PAGE_READONLY, 0, 0, NULL);
    mapping->data = section ? MapViewOfFile(section, FILE_MAP_READ, 0, 0, (size_t)facts.size) : NULL;
    if (!mapping->data) {
        win32_failed();
        if (section)
            CloseHandle(section);
        return fxs_fail(message, "%s: cannot be mapped into memory: %s", path, strerror(errno));
    }
    CloseHandle(section);
    mapping->bytes = (size_t)facts.size;
    mapping->descriptor = (int)(intptr_t)handle;
    mapping->modified[0] = modified(handle);
    fxs_note_opened(facts.device, facts.inode);
    return 0;
}

int fxs_map_open(fxs_mapping *mapping, const char *path, fxs_message *message)
{
    const char *fault = fxs_path_fault(path);
    memset(mapping, 0, sizeof *mapping);
    if (fault)
        return fxs_fail(message, "%s: %s", path, fault);
    const HANDLE handle = win32_open(path, GENERIC_READ, FILE_FLAG_BACKUP_SEMANTICS);
    if (handle == INVALID_HANDLE_VALUE)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    const int error = map_opened(mapping, handle, path, message);
    if (error)
        CloseHandle(handle);
    return error;
}

int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message)
{
    fxs_file_facts facts;
    if (win32_look(handle_of(mapping), &facts) != FXS_FILE_REGULAR || facts.size < mapping->bytes)
        return fxs_fail(message, "%s: was cut short while it was read", path);
    if (facts.size != mapping->bytes || modified(handle_of(mapping)) != mapping->modified[0])
        return fxs_fail(message, "%s: was written to while it was read", path);
    return 0;
}

void fxs_map_close(fxs_mapping *mapping)
{
    if (!mapping->data)
        return;
    UnmapViewOfFile(mapping->data);
    CloseHandle(handle_of(mapping));
    memset(mapping, 0, sizeof *mapping);
}
