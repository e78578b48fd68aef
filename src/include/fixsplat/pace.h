/* A clock that holds a frame rate. From the measured times of frames it chooses the budget of Gaussians, the size of
 * the picture, and the share of the picture's periphery that is drawn with fewer samples.
 *
 * The choice is a pure function of the numbers handed in: the clock reads no time and allocates nothing. One thread at
 * a time may use an fxs_pace. A program calls fxs_pace_init, sets the limits, calls fxs_pace_step with a time of 0 for
 * the first choice, draws with this choice, and calls fxs_pace_step with the time of each drawn frame.
 *
 * The clock lowers the quality before frames are late: if the mean of the last 32 times, or its trend, exceeds 85 % of
 * a frame, or if two of the last 32 times exceed 95 %. One slow frame changes nothing. The clock raises the quality in
 * steps of 1/48, as far as the slowest view of the last 6 to 12 seconds allows. Until the first good choice, the steps
 * are larger. The periphery loses samples first and regains them last; budget and pixels change by the same factor. */
#ifndef FXS_PACE_H
#define FXS_PACE_H

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Why the clock made its last choice. */
enum fxs_pace_reason {
    FXS_PACE_START,                /* the first choice; no frame has changed it */
    FXS_PACE_LATE,                 /* lower quality: two recent frames were late or nearly late */
    FXS_PACE_SLOWER,               /* lower quality: frames take too long on average, or soon will */
    FXS_PACE_LEAST,                /* frames take too long, but the limits allow no lower quality */
    FXS_PACE_FASTER                /* higher quality: the slowest recent frames left time */
};

typedef struct fxs_pace {
    uint32_t size;

    /* Limits. The program sets them after fxs_pace_init, and may change them between two steps. */
    uint32_t frame_nanoseconds;    /* time of a frame, 10^9 / (frames a second): 100,000 to 2 * 10^9; default: 60 frames
                                      a second */
    uint32_t budget_least, budget_most;   /* range of the budget, Gaussians; most 0 (default): no budget is chosen */
    uint32_t scale_least_q16;      /* smallest width and height of the picture, as a share of the full width and height:
                                      1024 (a 64th) to 65536; 65536 (default): the size is kept */
    uint32_t rates_most;           /* highest level of rates, 0 to 2; 0 (default): full rate */

    /* The choice. The program may change it between two steps; a budget of 0 stands for budget_most. */
    uint32_t budget;               /* for fxs_options.budget; 0 if no budget is chosen */
    uint32_t scale_q16;            /* picture's width / full width, equal to the ratio of the heights */
    uint32_t rates;                /* level of rates: how much of the periphery is drawn with one sample for 2x2 or 4x4
                                      pixels; 0: nothing */
    uint32_t number;               /* number of the choice: rises by 1 with each change */
    enum fxs_pace_reason reason;

    /* State of the clock, in units of frame_nanoseconds where it ends in _q16. */
    uint32_t settled, quiet, count;
    uint32_t slow_q16, peaks_q16[2], recent_q16[32];
    uint64_t elapsed;
} fxs_pace;

/* Initialises a clock with the default limits. */
FXS_EXPERIMENTAL void fxs_pace_init(fxs_pace *pace, uint32_t size);
#define fxs_pace_init(pace) fxs_pace_init(pace, (uint32_t)sizeof *(pace))

/* Takes the time of a frame and makes a choice. `nanoseconds`: time that the device took for the frame; 0 or more than
   2^40: unknown. `drawn`: Gaussians drawn (fxs_stats.drawn); 0: unknown. `number`: pace->number when the frame was
   requested; times of earlier choices are ignored, so times may arrive several frames late.
   Returns 1 if the choice has changed, 0 if not, or an error: FXS_ERR_ARGUMENT for limits out of range or a null
   pointer, FXS_ERR_STRUCT. */
FXS_EXPERIMENTAL int fxs_pace_step(fxs_pace *pace, uint64_t nanoseconds, uint32_t drawn, uint32_t number);

/* Returns the reason as a short text, such as "lowered: frames were late". The string is static and never null. */
FXS_EXPERIMENTAL const char *fxs_pace_why(enum fxs_pace_reason reason);

#ifdef __cplusplus
}
#endif

#endif
