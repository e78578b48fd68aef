/* A library for LD_PRELOAD that simulates faults. FAULT_AT=N: allocation N fails. FAULT_EVER=1: all later
   allocations fail too. FAULT_KILL=N: the Nth call of rename kills the process. FAULT_LOG=FILE: logs fsync and
   rename, and the number of allocations. Allocations of libwebp 1.2.4 never fail, because their results are not all
   checked. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static long calls, fails_at;
static int fails_ever;

static uintptr_t webp_start, webp_end;     /* address range of libwebp's code; 0: libwebp is not loaded */

static int find_webp(struct dl_phdr_info *object, size_t size, void *unused)
{
    (void)size, (void)unused;
    for (int i = 0; i < object->dlpi_phnum && strstr(object->dlpi_name, "libwebp.so"); i++)
        if (object->dlpi_phdr[i].p_type == PT_LOAD && object->dlpi_phdr[i].p_flags & PF_X) {
            webp_start = object->dlpi_addr + object->dlpi_phdr[i].p_vaddr;
            webp_end = webp_start + object->dlpi_phdr[i].p_memsz;
        }
    return 0;
}

static int is_webp(const void *caller)
{
    return (uintptr_t)caller >= webp_start && (uintptr_t)caller < webp_end;
}

#define fails() (!is_webp(__builtin_return_address(0)) && is_chosen())

static int is_chosen(void)
{
    long call = __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED);
    if (!fails_at || call < fails_at || (call > fails_at && !fails_ever))
        return 0;
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return fails() ? NULL : __libc_realloc(old, size);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    if (fails())
        return ENOMEM;
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}

typedef int main_function(int, char **, char **);
static main_function *own_main;

static int counted_main(int argc, char **argv, char **environment)
{
    dl_iterate_phdr(find_webp, NULL);
    const char *at = getenv("FAULT_AT"), *ever = getenv("FAULT_EVER");
    fails_at = at ? atol(at) : 0;
    fails_ever = ever && *ever;
    calls = 0;
    return own_main(argc, argv, environment);
}

/* Starts the program with a different main, so that allocations in library constructors are not counted. */
int __libc_start_main(main_function *program, int argc, char **argv, void (*init)(void), void (*fini)(void),
                      void (*linker_fini)(void), void *stack_end)
{
    own_main = program;
    return ((int (*)(main_function *, int, char **, void (*)(void), void (*)(void), void (*)(void), void *))
            dlsym(RTLD_NEXT, "__libc_start_main"))(counted_main, argc, argv, init, fini, linker_fini, stack_end);
}

static void note(const char *format, ...)
{
    char text[64];
    const char *path = getenv("FAULT_LOG");
    int log = path ? open(path, O_WRONLY | O_CREAT | O_APPEND, 0666) : -1;
    if (log < 0)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (write(log, text, strlen(text)) < 0)
        _exit(99);
    close(log);
}

__attribute__((destructor)) static void end(void)
{
    note("%ld allocations\n", calls);
}

int fsync(int descriptor)
{
    struct stat status;
    fstat(descriptor, &status);
    note("fsync %s\n", S_ISDIR(status.st_mode) ? "folder" : "file");
    return ((int (*)(int))dlsym(RTLD_NEXT, "fsync"))(descriptor);
}

int rename(const char *from, const char *to)
{
    static int renames;
    const char *kills = getenv("FAULT_KILL");
    note("rename\n");
    if (kills && ++renames == atoi(kills))
        raise(SIGKILL);
    return ((int (*)(const char *, const char *))dlsym(RTLD_NEXT, "rename"))(from, to);
}
