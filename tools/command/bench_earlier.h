/* Reads the JSON output of an earlier `fixsplat bench --json`, for the option --compare. */
#ifndef BENCH_EARLIER_H
#define BENCH_EARLIER_H

#include "command.h"

/* Tells how a difference between two benchmarks is treated: ignored, shown next to the ratios of times, or an error. */
enum { FACT_ASIDE, FACT_MARKED, FACT_SAME };

typedef struct bench_fact {
    const char *name, *text;
    double number;
    int kind;
} bench_fact;

#define MARKS_MOST 512

typedef struct bench_earlier {
    double stages[FXS_STAGES], frame;       /* median times of the stages and of a frame in milliseconds */
    char marks[MARKS_MOST];
} bench_earlier;

int bench_earlier_read(bench_earlier *earlier, const char *path, const bench_fact *facts, int count);

#endif
