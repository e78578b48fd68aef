/* A clock that holds a frame rate.
 *
 * Demand is the load of a frame as a share of the load that the clock allows:
 *   demand = max((mean + max(mean - slow, 0)) / 0.85, high / 0.95)
 * `high` is the second largest of the last 32 times, `mean` their mean with each time limited to `high`, and `slow` an
 * exponential average of the mean over 256 frames. All are in units of a frame. A demand above 1 lowers the quality by
 * AIM / demand. A demand that stayed below ROOM for a whole window of time raises the quality. The clock assumes that
 * times change by the same factor as budget and pixels, and corrects its memory by this factor. Real times change less,
 * so the clock approaches its aim from the safe side. */
#include "sized.h"

#include <fixsplat/pace.h>

#define ONE 65536u
#define AIM 62915u                     /* 0.96 */
#define ROOM 60293u                    /* 0.92 */
#define ARRIVED 58982u                 /* 0.9 */
#define STEP (ONE + ONE / 48)
#define LEAST_STEP (ONE + ONE / 4)     /* until the first good choice */
#define RATE_GAIN 57344u               /* 7/8: a level of rates lowers times at least by this factor */
#define RATE_LOSS 87381u               /* 4/3: without a level of rates, times grow at most by this factor */
#define LONGEST 16u                    /* longer times count as 16 frames */
#define UNKNOWN ((uint64_t)1 << 40)
#define WINDOW 6000000000u             /* nanoseconds */
#define START 1000000000u

enum { RECENT = sizeof ((fxs_pace *)0)->recent_q16 / sizeof(uint32_t), QUIET = 16, PROBES = 3 };

static uint32_t scaled(uint32_t value, uint32_t factor_q16)
{
    const uint64_t product = (uint64_t)value * factor_q16 >> 16;
    return product < UINT32_MAX ? (uint32_t)product : UINT32_MAX;
}

