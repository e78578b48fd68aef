/* Runs a test program on a microcontroller. Defines the functions that newlib needs. The test is built with
   -Dmain=test_main and gets no arguments. */
#include <errno.h>
#include <malloc.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "port/board/cortexm/firmware.h"
#include "port/board/cortexm/console.h"

int test_main(int argc, char **argv);

int main(void)
{
    static char name[] = "test", *argv[] = {name, NULL};
    const int status = test_main(1, argv);
    exit(status);
}

void *_sbrk(ptrdiff_t bytes)
{
    static unsigned char *end = board_memory;
    if (bytes > board_memory_end - end) {
        errno = ENOMEM;
        return (void *)-1;
    }
    end += bytes;
    return end - bytes;
}

int posix_memalign(void **memory, size_t alignment, size_t bytes)
{
    *memory = memalign(alignment, bytes);
    return *memory ? 0 : ENOMEM;
}

int _write(int file, const char *bytes, int count)
{
    (void)file;
    for (int i = 0; i < count; i++) {
        const char text[2] = {bytes[i], 0};
        console_text(text);
    }
    return count;
}

int _fstat(int file, struct stat *s)
{
    (void)file;
    s->st_mode = S_IFCHR;
    return 0;
}

int _isatty(int file)
{
    (void)file;
    return 1;
}

int _read(int file, char *bytes, int count)
{
    (void)file, (void)bytes, (void)count;
    return 0;
}

int _lseek(int file, int offset, int from)
{
    (void)file, (void)offset, (void)from;
    return 0;
}

int _close(int file)
{
    (void)file;
    return -1;
}

int _getpid(void)
{
    return 1;
}

int _kill(int process, int signal)
{
    (void)process;
    console_exit(signal);
    return -1;
}

void _exit(int status)
{
    console_exit(status);
    for (;;)
        ;
}
