/* Operating system functions other than files and outputs. Implemented in port/posix and port/win32. Paths are UTF-8
   with / between folders. */
#ifndef FXS_OS_CALLS_H
#define FXS_OS_CALLS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <fixsplat/fixsplat.h>

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Allocates memory aligned to 64 bytes, for fxs_aligned_free. Returns null if out of memory. */
void *fxs_aligned_allocate(size_t bytes);

/* Accepts null. */
void fxs_aligned_free(void *block);

/* A text in memory that is written through `file`. */
typedef struct fxs_printed {
    FILE *file;
    char *text;                /* set by fxs_print_end: `size` bytes and a 0, for free() */
    size_t size;
} fxs_printed;

/* Returns 0, or -1 if out of memory. `printed` must not move until fxs_print_end. */
int fxs_print_begin(fxs_printed *printed);

/* Closes the file. Returns 0, or -1 and a null text if a write failed. */
int fxs_print_end(fxs_printed *printed);

/* ---- Names of files ---------------------------------------------------------------------------------------------- */

enum fxs_file_kind { FXS_FILE_NONE, FXS_FILE_REGULAR, FXS_FILE_FOLDER, FXS_FILE_OTHER };

typedef struct fxs_file_facts {
    uint64_t size, device, inode;
    uint64_t modified;         /* time of modification in nanoseconds modulo 2^64, only for comparison */
} fxs_file_facts;

/* The kind of a file. Follows symbolic links. */
enum fxs_file_kind fxs_file_kind(const char *path);

/* As fxs_file_kind; also fills in the facts of a file or folder. */
enum fxs_file_kind fxs_file_look(const char *path, fxs_file_facts *facts);

/* As fxs_file_look, but does not follow symbolic links: a link is FXS_FILE_OTHER. */
enum fxs_file_kind fxs_file_look_at_name(const char *path, fxs_file_facts *facts);

/* As fxs_file_look, for an open file. */
enum fxs_file_kind fxs_stream_look(FILE *file, fxs_file_facts *facts);

/* 1 if the name exists, even as a symbolic link to a missing file, else 0. */
int fxs_file_is_named(const char *path);

/* 1 if the path is absolute. */
static inline int fxs_path_is_whole(const char *path)
{
#ifdef _WIN32
    if (path[0] && path[1] == ':')
        return 1;
#endif
    return *path == '/';
}

/* Converts a path from the system to this program's form: on Windows, \ becomes /. A path without \ is not written
   to, so it may be a constant. */
static inline void fxs_path_take(char *path)
{
#ifdef _WIN32
    for (; *path; path++)
        if (*path == '\\')
            *path = '/';
#else
    (void)path;
#endif
}

/* For a path with a name from a data file: if no file has exactly this name, replaces each \ by /. */
static inline void fxs_path_settle(char *path)
{
    for (char *c = fxs_file_is_named(path) ? NULL : strchr(path, '\\'); c; c = strchr(c, '\\'))
        *c = '/';
}

/* 1 if a path ends with `ending`, in any case, after at least one other character. */
static inline int fxs_ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), size = strlen(ending);
    return length > size && !strncasecmp(path + length - size, ending, size);
}

/* Why the system does not allow a path, as "is the name of a device in Windows"; null: the path is allowed. */
const char *fxs_path_fault(const char *path);

/* These return 0, or -1 and errno. */
int fxs_file_remove(const char *path);
int fxs_file_rename(const char *from, const char *to);
int fxs_folder_remove(const char *path);

/* Returns 0 if a file, or files in a folder, can be written, else -1. */
int fxs_file_may_be_written(const char *path);

/* Makes a symbolic link to a file, or to a folder if fxs_links_folders returns 1. On systems where that needs
   privileges: a hard link or a copy. Returns 0, or -1 and errno. */
int fxs_file_link(const char *target, const char *name);
int fxs_links_folders(void);

/* Removes a link made by fxs_file_link; leaves other files alone. */
void fxs_file_unlink(const char *name);

/* Locks a file until this process ends. Creates the file if missing. Returns 0, also on a file system without locks;
   1 if another process holds the lock; or -1 and errno. */
int fxs_file_lock(const char *path);

/* The absolute path without symbolic links, for free(). Null and errno on failure. */
char *fxs_path_whole(const char *path);

/* Makes a folder unless it exists. Returns 0, or an error and a message. */
int fxs_folder_make(const char *path, fxs_message *message);

/* Calls `each` with the name of every entry of a folder, in no particular order. Returns 0, or -1 and errno if the
   folder cannot be read. */
int fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument);

/* ---- Places ------------------------------------------------------------------------------------------------------ */

/* The path of a file with user data: in $XDG_STATE_HOME/fixsplat or ~/.local/state/fixsplat; on Windows in
   %APPDATA%\fixsplat. is_written: 1 creates the folders. Returns 0, or -1 if the user has no such folder. */
int fxs_state_path(const char *name, int is_written, char *path, size_t room);

/* The path of a sans-serif font of the system. Returns 0, or -1 and a message. */
int fxs_font_find(char *path, size_t room, fxs_message *message);

/* ---- Commands for people to type --------------------------------------------------------------------------------- */

/* For printing shell commands: the quote around a word, an escaped quote inside it, the character that must be
   doubled before either, and the name of Python. */
