#include "file_guard.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/base/opened.h"
#include <fixsplat/output.h>
#include "command.h"

enum use { OPENED, GIVEN, OUTPUT };         /* by the library; to the command */

/* A regular file, or the place in its folder where one is to be. */
typedef struct file {
    enum use use;
    uint64_t device, inode;                 /* of the file, or of the folder of one that is not there, */
    char *place;                            /* and its name in that; null of a file that is there */
    char *name;                             /* of an output, as it was given */
} file;

static struct {
    pthread_mutex_t lock;                   /* photographs are opened by several threads */
    file *files;
    size_t count, room;
    int incomplete;                         /* no memory for one */
    enum files_force force;
} known = {.lock = PTHREAD_MUTEX_INITIALIZER};

static void add(file f)
{
    pthread_mutex_lock(&known.lock);
    if (known.count == known.room) {
        const size_t room = 2 * known.room + 16;
        file *larger = realloc(known.files, room * sizeof *larger);
        known.files = larger ? larger : known.files;
        known.room = larger ? room : known.room;
    }
    if (known.count < known.room)
        known.files[known.count++] = f;
    else
        known.incomplete = 1;
    pthread_mutex_unlock(&known.lock);
}

static void add_opened(uint64_t device, uint64_t inode)
{
    add((file){OPENED, device, inode, 0, 0});
}

void files_begin(void)
{
    fxs_tell_opened(add_opened);
}

static char *copy_of(const char *text)
{
    char *copy = strdup(text);
    known.incomplete |= !copy;
    return copy;
}

/* Of a file that is not there. Returns 0 where there is no folder for it. */
static int find_place(file *f, const char *name, struct stat *folder)
{
    char *target = fxs_output_target(name), *slash = target ? strrchr(target, '/') : 0;
    if (!target)
        return 0;
    f->place = copy_of(slash ? slash + 1 : target);
    if (slash)
        slash[1] = 0;
    const int found = f->place && !stat(slash ? target : ".", folder);
    free(target);
    return found;
}

static int find_file(file *f, const char *name)
{
    struct stat status;
    const int found = strcmp(name, "-") ? !stat(name, &status)
                                        : !fstat(f->use == OUTPUT ? STDOUT_FILENO : STDIN_FILENO, &status);
    if (found ? !S_ISREG(status.st_mode) : !find_place(f, name, &status))
        return 0;
    f->device = (uint64_t)status.st_dev;
    f->inode = (uint64_t)status.st_ino;
    return 1;
}

static void add_named(enum use use, const char *name)
{
    file f = {.use = use};
    if (!name || !find_file(&f, name)) {
        free(f.place);
        return;
    }
    f.name = use == OUTPUT ? copy_of(strcmp(name, "-") ? name : "standard output") : 0;
    add(f);
}

void files_read(const char *name)
{
    add_named(GIVEN, name);
}

void files_write(const char *name)
{
    add_named(OUTPUT, name);
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

/* One file, by all of its uses. */
static int check_file(const file *files, size_t count)
{
    size_t uses[3] = {0};
    const char *name = 0;
    for (size_t i = 0; i < count; i++) {
        uses[files[i].use]++;
        name = files[i].name ? files[i].name : name;
    }
    if (uses[OUTPUT] > 1)
        return fail(EXIT_USAGE, "%s: two outputs are one file", name);
    if (!uses[OUTPUT] || !(uses[GIVEN] || uses[OPENED]) || (uses[GIVEN] && known.force == FILES_FORCED))
        return 0;
    return fail(EXIT_USAGE, "%s: is read and cannot be written too%s", name,
                uses[GIVEN] && known.force == FILES_REFUSE_UNFORCED ? "; --force replaces it" : "");
}

int files_check(void)
{
    if (known.incomplete)
        return fail(EXIT_FAILED, "out of memory");
    if (known.count)
        qsort(known.files, known.count, sizeof *known.files, compare);
    for (size_t first = 0, end; first < known.count; first = end) {
        for (end = first + 1; end < known.count && !compare(&known.files[first], &known.files[end]); end++)
            ;
        const int status = check_file(known.files + first, end - first);
        if (status)
            return status;
    }
    return 0;
}
