#include "fit_verdict.h"

#include <math.h>
#include <stdio.h>

/* By the mean PSNR, dB, of photographs that were held out. */
static const struct {
    double least;
    const char *words;
} verdicts[] = {
    {30, "Very good: from new places it is hard to tell from a photograph"},
    {25, "Good: from new places it looks like a photograph with less detail"},
    {20, "Fair: from new places all is there, but blurred or spotted"},
    {-INFINITY, "Poor: from new places it does not look like the photographs"}
};

/* dB: beyond these differences the reason is worth a sentence. */
enum { OVERFITTED = 5, EXPOSED = 2 };

static const char *words_for(double psnr)
{
    int i = 0;
    while (psnr < verdicts[i].least)
        i++;
    return verdicts[i].words;
}

void verdict_print(const quality *measured, double fitted)
{
    char psnr[32], other[32];
    fxs_metrics_psnr(psnr, measured->psnr, "any");
    if (fitted > 0)
        printf("%s (%.4s dB; %.4s where it was fitted).\n", words_for(measured->psnr), psnr,
               fxs_metrics_psnr(other, fitted, "any"));
    else
        printf("Nothing was held out, so how it looks from new places is not known (%.4s dB where it was fitted).\n",
               psnr);
    if (measured->affine_psnr - measured->psnr > EXPOSED)
        puts("The photographs differ in exposure or white balance: --exposure gain may help.");
    else if (measured->psnr < verdicts[0].least && fitted - measured->psnr > OVERFITTED)
        puts("Places between the photographs are much worse than theirs: more photographs would help.");
    else if (measured->psnr < verdicts[1].least && fitted > 0)
        puts("Where it was fitted it is not much better: more --steps or sharper photographs would help.");
}