#ifdef _WIN32
#define FXS_SHELL_QUOTE '"'
#define FXS_SHELL_QUOTED_QUOTE "\\\""
#define FXS_SHELL_DOUBLED '\\'
#define FXS_PYTHON "py"
#else
#define FXS_SHELL_QUOTE '\''
#define FXS_SHELL_QUOTED_QUOTE "'\\''"
#define FXS_SHELL_DOUBLED '\0'         /* nothing */
#define FXS_PYTHON "python3"
#endif

/* ---- Streams ----------------------------------------------------------------------------------------------------- */

/* As fopen with mode r, w or a; add b to write line ends unchanged. Null and errno on failure. */
FILE *fxs_stream_open(const char *path, const char *mode);

/* As tmpfile: open for reading and writing, deleted on close. Null and errno on failure. */
FILE *fxs_stream_temporary(void);

/* Truncates a file to 0 bytes. Returns 0, or -1 and errno; EINVAL: this kind of file has no length. */
int fxs_stream_empty(FILE *file);

/* The errno of a failed write, never 0. The caller sets errno to 0 before the call that may fail. */
int fxs_stream_fault(FILE *file);

int fxs_is_terminal(FILE *file);

/* 1 if the terminal window closes when this program ends, as after a double click in Windows; the last output would
   be lost. */
int fxs_terminal_ends_with_this(void);

/* Text that clears the current line of a terminal. */
extern const char fxs_erase_line[];

/* 1 if a terminal accepts ECMA-48 sequences (colours). Enables them on Windows. */
int fxs_terminal_takes_codes(FILE *file);

/* ---- Descriptors ------------------------------------------------------------------------------------------------- */

/* Descriptors allow positional reads from any thread; libmicrohttpd takes them. Child processes do not inherit them.
   Functions that return a descriptor return -1 and errno on failure. */

/* 1 if an open file can be replaced by another, else 0. */
#ifdef _WIN32
enum { FXS_OPEN_MAY_BE_REPLACED = 0 };
#else
enum { FXS_OPEN_MAY_BE_REPLACED = 1 };
#endif

/* Opens a file for reading. Fails for a symbolic link, and does not block on a FIFO. */
int fxs_descriptor_open(const char *path);

/* A second descriptor of the same file, independent of the first. */
int fxs_descriptor_again(int descriptor);
int fxs_descriptor_of(FILE *file);

enum fxs_file_kind fxs_descriptor_look(int descriptor, fxs_file_facts *facts);

/* Reads `size` bytes from the start of the file. Returns 0, or -1 if it has fewer. */
int fxs_descriptor_read(int descriptor, void *out, size_t size);

void fxs_descriptor_close(int descriptor);

/* ---- Programs ---------------------------------------------------------------------------------------------------- */

/* Must be the first call in main. Replaces closed standard files by ones on which every operation fails, makes
   standard files binary, and converts the arguments to UTF-8, with / in paths. */
void fxs_program_begin(int *argc, char ***argv);

/* The path of this program, truncated to fit; empty if unknown. */
void fxs_program_path(char *path, size_t room);

/* 1 if the user's PATH has the program, or the system finds the library, else 0. */
int fxs_program_is_here(const char *name);
int fxs_library_is_here(const char *name);

/* Sets an environment variable of this process and its children. */
void fxs_program_set(const char *variable, const char *value);

/* Receives a program's output in pieces. */
typedef void fxs_program_said_fn(void *argument, const char *data, size_t size);

enum { FXS_PROGRAM_MISSING = 127,      /* the exit status of shells for a missing program */
       FXS_PROGRAM_SIGNAL = 256 };

/* Runs a program from PATH: `arguments` begins with its name and ends with null. Its standard input is empty;
   standard output goes to `said`, standard error to `log`. If this process ends meanwhile, even by SIGKILL, the
   program and its children are killed. Returns its exit status, FXS_PROGRAM_SIGNAL + the signal that killed it,
   FXS_PROGRAM_MISSING, or -1 and errno. */
int fxs_program_run(const char *const *arguments, FILE *log, fxs_program_said_fn *said, void *argument);

/* Replaces this process by a program (exec). Returns only on failure, with errno. */
void fxs_program_become(const char *path, char **argv);

/* Opens an address in the desktop's browser without waiting for it. Does nothing without a desktop. Returns 0, or -1
   and errno. */
int fxs_browse(const char *address);

/* ---- Shutdown ---------------------------------------------------------------------------------------------------- */

/* From now on, the first request to end this process (SIGHUP, SIGINT, SIGTERM; Ctrl-C) only sets a flag. The next
   one has its usual effect. Ignored signals stay ignored. */
void fxs_end_listen(void);

/* Nonzero after a request. */
int fxs_end_asked(void);

/* Restores the usual effect of requests. */
void fxs_end_listen_no_more(void);

/* Ends this process in the way that was requested. Call only after a request. */
void fxs_end_as_asked(void);

/* Server mode: SIGHUP, SIGINT and SIGTERM are blocked in this thread and in threads that it starts, and delivered by
   fxs_end_wait. Ignored signals stay ignored. SIGPIPE is ignored. Use instead of fxs_end_listen. */
void fxs_end_hold(void);

/* After fxs_end_hold: waits for a request, for at most `milliseconds`. Returns 1 after a request, else 0. */
int fxs_end_wait(unsigned milliseconds);

/* Calls a function with all signals blocked, so that threads it starts receive none. */
void fxs_without_signals(void (*call)(void *argument), void *argument);

#endif
