/* A minimal test harness. RUN(test) counts a test function as failed if a CHECK in the function failed, and as
   skipped after SKIP. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>

static int check_passed, check_failed, check_skipped;
static int check_faults, check_skips;                   /* numbers of failed checks and of skips in the running test */

#define CHECK(condition) \
    ((condition) ? 1 : (check_faults++, printf("  %s:%d: not so: %s\n", __FILE__, __LINE__, #condition), 0))

/* Skips the rest of the test function and prints the reason. */
#define SKIP(reason) do { printf("  skipped: %s\n", reason); check_skips++; return; } while (0)

#define RUN(test) RUN_AS(#test, test())

#define RUN_AS(name, call) do { \
        check_faults = check_skips = 0; \
        call; \
        if (check_faults) { check_failed++; printf("FAIL %s\n", name); } \
        else if (check_skips) { check_skipped++; printf("skip %s\n", name); } \
        else { check_passed++; printf("ok   %s\n", name); } \
        fflush(stdout); \
    } while (0)

/* Allocates memory aligned to 64 bytes, released with free. */
static inline void *check_aligned(size_t bytes)
{
    void *memory = 0;
    return posix_memalign(&memory, 64, bytes ? bytes : 64) ? 0 : memory;
}

/* Prints how many tests of the program passed, failed and were skipped. Returns the exit status. */
static int check_report(void)
{
    printf("%d passed, %d failed, %d skipped\n", check_passed, check_failed, check_skipped);
    return check_failed != 0;
}

#endif