static uint32_t between(uint32_t value, uint32_t least, uint32_t most)
{
    return value < least ? least : value > most ? most : value;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* scale * sqrt(factor), in Q16; scale <= 2^16, factor <= 2^17 */
static uint32_t scaled_side(uint32_t scale_q16, uint32_t factor_q16)
{
    const uint64_t square = (uint64_t)scale_q16 * scale_q16 * factor_q16 >> 16;   /* to 2^33 */
    uint64_t root = 0;
    for (uint64_t bit = 1 << 16; bit; bit >>= 1)
        if ((root | bit) * (root | bit) <= square)
            root |= bit;
    return (uint32_t)root;
}

void (fxs_pace_init)(fxs_pace *pace, uint32_t size)
{
    const fxs_pace all = {.frame_nanoseconds = 16666667, .scale_least_q16 = ONE, .scale_q16 = ONE};
    fxs_sized_fill(pace, size, &all, sizeof all);
}

const char *fxs_pace_why(enum fxs_pace_reason reason)
{
    static const char *const texts[] = {"first choice", "lowered: frames were late", "lowered: frames take longer",
                                        "too slow at the least quality", "raised: frames left time"};
    return (uint32_t)reason < sizeof texts / sizeof *texts ? texts[reason] : "unknown";
}

static int are_limits_right(const fxs_pace *p)
{
    return p->frame_nanoseconds >= 100000 && p->frame_nanoseconds <= 2000000000 && p->scale_least_q16 >= 1024 &&
           p->scale_least_q16 <= ONE && p->rates_most <= 2 && p->budget_least <= p->budget_most;
}

/* at least 1 if a budget is chosen, because a budget of 0 is no limit */
static uint32_t least_budget(const fxs_pace *p)
{
    return p->budget_most && !p->budget_least ? 1 : p->budget_least;
}

static void limit(fxs_pace *p)
{
    p->budget = between(p->budget ? p->budget : p->budget_most, least_budget(p), p->budget_most);
    p->scale_q16 = between(p->scale_q16, p->scale_least_q16, ONE);
    p->rates = between(p->rates, 0, p->rates_most);
}

/* ---- Measuring --------------------------------------------------------------------------------------------------- */

static uint32_t known(const fxs_pace *p)
{
    return p->count < RECENT ? p->count : RECENT;
}

static uint32_t second_largest(const fxs_pace *p)
{
    uint32_t first = 0, second = 0;
    for (uint32_t i = 0; i < known(p); i++) {
        second = larger(second, p->recent_q16[i] < first ? p->recent_q16[i] : first);
        first = larger(first, p->recent_q16[i]);
    }
    return second;
}

static uint32_t mean_to(const fxs_pace *p, uint32_t most)
{
    uint32_t sum = 0;                                                    /* to 2^25 */
    for (uint32_t i = 0; i < known(p); i++)
        sum += between(p->recent_q16[i], 0, most);
    return sum / known(p);
}

static void take(fxs_pace *p, uint64_t nanoseconds)
{
    const uint64_t frame = p->frame_nanoseconds;
    nanoseconds = nanoseconds < LONGEST * frame ? nanoseconds : LONGEST * frame;
    p->recent_q16[p->count % RECENT] = (uint32_t)((nanoseconds << 16) / frame);
    p->count = p->count + 1 < 2 * RECENT ? p->count + 1 : RECENT;
    p->quiet++;
    p->elapsed += nanoseconds > frame ? nanoseconds : frame;
}

/* Returns the demand. Slow frames lower the quality only until the mean is a third of a frame: then they have another
   cause. *is_late: two frames were late or nearly late. */
static uint32_t demand_of(fxs_pace *p, int *is_late)
{
    const uint32_t high = second_largest(p), mean = mean_to(p, high);
    p->slow_q16 = p->count < RECENT ? mean : (uint32_t)(((uint64_t)p->slow_q16 * 255 + mean) / 256);
    const uint32_t ahead = mean + (mean > p->slow_q16 ? mean - p->slow_q16 : 0);
    const uint32_t of_mean = ahead * 20 / 17, of_high = between(high, 0, 3 * mean) * 20 / 19;
    *is_late = of_high > ONE;
    return larger(of_mean, of_high);
}

static void remember(fxs_pace *p, uint32_t demand)
{
    p->peaks_q16[0] = larger(p->peaks_q16[0], demand);
    if (p->elapsed < WINDOW)
        return;
    p->peaks_q16[1] = p->peaks_q16[0];
    p->peaks_q16[0] = demand;
    p->elapsed = 0;
}

/* Corrects the memory for a change of quality that changes times by a factor. */
static void expect(fxs_pace *p, uint32_t factor_q16)
{
    for (uint32_t i = 0; i < RECENT; i++)
        p->recent_q16[i] = between(scaled(p->recent_q16[i], factor_q16), 0, LONGEST * ONE);
    for (int i = 0; i < 2; i++)
        p->peaks_q16[i] = between(scaled(p->peaks_q16[i], factor_q16), 0, 2 * LONGEST * ONE);
    p->slow_q16 = p->count ? mean_to(p, second_largest(p)) : 0;
    p->quiet = 0;
}

/* ---- Choosing ---------------------------------------------------------------------------------------------------- */

/* Lowers the quality by a factor, at most by half. Returns 0 if the limits allow nothing lower. */
static int lower(fxs_pace *p, uint32_t factor_q16, uint32_t drawn)
{
    const fxs_pace before = *p;
    uint32_t rest = larger(factor_q16, ONE / 2);
    if (p->rates < p->rates_most) {
        p->rates++;
        rest = between((uint32_t)(((uint64_t)rest << 16) / RATE_GAIN), 0, ONE);
    }
    if (rest < ONE) {
        const uint32_t used = drawn ? between(p->budget, 0, drawn) : p->budget;
        p->budget = between(scaled(used, rest), least_budget(p), p->budget);
        p->scale_q16 = larger(scaled_side(p->scale_q16, rest), p->scale_least_q16);
    }
    if (p->budget == before.budget && p->scale_q16 == before.scale_q16 && p->rates == before.rates)
        return 0;
    expect(p, factor_q16);
    return 1;
}

/* Raises the quality by a factor, first that of budget and pixels which has the smaller share of its largest value. A
   budget that does not limit the frame does not grow. Returns 0 if the limits allow nothing higher. */
static int raise(fxs_pace *p, uint32_t factor_q16, uint32_t drawn, uint32_t peak)
{
    const uint32_t of_pixels = scaled(p->scale_q16, p->scale_q16);
    const uint32_t of_budget = p->budget_most ? (uint32_t)(((uint64_t)p->budget << 16) / p->budget_most) : ONE;
    const int with_budget = p->budget < p->budget_most && (!drawn || drawn > p->budget / 2);
    const int with_pixels = p->scale_q16 < ONE;
    if (with_budget && (!with_pixels || of_budget <= of_pixels + of_pixels / 16))
        p->budget = between(larger(scaled(p->budget, factor_q16), p->budget + 1), 0, p->budget_most);
    if (with_pixels && (!with_budget || of_pixels <= of_budget + of_budget / 16))
        p->scale_q16 = between(scaled_side(p->scale_q16, factor_q16), 0, ONE);
    if (!with_budget && !with_pixels) {
        factor_q16 = RATE_LOSS;
        if (!p->rates || scaled(peak, factor_q16) > AIM)
            return 0;
        p->rates--;
    }
    expect(p, factor_q16);
    return 1;
}

/* The first choices of a clock: raises the quality in large steps until the demand is right. Returns 1 if it has
   raised the quality. */
static int rise(fxs_pace *p, uint32_t demand, uint32_t drawn)
{
    if (p->count < PROBES)
        return 0;
    if (demand < ARRIVED &&
        raise(p, between((uint32_t)(((uint64_t)AIM << 16) / (demand + 1)), LEAST_STEP, 2 * ONE), drawn, demand)) {
        p->count = 0;
        return 1;
    }
    if (demand >= ARRIVED || p->elapsed > START) {
        p->settled = 1;
        p->peaks_q16[0] = p->peaks_q16[1] = demand;
    }
    return 0;
}

static enum fxs_pace_reason choose(fxs_pace *p, uint32_t drawn)
{
    int is_late;
    const uint32_t demand = demand_of(p, &is_late);
    if (p->count < 2)
        return p->reason;
    remember(p, demand);
    const uint32_t peak = larger(p->peaks_q16[0], p->peaks_q16[1]);
    if (demand > ONE) {
        const uint32_t factor = (uint32_t)(((uint64_t)AIM << 16) / demand);
        return !lower(p, factor, drawn) ? FXS_PACE_LEAST : is_late ? FXS_PACE_LATE : FXS_PACE_SLOWER;
    }
    if (p->settled ? p->quiet >= QUIET && peak < ROOM && raise(p, STEP, drawn, peak) : rise(p, demand, drawn))
        return FXS_PACE_FASTER;
    return p->reason;
}

int fxs_pace_step(fxs_pace *pace, uint64_t nanoseconds, uint32_t drawn, uint32_t number)
{
    if (!pace || pace->size < sizeof *pace || !are_limits_right(pace))
        return pace && pace->size < sizeof *pace ? FXS_ERR_STRUCT : FXS_ERR_ARGUMENT;
    const uint32_t budget = pace->budget, scale = pace->scale_q16, rates = pace->rates;
    limit(pace);
    if (nanoseconds && nanoseconds <= UNKNOWN && number == pace->number) {
        take(pace, nanoseconds);
        pace->reason = choose(pace, drawn);
    }
    const int is_changed = budget != pace->budget || scale != pace->scale_q16 || rates != pace->rates;
    pace->number += (uint32_t)is_changed;
    return is_changed;
}
