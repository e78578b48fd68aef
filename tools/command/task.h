/* A task of several steps, most of them done by external programs, with a log of their output and progress on
   stderr. */
#ifndef TASK_H
#define TASK_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "src/base/os_calls.h"

enum { TASK_LINE = 512, TO_INSTALL = 64 };

#define TO_PATH ", in a folder of PATH"      /* hint where to put a program */

typedef struct task task;
struct task {
    const char *of;                /* input of the task, for messages */
    const char *log_name;
    FILE *log;
    const char *doing;             /* the step, as in "failed while looking for features" */
    void (*look)(task *t, const char *line);   /* called for each line that a program prints; may be null */
    void *argument;
    char line[TASK_LINE];
    size_t length;
    uint64_t start, shown;         /* nanoseconds: start of the step; last progress shown, or 0 */
};

void task_begin(task *t, const char *doing, void (*look)(task *t, const char *line));

/* Shows progress: on a terminal a line in place, otherwise a line at first and then every ten seconds. Includes the
   remaining time unless `all` is 0. */
void task_show(task *t, uint64_t done, uint64_t all);

/* Runs a program from PATH; `arguments` begin with its name and end with null. Its input is empty, and its errors go
   to the log. Its output goes piece by piece to `take` or, if that is null, to the log and to t->look. Returns as
   fxs_program_run. */
int task_run(task *t, const char *const *arguments, fxs_program_said_fn *take, void *argument);

/* True if the program did not finish by itself: missing, not executable, or ended by a signal. */
int task_is_cut(int status);

/* "apt install " and the package on systems with apt, otherwise "install it" and `otherwise`. Returns `words`. */
const char *to_install(char words[TO_INSTALL], const char *package, const char *otherwise);

/* Prints why a program failed, from the status of task_run. Returns the exit status of the command. */
int task_failed(const task *t, const char *program, int status);

/* Joins two paths. The result is empty if it would be too long. */
enum { TASK_PATH = 4096 };
void join_path(char path[TASK_PATH], const char *folder, const char *name);

int is_folder(const char *path);

/* Makes a folder unless it exists. Returns 0, or prints the reason and returns EXIT_FAILED. */
int make_folder(const char *path);

/* As make_folder, but also makes the folder's parent folders. */
int make_folders(const char *path);

/* Removes a folder and its files, but no subfolders. For a link, removes only the link. */
void remove_folder(const char *path);

#endif
