/* Starts programs, opens a browser, and handles console events that ask this process to end. */
#include "win32.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <shellapi.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

static UINT code_page;

static void restore_console(void)
{
    SetConsoleOutputCP(code_page);
}

void fxs_program_begin(int *argc, char ***argv)
{
    FILE *const standard[] = {stdin, stdout, stderr};
    for (int i = 0; i < 3; i++)
        if (_fileno(standard[i]) >= 0)
            _setmode(_fileno(standard[i]), _O_BINARY);
    code_page = GetConsoleOutputCP();
    if (code_page && code_page != CP_UTF8 && SetConsoleOutputCP(CP_UTF8))
        atexit(restore_console);
    win32_arguments(argc, argv);
}

void fxs_program_path(char *path, size_t room)
{
    wchar_t wide[4096];
    const DWORD length = GetModuleFileNameW(NULL, wide, sizeof wide / sizeof *wide);
    char *text = length && length < sizeof wide / sizeof *wide ? win32_narrow(wide) : NULL;
    if (text)
        fxs_path_take(text);
    if (text && strlen(text) > 4 && !_stricmp(text + strlen(text) - 4, ".exe"))
        text[strlen(text) - 4] = 0;
    snprintf(path, room, "%s", text ? text : "");
    free(text);
}

int fxs_program_is_here(const char *name)
{
    wchar_t *wide = win32_wide(name);
    const int is_here = wide && SearchPathW(NULL, wide, L".exe", 0, NULL, NULL) > 0;
    free(wide);
    return is_here;
}

int fxs_library_is_here(const char *name)
{
    HMODULE library = LoadLibraryA(name);
    return library && FreeLibrary(library);
}

void fxs_program_set(const char *variable, const char *value)
{
    char text[256];
    if (snprintf(text, sizeof text, "%s=%s", variable, value) < (int)sizeof text)
        _putenv(text);
}

static wchar_t *add_word(wchar_t *to, const wchar_t *word)
{
    *to++ = L'"';
    for (size_t slashes = 0; *word; word++) {
        slashes = *word == L'\\' ? slashes + 1 : 0;
        if (*word == L'"')
            *to++ = L'\\';
        *to++ = *word;
        if (slashes && (word[1] == L'"' || !word[1]))
            for (; slashes; slashes--)
                *to++ = L'\\';
    }
    *to++ = L'"';
    *to++ = L' ';
    return to;
}

static wchar_t *command_line(const char *const *arguments)
{
    size_t room = 1;
    for (size_t i = 0; arguments[i]; i++)
        room += 2 * strlen(arguments[i]) + 3;
    wchar_t *line = malloc(room * sizeof *line), *end = line;
    for (size_t i = 0; line && arguments[i]; i++) {
        wchar_t *word = win32_wide(arguments[i]);
        if (!word) {
            free(line);
            return NULL;
        }
        end = add_word(end, word);
        free(word);
    }
    if (line)
        *end = 0;
    return line;
}

static int start(const char *const *arguments, HANDLE input, HANDLE output, HANDLE log, HANDLE *process)
{
    STARTUPINFOW how = {.cb = sizeof how, .dwFlags = STARTF_USESTDHANDLES, .hStdInput = input, .hStdOutput = output,
                        .hStdError = log};
    PROCESS_INFORMATION started;
    wchar_t *line = command_line(arguments);
    const int result = !line ? -1 : CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &how, &started)
                                        ? 0 : win32_failed();
    free(line);
    if (!result) {
        CloseHandle(started.hThread);
        *process = started.hProcess;
    }
    return result;
}

/* Makes Windows end a started program when this process ends. break_away: 1 lets the program's children live on. */
static void bind_to_this(HANDLE process, int break_away)
{
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits = {0};
    const HANDLE job = CreateJobObjectW(NULL, NULL);
    limits.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE |
                                              (break_away ? JOB_OBJECT_LIMIT_SILENT_BREAKAWAY_OK : 0);
    if (job && SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits))
        AssignProcessToJobObject(job, process);
}

static DWORD wait_for(HANDLE process)
{
    DWORD code = 0;
    WaitForSingleObject(process, INFINITE);
    GetExitCodeProcess(process, &code);
    CloseHandle(process);
    return code;
}

/* Converts a program's exit code to a status. The crash of a program is reported as if by a signal. */
static int status_of(DWORD code)
{
    return code < FXS_PROGRAM_SIGNAL ? (int)code : FXS_PROGRAM_SIGNAL + SIGSEGV;
}

static void hear_all(HANDLE from, fxs_program_said_fn *said, void *argument)
{
    char data[65536];
    for (DWORD size; ReadFile(from, data, sizeof data, &size, NULL) && size;)
        said(argument, data, size);
}

