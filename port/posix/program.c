/* Starts programs with posix_spawnp, opens a browser, and handles signals that ask this process to end. */
#include "src/base/os_calls.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#ifdef __APPLE__
#include <mach-o/dyld.h>
#endif

extern char **environ;

/* Opens /dev/null in place of a closed standard file, so that no other file gets its descriptor. Reads and writes are
   swapped, so that every use fails. */
void fxs_program_begin(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    signal(SIGXFSZ, SIG_IGN);          /* a write beyond the file size limit fails with an error instead of a signal */
    for (int i = STDIN_FILENO; i <= STDERR_FILENO; i++)
        if (fcntl(i, F_GETFD) < 0)
            open("/dev/null", i == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void fxs_program_path(char *path, size_t room)
{
#ifdef __APPLE__
    uint32_t length = (uint32_t)room;
    if (_NSGetExecutablePath(path, &length))
        path[0] = 0;
#else
    const ssize_t length = readlink("/proc/self/exe", path, room - 1);
    path[length > 0 ? length : 0] = 0;
#endif
}

int fxs_program_is_here(const char *name)
{
    char path[4096];
    const char *folder = getenv("PATH");
    while (folder && *folder) {
        const int length = (int)strcspn(folder, ":");
        if (snprintf(path, sizeof path, "%.*s/%s", length, folder, name) < (int)sizeof path && !access(path, X_OK))
            return 1;
        folder += length + (folder[length] == ':');
    }
    return 0;
}

int fxs_library_is_here(const char *name)
{
    void *library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    return library && !dlclose(library);
}

void fxs_program_set(const char *variable, const char *value)
{
    setenv(variable, value, 1);
}

void fxs_program_become(const char *path, char **argv)
{
    execvp(path, argv);
}

/* Starts a program in the process group `group`; 0: a group of its own. `input` below 0: none. */
static int start(const char *const *arguments, pid_t group, int input, int output, int log, const sigset_t *mask,
                 pid_t *child)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    int error = posix_spawn_file_actions_init(&actions);
    if (error)
        return error;
    error = posix_spawnattr_init(&attributes);
    if (error) {
        posix_spawn_file_actions_destroy(&actions);
        return error;
    }
    posix_spawnattr_setsigmask(&attributes, mask);
    posix_spawnattr_setpgroup(&attributes, group);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    error = input < 0 ? posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0)
                      : posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    error = error ? error : posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    error = error ? error : posix_spawn_file_actions_adddup2(&actions, log, STDERR_FILENO);
    /* posix_spawnp does not change the arguments, although its type lacks const */
    if (!error)
        error = posix_spawnp(child, arguments[0], &actions, &attributes, (char *const *)(uintptr_t)arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

static void close_pipe(const int ends[2])
{
    close(ends[0]);
    close(ends[1]);
}

static int read_all(int from, void *out, size_t size)
{
    ssize_t n;
    do
        n = read(from, out, size);
    while (n < 0 && errno == EINTR);
    return n == (ssize_t)size;
}

/* Starts a guard process with a process group, which the guarded program then joins, so that the guard needs no message
   to know the group. When this process ends, even by SIGKILL, the pipe `life` ends, and the guard kills the group. A
   byte in the pipe ends the guard. Returns 0 if no guard can be started. */
static pid_t start_guard(const int life[2], const int output[2])
{
    char byte;
    const pid_t guard = fork();
    if (guard > 0)
        setpgid(guard, guard);
    if (guard)
        return guard > 0 ? guard : 0;
    setpgid(0, 0);
    close(life[1]);
    close_pipe(output);            /* so that the program's output ends with the program */
    if (!read_all(life[0], &byte, 1))
        kill(-getpid(), SIGKILL);
    _exit(0);
}

static volatile sig_atomic_t running;

/* Signal handler for Ctrl-Z: stops the started program and this process. When this process continues, continues the
   program. */
static void stop_both(int number)
{
    const int error = errno;
    (void)number;
    kill(-running, SIGSTOP);
    raise(SIGSTOP);
    kill(-running, SIGCONT);
    errno = error;
}

static void listen_to_stops(pid_t group, struct sigaction *before)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = stop_both;
    action.sa_flags = SA_RESTART;
    running = group;
    sigaction(SIGTSTP, 0, before);
    if (before->sa_handler == SIG_DFL)
        sigaction(SIGTSTP, &action, 0);
}

static void hear_all(int from, fxs_program_said_fn *said, void *argument)
{
    char data[65536];
    for (;;) {
        const ssize_t size = read(from, data, sizeof data);
        if (size > 0)
            said(argument, data, (size_t)size);
        else if (size == 0 || errno != EINTR)
            return;
    }
}

static int wait_for(pid_t child)
{
    int status;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : FXS_PROGRAM_SIGNAL + WTERMSIG(status);
}

static int make_pipe(int ends[2])
{
    if (pipe(ends))
        return -1;
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    return 0;
}

static int attend(pid_t child, pid_t group, int from, fxs_program_said_fn *said, void *argument)
{
    struct sigaction before;
    listen_to_stops(group, &before);
    hear_all(from, said, argument);
    const int status = wait_for(child);
    const int error = errno;
    sigaction(SIGTSTP, &before, 0);
    errno = error;
    return status;
}

int fxs_program_run(const char *const *arguments, FILE *log, fxs_program_said_fn *said, void *argument)
{
    int ends[2], life[2], status = -1;
    sigset_t all, before;
    pid_t child;
    if (log)
        fflush(log);
    if (make_pipe(ends))
        return -1;
    if (make_pipe(life)) {
        close_pipe(ends);
        return -1;
    }
    /* Signals are blocked from here, so that this process cannot end before the guard process can end the started
       program. */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const pid_t guard = start_guard(life, ends);
    const int error = start(arguments, guard, -1, ends[1], log ? fileno(log) : ends[1], &before, &child);
    close(ends[1]);
    pthread_sigmask(SIG_SETMASK, &before, 0);
    if (!error)
        status = attend(child, guard ? guard : child, ends[0], said, argument);
    const int last = error ? error : errno;
    close(ends[0]);
    if (guard && write(life[1], "", 1) == 1)
        wait_for(guard);
    close_pipe(life);
    errno = last;
    return error == ENOENT ? FXS_PROGRAM_MISSING : status;
}

int fxs_program_feed(const char *const *arguments, FILE *log, fxs_fed *fed)
{
    int ends[2];
    sigset_t mask;
    pid_t child;
    fflush(log);
    if (make_pipe(ends))
        return -1;
    pthread_sigmask(SIG_SETMASK, 0, &mask);
    const int error = start(arguments, 0, ends[0], fileno(log), fileno(log), &mask, &child);
    close(ends[0]);
    if (error)
        close(ends[1]);
    else
        *fed = (fxs_fed){ends[1], child};
    errno = error;
    return error == ENOENT ? FXS_PROGRAM_MISSING : error ? -1 : 0;
}

int fxs_fed_write(const fxs_fed *fed, const void *bytes, size_t size)
{
    const char *at = bytes;
    sigset_t broken, before, pending;
    int number;
    sigemptyset(&broken);
    sigaddset(&broken, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &broken, &before);
    while (size) {
        const ssize_t written = write((int)fed->input, at, size);
        if (written < 0 && errno != EINTR)
            break;
        at += written > 0 ? written : 0;
        size -= written > 0 ? (size_t)written : 0;
    }
    const int error = errno;
    if (size && error == EPIPE && !sigpending(&pending) && sigismember(&pending, SIGPIPE))
        sigwait(&broken, &number);
    pthread_sigmask(SIG_SETMASK, &before, 0);
    errno = error;
    return size ? -1 : 0;
}

int fxs_fed_end(const fxs_fed *fed)
{
    close((int)fed->input);
    return wait_for((pid_t)fed->process);
}

/* Runs the browser in a session of its own, where Ctrl-C does not reach it. */
static void run_browser(const char *address)
{
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, 0);
    signal(SIGPIPE, SIG_DFL);
    setsid();
    if (freopen("/dev/null", "r", stdin) && freopen("/dev/null", "w", stdout) && freopen("/dev/null", "w", stderr))
        execlp("xdg-open", "xdg-open", address, (char *)0);
    _exit(127);
}

