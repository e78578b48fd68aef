/* Tests of the clock that holds a frame rate, on simulated devices. With names of devices as its arguments, prints the
 * course of each device for tools/scripts/plot.awk: a line a second with the device's name, the number of drawn frames
 * and of late frames, the budget, and the longest time of a frame. The last two are in percent. */
#include <math.h>
#include <string.h>

#include <fixsplat/pace.h>

#include "check.h"

enum { RATE = 72, DELAY = 2, SECOND = RATE, MINUTE = 60 * RATE };
#define MOST 1000000u
static const double FRAME = 1e9 / RATE;

/* A device: times in milliseconds of a frame's fixed part, of MOST Gaussians and of all pixels; relative noise. */
typedef struct device {
    const char *name;
    double fixed, gaussians, pixels, noise;
    double (*slowness)(double second);                  /* null: 1 */
    double burst, burst_ms;                             /* probability of a burst, its time */
    double (*view)(double second);                      /* share of MOST that the view holds; null: 1 */
} device;

typedef struct course {
    fxs_pace pace;
    uint32_t seed;
    uint32_t missed, changes, frames;
    struct { double time; uint32_t drawn, number; } late[DELAY + 1];   /* times that the clock has not yet seen */
} course;

static double random_of(course *c)
{
    c->seed = c->seed * 1664525u + 1013904223u;
    return (c->seed >> 8) / 16777216.0;
}

static double throttling(double s)                      /* by half in two minutes, in steps as of a clock; then cool */
{
    return s < 30 ? 1 : s < 150 ? 1 + 0.5 * floor((s - 30) / 10) / 12 : s < 240 ? 1.5 : 1;
}

static double alternating(double s)
{
    return fmod(s, 8) < 4 ? 0.3 : 1;
}

static const device devices[] = {
    {"slow", 2, 20, 12, 0.05, 0, 0, 0, 0},
    {"throttling", 1.5, 6, 4, 0.04, throttling, 0, 0, 0},
    {"bursty", 2, 9, 5, 0.05, 0, 0.02, 2.5, 0},
    {"alternating", 1, 16, 4, 0.04, 0, 0, 0, alternating},
    {"fast", 1, 3, 3, 0.1, 0, 0.0005, 30, 0},
};

static const device *named(const char *name)
{
    for (size_t i = 0; i < sizeof devices / sizeof *devices; i++)
        if (!strcmp(devices[i].name, name))
            return &devices[i];
    return 0;
}

static void begin(course *c)
{
    memset(c, 0, sizeof *c);
    fxs_pace_init(&c->pace);
    c->pace.frame_nanoseconds = (uint32_t)FRAME;
    c->pace.budget_most = MOST;
    c->pace.budget_least = MOST / 20;
    c->pace.scale_least_q16 = 65536 / 3;
    fxs_pace_step(&c->pace, 0, 0, 0);
}

static double pixels_of(const fxs_pace *p)
{
    return p->scale_q16 / 65536.0 * (p->scale_q16 / 65536.0);
}

/* Draws a frame. Returns its time in nanoseconds. */
static double draw(course *c, const device *d)
{
    static const double of_rates[] = {1, 0.8, 0.65};
    const double s = c->frames++ / (double)RATE;
    fxs_pace *p = &c->pace;
    const double seen = (d->view ? d->view(s) : 1) * MOST;
    const double drawn = p->budget_most && p->budget < seen ? p->budget : seen;
    double ms = d->fixed + d->gaussians * drawn / MOST + d->pixels * pixels_of(p) * of_rates[p->rates];
    ms *= (d->slowness ? d->slowness(s) : 1) * (1 + d->noise * (2 * random_of(c) - 1));
    ms += random_of(c) < d->burst ? d->burst_ms : 0;
    memmove(c->late, c->late + 1, sizeof c->late - sizeof *c->late);
    c->late[DELAY].time = ms * 1e6;
    c->late[DELAY].drawn = (uint32_t)drawn;
    c->late[DELAY].number = p->number;
    c->changes += fxs_pace_step(p, (uint64_t)c->late[0].time, c->late[0].drawn, c->late[0].number) == 1;
    c->missed += ms * 1e6 > FRAME;
    return ms * 1e6;
}

