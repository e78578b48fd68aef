/* Reads the JSON of an earlier `fixsplat bench --json`, for bench --compare. */
#ifndef BENCH_EARLIER_H
#define BENCH_EARLIER_H

#include "command.h"

/* How a difference between two benchmarks is treated: ignored, shown beside the ratios, or an error. */
enum { FACT_ASIDE, FACT_MARKED, FACT_SAME };

/* A member of the JSON object: `number`, or `text` unless null. */
typedef struct bench_fact {
    const char *name, *text;
    double number;
    int kind;
} bench_fact;

#define MARKS_MOST 512

typedef struct bench_earlier {
    double stages[FXS_STAGES], frame;       /* median times, milliseconds */
    char marks[MARKS_MOST];                 /* text about the differing facts */
} bench_earlier;

/* Returns 0. On failure prints the reason and returns the exit status. */
int bench_earlier_read(bench_earlier *earlier, const char *path, const bench_fact *facts, int count);

#endif
