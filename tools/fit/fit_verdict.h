/* Prints at the end of `fixsplat fit` how the scene came out, its faults, and the next commands. */
#ifndef FIT_VERDICT_H
#define FIT_VERDICT_H

#include "cmd_fit.h"

typedef struct fit_verdict {
    const fit_command *c;
    uint32_t steps;                 /* number of steps made; 0: the scene moves, and has no findings */
    int is_corrected;               /* 1: exposures were fitted, so PSNR is that after the best affine map of colours */
    int is_known;                   /* 0: masks ignore all pixels of the measured photographs */
    int has_held_out;
    double psnr, affine_psnr;       /* means of the measured photographs, dB */
    double fitted;                  /* mean PSNR of fitted photographs, dB; 0: not measured */
    const quality_view *worst;      /* photograph that is far worse than the others; null: none */
    double worst_psnr;              /* its PSNR in dB */
    const char *worst_why;
    int has_subject;
    fxs_fit_subject subject;
} fit_verdict;

/* Judges a finished fit by its measured quality, and measures fitted photographs too. `photos` have the fit's poses.
   The arguments must outlive *v. */
int fit_verdict_find(fit_verdict *v, const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, world *scene,
                     const quality *measured);

/* Judges a scene that moves by its mean PSNR in dB. */
fit_verdict fit_verdict_of_moving(const fit_command *c, double psnr, int has_held_out);

/* Prints at most six lines: a verdict, findings and commands. */
void fit_verdict_print_text(const fit_verdict *v);

/* Prints members of a JSON object: verdict, a word or null, and advice, an array of the findings' names. */
void fit_verdict_print_json(const fit_verdict *v);

#endif
