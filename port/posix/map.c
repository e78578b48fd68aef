#define _DEFAULT_SOURCE            /* MAP_ANONYMOUS */
#include "map.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* What the handler for SIGBUS looks through: a signal may come at any time, so there is no lock. */
enum { RANGES = 64 };
static struct range {
    uintptr_t start, end;          /* end 0: free; set last, cleared first */
    int taken, lost;               /* lost: the handler put zeros there */
} ranges[RANGES];

static struct sigaction before;

static struct range *range_at(uintptr_t address)
{
    for (struct range *r = ranges; r < ranges + RANGES; r++) {
        const uintptr_t end = __atomic_load_n(&r->end, __ATOMIC_ACQUIRE);
        if (address < end && address >= r->start)
            return r;
    }
    return 0;
}

static void note_range(const fxs_mapping *mapping, struct range *r)
{
    r->start = (uintptr_t)mapping->data;
    r->lost = 0;
    __atomic_store_n(&r->end, r->start + mapping->bytes, __ATOMIC_RELEASE);
}

static struct range *take_range(void)
{
    for (struct range *r = ranges; r < ranges + RANGES; r++)
        if (!__atomic_exchange_n(&r->taken, 1, __ATOMIC_ACQUIRE))
            return r;
    return 0;
}

static void free_range(struct range *r)
{
    __atomic_store_n(&r->end, 0, __ATOMIC_RELEASE);
    __atomic_store_n(&r->taken, 0, __ATOMIC_RELEASE);
}

/* Zeros from the page of the fault to the end of the range. */
static int fill_with_zeros(uintptr_t address)
{
    struct range *r = range_at(address);
    if (!r)
        return 0;
    const uintptr_t page = address - address % (uintptr_t)sysconf(_SC_PAGESIZE);
    __atomic_store_n(&r->lost, 1, __ATOMIC_RELEASE);
    return mmap((void *)page, r->end - page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
}

static void handle(int signal_number, siginfo_t *info, void *context)
{
    const int error = errno, filled = fill_with_zeros((uintptr_t)info->si_addr);
    (void)context;
    if (!filled)                   /* the instruction runs again, and does what it did before */
        sigaction(signal_number, &before, 0);
    errno = error;
}

void fxs_map_guard(void)
{
    struct sigaction action;
    if (!sigaction(SIGBUS, 0, &action) && action.sa_flags & SA_SIGINFO && action.sa_sigaction == handle)
        return;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = handle;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGBUS, &action, &before);
}

static int map_file(fxs_mapping *mapping, const char *path, fxs_message *message)
{
    struct stat status;
    mapping->descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);   /* a FIFO does not block */
    if (mapping->descriptor < 0)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    if (fstat(mapping->descriptor, &status) || !S_ISREG(status.st_mode) || status.st_size < 1 ||
        (uintmax_t)status.st_size > SIZE_MAX)
        return fxs_fail(message, "%s: cannot be mapped into memory", path);
    mapping->bytes = (size_t)status.st_size;
    mapping->modified[0] = status.st_mtim.tv_sec;
    mapping->modified[1] = status.st_mtim.tv_nsec;
    void *data = mmap(0, mapping->bytes, PROT_READ, MAP_PRIVATE, mapping->descriptor, 0);
    if (data == MAP_FAILED)
        return fxs_fail(message, "%s: cannot be mapped into memory: %s", path, strerror(errno));
    mapping->data = data;
    return 0;
}

int fxs_map(fxs_mapping *mapping, const char *path, fxs_message *message)
{
    memset(mapping, 0, sizeof *mapping);
    struct range *r = take_range();
    if (!r)
        return fxs_fail(message, "%s: more than %d files are mapped", path, (int)RANGES);
    if (map_file(mapping, path, message)) {
        if (mapping->descriptor >= 0)
            close(mapping->descriptor);
        free_range(r);
        return -1;
    }
    note_range(mapping, r);
    return 0;
}

int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message)
{
    struct stat status;
    const struct range *r = range_at((uintptr_t)mapping->data);
    if (!r || __atomic_load_n(&r->lost, __ATOMIC_ACQUIRE) || fstat(mapping->descriptor, &status) ||
        (uintmax_t)status.st_size < mapping->bytes)
        return fxs_fail(message, "%s: was cut short while it was read", path);
    if ((uintmax_t)status.st_size != mapping->bytes || status.st_mtim.tv_sec != mapping->modified[0] ||
        status.st_mtim.tv_nsec != mapping->modified[1])
        return fxs_fail(message, "%s: was written to while it was read", path);
    return 0;
}

void fxs_unmap(fxs_mapping *mapping)
{
    struct range *r = mapping->data ? range_at((uintptr_t)mapping->data) : 0;
    if (!r)
        return;
    munmap(mapping->data, mapping->bytes);
    close(mapping->descriptor);
    free_range(r);
    memset(mapping, 0, sizeof *mapping);
}
