/* Functions of the operating system, except those for output files. Implemented in port/posix and port/win32. Paths are
   UTF-8 with / between folders. */
#ifndef FXS_OS_CALLS_H
#define FXS_OS_CALLS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <fixsplat/fixsplat.h>

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Allocates memory aligned to 64 bytes. Returns null if memory ran out. */
void *fxs_aligned_allocate(size_t bytes);

void fxs_aligned_free(void *block);

typedef struct fxs_printed {
    FILE *file;
    char *text;                /* printed text, set by fxs_print_end; the caller calls free() */
    size_t size;
} fxs_printed;

/* Opens printed->file, which prints to memory. `printed` must not move until fxs_print_end. */
int fxs_print_begin(fxs_printed *printed);

int fxs_print_end(fxs_printed *printed);

/* ---- Names of files ---------------------------------------------------------------------------------------------- */

enum fxs_file_kind { FXS_FILE_NONE, FXS_FILE_REGULAR, FXS_FILE_FOLDER, FXS_FILE_OTHER };

typedef struct fxs_file_facts {
    uint64_t size, device, inode;
    uint64_t modified;         /* time of modification in nanoseconds */
} fxs_file_facts;

/* Functions that return a file kind follow symbolic links, except fxs_file_look_at_name. */
enum fxs_file_kind fxs_file_kind(const char *path);

enum fxs_file_kind fxs_file_look(const char *path, fxs_file_facts *facts);

/* Returns the kind of a file without following symbolic links. The kind of a link is FXS_FILE_OTHER. */
enum fxs_file_kind fxs_file_look_at_name(const char *path, fxs_file_facts *facts);

enum fxs_file_kind fxs_stream_look(FILE *file, fxs_file_facts *facts);

/* Returns 1 if a file or symbolic link of this name exists. */
int fxs_file_is_named(const char *path);

static inline int fxs_path_is_whole(const char *path)
{
#ifdef _WIN32
    if (path[0] && path[1] == ':')
        return 1;
#endif
    return *path == '/';
}

/* On Windows, replaces backslashes in a path by slashes. */
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

/* Replaces backslashes in a path by slashes, unless a file has exactly this name with backslashes. */
static inline void fxs_path_settle(char *path)
{
    for (char *c = fxs_file_is_named(path) ? NULL : strchr(path, '\\'); c; c = strchr(c, '\\'))
        *c = '/';
}

/* Returns 1 if a path ends with `ending`, ignoring case, and has at least a character before the ending. */
static inline int fxs_ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), size = strlen(ending);
    return length > size && !strncasecmp(path + length - size, ending, size);
}

/* Returns the reason why the system forbids a path, or null for an allowed path. */
const char *fxs_path_fault(const char *path);

int fxs_file_remove(const char *path);
int fxs_file_rename(const char *from, const char *to);
int fxs_folder_remove(const char *path);

/* Returns 0 if the user may write to this file, or may make files in this folder. */
int fxs_file_may_be_written(const char *path);

/* Makes a symbolic link to a file. Links to folders too if fxs_links_folders returns 1. Without symbolic links, makes a
   hard link or a copy. */
int fxs_file_link(const char *target, const char *name);
int fxs_links_folders(void);

/* Removes a link made by fxs_file_link, but no other file. */
void fxs_file_unlink(const char *name);

/* Locks a file until this process ends. Returns 1 if another process holds the lock. */
int fxs_file_lock(const char *path);

/* Returns the absolute path without symbolic links. The caller calls free(). Returns null and errno on failure. */
char *fxs_path_whole(const char *path);

/* Makes a folder. Returns 0, also if the folder exists already; or an error and a message. */
int fxs_folder_make(const char *path, fxs_message *message);

/* Calls the function `each` with every name in a folder, in arbitrary order. */
int fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument);

/* ---- User data and fonts ----------------------------------------------------------------------------------------- */

/* Stores the path of a file in this program's folder of user data, or of the user's cache. is_written: 1 also makes
   missing folders. */
int fxs_state_path(const char *name, int is_written, char *path, size_t room);
int fxs_cache_path(const char *name, int is_written, char *path, size_t room);

int fxs_font_find(char *path, size_t room, fxs_message *message);

/* ---- Shell commands in messages ---------------------------------------------------------------------------------- */

/* How a shell command quotes a word: the quote around the word, an escaped quote, and the character to double before a
   quote. */
#ifdef _WIN32
#define FXS_SHELL_QUOTE '"'
#define FXS_SHELL_QUOTED_QUOTE "\\\""
#define FXS_SHELL_DOUBLED '\\'
#define FXS_PYTHON "py"
#else
#define FXS_SHELL_QUOTE '\''
#define FXS_SHELL_QUOTED_QUOTE "'\\''"
#define FXS_SHELL_DOUBLED '\0'
#define FXS_PYTHON "python3"
#endif

/* ---- Streams ----------------------------------------------------------------------------------------------------- */

