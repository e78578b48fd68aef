/* malloc and free of a WebAssembly module, for few, mostly large blocks, aligned to 64 bytes. malloc takes the first
   block that fits in a list of free blocks. The list is in ascending order of addresses, and free merges neighbours. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/pages_internal.h"

#define PAGE 65536u

typedef struct block {
    size_t bytes;                  /* size in bytes of this block with its header, a multiple of 64 */
    struct block *next;
} __attribute__((aligned(64))) block;

extern unsigned char __heap_base;  /* end of the stack and of all data; the linker sets its address */
static block *first;
static uintptr_t end;

static int touch(const block *a, const block *b)
{
    return a && b && (uintptr_t)a + a->bytes == (uintptr_t)b;
}

static void give(block *given)
{
    block *before = NULL, *after = first;
    for (; after && after < given; after = after->next)
        before = after;
    given->next = after;
    if (touch(given, after)) {
        given->bytes += after->bytes;
        given->next = after->next;
    }
    if (touch(before, given)) {
        before->bytes += given->bytes;
        before->next = given->next;
    } else if (before)
        before->next = given;
    else
        first = given;
}

static int grow(size_t bytes)
{
    const size_t pages = bytes / PAGE + 1;
    if (!end)
        end = ((uintptr_t)&__heap_base + 63) & ~(uintptr_t)63;
    const size_t old = __builtin_wasm_memory_size(0);
    if (pages > 65535 - old || __builtin_wasm_memory_grow(0, pages) == SIZE_MAX)
        return 0;
    block *made = (block *)end;
    made->bytes = (old + pages) * PAGE - end;
    end += made->bytes;
    give(made);
    return 1;
}

static block *take(size_t bytes)
{
    for (block **at = &first; *at; at = &(*at)->next) {
        block *found = *at;
        if (found->bytes < bytes)
            continue;
        if (found->bytes > bytes) {
            block *rest = (block *)((uintptr_t)found + bytes);
            *rest = (block){found->bytes - bytes, found->next};
            *at = rest;
        } else
            *at = found->next;
        found->bytes = bytes;
        return found;
    }
    return NULL;
}

void *malloc(size_t bytes)
{
    if (bytes > SIZE_MAX - 4 * PAGE)
        return NULL;
    const size_t whole = (bytes + 63) / 64 * 64 + sizeof(block);
    block *taken = take(whole);
    if (!taken && grow(whole))
        taken = take(whole);
    return taken ? taken + 1 : NULL;
}

void free(void *memory)
{
    if (memory)
        give((block *)memory - 1);
}

void *calloc(size_t count, size_t size)
{
    void *memory = size && count > SIZE_MAX / size ? NULL : malloc(count * size);
    return memory ? memset(memory, 0, count * size) : NULL;
}

void *realloc(void *memory, size_t bytes)
{
    void *larger = malloc(bytes);
    if (memory && larger) {
        const size_t old = ((block *)memory - 1)->bytes - sizeof(block);
        memcpy(larger, memory, old < bytes ? old : bytes);
        free(memory);
    }
    return larger;
}

/* Asks for large pages of memory. Does nothing, since the memory of a WebAssembly module has pages of one size. */
void fxs_use_large_pages(void *block, size_t bytes)
{
    (void)block;
    (void)bytes;
}
