/* Tasks of several steps by external programs, with a log and progress on stderr. */
#ifndef TASK_H
#define TASK_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "src/base/os_calls.h"

enum { TASK_LINE = 512, TO_INSTALL = 64 };

#define TO_PATH ", in a folder of PATH"

typedef struct task task;
struct task {
    const char *of;
    const char *log_name;
    FILE *log;
    const char *doing;             /* name of the current step, such as "looking for features" */
    void (*look)(task *t, const char *line);   /* callback for each line that a program prints; may be null */
    void *argument;
    char line[TASK_LINE];
    size_t length;
    uint64_t start, shown;         /* start time of the step, and time of the last shown progress, in nanoseconds */
};

void task_begin(task *t, const char *doing, void (*look)(task *t, const char *line));

/* Shows that `done` of `all` units of a step are done, and the remaining time. If `all` is 0, the total is unknown. */
void task_show(task *t, uint64_t done, uint64_t all);

/* Runs a program found in PATH. `arguments` begin with the program's name and end with null. The program's error
   messages go to the log, its output to `take`. If `take` is null, both go to the log and to t->look. Returns the
   result of fxs_program_run. */
int task_run(task *t, const char *const *arguments, fxs_program_said_fn *take, void *argument);

/* True if `status` says that a program did not finish: it was missing, not executable, or ended by a signal. */
int task_is_cut(int status);

/* Writes how to install a package: "apt install" and its name if the system has apt, else `otherwise`. Returns
   `words`. */
const char *to_install(char words[TO_INSTALL], const char *package, const char *otherwise);

/* Prints why a program failed, from its status, a result of task_run. Returns the exit status. */
int task_failed(const task *t, const char *program, int status);

/* Joins two paths. A path that is too long becomes empty. */
enum { TASK_PATH = 4096 };
void join_path(char path[TASK_PATH], const char *folder, const char *name);

int is_folder(const char *path);

int make_folder(const char *path);

int make_folders(const char *path);

/* Removes a folder and its files, but no subfolders. A link is removed without its target. */
void remove_folder(const char *path);

#endif