static void draw_for(course *c, const device *d, uint32_t frames)
{
    c->missed = c->changes = 0;
    for (uint32_t i = 0; i < frames; i++)
        draw(c, d);
}

static void print_course(const device *d)
{
    course c;
    begin(&c);
    for (int s = 0; s < 300; s++) {
        double longest = 0;
        for (int i = 0; i < SECOND; i++)
            longest = fmax(longest, draw(&c, d));
        printf("%s %u %u %.1f %.1f\n", d->name, c.frames, c.missed, c.pace.budget * 100.0 / MOST,
               100 * longest / FRAME);
    }
}

/* ---- Devices ----------------------------------------------------------------------------------------------------- */

enum { SEEDS = 3, MINUTES = 5 };

/* Draws the first second, then five minutes. Returns the clock at the end; sums without the first second. */
static course run(const device *d, uint32_t seed, uint32_t later_changes[MINUTES])
{
    course c;
    uint32_t missed = 0;
    begin(&c);
    c.seed = seed;
    draw_for(&c, d, SECOND);
    for (int m = 0; m < MINUTES; m++) {
        draw_for(&c, d, MINUTE);
        missed += c.missed;
        later_changes[m] = c.changes;
    }
    c.missed = missed;
    return c;
}

static void at_most_one_frame_in_a_thousand_is_missed(void)
{
    for (size_t i = 0; i < sizeof devices / sizeof *devices; i++)
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            uint32_t changes[MINUTES];
            const course c = run(&devices[i], seed, changes);
            if (!CHECK(c.missed * 1000 <= MINUTES * MINUTE))
                printf("  %s, seed %u: %u missed\n", devices[i].name, seed, c.missed);
        }
}

static void the_choice_is_steady(void)
{
    static const char *const names[] = {"slow", "bursty", "alternating"};
    for (int i = 0; i < 3; i++)
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            uint32_t changes[MINUTES];
            run(named(names[i]), seed, changes);
            for (int m = 1; m < MINUTES; m++)
                if (!CHECK(changes[m] <= 6))
                    printf("  %s, seed %u: %u changes in minute %d\n", names[i], seed, changes[m], m);
        }
}

static void a_slow_device_is_well_used(void)
{
    uint32_t changes[MINUTES];
    course c = run(named("slow"), 1, changes);
    double sum = 0;
    for (int i = 0; i < MINUTE; i++)
        sum += draw(&c, named("slow"));
    CHECK(sum / MINUTE > 0.75 * FRAME && sum / MINUTE < 0.87 * FRAME);
    CHECK(fabs(c.pace.budget / (double)MOST - pixels_of(&c.pace)) < 0.02);
}

static void a_fast_device_keeps_full_quality(void)
{
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        uint32_t changes[MINUTES];
        const course c = run(named("fast"), seed, changes);
        CHECK(c.pace.budget == MOST && c.pace.scale_q16 == 65536);
        CHECK(c.pace.number == 1);                          /* of the first choice, before the first frame */
    }
}

static void throttling_costs_no_frame_and_quality_comes_back(void)
{
    course c;
    begin(&c);
    draw_for(&c, named("throttling"), 240 * RATE);
    CHECK(c.missed == 0 && c.pace.budget < 0.65 * MOST);
    draw_for(&c, named("throttling"), 60 * RATE);
    CHECK(c.missed == 0 && c.pace.budget > 0.9 * MOST && c.pace.scale_q16 > 0.94 * 65536);
    CHECK(c.changes <= 30);
}

/* ---- Single rules ------------------------------------------------------------------------------------------------ */

/* Hands in the same time, as a share of a frame. Returns the number of changes. */
static int hand_in(fxs_pace *p, double share, int frames, uint32_t drawn)
{
    int changes = 0;
    for (int i = 0; i < frames; i++)
        changes += fxs_pace_step(p, (uint64_t)(share * FRAME), drawn, p->number) == 1;
    return changes;
}

static fxs_pace settled(void)
{
    course c;
    begin(&c);
    c.pace.budget = MOST / 2;
    hand_in(&c.pace, 0.8, 200, 0);
    return c.pace;
}

static void one_slow_frame_changes_nothing(void)
{
    fxs_pace p = settled();
    CHECK(hand_in(&p, 10, 1, 0) == 0 && hand_in(&p, 0.8, 40, 0) == 0);
    CHECK(hand_in(&p, 1.3, 2, 0) == 1 && p.reason == FXS_PACE_LATE);
}

