/* What an earlier `fixsplat bench --json` printed, for bench --compare. */
#ifndef BENCH_EARLIER_H
#define BENCH_EARLIER_H

#include "command.h"

/* What a fact of a run means for comparing: an earlier one with another is refused, or its ratios are marked. */
enum { FACT_ASIDE, FACT_MARKED, FACT_SAME };

/* A member of the JSON object: a text, or where that is null a number. */
typedef struct bench_fact {
    const char *name, *text;
    double number;
    int kind;
} bench_fact;

#define MARKS_MOST 512

typedef struct bench_earlier {
    double stages[FXS_STAGES], frame;       /* median milliseconds */
    char marks[MARKS_MOST];                 /* what differs but the times, one line, or empty */
} bench_earlier;

/* Reads the file. Returns 0, or prints that it is none or what about it cannot be compared, and returns the exit
   status. */
int bench_earlier_read(bench_earlier *earlier, const char *path, const bench_fact *facts, int count);

#endif
