/* Converts scenes to a file of another format. */
#ifndef CMD_CONVERT_H
#define CMD_CONVERT_H

#include "load_world.h"

/* Writes all scenes of a world (placed scenes) to one file, in the format of its ending. No input may be an .fxs file
   or `out`. In messages, `name` stands for the inputs. */
int convert_merged(const char *out, int spz_version, int spz_fine, const fxs_world *placed, const char *name,
                   const load_options *load);

#endif
