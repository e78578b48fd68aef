#ifdef __linux__
#define _GNU_SOURCE                        /* declares sched_getaffinity */
#include <sched.h>
#endif

#include <fixsplat/system.h>

#include <unistd.h>

uint32_t fxs_processors(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
#ifdef __linux__
    cpu_set_t allowed;
    if (!sched_getaffinity(0, sizeof allowed, &allowed))
        n = CPU_COUNT(&allowed);
#endif
    return n < 1 ? 1 : n > 64 ? 64 : (uint32_t)n;
}
