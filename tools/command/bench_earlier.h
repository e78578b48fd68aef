/* Reads the output of an earlier `fixsplat bench --json`, for bench --compare. */
#ifndef BENCH_EARLIER_H
#define BENCH_EARLIER_H

#include "command.h"

/* How a differing fact is treated: ignored, marked beside the ratios, or an error. */
enum { FACT_ASIDE, FACT_MARKED, FACT_SAME };

/* A member of the JSON object: a text, or a number if the text is null. */
typedef struct bench_fact {
    const char *name, *text;
    double number;
    int kind;
} bench_fact;

#define MARKS_MOST 512

typedef struct bench_earlier {
    double stages[FXS_STAGES], frame;       /* median milliseconds */
    char marks[MARKS_MOST];                 /* differing facts, in one line; empty: none */
} bench_earlier;

/* Returns 0, or prints why the file cannot be read or compared, and returns the exit status. */
int bench_earlier_read(bench_earlier *earlier, const char *path, const bench_fact *facts, int count);

#endif
