/* Writes output files. Data goes to a locked temporary file in the target's folder. When complete, the file is
 * synced and renamed to the target. A signal handler removes unfinished files. */
#include "src/base/output_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/output.h>
#include "src/base/opened.h"

enum { LINKS_MOST = 40,
       NAME_ROOM = 64,
       WRITERS_MOST = 100 };

static fxs_output *under_way;   /* list of unfinished outputs, read by the handler of signals that end the process */
static char taken;

/* Takes a spin lock and blocks signals while the lock is held. The signal handler can therefore wait for another
   thread's lock. */
static void enter(sigset_t *before)
{
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, before);
    while (__atomic_test_and_set(&taken, __ATOMIC_ACQUIRE))
        sched_yield();
}

static void leave(const sigset_t *before)
{
    __atomic_clear(&taken, __ATOMIC_RELEASE);
    pthread_sigmask(SIG_SETMASK, before, NULL);
}

static void forget(fxs_output *output)
{
    sigset_t before;
    enter(&before);
    for (fxs_output **at = &under_way; *at; at = &(*at)->next)
        if (*at == output) {
            *at = output->next;
            break;
        }
    leave(&before);
}

/* Signal handler that removes the temporary files and ends the process. Keeps the spin lock, so that other threads
   wait. */
static void remove_and_end(int signal_number)
{
    while (__atomic_test_and_set(&taken, __ATOMIC_ACQUIRE))
        continue;
    for (const fxs_output *output = under_way; output; output = output->next)
        unlink(output->temporary);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

void fxs_output_remove_at_signals(void)
{
    static const int signals[] = {SIGHUP, SIGINT, SIGPIPE, SIGTERM, SIGXCPU, SIGXFSZ};
    struct sigaction action, old;
    memset(&action, 0, sizeof action);
    action.sa_handler = remove_and_end;
    sigfillset(&action.sa_mask);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        if (!sigaction(signals[i], NULL, &old) && old.sa_handler == SIG_DFL)
            sigaction(signals[i], &action, NULL);
}

static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

static char *read_link(const char *name)
{
    char text[PATH_MAX];
    ssize_t length = readlink(name, text, sizeof text);
    if (length < 0 || length == sizeof text) {
        errno = length < 0 ? errno : ENAMETOOLONG;
        return NULL;
    }
    size_t folder = text[0] == '/' ? 0 : folder_length(name);
    char *target = malloc(folder + (size_t)length + 1);
    if (target) {
        memcpy(target, name, folder);
        memcpy(target + folder, text, (size_t)length);
        target[folder + (size_t)length] = 0;
    }
    return target;
}

char *fxs_output_target(const char *path)
{
    struct stat status;
    char *name = strdup(path);
    for (int i = 0; name && !lstat(name, &status) && S_ISLNK(status.st_mode); i++) {
        char *next = i < LINKS_MOST ? read_link(name) : NULL;
        int error = i < LINKS_MOST ? errno : ELOOP;
        free(name);
        name = next;
        errno = error;
    }
    return name;
}

static char standard_output[] = "standard output";

static void release(fxs_output *output)
{
    if (output->lock >= 0)
        close(output->lock);
    if (output->path != standard_output)
        free(output->path);
    free(output->target);
    free(output->temporary);
}

static void name_temporary(fxs_output *output, int i)
{
    const size_t folder = folder_length(output->target);
    uint32_t hash = 0x811c9dc5u;
    for (const char *c = output->target + folder; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 0x01000193u;
    snprintf(output->temporary, folder + NAME_ROOM, "%.*s.fixsplat-%08" PRIx32 "-%d.tmp", (int)folder, output->target,
             hash, i);
}

/* Removes a temporary file that an earlier process left. Writers lock their temporary files, so a free lock means that
   the writer has ended. Returns 0 if no such file exists. */
static int remove_left(const char *name)
{
    struct stat own, there;
    const int flags = O_NOFOLLOW | O_NONBLOCK | O_NOCTTY;
    /* the file is opened for writing, because flock() over NFS requires write access */
    int descriptor = open(name, O_WRONLY | flags);
    if (descriptor < 0 && errno == EACCES)
        descriptor = open(name, O_RDONLY | flags);
    if (descriptor < 0)
        return errno != ENOENT;
    if (!flock(descriptor, LOCK_EX | LOCK_NB) && !fstat(descriptor, &own) && S_ISREG(own.st_mode) &&
        !lstat(name, &there) && own.st_dev == there.st_dev && own.st_ino == there.st_ino)
        unlink(name);
    close(descriptor);
    return 1;
}

static int create(const char *name, const struct stat *old)
{
    struct stat own;
    const mode_t mode = old ? old->st_mode & 0777 : 0666;
    const int descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL, mode);
    if (descriptor < 0)
        return -1;
    if ((flock(descriptor, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK) || (!fstat(descriptor, &own) && !own.st_nlink)) {
        close(descriptor);
        errno = EEXIST;
        return -1;
    }
    if (old)
        fchmod(descriptor, mode);
    return descriptor;
}

static int create_beside(fxs_output *output, const struct stat *old)
{
    int descriptor = -1, own = 0;
    sigset_t before;
    output->temporary = malloc(folder_length(output->target) + NAME_ROOM);
    if (!output->temporary)
        return -1;
    enter(&before);
    for (int i = 0; i < WRITERS_MOST; i++) {
        name_temporary(output, i);
        const int there = remove_left(output->temporary);
        if (descriptor < 0) {
            own = i;
            descriptor = create(output->temporary, old);
            if (descriptor < 0 && errno != EEXIST)
                break;
        } else if (!there)
            break;
    }
    if (descriptor >= 0) {
        name_temporary(output, own);
        output->lock = dup(descriptor);
        output->next = under_way;
        under_way = output;
    }
    leave(&before);
    return descriptor;
}

/* Returns 1 if a symbolic link such as /dev/stdout leads to standard output. Opening the link again would truncate the
   file that standard output goes to. */
static int is_standard_output(const char *path, const struct stat *status)
{
    struct stat own, out;
    return !lstat(path, &own) && S_ISLNK(own.st_mode) && !fstat(STDOUT_FILENO, &out) && out.st_dev == status->st_dev &&
           out.st_ino == status->st_ino;
}

static int open_descriptor(fxs_output *output)
{
    struct stat status;
    if (output->path == standard_output)
        return dup(STDOUT_FILENO);
    int exists = !stat(output->path, &status);
    if (exists && is_standard_output(output->path, &status))
        return dup(STDOUT_FILENO);
    if (exists && S_ISDIR(status.st_mode)) {
        errno = EISDIR;
        return -1;
    }
    if (exists && !S_ISREG(status.st_mode))
        return open(output->path, O_WRONLY | O_NOCTTY);
    output->target = fxs_output_target(output->path);
    return output->target ? create_beside(output, exists ? &status : NULL) : -1;
}

static void drop(fxs_output *output)
{
    if (!output->temporary)
        return;
    unlink(output->temporary);
    forget(output);
}

int fxs_output_open(fxs_output *output, const char *path, uint64_t count, fxs_message *message)
{
    FXS_TRY(fxs_may_write(path, message));
    memset(output, 0, sizeof *output);
    output->lock = -1;
    output->left = count;
    output->path = strcmp(path, "-") ? strdup(path) : standard_output;
    int descriptor = output->path ? open_descriptor(output) : -1;
    output->file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (output->file)
        return 0;
    const int number = descriptor >= 0 && errno == EINVAL ? EBADF : errno;
    const int error = fxs_output_fail(output->path ? output->path : path, number, message);
    if (descriptor >= 0) {
        close(descriptor);
        drop(output);
    }
    release(output);
    return error;
}

/* Writes a file to disk. Some file systems do not support fsync, which is no error. */
static int sync_file(FILE *file)
{
    return !fsync(fileno(file)) || errno == EINVAL || errno == EROFS ? 0 : -1;
}

/* Writes the folder of a renamed file to disk. Ignores a failure, because the file itself is complete. */
static void sync_folder(fxs_output *output)
{
    const size_t folder = folder_length(output->target);
    output->target[folder] = 0;
    int descriptor = open(folder ? output->target : ".", O_RDONLY);
    if (descriptor < 0)
        return;
    fsync(descriptor);
    close(descriptor);
}

const char *fxs_output_lend(fxs_output *output)
{
    return output->temporary;
}

void fxs_output_take_back(fxs_output *output)
{
    (void)output;
}

int fxs_output_close(fxs_output *output, fxs_message *message)
{
    int result = 0;
    errno = 0;
    if ((fflush(output->file) || ferror(output->file)) && !output->error)
        output->error = errno ? errno : EIO;
    int complete = !output->error && !output->left;
    if (complete && output->temporary && sync_file(output->file))
        output->error = errno;
    if (fclose(output->file) && !output->error)
        output->error = errno;
    if (!output->error && output->left)
        result = fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: %" PRIu64 " Gaussians fewer than announced", output->path,
                             output->left);
    else if (output->error || (output->temporary && rename(output->temporary, output->target))) {
        output->error = output->error ? output->error : errno;
        result = fxs_output_fail(output->path, output->error, message);
    }
    if (result)
        drop(output);
    else if (output->temporary) {
        forget(output);
        sync_folder(output);
    }
    release(output);
    return result;
}
