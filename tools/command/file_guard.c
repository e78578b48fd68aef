/* Identifies files by device and inode, and missing files by folder and name. Refuses outputs that would replace an
   input or another output. */
#include "file_guard.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/output.h>
#include "src/base/opened.h"
#include "src/base/os_calls.h"
#include "command.h"

typedef struct file {
    uint64_t device, inode;                 /* device and inode of the file, or of a missing file's folder */
    char *place;                            /* file name of a missing file; else null */
    char *name;                             /* path of the file as given by the user */
    int is_given;                           /* 1: the command line names the file; 0: the library opened it */
} file;

typedef struct file_list {
    file *files;
    size_t count, room;
} file_list;

static struct {
    pthread_mutex_t lock;
    file_list read, written;
    int incomplete;
    enum files_force force;
} known = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void add(file_list *list, file f)
{
    pthread_mutex_lock(&known.lock);
    if (list->count == list->room) {
        const size_t room = 2 * list->room + 16;
        file *larger = realloc(list->files, room * sizeof *larger);
        list->files = larger ? larger : list->files;
        list->room = larger ? room : list->room;
    }
    if (list->count < list->room)
        list->files[list->count++] = f;
    else
        known.incomplete = 1;
    pthread_mutex_unlock(&known.lock);
}

static void add_opened(uint64_t device, uint64_t inode)
{
    add(&known.read, (file){.device = device, .inode = inode});
}

static char *copy_of(const char *text)
{
    char *copy = strdup(text);
    known.incomplete |= !copy;
    return copy;
}

/* Identifies a missing file by folder and name. Returns 0 if the folder does not exist. */
static int find_place(file *f, const char *name, fxs_file_facts *folder)
{
    char *target = fxs_output_target(name), *slash = target ? strrchr(target, '/') : 0;
    if (!target)
        return 0;
    f->place = copy_of(slash ? slash + 1 : target);
    if (slash)
        slash[1] = 0;
    const int found = f->place && fxs_file_look(slash ? target : ".", folder) != FXS_FILE_NONE;
    free(target);
    return found;
}

/* Identifies a file by device and inode, or a missing file by its folder and name. Allocates f->place. Returns 0 for a
   device or a missing folder. */
static int find_file(file *f, const char *name, FILE *standard)
{
    fxs_file_facts facts;
    const enum fxs_file_kind kind = strcmp(name, "-") ? fxs_file_look(name, &facts) : fxs_stream_look(standard, &facts);
    if (kind == FXS_FILE_NONE ? !find_place(f, name, &facts) : kind != FXS_FILE_REGULAR)
        return 0;
    f->device = facts.device;
    f->inode = facts.inode;
    return 1;
}

static const char *shown(const char *name)
{
    return strcmp(name, "-") ? name : "standard output";
}

void files_read(const char *name)
{
    file f = {.is_given = 1};
    if (name && find_file(&f, name, stdin))
        add(&known.read, f);
    else
        free(f.place);
}

void files_forget(void)
{
    size_t kept = 0;
    pthread_mutex_lock(&known.lock);
    for (size_t i = 0; i < known.read.count; i++)
        if (known.read.files[i].is_given)
            known.read.files[kept++] = known.read.files[i];
    known.read.count = kept;
    pthread_mutex_unlock(&known.lock);
}

void files_write(const char *name)
{
    file f = {.is_given = 0};
    if (name && find_file(&f, name, stdout)) {
        f.name = copy_of(shown(name));
        add(&known.written, f);
    } else
        free(f.place);
}

void files_force(enum files_force force)
{
    known.force = force;
}

static int compare(const void *a, const void *b)
{
    const file *one = a, *other = b;
    if (one->device != other->device)
        return one->device < other->device ? -1 : 1;
    if (one->inode != other->inode)
        return one->inode < other->inode ? -1 : 1;
    return !one->place || !other->place ? !!one->place - !!other->place : strcmp(one->place, other->place);
}

int files_same(const char *one, const char *other)
{
    file a = {.place = 0}, b = {.place = 0};
    const int same = find_file(&a, one, stdin) && find_file(&b, other, stdout) && !compare(&a, &b);
    free(a.place);
    free(b.place);
    return same;
}

/* Returns an error code and a message if the output would replace an input, else 0. */
static int check_output(const file *output, const char *name, fxs_message *message)
{
    size_t found = 0, given = 0;
    pthread_mutex_lock(&known.lock);
    for (size_t i = 0; i < known.read.count; i++)
        if (!compare(&known.read.files[i], output)) {
            found++;
            given += known.read.files[i].is_given != 0;
        }
    pthread_mutex_unlock(&known.lock);
    if (!found || (given && known.force == FILES_FORCED))
        return 0;
    return fxs_fail(message, "%s: is read and cannot be written too%s", name,
                    given && known.force == FILES_REFUSE_UNFORCED ? "; --force replaces it" : "");
}

static int check_begun(const char *name, fxs_message *message)
{
    file f = {.place = 0};
    const int error = find_file(&f, name, stdout) ? check_output(&f, shown(name), message) : 0;
    free(f.place);
    return error;
}

void files_begin(void)
{
    fxs_tell_opened(add_opened);
    fxs_ask_outputs(check_begun);
}

int files_check(void)
{
    const file_list *written = &known.written;
    fxs_message message;
    if (known.incomplete)
        return fail(EXIT_FAILED, "out of memory");
    for (size_t i = 0; i < written->count; i++)
        if (check_output(&written->files[i], written->files[i].name, &message))
            return fail(EXIT_USAGE, "%s", message.text);
    if (written->count)
        qsort(written->files, written->count, sizeof *written->files, compare);
    for (size_t i = 1; i < written->count; i++)
        if (!compare(&written->files[i - 1], &written->files[i]))
            return fail(EXIT_USAGE, "%s: two outputs are one file", written->files[i].name);
    return 0;
}

void files_done(void)
{
    for (size_t i = 0; i < known.written.count; i++) {
        free(known.written.files[i].place);
        free(known.written.files[i].name);
    }
    known.written.count = 0;
}
