/* Chooses a table of kernels for a set of instruction sets. */
#ifndef FXS_FASTEST_H
#define FXS_FASTEST_H

#include <fixsplat/internal/kernels.h>

/* Returns the fastest kernels for the instruction sets in `cpu` that this processor has. The table stays valid until
   the program ends. */
static inline const fxs_kernels *kernels_for(unsigned cpu)
{
    static fxs_kernels tables[128];
    fxs_kernels *table = &tables[cpu % 128];
    fxs_kernels_choose(table, cpu);
    return table;
}

#endif
