/* Runs external programs step by step. Output goes to a log, progress to stderr. */
#include "task.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include <fixsplat/system.h>
#include "command.h"

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
    const int is_line = fxs_is_terminal(stderr);
    const double seconds = (double)(now - t->start) * 1e-9;
    if (is_quiet() || (t->shown && now - t->shown < (is_line ? 200000000u : 10000000000u)))
        return;
    done = all && done > all ? all : done;         /* clamped to `all`, since the external program may count further */
    if (done && all)
        snprintf(left, sizeof left, ", some %.0f s left", seconds / (double)done * (double)(all - done));
    snprintf(text, sizeof text, all ? "%s: %" PRIu64 " of %" PRIu64 "%s" : "%s: %" PRIu64, t->doing, done, all, left);
    if (is_line)
        progress_line(text);
    else
        note("%s", text);
    t->shown = now;
}

/* Returns a line without the time and place that glog, the log of COLMAP 3.9 and later, writes before it:
   "I20260102 10:11:12.131415   123 file.cc:45] ". */
static const char *without_stamp(const char *line)
{
    const char *end = strchr("IWEF", *line) && line[0] && line[1] >= '0' && line[1] <= '9' ? strstr(line, "] ") : 0;
    return end ? end + 2 : line;
}

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
            t->look(t, without_stamp(t->line));
        t->length = ends ? 0 : t->length;
    }
}

int task_run(task *t, const char *const *arguments, fxs_program_said_fn *take, void *argument)
{
    const int status = fxs_program_run(arguments, take ? t->log : 0, take ? take : take_lines, take ? argument : t);
    const int error = errno;
    progress_end();
    errno = error;
    return status;
}

int task_is_cut(int status)
{
    return status < 0 || status == FXS_PROGRAM_MISSING || status >= FXS_PROGRAM_SIGNAL;
}

const char *to_install(char words[TO_INSTALL], const char *package, const char *otherwise)
{
    const int has_apt = fxs_program_is_here("apt");
    snprintf(words, TO_INSTALL, "%s%s", has_apt ? "apt install " : "install it", has_apt ? package : otherwise);
    return words;
}

int task_failed(const task *t, const char *program, int status)
{
    char words[TO_INSTALL];
    return status == FXS_PROGRAM_MISSING
               ? fail(EXIT_FAILED, "%s: finding the cameras needs %s, which is not installed: %s", t->of, program,
                      to_install(words, program, TO_PATH))
           : status < 0 ? fail(EXIT_FAILED, "%s: %s", program, strerror(errno))
           : status > FXS_PROGRAM_SIGNAL
               ? fail(EXIT_FAILED, "%s: ended by signal %d while %s; the same command goes on", program,
                      status - FXS_PROGRAM_SIGNAL, t->doing)
               : fail(EXIT_FAILED, "%s: failed while %s: see %s", program, t->doing, t->log_name);
}

void join_path(char path[TASK_PATH], const char *folder, const char *name)
{
    if (snprintf(path, TASK_PATH, "%s/%s", folder, name) >= TASK_PATH)
        *path = 0;
}

int is_folder(const char *path)
{
    return fxs_file_kind(path) == FXS_FILE_FOLDER;
}

int make_folder(const char *path)
{
    fxs_message why;
    if (!fxs_folder_make(path, &why))
        return 0;
    return fxs_file_is_named(path) && !is_folder(path) ? fail(EXIT_FAILED, "%s: not a folder", path) : fail_for(&why);
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

static void remove_in(void *folder, const char *name)
{
    char path[TASK_PATH];
    join_path(path, folder, name);
    fxs_file_remove(path);
}

void remove_folder(const char *path)
{
    char folder[TASK_PATH];
    fxs_file_unlink(path);
    if (snprintf(folder, sizeof folder, "%s", path) < TASK_PATH)
        fxs_folder_each(path, remove_in, folder);
    fxs_folder_remove(path);
}
