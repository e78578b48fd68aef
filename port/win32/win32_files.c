/* Files, folders, links, streams and file descriptors on Windows. */
#include "win32.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>

#include "src/base/files_internal.h"
#include "src/base/try_internal.h"

HANDLE win32_open(const char *path, DWORD access, DWORD flags)
{
    wchar_t *wide = win32_path(path);
    if (!wide)
        return INVALID_HANDLE_VALUE;
    const HANDLE handle = CreateFileW(wide, access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                                      OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL | flags, NULL);
    if (handle == INVALID_HANDLE_VALUE)
        win32_failed();
    free(wide);
    return handle;
}

enum fxs_file_kind win32_look(HANDLE handle, fxs_file_facts *facts)
{
    BY_HANDLE_FILE_INFORMATION about;
    *facts = (fxs_file_facts){0};
    if (GetFileType(handle) != FILE_TYPE_DISK || !GetFileInformationByHandle(handle, &about))
        return GetFileType(handle) == FILE_TYPE_UNKNOWN ? FXS_FILE_NONE : FXS_FILE_OTHER;
    const FILETIME modified = about.ftLastWriteTime;       /* time of modification in units of 100 ns */
    *facts = (fxs_file_facts){(uint64_t)about.nFileSizeHigh << 32 | about.nFileSizeLow, about.dwVolumeSerialNumber,
                              (uint64_t)about.nFileIndexHigh << 32 | about.nFileIndexLow,
                              100 * ((uint64_t)modified.dwHighDateTime << 32 | modified.dwLowDateTime)};
    return about.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY ? FXS_FILE_FOLDER : FXS_FILE_REGULAR;
}

static enum fxs_file_kind look_at(HANDLE handle, fxs_file_facts *facts)
{
    if (handle == INVALID_HANDLE_VALUE)
        return FXS_FILE_NONE;
    const enum fxs_file_kind kind = win32_look(handle, facts);
    CloseHandle(handle);
    return kind;
}

enum fxs_file_kind fxs_file_look(const char *path, fxs_file_facts *facts)
{
    return look_at(win32_open(path, FILE_READ_ATTRIBUTES, FILE_FLAG_BACKUP_SEMANTICS), facts);
}

/* Opens a file that is not a symbolic link. Sets errno to ELOOP for a link. */
static HANDLE open_itself(const char *path, DWORD access, DWORD flags)
{
    FILE_ATTRIBUTE_TAG_INFO about = {0};
    const HANDLE handle = win32_open(path, access, flags | FILE_FLAG_OPEN_REPARSE_POINT);
    if (handle == INVALID_HANDLE_VALUE ||
        !GetFileInformationByHandleEx(handle, FileAttributeTagInfo, &about, sizeof about) ||
        !(about.FileAttributes & FILE_ATTRIBUTE_REPARSE_POINT))
        return handle;
    CloseHandle(handle);
    if (!IsReparseTagNameSurrogate(about.ReparseTag))
        return win32_open(path, access, flags);
    errno = ELOOP;
    return INVALID_HANDLE_VALUE;
}

enum fxs_file_kind fxs_file_look_at_name(const char *path, fxs_file_facts *facts)
{
    errno = 0;
    const HANDLE handle = open_itself(path, FILE_READ_ATTRIBUTES, FILE_FLAG_BACKUP_SEMANTICS);
    return handle == INVALID_HANDLE_VALUE && errno == ELOOP ? FXS_FILE_OTHER : look_at(handle, facts);
}

enum fxs_file_kind fxs_stream_look(FILE *file, fxs_file_facts *facts)
{
    return win32_look((HANDLE)_get_osfhandle(_fileno(file)), facts);
}

enum fxs_file_kind fxs_file_kind(const char *path)
{
    fxs_file_facts unused;
    return fxs_file_look(path, &unused);
}

static DWORD attributes_of(const char *path)
{
    wchar_t *wide = win32_path(path);
    const DWORD attributes = wide ? GetFileAttributesW(wide) : INVALID_FILE_ATTRIBUTES;
    free(wide);
    return attributes;
}

int fxs_file_is_named(const char *path)
{
    return attributes_of(path) != INVALID_FILE_ATTRIBUTES;
}

