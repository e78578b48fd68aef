/* Functions that several files of port/win32 use. */
#ifndef WIN32_H
#define WIN32_H

#define WIN32_LEAN_AND_MEAN
#define _WIN32_WINNT 0x0601
#include <windows.h>
#include <stdio.h>

#include "src/base/os_calls.h"

/* Converts a UTF-8 path to UTF-16. Long paths become absolute and get the prefix \\?\. The caller calls free(). Returns
   null and errno on failure. */
wchar_t *win32_path(const char *path);

/* Converts a UTF-8 path to an absolute UTF-16 path with the prefix \\?\. The caller calls free(). */
wchar_t *win32_whole_path(const char *path);

/* Convert text from UTF-16 to UTF-8 and back. The caller calls free(). Return null and errno on failure. */
char *win32_narrow(const wchar_t *text);
wchar_t *win32_wide(const char *text);

/* Replaces main's arguments by the words of the command line in UTF-8, with wildcards expanded. */
void win32_arguments(int *argc, char ***argv);

/* Sets errno to the value that corresponds to GetLastError. Returns -1. */
int win32_failed(void);

enum fxs_file_kind win32_look(HANDLE handle, fxs_file_facts *facts);

/* Opens an existing file. Other programs may still read, write and replace the file. Returns INVALID_HANDLE_VALUE and
   errno on failure. */
HANDLE win32_open(const char *path, DWORD access, DWORD flags);

/* Makes a FILE from a handle, which fclose then closes. On failure, closes the handle and returns null and errno. */
FILE *win32_stream(HANDLE handle, const char *mode);

#endif
