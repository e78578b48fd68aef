/* Substitutes for POSIX functions in test programs for Windows. The compiler includes this header before each
   program. */
#ifndef ON_WINDOWS_H
#define ON_WINDOWS_H

#include <direct.h>
#include <errno.h>
#include <malloc.h>
#include <process.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define mkdir(path, mode) _mkdir(path)
#define setenv(name, value, replace) _putenv_s(name, value)
#define unsetenv(name) _putenv_s(name, "")

/* Replaces POSIX mkdtemp. Windows' _mktemp has only 26 names for a process id, and an earlier process may have used
   all of them. */
static inline char *mkdtemp(char *name)
{
    char *end = name + strlen(name) - strlen("XXXXXX");
    for (int i = 0; i < 1000; i++) {
        snprintf(end, sizeof "XXXXXX", "%06x", ((unsigned)_getpid() * 1000u + (unsigned)i) & 0xffffffu);
        if (!_mkdir(name))
            return name;
    }
    return NULL;
}

/* Replaces posix_memalign, so that free accepts the aligned block. The pointer from malloc and a 64-bit mark lie
   before the block. free_block replaces free and looks for the mark. */
#define ALIGNED_MARK 0x7a11ed0b10c5ba5eu

static inline int posix_memalign(void **memory, size_t alignment, size_t bytes)
{
    uint64_t *whole = malloc(bytes + 2 * alignment);
    if (!whole)
        return ENOMEM;
    uint64_t *block = (uint64_t *)(((uintptr_t)whole + 2 * sizeof *block + alignment - 1) / alignment * alignment);
    block[-1] = ALIGNED_MARK;
    block[-2] = (uint64_t)(uintptr_t)whole;
    *memory = block;
    return 0;
}

static inline void free_block(void *memory)
{
    uint64_t *volatile where = memory;   /* volatile hides from the compiler that block[-1] lies before the block */
    uint64_t *block = where;
    free(block && (uintptr_t)block % 64 == 0 && block[-1] == ALIGNED_MARK ? (void *)(uintptr_t)block[-2] : memory);
}
#define free free_block

/* Replaces an existing file, as POSIX rename does. The two names may differ in case only. */
static inline int rename_over(const char *from, const char *to)
{
    if (!rename(from, to))
        return 0;
    _unlink(to);
    return rename(from, to);
}
#define rename rename_over

static inline int run_shell(const char *command)
{
    char line[256];
    const char *space = strrchr(command, ' ');
    snprintf(line, sizeof line, "rd /s /q %s", space ? space + 1 : "");
    for (char *c = line + strlen("rd /s /q "); *c; c++)
        *c = *c == '/' ? '\\' : *c;
    return strncmp(command, "rm -r", 5) ? -1 : system(line);
}
#define system run_shell

#endif
