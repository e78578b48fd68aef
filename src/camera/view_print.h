/* Prints a view (camera) as an object of cameras.json. */
#ifndef FXS_VIEW_PRINT_H
#define FXS_VIEW_PRINT_H

#include <stdio.h>

#include <fixsplat/camera.h>

void fxs_view_print(FILE *to, const fxs_view *view);

#endif