int fxs_program_run(const char *const *arguments, FILE *log, fxs_program_said_fn *said, void *argument)
{
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    HANDLE from, to, process;
    if (log)
        fflush(log);
    if (!CreatePipe(&from, &to, &inherited, 0))
        return win32_failed();
    const HANDLE errors = log ? (HANDLE)_get_osfhandle(_fileno(log)) : to;
    const HANDLE input = CreateFileW(L"NUL", GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                                     OPEN_EXISTING, 0, NULL);
    SetHandleInformation(from, HANDLE_FLAG_INHERIT, 0);
    SetHandleInformation(errors, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
    int status = start(arguments, input, to, errors, &process);
    const int error = errno;
    CloseHandle(to);
    if (!status) {
        bind_to_this(process, 0);
        hear_all(from, said, argument);
        status = status_of(wait_for(process));
    } else if (error == ENOENT)
        status = FXS_PROGRAM_MISSING;
    CloseHandle(from);
    CloseHandle(input);
    errno = error;
    return status;
}

int fxs_program_feed(const char *const *arguments, FILE *log, fxs_fed *fed)
{
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    HANDLE from, to, process;
    fflush(log);
    if (!CreatePipe(&from, &to, &inherited, 0))
        return win32_failed();
    const HANDLE errors = (HANDLE)_get_osfhandle(_fileno(log));
    SetHandleInformation(to, HANDLE_FLAG_INHERIT, 0);
    SetHandleInformation(errors, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
    const int status = start(arguments, from, errors, errors, &process), error = errno;
    CloseHandle(from);
    if (status) {
        CloseHandle(to);
        errno = error;
        return error == ENOENT ? FXS_PROGRAM_MISSING : -1;
    }
    bind_to_this(process, 0);
    *fed = (fxs_fed){(intptr_t)to, (intptr_t)process};
    return 0;
}

int fxs_fed_write(const fxs_fed *fed, const void *bytes, size_t size)
{
    const char *at = bytes;
    for (DWORD written; size; at += written, size -= written)
        if (!WriteFile((HANDLE)fed->input, at, size < 1 << 20 ? (DWORD)size : 1 << 20, &written, NULL))
            return win32_failed();
    return 0;
}

int fxs_fed_end(const fxs_fed *fed)
{
    CloseHandle((HANDLE)fed->input);
    return status_of(wait_for((HANDLE)fed->process));
}

static BOOL WINAPI leave_it(DWORD kind)
{
    if (kind != CTRL_C_EVENT && kind != CTRL_BREAK_EVENT)
        Sleep(INFINITE);
    return TRUE;
}

/* Runs a program in place of this process. Windows cannot replace a process, so this process waits for the program and
   ends with the program's exit code. */
void fxs_program_become(const char *path, char **argv)
{
    HANDLE process;
    char **arguments;
    size_t count = 0;
    while (argv[count])
        count++;
    arguments = calloc(count + 2, sizeof *arguments);
    char *program = malloc(strlen(path) + sizeof ".exe");
    if (!arguments || !program)
        return;
    strcat(strcpy(program, path), ".exe");
    arguments[0] = program;
    for (size_t i = 1; i < count; i++)
        arguments[i] = argv[i];
    /* The started program handles Ctrl-C. Ctrl-C is not ignored by a setting of this process, because the program would
       inherit it. */
    SetConsoleCtrlHandler(leave_it, TRUE);
    if (fxs_terminal_ends_with_this())
        fxs_program_set("FIXSPLAT_OWN_CONSOLE", "1");
    const int error = start((const char *const *)arguments, GetStdHandle(STD_INPUT_HANDLE),
                            GetStdHandle(STD_OUTPUT_HANDLE), GetStdHandle(STD_ERROR_HANDLE), &process);
    free(arguments);
    free(program);
    if (!error) {
        /* 1: a browser that the started program has opened lives on when this process ends */
        bind_to_this(process, 1);
        exit((int)wait_for(process));
    }
}

int fxs_browse(const char *address)
{
    wchar_t *wide = win32_wide(address);
    const int is_opened = wide && (intptr_t)ShellExecuteW(NULL, NULL, wide, NULL, NULL, SW_SHOWNORMAL) > 32;
    free(wide);
    return is_opened ? 0 : win32_failed();
}

static volatile LONG asked;
static int is_held;

/* Handler of console events, which runs on a thread of its own. When the handler returns, the process ends, except for
   Ctrl-C and Ctrl-Break. */
static BOOL WINAPI note_request(DWORD kind)
{
    if (InterlockedExchange(&asked, 1))
        return FALSE;
    if (kind != CTRL_C_EVENT && kind != CTRL_BREAK_EVENT)
        Sleep(INFINITE);
    return TRUE;
}

void fxs_end_listen(void)
{
    SetConsoleCtrlHandler(note_request, TRUE);
}

int fxs_end_asked(void)
{
    return (int)asked;
}

void fxs_end_listen_no_more(void)
{
    SetConsoleCtrlHandler(note_request, FALSE);
}

void fxs_end_as_asked(void)
{
    exit((int)STATUS_CONTROL_C_EXIT);
}

void fxs_end_hold(void)
{
    is_held = 1;
    fxs_end_listen();
}

int fxs_end_wait(unsigned milliseconds)
{
    if (!is_held || !asked)
        Sleep(milliseconds);
    return is_held && asked;
}

void fxs_without_signals(void (*call)(void *argument), void *argument)
{
    call(argument);
}
