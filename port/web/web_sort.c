/* The function qsort as a bottom-up heap sort, which makes few comparisons, needs no extra memory, and has no slow
   input. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef int compare_fn(const void *, const void *);

/* Puts `value` into the heap: from the free place `at`, moves down to the place where the value belongs. */
static inline void sift(char *base, size_t count, size_t at, size_t width, const char *value, compare_fn *compare)
{
    const size_t top = at;
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        if (child + 1 < count && compare(base + child * width, base + (child + 1) * width) < 0)
            child++;
        memcpy(base + at * width, base + child * width, width);
    }
    for (size_t above; at > top && compare(base + (above = (at - 1) / 2) * width, value) < 0; at = above)
        memcpy(base + at * width, base + above * width, width);
    memcpy(base + at * width, value, width);
}

static inline void sort(char *base, size_t count, size_t width, char *value, compare_fn *compare)
{
    for (size_t at = count / 2; at-- > 0;) {
        memcpy(value, base + at * width, width);
        sift(base, count, at, width, value, compare);
    }
    for (size_t last = count; last-- > 1;) {
        memcpy(value, base + last * width, width);
        memcpy(base + last * width, base, width);
        sift(base, last, 0, width, value, compare);
    }
}

void qsort(void *base, size_t count, size_t width, compare_fn *compare)
{
    char value[64];
    if (width == sizeof(uint64_t))
        sort(base, count, sizeof(uint64_t), value, compare);
    else if (width <= sizeof value)
        sort(base, count, width, value, compare);
    else
        __builtin_trap();
}