static void a_slower_mean_is_answered_at_once(void)
{
    fxs_pace p = settled();
    const uint32_t before = p.budget;
    int changes = 0;
    for (int i = 0; i < 100; i++) {
        changes += hand_in(&p, 0.9 * p.budget / before, 1, 0);
        CHECK(changes == 0 || p.reason == FXS_PACE_SLOWER);
    }
    CHECK(changes >= 1 && changes <= 3 && p.budget < before * 0.95 && p.budget > before * 0.85);
}

static void a_rising_mean_is_answered_before_its_limit(void)
{
    fxs_pace p = settled();
    int changes = 0;
    for (int i = 0; i < 600 && !changes; i++)
        changes = hand_in(&p, 0.8 + i * 0.0002, 1, 0);
    CHECK(changes && p.reason == FXS_PACE_SLOWER);
    CHECK(p.slow_q16 < 0.83 * 65536);
}

static void slow_frames_of_another_cause_leave_a_third(void)
{
    fxs_pace p = settled();
    for (int i = 0; i < 10000; i++)
        hand_in(&p, i % 10 == 0 ? 1.5 : 0.4 * p.budget / MOST, 1, 0);
    CHECK(p.budget > MOST / 20 && p.reason != FXS_PACE_LEAST);
}

static void what_may_not_move_stays(void)
{
    fxs_pace p;
    fxs_pace_init(&p);
    CHECK(hand_in(&p, 20, 100, 0) == 0 && p.reason == FXS_PACE_LEAST);
    CHECK(p.budget == 0 && p.scale_q16 == 65536 && p.rates == 0);
    p.budget_most = MOST;
    hand_in(&p, 20, 300, 0);
    CHECK(p.budget == 1 && p.scale_q16 == 65536 && p.rates == 0);
    fxs_pace_init(&p);
    p.scale_least_q16 = 16384;
    hand_in(&p, 20, 100, 0);
    CHECK(p.budget == 0 && p.scale_q16 == 16384 && p.rates == 0);
}

static void the_periphery_goes_first_and_comes_back_last(void)
{
    course c;
    begin(&c);
    c.pace.rates_most = 2;
    hand_in(&c.pace, 0.9, 2, 0);
    CHECK(c.pace.rates == 1 && c.pace.budget == MOST && c.pace.scale_q16 == 65536);
    hand_in(&c.pace, 1.5, 10, 0);
    CHECK(c.pace.rates == 2 && c.pace.budget < MOST && c.pace.scale_q16 < 65536);
    while (c.pace.budget < MOST || c.pace.scale_q16 < 65536) {
        CHECK(c.pace.rates == 2);
        hand_in(&c.pace, 0.5, 1, 0);
    }
    hand_in(&c.pace, 0.7, 3000, 0);                         /* without a level 0.93 of a frame: not yet */
    CHECK(c.pace.rates == 2);
    hand_in(&c.pace, 0.5, 3000, 0);
    CHECK(c.pace.rates == 0);
}

static void the_budget_follows_what_is_drawn(void)
{
    course c;
    begin(&c);
    c.pace.scale_least_q16 = 65536;
    hand_in(&c.pace, 1.2, 2, 300000);
    CHECK(c.pace.budget < 300000);
    const uint32_t before = c.pace.budget;
    hand_in(&c.pace, 0.3, 3000, before / 2);
    CHECK(c.pace.budget == before);
    hand_in(&c.pace, 0.3, 3000, before);
    CHECK(c.pace.budget > before);
}

static void times_of_earlier_choices_are_ignored(void)
{
    fxs_pace p = settled();
    const uint32_t number = p.number;
    CHECK(hand_in(&p, 1.3, 2, 0) == 1 && p.number == number + 1);
    for (int i = 0; i < 100; i++)
        CHECK(fxs_pace_step(&p, (uint64_t)(1.3 * FRAME), 0, number) == 0);
}