char *fxs_path_whole(const char *path)
{
    const HANDLE handle = win32_open(path, FILE_READ_ATTRIBUTES, FILE_FLAG_BACKUP_SEMANTICS);
    if (handle == INVALID_HANDLE_VALUE)
        return NULL;
    const DWORD room = GetFinalPathNameByHandleW(handle, NULL, 0, 0) + 1;
    wchar_t *wide = malloc(room * sizeof *wide);
    char *whole = NULL;
    if (wide && GetFinalPathNameByHandleW(handle, wide, room, 0)) {
        /* a path \\?\UNC\computer\... means \\computer\... */
        const int is_shared = !wcsncmp(wide, L"\\\\?\\UNC\\", 8);
        if (is_shared)
            wide[6] = L'\\';
        whole = win32_narrow(wide + (is_shared ? 6 : wcsncmp(wide, L"\\\\?\\", 4) ? 0 : 4));
    } else
        win32_failed();
    free(wide);
    CloseHandle(handle);
    for (char *c = whole; c && *c; c++)
        *c = *c == '\\' ? '/' : *c;
    return whole;
}

static int call(const char *path, BOOL WINAPI change(const wchar_t *wide))
{
    wchar_t *wide = win32_path(path);
    const int result = !wide ? -1 : change(wide) ? 0 : win32_failed();
    free(wide);
    return result;
}

int fxs_file_remove(const char *path)
{
    return call(path, DeleteFileW);
}

int fxs_folder_remove(const char *path)
{
    return call(path, RemoveDirectoryW);
}

int fxs_file_rename(const char *from, const char *to)
{
    wchar_t *old = win32_path(from), *name = win32_path(to);
    const int result = !old || !name ? -1 : MoveFileExW(old, name, MOVEFILE_REPLACE_EXISTING) ? 0 : win32_failed();
    free(old);
    free(name);
    return result;
}

static int may_have_files(const char *folder)
{
    char name[64];
    const size_t length = strlen(folder);
    char *path = malloc(length + sizeof name);
    snprintf(name, sizeof name, "/fixsplat-%lx.tmp", GetCurrentProcessId());
    if (path)
        sprintf(path, "%s%s", folder, name + (length && folder[length - 1] == '/'));
    wchar_t *wide = path ? win32_path(path) : NULL;
    const HANDLE file = !wide ? INVALID_HANDLE_VALUE
                              : CreateFileW(wide, GENERIC_WRITE | DELETE, FILE_SHARE_DELETE, NULL, CREATE_ALWAYS,
                                            FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
    const int result = file != INVALID_HANDLE_VALUE ? 0 : wide ? win32_failed() : -1;
    if (file != INVALID_HANDLE_VALUE)
        CloseHandle(file);
    free(wide);
    free(path);
    return result;
}

int fxs_file_may_be_written(const char *path)
{
    const DWORD attributes = attributes_of(path);
    if (attributes != INVALID_FILE_ATTRIBUTES && attributes & FILE_ATTRIBUTE_DIRECTORY)
        return may_have_files(path);
    if (attributes != INVALID_FILE_ATTRIBUTES && !(attributes & FILE_ATTRIBUTE_READONLY))
        return 0;
    errno = attributes != INVALID_FILE_ATTRIBUTES ? EACCES : ENOENT;
    return -1;
}

/* Makes a hard link to a file, or a copy on another drive, because symbolic links need administrator rights. */
int fxs_file_link(const char *target, const char *name)
{
    wchar_t *old = win32_path(target), *wide = win32_path(name);
    int result = -1;
    if (old && wide)
        result = CreateHardLinkW(wide, old, NULL) || CopyFileW(old, wide, TRUE) ? 0 : win32_failed();
    free(old);
    free(wide);
    return result;
}

/* Locks a file until the process ends, by an unshared handle that stays open. */
int fxs_file_lock(const char *path)
{
    wchar_t *wide = win32_path(path);
    const HANDLE handle = !wide ? INVALID_HANDLE_VALUE
                                : CreateFileW(wide, GENERIC_WRITE, 0, NULL, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL, NULL);
    const int result = !wide ? -1 : handle != INVALID_HANDLE_VALUE ? 0 : win32_failed();
    free(wide);
    return result && errno == EBUSY ? 1 : result;
}

int fxs_links_folders(void)
{
    return 0;
}

void fxs_file_unlink(const char *name)
{
    const DWORD attributes = attributes_of(name);
    if (attributes != INVALID_FILE_ATTRIBUTES && attributes & FILE_ATTRIBUTE_REPARSE_POINT)
        (attributes & FILE_ATTRIBUTE_DIRECTORY ? fxs_folder_remove : fxs_file_remove)(name);
}

static BOOL WINAPI create_folder(const wchar_t *wide)
{
    return CreateDirectoryW(wide, NULL);
}

int fxs_folder_make(const char *path, fxs_message *message)
{
    const char *fault = fxs_path_fault(path);
    if (fault)
        return fxs_fail(message, "%s: %s", path, fault);
    if (!call(path, create_folder))
        return 0;
    const int error = errno;
    return error == EEXIST && fxs_file_kind(path) == FXS_FILE_FOLDER ? 0 : fxs_fail_errno(message, path, error);
}

static wchar_t *all_in(const char *folder)
{
    wchar_t *wide = win32_path(folder);
    const size_t length = wide ? wcslen(wide) : 0;
    wchar_t *pattern = wide ? malloc((length + 3) * sizeof *pattern) : NULL;
    if (pattern)
        wcscat(wcscpy(pattern, wide), length && wide[length - 1] == L'\\' ? L"*" : L"\\*");
    free(wide);
    return pattern;
}

int fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument)
{
    WIN32_FIND_DATAW entry;
    wchar_t *pattern = all_in(path);
    const HANDLE found = pattern ? FindFirstFileW(pattern, &entry) : INVALID_HANDLE_VALUE;
    const int result = found != INVALID_HANDLE_VALUE ? 0 : pattern ? win32_failed() : -1;
    free(pattern);
    if (result)
        return result;
    do {
        char *name = win32_narrow(entry.cFileName);
        if (name)
            each(argument, name);
        free(name);
    } while (FindNextFileW(found, &entry));
    FindClose(found);
    return 0;
}

