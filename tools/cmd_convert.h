/* Writes scenes as a file of another format, for `fixsplat convert` and for the window. */
#ifndef CMD_CONVERT_H
#define CMD_CONVERT_H

#include "load_world.h"

/* Writes the files of a world as one, what load->filter leaves of it, by the ending of `out`. None of them is an .fxs,
   or `out`. `spz_version` and `spz_fine` 0 are the default; `name` is that of the whole, for messages. Returns 0, or
   prints why not and returns EXIT_FAILED; what was at `out` before is there still then. */
int convert_merged(const char *out, int spz_version, int spz_fine, const fxs_world *placed, const char *name,
                   const load_options *load);

#endif
