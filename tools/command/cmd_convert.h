/* Writes scenes as a file of another format, for `fixsplat convert` and the window. */
#ifndef CMD_CONVERT_H
#define CMD_CONVERT_H

#include "load_world.h"

/* Writes the files of a world, filtered by load->filter, as one file in the format of `out`'s ending. No input may
   be an .fxs or `out` itself. spz_version and spz_fine: 0 is the default; `name` stands for the whole in messages.
   Returns 0, or prints the reason and returns EXIT_FAILED, with an earlier file at `out` unchanged. */
int convert_merged(const char *out, int spz_version, int spz_fine, const fxs_world *placed, const char *name,
                   const load_options *load);

#endif
