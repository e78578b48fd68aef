/* Weights of Gaussians: how much of the picture they cover. */
#ifndef FXS_WEIGHT_H
#define FXS_WEIGHT_H

#include <fixsplat/pack.h>

/* The weight of a Gaussian: opacity times area, where the area is the product of its two largest sigmas, each clamped
   to e^-20..e^20; NaN and infinity count as e^-20. */
double fxs_weight(const fxs_gaussian *gaussian);

/* Returns the dropped share of the Gaussians' total weight, 0 to 1. */
double fxs_dropped_share(const fxs_pack_dropped *dropped);

#endif
