/* Converts paths between UTF-8 and the UTF-16 of Windows, and checks file names. */
#include "win32.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { SHORT_MOST = 240 };

char *win32_narrow(const wchar_t *text)
{
    const int size = WideCharToMultiByte(CP_UTF8, 0, text, -1, NULL, 0, NULL, NULL);
    char *narrow = size > 0 ? malloc((size_t)size) : NULL;
    if (narrow)
        WideCharToMultiByte(CP_UTF8, 0, text, -1, narrow, size, NULL, NULL);
    else
        errno = size > 0 ? ENOMEM : EINVAL;
    return narrow;
}

wchar_t *win32_wide(const char *text)
{
    const int size = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, NULL, 0);
    wchar_t *wide = size > 0 ? malloc((size_t)size * sizeof *wide) : NULL;
    if (wide)
        MultiByteToWideChar(CP_UTF8, 0, text, -1, wide, size);
    else
        errno = size > 0 ? ENOMEM : EINVAL;
    return wide;
}

/* Returns 1 for names of Windows devices such as con, also with an extension or with spaces before it. */
static int is_device(const char *name, size_t length)
{
    static const char *const names[] = {"con", "prn", "aux", "nul", "conin$", "conout$"};
    size_t stem = 0;
    while (stem < length && name[stem] != '.' && name[stem] != ':')
        stem++;
    while (stem && name[stem - 1] == ' ')
        stem--;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (stem == strlen(names[i]) && !_strnicmp(name, names[i], stem))
            return 1;
    return stem == 4 && (!_strnicmp(name, "com", 3) || !_strnicmp(name, "lpt", 3)) && name[3] >= '1' && name[3] <= '9';
}

static int is_nul(const char *path)
{
    return !_stricmp(path, "nul");
}

/* Returns the length of a path's beginning: the drive, and a prefix \\?\ or \\.\, with either kind of slash. */
static size_t root_of(const char *path)
{
    static const char strokes[] = "/\\";
    const int is_prefixed = strspn(path, strokes) == 2 && path[2] && strchr("?.", path[2]) && path[3] &&
                            strchr(strokes, path[3]);
    const size_t prefix = is_prefixed ? 4 : 0;
    return prefix + (path[prefix] && path[prefix + 1] == ':' ? 2 : 0);
}

const char *fxs_path_fault(const char *path)
{
    for (const char *name = path + root_of(path); *name;) {
        const size_t length = strcspn(name, "/\\");
        if (length && strspn(name, ".") != length) {
            if (is_device(name, length) && !is_nul(path))
                return "is the name of a device in Windows";
            if (name[length - 1] == '.' || name[length - 1] == ' ')
                return "ends in a dot or a space, which Windows leaves out of names";
            if (memchr(name, ':', length))
                return "has a colon, which is no part of names in Windows";
            if (memchr(name, '"', length))
                return "has a quote, which is no part of names in Windows: leave out the \\ before a quote";
            if (strcspn(name, "*?<>|") < length)
                return "has one of * ? < > |, which are no part of names in Windows";
        }
        name += length + (name[length] != 0);
    }
    return NULL;
}

/* Returns the absolute path with the prefix \\?\, which allows any length. */
static wchar_t *prefixed(const wchar_t *wide)
{
    const DWORD room = GetFullPathNameW(wide, 0, NULL, NULL);
    wchar_t *whole = malloc((room + 16) * sizeof *whole);
    if (!whole || !GetFullPathNameW(wide, room, whole + 8, NULL)) {
        errno = whole ? EINVAL : ENOMEM;
        free(whole);
        return NULL;
    }
    const wchar_t *from = whole + 8, *prefix = L"\\\\?\\";
    if (!wcsncmp(from, L"\\\\", 2)) {
        const int is_prefixed = from[2] == L'?' || from[2] == L'.';
        prefix = is_prefixed ? L"" : L"\\\\?\\UNC\\";
        from += is_prefixed ? 0 : 2;
    }
    memmove(whole + wcslen(prefix), from, (wcslen(from) + 1) * sizeof *whole);
    memcpy(whole, prefix, wcslen(prefix) * sizeof *whole);
    return whole;
}

static wchar_t *convert(const char *path, DWORD longest)
{
    if (!*path || fxs_path_fault(path)) {
        errno = *path ? EINVAL : ENOENT;
        return NULL;
    }
    wchar_t *wide = win32_wide(path);
    if (!wide)
        return NULL;
    for (wchar_t *c = wide; *c; c++)
        *c = *c == L'/' ? L'\\' : *c;
    if (GetFullPathNameW(wide, 0, NULL, NULL) < longest)
        return wide;
    wchar_t *whole = prefixed(wide);
    free(wide);
    return whole;
}

wchar_t *win32_path(const char *path)
{
    return convert(path, SHORT_MOST);
}

wchar_t *win32_whole_path(const char *path)
{
    return convert(path, 0);
}

int win32_failed(void)
{
    static const struct {
        DWORD error;
        int number;
    } rows[] = {
        {ERROR_FILE_NOT_FOUND, ENOENT}, {ERROR_PATH_NOT_FOUND, ENOENT}, {ERROR_INVALID_DRIVE, ENOENT},
        {ERROR_BAD_NETPATH, ENOENT}, {ERROR_ACCESS_DENIED, EACCES}, {ERROR_WRITE_PROTECT, EROFS},
        {ERROR_SHARING_VIOLATION, EBUSY}, {ERROR_LOCK_VIOLATION, EBUSY}, {ERROR_USER_MAPPED_FILE, EBUSY},
        {ERROR_DELETE_PENDING, EBUSY}, {ERROR_FILE_EXISTS, EEXIST}, {ERROR_ALREADY_EXISTS, EEXIST},
        {ERROR_NOT_ENOUGH_MEMORY, ENOMEM}, {ERROR_OUTOFMEMORY, ENOMEM}, {ERROR_DISK_FULL, ENOSPC},
        {ERROR_HANDLE_DISK_FULL, ENOSPC}, {ERROR_DIR_NOT_EMPTY, ENOTEMPTY}, {ERROR_DIRECTORY, ENOTDIR},
        {ERROR_INVALID_NAME, EINVAL}, {ERROR_FILENAME_EXCED_RANGE, ENAMETOOLONG}, {ERROR_BROKEN_PIPE, EPIPE},
    };
    const DWORD error = GetLastError();
    errno = EIO;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].error == error)
            errno = rows[i].number;
    return -1;
}
