/* Measures the time of a frame's stages. */
#include "times.h"

void fxs_lap(const fxs_frame *f, fxs_laps *laps, int which)
{
    if (!laps->times)
        return;
    const uint64_t now = fxs_now(f);
    laps->times[which] += now - laps->start;
    laps->start = now;
}

void fxs_share_time(fxs_frame *f, uint64_t start, const uint64_t *times, uint32_t jobs, uint32_t columns,
                    const enum fxs_stage *stages)
{
    const uint64_t wall = fxs_now(f) - start;
    uint64_t sums[FXS_LAPS] = {0}, total = 0;
    for (uint32_t i = 0; i < jobs * columns; i++) {
        sums[i % columns] += times[i];
        total += times[i];
    }
    for (uint32_t c = 0; c < columns && total; c++)
        f->stats.nanoseconds[stages[c]] += wall * (sums[c] * 1024 / total) / 1024;
}