/* Opens a file like fopen, with mode r, w or a. Line ends are never converted. */
FILE *fxs_stream_open(const char *path, const char *mode);

FILE *fxs_stream_temporary(void);

int fxs_stream_empty(FILE *file);

/* Returns the errno of a failed write, never 0. Set errno to 0 before writing. */
int fxs_stream_fault(FILE *file);

int fxs_is_terminal(FILE *file);

/* Returns 1 if the terminal window closes when this program ends. */
int fxs_terminal_ends_with_this(void);

/* Escape sequence that clears the current line of a terminal. */
extern const char fxs_erase_line[];

/* Returns 1 if a terminal accepts colours (ECMA-48). */
int fxs_terminal_takes_codes(FILE *file);

/* ---- File descriptors -------------------------------------------------------------------------------------------- */

/* The file descriptors of these functions allow reads at any position from any thread. Child processes do not inherit
   them. */

/* 1 if the system lets another file take the place of an open file. */
#ifdef _WIN32
enum { FXS_OPEN_MAY_BE_REPLACED = 0 };
#else
enum { FXS_OPEN_MAY_BE_REPLACED = 1 };
#endif

/* Opens a file for reading and returns a descriptor. Fails for symbolic links, and does not wait for the writer of a
   FIFO. */
int fxs_descriptor_open(const char *path);

/* Returns a second descriptor of an open file, to be closed separately. */
int fxs_descriptor_again(int descriptor);
int fxs_descriptor_of(FILE *file);

enum fxs_file_kind fxs_descriptor_look(int descriptor, fxs_file_facts *facts);

/* Reads the first `size` bytes of an open file. */
int fxs_descriptor_read(int descriptor, void *out, size_t size);

void fxs_descriptor_close(int descriptor);

/* ---- Programs ---------------------------------------------------------------------------------------------------- */

/* Prepares the process; must be the first call in main. Makes standard input, output and error binary, and replaces
   them if closed. Converts the arguments to UTF-8. */
void fxs_program_begin(int *argc, char ***argv);

/* Stores the path of the running program; an empty path if unknown. */
void fxs_program_path(char *path, size_t room);

/* Return 1 if a program is in PATH or a library is installed, else 0. */
int fxs_program_is_here(const char *name);
int fxs_library_is_here(const char *name);

void fxs_program_set(const char *variable, const char *value);

/* Callback that receives the output of a program in pieces. */
typedef void fxs_program_said_fn(void *argument, const char *data, size_t size);

enum { FXS_PROGRAM_MISSING = 127,
       FXS_PROGRAM_SIGNAL = 256 };

/* Runs the program arguments[0] from PATH; a null ends the arguments. The program's standard output goes to `said`, its
   standard error to `log`, or to `said` if `log` is null. If this process dies, the program and its children are
   killed. Returns the exit status, FXS_PROGRAM_SIGNAL plus a signal's number, FXS_PROGRAM_MISSING, or -1. */
int fxs_program_run(const char *const *arguments, FILE *log, fxs_program_said_fn *said, void *argument);

/* A program that reads what this process writes. */
typedef struct fxs_fed {
    intptr_t input, process;
} fxs_fed;

/* Starts the program arguments[0] from PATH, whose standard output and error go to `log`. It ends by itself if this
   process dies, because its input ends. Returns 0, FXS_PROGRAM_MISSING or -1. */
int fxs_program_feed(const char *const *arguments, FILE *log, fxs_fed *fed);

/* Writes to the program's standard input, without SIGPIPE. Returns 0 or -1. */
int fxs_fed_write(const fxs_fed *fed, const void *bytes, size_t size);

/* Ends the program's input and waits for its end. Returns a status as fxs_program_run. */
int fxs_fed_end(const fxs_fed *fed);

void fxs_program_become(const char *path, char **argv);

int fxs_browse(const char *address);

/* Lets the user's desktop open .fxs and .ply files in the viewer by a double click. is_removed: 1 undoes this. Returns
   0, or an error and a message. */
int fxs_associate(int is_removed, fxs_message *why);

/* ---- Shutdown ---------------------------------------------------------------------------------------------------- */

/* Makes the first SIGHUP, SIGINT, SIGTERM or Ctrl-C only set a flag, which fxs_end_asked reads. Ignored signals stay
   ignored. */
void fxs_end_listen(void);

/* Returns nonzero after a signal that asked this process to end. */
int fxs_end_asked(void);

/* Restores the default effect of the signals that ask this process to end. */
void fxs_end_listen_no_more(void);

void fxs_end_as_asked(void);

/* For servers: blocks SIGHUP, SIGINT and SIGTERM, for which fxs_end_wait then waits. Ignores SIGPIPE. */
void fxs_end_hold(void);

/* Waits for a signal that asks this process to end. Returns 1 if one arrives within `milliseconds`, else 0. */
int fxs_end_wait(unsigned milliseconds);

/* Calls a function with all signals blocked. Threads that the function starts then receive no signals. */
void fxs_without_signals(void (*call)(void *argument), void *argument);

#endif
