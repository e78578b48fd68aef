/* Maps files into memory, read-only. A mapped file that is cut short gives zeros instead of SIGBUS, and fxs_map_check
   reports the loss. */
#define _DEFAULT_SOURCE            /* MAP_ANONYMOUS */
#include <fixsplat/system.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/base/opened.h"

/* Address ranges of mapped files. The SIGBUS handler may search them at any time, so all fields are accessed atomically
   and without a lock. */
enum { RANGES = 64 };
static struct range {
    /* first address and end of a mapped range; end = 0: nothing is mapped. end is set last and cleared first. */
    uintptr_t start, end;
    int lost;
    int taken;
} ranges[RANGES];

static int guarded;
static struct sigaction before;

static uintptr_t load(const uintptr_t *number)
{
    return __atomic_load_n(number, __ATOMIC_ACQUIRE);
}

static int take_range(void)
{
    int slot = 0;
    while (slot < RANGES && __atomic_exchange_n(&ranges[slot].taken, 1, __ATOMIC_ACQUIRE))
        slot++;
    return slot;
}

static void free_range(int slot)
{
    __atomic_store_n(&ranges[slot].taken, 0, __ATOMIC_RELEASE);
}

static void note_range(const fxs_mapping *mapping)
{
    struct range *r = &ranges[mapping->slot];
    __atomic_store_n(&r->lost, 0, __ATOMIC_RELAXED);
    __atomic_store_n(&r->start, (uintptr_t)mapping->data, __ATOMIC_RELEASE);
    __atomic_store_n(&r->end, (uintptr_t)mapping->data + mapping->bytes, __ATOMIC_RELEASE);
}

/* Replaces the pages of a mapped file by zeros, from the page with the faulting address to the file's end. */
static int fill_with_zeros(uintptr_t address)
{
    for (struct range *r = ranges; r < ranges + RANGES; r++) {
        const uintptr_t end = load(&r->end);
        if (address >= end || address < load(&r->start))
            continue;
        const uintptr_t page = address - address % (uintptr_t)sysconf(_SC_PAGESIZE);
        __atomic_store_n(&r->lost, 1, __ATOMIC_RELEASE);
        return mmap((void *)page, end - page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
    }
    return 0;
}

static void handle_as_before(int signal_number, siginfo_t *info, void *context)
{
    if (before.sa_flags & SA_SIGINFO)
        before.sa_sigaction(signal_number, info, context);
    else if (before.sa_handler == SIG_DFL) {
        signal(signal_number, SIG_DFL);
        raise(signal_number);
    } else if (before.sa_handler != SIG_IGN)
        before.sa_handler(signal_number);
}

static void handle(int signal_number, siginfo_t *info, void *context)
{
    /* si_code is positive for a fault of this process, not for a signal that another process sent */
    const int error = errno, fault = info->si_code > 0;
    if (!fault || !fill_with_zeros((uintptr_t)info->si_addr))
        handle_as_before(signal_number, info, context);
    errno = error;
}

void fxs_map_guard(void)
{
    struct sigaction action;
    if (__atomic_exchange_n(&guarded, 1, __ATOMIC_ACQ_REL) || sigaction(SIGBUS, 0, &before))
        return;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = handle;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGBUS, &action, 0);
}

static int map_file(fxs_mapping *mapping, const char *path, fxs_message *message)
{
    struct stat status;
    /* O_NONBLOCK: open does not wait for the writer of a FIFO */
    mapping->descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
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
    fxs_note_opened((uint64_t)status.st_dev, (uint64_t)status.st_ino);
    return 0;
}

int fxs_map_open(fxs_mapping *mapping, const char *path, fxs_message *message)
{
    memset(mapping, 0, sizeof *mapping);
    mapping->slot = take_range();
    if (mapping->slot == RANGES)
        return fxs_fail(message, "%s: more than %d files are mapped", path, (int)RANGES);
    const int error = map_file(mapping, path, message);
    if (!error) {
        note_range(mapping);
        return 0;
    }
    if (mapping->descriptor >= 0)
        close(mapping->descriptor);
    free_range(mapping->slot);
    return error;
}

int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message)
{
    struct stat status;
    if (__atomic_load_n(&ranges[mapping->slot].lost, __ATOMIC_ACQUIRE) || fstat(mapping->descriptor, &status) ||
        (uintmax_t)status.st_size < mapping->bytes)
        return fxs_fail(message, "%s: was cut short while it was read", path);
    if ((uintmax_t)status.st_size != mapping->bytes || status.st_mtim.tv_sec != mapping->modified[0] ||
        status.st_mtim.tv_nsec != mapping->modified[1])
        return fxs_fail(message, "%s: was written to while it was read", path);
    return 0;
}

void fxs_map_close(fxs_mapping *mapping)
{
    if (!mapping->data)
        return;
    __atomic_store_n(&ranges[mapping->slot].end, 0, __ATOMIC_RELEASE);
    munmap(mapping->data, mapping->bytes);
    close(mapping->descriptor);
    free_range(mapping->slot);
    memset(mapping, 0, sizeof *mapping);
}