/* Opens a browser, by forking twice. The first child ends at once, so this process never has to wait for the
   browser. */
int fxs_browse(const char *address)
{
    if (!getenv("DISPLAY") && !getenv("WAYLAND_DISPLAY"))
        return 0;
    const pid_t child = fork();
    if (child < 0)
        return -1;
    if (child)
        waitpid(child, 0, 0);
    else if (fork())
        _exit(0);
    else
        run_browser(address);
    return 0;
}

static const int signals[] = {SIGHUP, SIGINT, SIGTERM};
enum { SIGNALS = sizeof signals / sizeof *signals };
static struct sigaction before[SIGNALS];
static volatile sig_atomic_t asked;

void fxs_end_listen_no_more(void)
{
    for (int i = 0; i < SIGNALS; i++)
        sigaction(signals[i], &before[i], 0);
}

static void note_request(int number)
{
    asked = number;
    fxs_end_listen_no_more();
}

void fxs_end_listen(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = note_request;
    sigfillset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    for (int i = 0; i < SIGNALS; i++)
        sigaction(signals[i], 0, &before[i]);
    for (int i = 0; i < SIGNALS; i++)
        if (before[i].sa_handler != SIG_IGN)
            sigaction(signals[i], &action, 0);
}

int fxs_end_asked(void)
{
    return asked;
}

void fxs_end_as_asked(void)
{
    raise(asked);
}

static sigset_t mask_to_wait;

static void note_held(int number)
{
    asked = number;
}

void fxs_end_hold(void)
{
    struct sigaction now, action;
    sigset_t held;
    signal(SIGPIPE, SIG_IGN);
    memset(&action, 0, sizeof action);
    action.sa_handler = note_held;
    sigfillset(&action.sa_mask);
    sigemptyset(&held);
    for (int i = 0; i < SIGNALS; i++)
        if (!sigaction(signals[i], 0, &now) && now.sa_handler != SIG_IGN)
            sigaddset(&held, signals[i]);
    pthread_sigmask(SIG_BLOCK, &held, &mask_to_wait);
    for (int i = 0; i < SIGNALS; i++)
        if (sigismember(&held, signals[i]))
            sigaction(signals[i], &action, 0);
}

int fxs_end_wait(unsigned milliseconds)
{
    const struct timespec most = {(time_t)(milliseconds / 1000), (long)(milliseconds % 1000) * 1000000};
    asked = 0;
    pselect(0, 0, 0, 0, &most, &mask_to_wait);
    return asked != 0;
}

void fxs_without_signals(void (*call)(void *argument), void *argument)
{
    sigset_t all, mask;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &mask);
    call(argument);
    pthread_sigmask(SIG_SETMASK, &mask, 0);
}
