#include "task.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <spawn.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fixsplat/clock.h>
#include "command.h"

extern char **environ;

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

void task_begin(task *t, const char *doing, void (*look)(task *t, const char *line))
{
    t->doing = doing;
    t->look = look;
    t->start = fxs_clock(0);
    t->shown = 0;
    t->length = 0;
    fprintf(t->log, "\n== %s\n", doing);
}

void task_show(task *t, uint64_t done, uint64_t all)
{
    char text[160], left[48] = "";
    const uint64_t now = fxs_clock(0);
    const int is_line = isatty(STDERR_FILENO);
    const double seconds = (double)(now - t->start) * 1e-9;
    if (is_quiet() || (t->shown && now - t->shown < (is_line ? 200000000u : 10000000000u)))
        return;
    if (done && all)
        snprintf(left, sizeof left, ", some %.0f s left", seconds / (double)done * (double)(all - done));
    snprintf(text, sizeof text, all ? "%s: %" PRIu64 " of %" PRIu64 "%s" : "%s: %" PRIu64, t->doing, done, all, left);
    if (is_line)
        progress_line(text);
    else
        note("%s", text);
    t->shown = now;
}

/* ---- Programs ---------------------------------------------------------------------------------------------------- */

static void take_lines(void *argument, const char *data, size_t size)
{
    task *t = argument;
    fwrite(data, 1, size, t->log);
    for (size_t i = 0; i < size; i++) {
        const int ends = data[i] == '\n' || data[i] == '\r';
        if (!ends && t->length < TASK_LINE - 1)
            t->line[t->length++] = data[i];
        t->line[t->length] = 0;
        if (ends && t->length && t->look)
            t->look(t, t->line);
        t->length = ends ? 0 : t->length;
    }
}

static int start(const char *const *arguments, int output, int log, pid_t *child)
{
    posix_spawn_file_actions_t actions;
    int error = posix_spawn_file_actions_init(&actions);
    if (error)
        return error;
    error = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    error = error ? error : posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    error = error ? error : posix_spawn_file_actions_adddup2(&actions, log, STDERR_FILENO);
    /* posix_spawnp does not change the arguments, though its type does not say so */
    error = error ? error : posix_spawnp(child, arguments[0], &actions, 0, (char *const *)(uintptr_t)arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

static void take_all(int from, task_data_fn *take, void *argument)
{
    char data[65536];
    for (;;) {
        const ssize_t size = read(from, data, sizeof data);
        if (size > 0)
            take(argument, data, (size_t)size);
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
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int task_run(task *t, const char *const *arguments, task_data_fn *take, void *argument)
{
    int ends[2], status = -1;
    pid_t child;
    fflush(t->log);
    if (pipe(ends))
        return -1;
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    const int error = start(arguments, ends[1], fileno(t->log), &child);
    close(ends[1]);
    if (!error) {
        take_all(ends[0], take ? take : take_lines, take ? argument : t);
        status = wait_for(child);
    }
    close(ends[0]);
    progress_end();
    errno = error ? error : errno;
    return error == ENOENT ? TASK_MISSING : status;
}

int task_failed(const task *t, const char *program, int status)
{
    return status == TASK_MISSING
               ? fail(EXIT_FAILED, "%s: to find its cameras takes %s, which is not here: apt install %s", t->of, program,
                      program)
           : status < 0 ? fail(EXIT_FAILED, "%s: %s", program, strerror(errno))
           : status > 128 ? fail(EXIT_FAILED, "%s: ended by signal %d while %s; the same command goes on", program,
                                 status - 128, t->doing)
                          : fail(EXIT_FAILED, "%s: failed while %s: see %s", program, t->doing, t->log_name);
}

/* ---- Folders ----------------------------------------------------------------------------------------------------- */

void join_path(char path[TASK_PATH], const char *folder, const char *name)
{
    if (snprintf(path, TASK_PATH, "%s/%s", folder, name) >= TASK_PATH)
        *path = 0;
}

int is_folder(const char *path)
{
    struct stat status;
    return !stat(path, &status) && S_ISDIR(status.st_mode);
}

int make_folder(const char *path)
{
    if (!mkdir(path, 0777))
        return 0;
    const int error = errno;
    return error == EEXIST && is_folder(path) ? 0 : fail(EXIT_FAILED, "%s: %s", path,
                                                         error == EEXIST ? "not a folder" : strerror(error));
}

int make_folders(const char *path)
{
    char part[TASK_PATH];
    int status = 0;
    for (const char *slash = strchr(path + (*path == '/'), '/'); slash && !status; slash = strchr(slash + 1, '/')) {
        if (slash - path >= TASK_PATH)
            return fail(EXIT_FAILED, "%s: name too long", path);
        snprintf(part, sizeof part, "%.*s", (int)(slash - path), path);
        status = is_folder(part) ? 0 : make_folder(part);
    }
    return status ? status : make_folder(path);
}

void remove_link(const char *path)
{
    struct stat status;
    if (!lstat(path, &status) && S_ISLNK(status.st_mode))
        unlink(path);
}

void remove_folder(const char *path)
{
    char name[TASK_PATH];
    remove_link(path);
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != 0;) {
        join_path(name, path, entry->d_name);
        unlink(name);
    }
    if (folder)
        closedir(folder);
    rmdir(path);
}
