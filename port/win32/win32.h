/* What the files of port/win32 share. */
#ifndef WIN32_H
#define WIN32_H

#define WIN32_LEAN_AND_MEAN
#define _WIN32_WINNT 0x0601
#include <windows.h>
#include <stdio.h>

#include "src/base/system.h"

/* A path in UTF-8 as the functions of Windows take it, with the prefix that longer ones than 260 characters need; for
   free(). Null, and errno. */
wchar_t *win32_path(const char *path);

/* The same from the root, always with the prefix. */
wchar_t *win32_whole_path(const char *path);

/* A text in UTF-16 as UTF-8, for free(), and the other way round. Null, and errno. */
char *win32_narrow(const wchar_t *text);
wchar_t *win32_wide(const char *text);

/* The arguments of the command line in UTF-8, as the command takes them. Where there is no memory they stay. */
void win32_arguments(int *argc, char ***argv);

/* Sets errno to what the last error of Windows means. Returns -1. */
int win32_failed(void);

/* What is known of an open file. */
enum fxs_file_kind win32_look(HANDLE handle, fxs_file_facts *facts);

/* Opens a file that others may read, write and replace. Returns INVALID_HANDLE_VALUE and errno. */
HANDLE win32_open(const char *path, DWORD access, DWORD flags);

/* A stream of a handle, which is closed with it, or at once where there is no memory: null and errno. `mode` is "rb",
   "wb", "w+b" or "ab". */
FILE *win32_stream(HANDLE handle, const char *mode);

#endif
