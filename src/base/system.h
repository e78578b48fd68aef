/* What the library and the command ask of the operating system beside files and outputs. The functions are in
   port/posix and port/win32. Paths are in UTF-8, with / between folders. */
#ifndef FXS_SYSTEM_H
#define FXS_SYSTEM_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <fixsplat/fixsplat.h>

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Memory at a multiple of 64 bytes, which the caller gives back; null: there is none. */
void *fxs_aligned_allocate(size_t bytes);

/* Null is allowed. */
void fxs_aligned_free(void *block);

/* A text that is written to `file`. */
typedef struct fxs_printed {
    FILE *file;
    char *text;                /* once it is ended: for free(), of `size` bytes, and a 0 behind them */
    size_t size;
} fxs_printed;

/* Returns 0, or -1 where there is no memory. `printed` must not move until it is ended. */
int fxs_print_begin(fxs_printed *printed);

/* Closes the file. Returns 0, or -1 where something could not be written; the text is null then. */
int fxs_print_end(fxs_printed *printed);

/* ---- Names of files ---------------------------------------------------------------------------------------------- */

enum fxs_file_kind { FXS_FILE_NONE, FXS_FILE_REGULAR, FXS_FILE_FOLDER, FXS_FILE_OTHER };

typedef struct fxs_file_facts {
    uint64_t size, device, inode;
    uint64_t modified;         /* when it was, in nanoseconds modulo 2^64: to tell one time from another */
} fxs_file_facts;

/* The kind of a file, after its symbolic links are followed. */
enum fxs_file_kind fxs_file_kind(const char *path);

/* The same, and what is known of the file or folder. */
enum fxs_file_kind fxs_file_look(const char *path, fxs_file_facts *facts);

/* The same of the name itself: a symbolic link is FXS_FILE_OTHER. */
enum fxs_file_kind fxs_file_look_at_name(const char *path, fxs_file_facts *facts);

/* Of an open file. */
enum fxs_file_kind fxs_stream_look(FILE *file, fxs_file_facts *facts);

/* 1 where the name exists, even as a symbolic link to a missing file, else 0. */
int fxs_file_is_named(const char *path);

/* 1 where the path does not depend on the folder that the program is in. */
static inline int fxs_path_is_whole(const char *path)
{
#ifdef _WIN32
    if (path[0] && path[1] == ':')
        return 1;
#endif
    return *path == '/';
}

/* A path that the system gives becomes as paths are here: \ of Windows, which no name has, becomes /. One without it may
   be a constant. */
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

/* A path with a name from a data file: where nothing has that very name, each \ of it is a /. */
static inline void fxs_path_settle(char *path)
{
    for (char *c = fxs_file_is_named(path) ? NULL : strchr(path, '\\'); c; c = strchr(c, '\\'))
        *c = '/';
}

/* 1 where a path ends so behind at least one character; capitals are small letters. */
static inline int fxs_ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), size = strlen(ending);
    return length > size && !strncasecmp(path + length - size, ending, size);
}

/* What makes a path none of the system, as "is the name of a device in Windows", or null. */
const char *fxs_path_fault(const char *path);

/* The following return 0, or -1 and errno. */
int fxs_file_remove(const char *path);
int fxs_file_rename(const char *from, const char *to);
int fxs_folder_remove(const char *path);

/* Whether a file, or files in a folder, can be written. */
int fxs_file_may_be_written(const char *path);

/* A symbolic link to a file, or to a folder where fxs_links_folders; or, where not everybody may make those, another
   name of the file, or a copy. */
int fxs_file_link(const char *target, const char *name);
int fxs_links_folders(void);

/* Removes what fxs_file_link made; nothing else. */
void fxs_file_unlink(const char *name);

/* Locks a file, which is made where it is not there, until this process ends, however it ends. Returns 0, also on a
   file system without locks; 1 where another process has it; or -1 and errno. */
int fxs_file_lock(const char *path);

/* The path from the root, without symbolic links, for free(). Null, and errno. */
char *fxs_path_whole(const char *path);

/* Makes a folder, unless it is there. Returns 0, or an error and a message. */
int fxs_folder_make(const char *path, fxs_message *message);

/* Calls a function with the name of each file in a folder, in no order; of a folder that cannot be read, with none.
   Returns 0, or -1 and errno where it cannot. */
int fxs_folder_each(const char *path, void (*each)(void *argument, const char *name), void *argument);

/* ---- Places ------------------------------------------------------------------------------------------------------ */

/* The path of a file that the programs keep for their user: in $XDG_STATE_HOME/fixsplat or ~/.local/state/fixsplat, of
   Windows in %APPDATA%\fixsplat. Where it is to be written, the folders above it are made. Returns 0, or -1 where there
   is no folder for it. */
int fxs_state_path(const char *name, int is_written, char *path, size_t room);

/* The path of a font of the system that is made for screens. Returns 0, or -1 and a message. */
int fxs_font_find(char *path, size_t room, fxs_message *message);

/* ---- Commands for people to type --------------------------------------------------------------------------------- */