static void implausible_times_are_ignored(void)
{
    fxs_pace p = settled();
    const fxs_pace before = p;
    for (int i = 0; i < 100; i++) {
        CHECK(fxs_pace_step(&p, 0, 0, p.number) == 0);
        CHECK(fxs_pace_step(&p, (uint64_t)-1000, 0, p.number) == 0);    /* as of a clock that went back */
    }
    CHECK(!memcmp(&p, &before, sizeof p));
    hand_in(&p, 1e4, 1000, 0);
    CHECK(p.budget == MOST / 20 && p.scale_q16 == 65536 / 3 && p.reason == FXS_PACE_LEAST);
    for (int i = 0; i < 100000; i++)
        fxs_pace_step(&p, 1, UINT32_MAX, p.number);
    CHECK(p.budget == MOST && p.scale_q16 == 65536);
}

static void wrong_limits_are_errors(void)
{
    fxs_pace p;
    fxs_pace_init(&p);
    const struct { uint32_t *field, value; } wrong[] = {
        {&p.frame_nanoseconds, 99999}, {&p.frame_nanoseconds, 2000000001}, {&p.budget_least, 1},
        {&p.scale_least_q16, 1023}, {&p.scale_least_q16, 65537}, {&p.rates_most, 3},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const uint32_t right = *wrong[i].field;
        *wrong[i].field = wrong[i].value;
        CHECK(fxs_pace_step(&p, 1, 1, 0) == FXS_ERR_ARGUMENT);
        *wrong[i].field = right;
    }
    CHECK(fxs_pace_step(&p, 1, 1, 0) == 0);
    p.size--;
    CHECK(fxs_pace_step(&p, 1, 1, 0) == FXS_ERR_STRUCT);
    CHECK(fxs_pace_step(0, 1, 1, 0) == FXS_ERR_ARGUMENT);
}

/* Limits, choices and times at random: the choice stays within the limits, and is the same on every machine. */
static void any_numbers(void)
{
    course c;
    uint32_t hash = 2166136261u;
    begin(&c);
    fxs_pace *p = &c.pace;
    for (uint32_t i = 0; i < 300000; i++) {
        const uint32_t a = (uint32_t)(random_of(&c) * 16777216), b = (uint32_t)(random_of(&c) * 16777216);
        if (i % 1000 == 0) {
            p->frame_nanoseconds = i % 7000 ? 100000 + 119 * a : 2000000000;
            p->budget_most = b % 3 ? b << 8 : UINT32_MAX;
            p->budget_least = p->budget_most >> a % 32;
            p->scale_least_q16 = 1024 + a % 64513;
            p->rates_most = a % 3;
            p->budget = a << 8;
            p->scale_q16 = b << 8;
            p->rates = b;
        }
        fxs_pace_step(p, (uint64_t)p->frame_nanoseconds * (a % 160) >> i / 100 % 10, b % 5 ? 0 : a,
                      p->number - (b % 9 == 0));
        CHECK(p->budget >= p->budget_least && p->budget <= p->budget_most && p->rates <= p->rates_most);
        CHECK(p->scale_q16 >= p->scale_least_q16 && p->scale_q16 <= 65536);
        CHECK(strcmp(fxs_pace_why(p->reason), "unknown"));
        hash = ((hash ^ p->budget) * 16777619u ^ p->scale_q16) * 16777619u ^ p->rates ^ (uint32_t)p->reason << 8;
    }
    if (!CHECK(hash == 0x97233ab3u))
        printf("  %08x\n", hash);
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc && named(argv[i]); i++)
        print_course(named(argv[i]));
    if (argc > 1)
        return 0;
    RUN(at_most_one_frame_in_a_thousand_is_missed);
    RUN(the_choice_is_steady);
    RUN(a_slow_device_is_well_used);
    RUN(a_fast_device_keeps_full_quality);
    RUN(throttling_costs_no_frame_and_quality_comes_back);
    RUN(one_slow_frame_changes_nothing);
    RUN(a_slower_mean_is_answered_at_once);
    RUN(a_rising_mean_is_answered_before_its_limit);
    RUN(slow_frames_of_another_cause_leave_a_third);
    RUN(what_may_not_move_stays);
    RUN(the_periphery_goes_first_and_comes_back_last);
    RUN(the_budget_follows_what_is_drawn);
    RUN(times_of_earlier_choices_are_ignored);
    RUN(implausible_times_are_ignored);
    RUN(wrong_limits_are_errors);
    RUN(any_numbers);
    return check_report();
}