FILE *win32_stream(HANDLE handle, const char *mode)
{
    const int descriptor = _open_osfhandle((intptr_t)handle, *mode == 'a' ? _O_APPEND : 0);
    FILE *file = descriptor < 0 ? NULL : _fdopen(descriptor, mode);
    if (!file && descriptor >= 0)
        _close(descriptor);
    else if (!file)
        CloseHandle(handle);
    return file;
}

static int open_checked(HANDLE handle, const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    fxs_file_facts found;
    if (win32_look(handle, &found) != FXS_FILE_REGULAR) {
        CloseHandle(handle);
        return fxs_fail(message, "%s: not a regular file", path);
    }
    if (facts)
        *facts = found;
    *file = win32_stream(handle, "rb");
    return *file ? 0 : fxs_fail_errno(message, path, errno);
}

/* Opens a regular file. Folders are opened too, so that the error message can say that the path is a folder. */
int fxs_file_open(const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    const char *fault = fxs_path_fault(path);
    *file = NULL;
    if (fault)
        return fxs_fail(message, "%s: %s", path, fault);
    const HANDLE handle = win32_open(path, GENERIC_READ, FILE_FLAG_BACKUP_SEMANTICS);
    return handle == INVALID_HANDLE_VALUE ? fxs_fail_errno(message, path, errno)
                                          : open_checked(handle, path, file, facts, message);
}

/* Returns the absolute path of a file's folder, or null and errno on failure. The caller calls free(). */
static char *whole_folder(const char *path)
{
    const size_t length = strlen(path) - strlen(strrchr(path, '/') ? strrchr(path, '/') + 1 : path);
    char *folder = malloc(length + 2);
    if (!folder)
        return NULL;
    memcpy(folder, path, length);
    strcpy(folder + length, length ? "" : ".");
    char *whole = fxs_path_whole(folder);
    free(folder);
    return whole;
}

static int is_within(const char *folder, const char *path)
{
    const size_t length = strlen(folder);
    return !_strnicmp(path, folder, length) &&
           (path[length] == '/' || path[length] == '\0' || folder[length - 1] == '/');
}

/* Stores the absolute path of `path` in *whole. Fails if it lies outside the folder of the file `first`. The caller
   frees *whole. */
static int follow_within(const char *first, const char *path, char **whole, fxs_message *message)
{
    char *folder = whole_folder(first);
    int result = 0;
    *whole = folder ? fxs_path_whole(path) : NULL;
    if (!*whole)
        result = fxs_fail_errno(message, path, errno);
    else if (!is_within(folder, *whole))
        result = fxs_fail(message, "%s: leaves the folder of %s", path, first);
    free(folder);
    return result;
}

int fxs_file_check_within(const char *first, const char *path, fxs_message *message)
{
    char *whole;
    const int result = follow_within(first, path, &whole, message);
    free(whole);
    return result;
}

int fxs_file_open_within(const char *first, const char *path, FILE **file, fxs_file_facts *facts, fxs_message *message)
{
    char *whole;
    int result = follow_within(first, path, &whole, message);
    *file = NULL;
    if (!result)
        result = fxs_file_open(whole, file, facts, message);
    free(whole);
    return result;
}

int fxs_file_read_at(FILE *file, uint64_t offset, void *out, size_t size)
{
    return _fseeki64(file, (__int64)offset, SEEK_SET) == 0 && fread(out, 1, size, file) == size ? 0 : -1;
}

