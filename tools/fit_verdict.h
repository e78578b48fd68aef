/* What the figures at the end of a fit say, in words. */
#ifndef FIT_VERDICT_H
#define FIT_VERDICT_H

#include "quality.h"

/* Prints a sentence on how good the scene is, and another on what would help where that can be told. `fitted`: the mean
   PSNR of photographs that were fitted, dB, where those that were measured were held out; else 0. */
void verdict_print(const quality *measured, double fitted);

#endif
