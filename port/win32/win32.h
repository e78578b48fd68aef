/* Functions that the files of port/win32 share. */
#ifndef WIN32_H
#define WIN32_H

#define WIN32_LEAN_AND_MEAN
#define _WIN32_WINNT 0x0601
#include <windows.h>
#include <stdio.h>

#include "src/base/os_calls.h"

/* Converts a UTF-8 path to UTF-16, for free(). Long paths become absolute and get the prefix \\?\. Returns null and
   errno on failure. */
wchar_t *win32_path(const char *path);

/* Converts a UTF-8 path to an absolute UTF-16 path with the prefix \\?\. */
wchar_t *win32_whole_path(const char *path);

/* Convert between UTF-16 and UTF-8, for free(). Return null and errno on failure. */
char *win32_narrow(const wchar_t *text);
wchar_t *win32_wide(const char *text);

/* Replaces the arguments by the command line in UTF-8, with wildcards expanded. */
void win32_arguments(int *argc, char ***argv);

/* Sets errno from GetLastError. Returns -1. */
int win32_failed(void);

enum fxs_file_kind win32_look(HANDLE handle, fxs_file_facts *facts);

/* Opens an existing file that other programs may read, write and replace. Returns INVALID_HANDLE_VALUE and errno on
   failure. */
HANDLE win32_open(const char *path, DWORD access, DWORD flags);

/* Makes a stream that owns the handle. On failure closes the handle and returns null and errno. */
FILE *win32_stream(HANDLE handle, const char *mode);

#endif