FILE *fxs_stream_open(const char *path, const char *mode)
{
    wchar_t *wide = win32_path(path);
    FILE *file = wide ? _wfopen(wide, *mode == 'r' ? L"rb" : *mode == 'w' ? L"wb" : L"ab") : NULL;
    free(wide);
    return file;
}

/* Opens a temporary file in the temporary folder. tmpfile of Windows would use the root of the drive. */
FILE *fxs_stream_temporary(void)
{
    static volatile LONG count;
    const DWORD access = GENERIC_READ | GENERIC_WRITE | DELETE;
    const DWORD shared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
    wchar_t folder[MAX_PATH + 1], name[MAX_PATH + 64];
    HANDLE handle = INVALID_HANDLE_VALUE;
    const DWORD length = GetTempPathW(MAX_PATH + 1, folder);
    if (length && length <= MAX_PATH)
        do {
            _snwprintf(name, sizeof name / sizeof *name, L"%lsfixsplat-%lx-%lx.tmp", folder, GetCurrentProcessId(),
                       InterlockedIncrement(&count));
            handle = CreateFileW(name, access, shared, NULL, CREATE_NEW,
                                 FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
        } while (handle == INVALID_HANDLE_VALUE && GetLastError() == ERROR_FILE_EXISTS);
    if (handle != INVALID_HANDLE_VALUE)
        return win32_stream(handle, "w+b");
    win32_failed();
    return NULL;
}

/* Returns the errno of a failed write. After a partial write, the C library reports no reason or EINVAL. Writing one
   more byte then gives the real error. */
int fxs_stream_fault(FILE *file)
{
    const int number = errno && errno != EINVAL ? errno : EIO;
    const HANDLE handle = (HANDLE)_get_osfhandle(_fileno(file));
    DWORD written;
    if (number != EIO || GetFileType(handle) != FILE_TYPE_DISK || WriteFile(handle, "", 1, &written, NULL))
        return number;
    win32_failed();
    return errno;
}

int fxs_stream_empty(FILE *file)
{
    fflush(file);
    return _chsize(_fileno(file), 0);
}

/* Text that clears a line of the console: 79 spaces, because older consoles do not support escape codes. */
#define TEN "          "
const char fxs_erase_line[] = "\r" TEN TEN TEN TEN TEN TEN TEN "         \r";

/* Returns 1 if a file is a console. Does not use _isatty, which is also true for the null device. */
int fxs_is_terminal(FILE *file)
{
    DWORD mode;
    return GetConsoleMode((HANDLE)_get_osfhandle(_fileno(file)), &mode) != 0;
}

int fxs_terminal_ends_with_this(void)
{
    DWORD others[2];
    const DWORD count = GetConsoleProcessList(others, 2);
    return count == 1 || (count == 2 && getenv("FIXSPLAT_OWN_CONSOLE")); /* 2: this program and its starter */
}

int fxs_terminal_takes_codes(FILE *file)
{
    DWORD mode;
    const HANDLE console = (HANDLE)_get_osfhandle(_fileno(file));
    return !GetConsoleMode(console, &mode) || SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

static int descriptor_of(HANDLE handle)
{
    const int descriptor = _open_osfhandle((intptr_t)handle, _O_RDONLY);
    if (descriptor < 0)
        CloseHandle(handle);
    return descriptor;
}

int fxs_descriptor_open(const char *path)
{
    const HANDLE handle = open_itself(path, GENERIC_READ, 0);
    return handle == INVALID_HANDLE_VALUE ? -1 : descriptor_of(handle);
}

int fxs_descriptor_again(int descriptor)
{
    const HANDLE process = GetCurrentProcess();
    const HANDLE first = (HANDLE)_get_osfhandle(descriptor);
    HANDLE handle;
    if (!DuplicateHandle(process, first, process, &handle, 0, FALSE, DUPLICATE_SAME_ACCESS))
        return win32_failed();
    return descriptor_of(handle);
}

int fxs_descriptor_of(FILE *file)
{
    return fxs_descriptor_again(_fileno(file));
}

enum fxs_file_kind fxs_descriptor_look(int descriptor, fxs_file_facts *facts)
{
    return win32_look((HANDLE)_get_osfhandle(descriptor), facts);
}

int fxs_descriptor_read(int descriptor, void *out, size_t size)
{
    OVERLAPPED from = {0};
    DWORD got;
    return size <= MAXDWORD && ReadFile((HANDLE)_get_osfhandle(descriptor), out, (DWORD)size, &got, &from) &&
           got == size ? 0 : -1;
}

void fxs_descriptor_close(int descriptor)
{
    _close(descriptor);
}