/* What a shell takes a word in, the same within such a word, what is doubled before both, and the name of Python. */
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

/* fopen: of its modes r, w and a, with b where no line is to end in another way than in the file. Null, and errno. */
FILE *fxs_stream_open(const char *path, const char *mode);

/* tmpfile: to be written and read, and gone when it is closed. Null, and errno. */
FILE *fxs_stream_temporary(void);

/* Takes out of a file all that is in it. Returns 0, or -1 and errno, of which EINVAL: it is of a kind that has no
   length. */
int fxs_stream_empty(FILE *file);

/* Why not all that was written to a stream has arrived: an errno, never 0. Before the call that failed, errno was 0. */
int fxs_stream_fault(FILE *file);

int fxs_is_terminal(FILE *file);

/* Whether the terminal was made for this program alone and ends with it, as by a double click in Windows: what is printed
   last is read by nobody. */
int fxs_terminal_ends_with_this(void);

/* Makes the line of a terminal an empty one. */
extern const char fxs_erase_line[];

/* Whether a terminal takes the codes of ECMA-48, which tell it of colours. On Windows it is told to take them. */
int fxs_terminal_takes_codes(FILE *file);

/* ---- Descriptors ------------------------------------------------------------------------------------------------- */

/* Of files that are read at any place by any thread, as libmicrohttpd takes them. Programs that are run from here do
   not have them. Those that return a descriptor return -1, and errno, where there is none. */

/* 1 where a file that is open can be replaced by another, else 0. */
#ifdef _WIN32
enum { FXS_OPEN_MAY_BE_REPLACED = 0 };
#else
enum { FXS_OPEN_MAY_BE_REPLACED = 1 };
#endif

/* Of a file to be read. It is no symbolic link, and waits for nobody who writes to a FIFO. */
int fxs_descriptor_open(const char *path);

/* Another of the same file, also after the first is closed. */
int fxs_descriptor_again(int descriptor);
int fxs_descriptor_of(FILE *file);

enum fxs_file_kind fxs_descriptor_look(int descriptor, fxs_file_facts *facts);

/* Reads that many bytes from the beginning. Returns 0, or -1 where not all could be read. */
int fxs_descriptor_read(int descriptor, void *out, size_t size);

void fxs_descriptor_close(int descriptor);

/* ---- Programs ---------------------------------------------------------------------------------------------------- */

/* Called first of all by main: a standard file that is closed becomes one that every use of fails, bytes go through
   the standard files unchanged, and the arguments are in UTF-8, their paths with /. */
void fxs_program_begin(int *argc, char ***argv);

/* The path of this program, cut to fit; empty where it is not known. */
void fxs_program_path(char *path, size_t room);

/* 1 where the user's path has a program of this name, or the system finds the library, else 0. */
int fxs_program_is_here(const char *name);
int fxs_library_is_here(const char *name);

/* Of this program and those that it runs. */
void fxs_program_set(const char *variable, const char *value);

/* A function that gets what a program prints, piece by piece. */
typedef void fxs_program_said_fn(void *argument, const char *data, size_t size);

enum { FXS_PROGRAM_MISSING = 127,      /* as a shell says that there is no such program */
       FXS_PROGRAM_SIGNAL = 256 };

/* Runs a program of the user's path, the first of the arguments, which end with null; its input is empty, and what it
   prints on standard error goes to `log`. However this process ends meanwhile, the program and those that it started
   are ended too. Returns its exit status, FXS_PROGRAM_SIGNAL and the signal's number where one ended it,
   FXS_PROGRAM_MISSING, or -1 and errno where it could not be run. */
int fxs_program_run(const char *const *arguments, FILE *log, fxs_program_said_fn *said, void *argument);

/* Runs a program in place of this one. Returns where that fails, with errno. */
void fxs_program_become(const char *path, char **argv);

/* Opens an address in the browser of a desktop, where there is one, and does not wait for it. Returns 0, or -1 and
   errno where it cannot. */
int fxs_browse(const char *address);

/* ---- Being asked to end ------------------------------------------------------------------------------------------ */

/* From here on the first request to end this process (Ctrl-C; SIGHUP, SIGINT, SIGTERM) is only noted. The next one does
   what it would have done, and what is ignored stays so. */
void fxs_end_listen(void);

/* Not 0 where there was one. */
int fxs_end_asked(void);

/* Requests end the process again. */
void fxs_end_listen_no_more(void);

/* Ends this process as the request would have done; only after one. */
void fxs_end_as_asked(void);

/* In the place of the others, for a program that waits for a request: from here on each waits for fxs_end_wait, of this
   thread and of those that it starts. What is ignored stays so. Nor is it ended by writing what nobody reads. */
void fxs_end_hold(void);

/* Waits for so many milliseconds, or for a request after fxs_end_hold. Returns 1 where there is one, else 0. */
int fxs_end_wait(unsigned milliseconds);

/* Calls a function whose threads get no signals. */
void fxs_without_signals(void (*call)(void *argument), void *argument);

#endif
