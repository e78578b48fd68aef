/* Reads the motion of Gaussians in a .ply: Spacetime Gaussians' lite model, SuperSplat 4D's, and FTGS of version 1. */
#ifndef FXS_PLY_MOTION_H
#define FXS_PLY_MOTION_H

#include "ply_header.h"

enum { FXS_PLY_TIMES = 15 };

typedef struct fxs_ply_motion {
    int moves;                       /* 0: the scene is still, and the other fields are unset */
    int is_colour;                   /* 1: f_dc_* are colours, not SH coefficients */
    int columns[FXS_PLY_TIMES];      /* indices of the properties that say how a Gaussian moves; -1: none */
    double start, unit;              /* seconds: the scene begins at `start`, and times in the file are in `unit` */
    double least_fade, fade_unit;    /* a fade is the number in the file, at least `least_fade`, times `fade_unit` */
    fxs_time time;
} fxs_ply_motion;

/* Finds the properties of motion of an element. Returns 0, or an error and a message. *motion must be zeroed. */
int fxs_ply_find_motion(fxs_ply_motion *motion, const fxs_ply_header *header, const fxs_ply_element *element,
                        const char *path, fxs_message *message);

/* Converts the numbers of the properties in `columns` (0 where there is none) to a motion. */
void fxs_ply_motion_of(const fxs_ply_motion *motion, const float numbers[FXS_PLY_TIMES], fxs_motion *out);

#endif
