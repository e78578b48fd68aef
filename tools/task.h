/* A task of several steps, most of which other programs do: what they print is kept in a log, and progress is shown. */
#ifndef TASK_H
#define TASK_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "src/base/system.h"

enum { TASK_LINE = 512, TO_INSTALL = 64 };

#define TO_PATH ", in a folder of PATH"      /* what to do with a program */

typedef struct task task;
struct task {
    const char *of;                /* what it is done with, for messages */
    const char *log_name;
    FILE *log;
    const char *doing;             /* the step, as in "failed while looking for features" */
    void (*look)(task *t, const char *line);   /* at a line that a program has printed; may be null */
    void *argument;
    char line[TASK_LINE];
    size_t length;
    uint64_t start, shown;         /* nanoseconds: of the step, and when it was last shown, or 0 */
};

void task_begin(task *t, const char *doing, void (*look)(task *t, const char *line));

/* On a terminal a line that changes, else one at first and then every ten seconds; with the time that is left where all
   is not 0. */
void task_show(task *t, uint64_t done, uint64_t all);

/* Runs a program of PATH with these arguments, the first its name and the last null. It reads nothing; its errors go to
   the log, its output to `take`, piece by piece, or where that is null to the log and to look. Returns as
   fxs_program_run. */
int task_run(task *t, const char *const *arguments, fxs_program_said_fn *take, void *argument);

/* Whether the program did not come to an end of its own: it is missing, could not be run, or a signal ended it. */
int task_is_cut(int status);

/* "apt install " and the package where there is apt, else "install it" and what is given. Returns `words`. */
const char *to_install(char words[TO_INSTALL], const char *package, const char *otherwise);

/* Prints why a program failed, by what task_run returned. Returns the exit status of the command. */
int task_failed(const task *t, const char *program, int status);

/* Where a path is too long, the joined one is empty. */
enum { TASK_PATH = 4096 };
void join_path(char path[TASK_PATH], const char *folder, const char *name);

int is_folder(const char *path);

/* Makes a folder, or leaves it as it is. Returns 0, or prints why not and returns EXIT_FAILED. */
int make_folder(const char *path);

/* The same with the folders that it is in. */
int make_folders(const char *path);

/* Removes a folder and the files in it, but no folders. Of a link, the link alone. */
void remove_folder(const char *path);

#endif
