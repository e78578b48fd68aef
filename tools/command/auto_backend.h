/* The choice of --backend auto: the fastest back end of a trial that is kept in the user's cache folder. */
#ifndef AUTO_BACKEND_H
#define AUTO_BACKEND_H

#include "frame_options.h"
#include "trial.h"

/* Up to this many pixels, opening a GPU takes longer than the processor takes to draw them: auto takes the processor,
   and no trial is made. 18 pictures of 1280x720. */
enum { AUTO_PIXELS = 1 << 24 };

/* Replaces "auto" in the options by the back end for a command that draws `pictures` of the options' size. Takes the
   processor for few pixels, and with --cpu, --threads or --max-memory, which are about the processor. */
void settle_backend(frame_options *options, double pictures);

/* Gets the kept trial of this machine, or makes one and keeps it. is_anew: 1 makes one in any case. Returns 0, or an
   error if it cannot be kept; *t is valid then too. */
int trial_get(trial *t, int is_anew, fxs_message *why);

/* Writes the model of this machine's processor, or "unknown". */
void name_processor(char name[128]);

#endif
