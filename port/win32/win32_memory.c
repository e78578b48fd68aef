#include "win32.h"

#include <malloc.h>
#include <stdlib.h>

#include <fixsplat/system.h>

#include "src/base/pages_internal.h"

/* Returns the time in nanoseconds: ticks * 10^9 / rate, computed in two parts to avoid overflow. */
uint64_t fxs_clock(void *unused)
{
    LARGE_INTEGER ticks, rate;
    (void)unused;
    QueryPerformanceCounter(&ticks);
    QueryPerformanceFrequency(&rate);
    const uint64_t t = (uint64_t)ticks.QuadPart, r = (uint64_t)rate.QuadPart;
    return t / r * 1000000000 + t % r * 1000000000 / r;
}

uint32_t fxs_processors(void)
{
    DWORD_PTR own, all;
    uint32_t n = 0;
    if (GetProcessAffinityMask(GetCurrentProcess(), &own, &all))
        for (; own; own &= own - 1)
            n++;
    return n < 1 ? 1 : n > 64 ? 64 : n;
}

/* Does nothing, because large pages need a special privilege on Windows. */
void fxs_use_large_pages(void *block, size_t bytes)
{
    (void)block, (void)bytes;
}

void *fxs_aligned_allocate(size_t bytes)
{
    return _aligned_malloc(bytes ? bytes : 1, 64);
}

void fxs_aligned_free(void *block)
{
    _aligned_free(block);
}

/* Begins printing to memory. Uses a temporary file, because Windows has no memory streams. */
int fxs_print_begin(fxs_printed *printed)
{
    *printed = (fxs_printed){.file = fxs_stream_temporary()};
    return printed->file ? 0 : -1;
}

int fxs_print_end(fxs_printed *printed)
{
    const __int64 size = fflush(printed->file) || ferror(printed->file) ? -1 : _ftelli64(printed->file);
    char *text = size > 0 ? malloc((size_t)size + 1) : NULL;
    rewind(printed->file);
    if (text && fread(text, 1, (size_t)size, printed->file) != (size_t)size) {
        free(text);
        text = NULL;
    }
    fclose(printed->file);
    if (!text)
        return -1;
    text[size] = 0;
    printed->text = text;
    printed->size = (size_t)size;
    return 0;
}
