/* The options of `fixsplat fit`, and the parts that fit what they say. */
#ifndef CMD_FIT_H
#define CMD_FIT_H

#include <fixsplat/blocks.h>
#include "fit_progress.h"

typedef struct fit_command {
    frame_options frame;            /* background, cut-off, SH degree, profile, threads, instruction sets */
    fxs_photos_options reading;
    fxs_fit_options options;
    const char *in, *out, *resume, *coarse, *measure, *compare, *cameras, *log_name;
    fit_log *log;
    char *found;                    /* OUT.cameras, where they were found */
    uint32_t frames;
    int quality;                    /* in by_quality, where it is given */
    int cameras_only, crops;
    char *saved;                    /* OUT.fit */
    int saves_itself;               /* it is the file of --resume */
    uint32_t block, blocks;         /* blocks 0: all */
    uint64_t save_every, metrics_every;   /* 0: never */
    int preview;
    uint64_t port;                  /* of the preview */
    const fit_watcher *watcher;     /* of it; or null */
    int json;
    char **argv;                    /* of the command, for the one that goes on */
} fit_command;

extern const char *const fit_recipes[];    /* the names of enum fxs_fit_recipe */

/* All but the last return 0, or print what is wrong and return the exit status. */

/* Finds the cameras where there are none yet, reads the photographs, and fits a scene to them, or to those of a block;
   or measures a scene by them. */
int fit_photos(fit_command *c);

/* Makes the steps from where the fit is to the last one, with all that is shown, saved and measured on the way. After
   a signal the fit is saved, and the program ends by it. Fills in *progress. */
int fit_make_steps(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, fit_progress *progress);

/* Saves the fit in OUT.fit, and prints why and the command that goes on from there. */
int fit_save_for_later(const fit_command *c, fxs_fit *fit, const char *why);

/* Writes the scene, measures it and prints the result. `block` or null; a scene that cannot be written is saved for
   later. */
int fit_end(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
            const fit_progress *progress);

/* Writes what the coarse fit has outside of all blocks as it is, and prints that. */
int fit_write_outside(const fit_command *c, const fxs_fit_block *block);

/* Prints what --measure has measured. */
void fit_print_measured(const fit_command *c, const fxs_photos *photos, const world *scene, const quality *q);

#endif
