/* Options and functions of `fixsplat fit`. */
#ifndef CMD_FIT_H
#define CMD_FIT_H

#include "src/fit/blocks.h"
#include "fit_progress.h"
#include "reconstruct.h"

typedef struct fit_watch fit_watch;

typedef struct fit_command {
    frame_options frame;
    fxs_photos_options reading;
    fxs_fit_options options;
    const char *in, *out, *resume, *coarse, *measure, *compare, *cameras, *log_name;
    fit_log *log;
    const char *photographs;        /* PHOTOS as given; `in` becomes the folder of cameras that were found */
    reconstruction found;           /* cameras found by structure from motion; all 0: they were known */
    uint32_t frames;
    int quality, of, photos;        /* of, photos: row of their tables, from 1; 0: not given */
    int cameras_only, crops;
    char *saved;                    /* path of the saved fit, OUT.fit */
    int saves_itself;               /* 1: --resume names OUT.fit, where this fit saves itself */
    uint32_t block, blocks;         /* number of the block to fit, and number of all blocks; 0: no blocks */
    uint64_t save_every, metrics_every;   /* steps between saves, and between measurements; 0: never */
    int preview;
    uint32_t watch_seconds;         /* seconds without a new photograph after which --watch ends; 0: no --watch */
    fit_watch *watch;               /* the watched folder; null: none */
    int moving;
    double fps;                     /* photographs of a camera a second; 0: as the files say, or 30 */
    uint32_t moment_steps;          /* steps of each moment of a moving scene but the first */
    uint32_t refine_steps;          /* steps for each moment that refine all moments together */
    uint64_t port;
    const fit_watcher *watcher;     /* callbacks that show the running fit; null: no preview */
    int json;
} fit_command;

/* Options of a fit, which --measure refuses. */
#define FIT_NOT_MEASURED \
    "output recipe exposure refine-poses antialiased surfaces sky steps batch block coarse max-gaussians seed " \
    "crop-to-subject cameras-only write-cameras save-every metrics-every preview log resume of photos"

/* What --quality sets. */
typedef struct fit_preset {
    enum fxs_fit_recipe recipe;     /* its default is the largest number of Gaussians */
    uint32_t steps;
    int resolution;
} fit_preset;

/* In the order of enum fit_quality. */
extern const fit_preset fit_presets[];
extern const char *const fit_qualities[];

extern const char *const fit_recipes[];

/* Fits a scene to all photographs, or to the photographs of a block (part of the scene). With --measure, measures a
   scene instead. */
int fit_photos(fit_command *c);

/* Fits a scene that moves to photographs of several moments. */
int fit_moving(fit_command *c);

/* Fits a scene to the photographs of a folder as they arrive in it. */
int fit_watched(fit_command *c);

/* Looks for new photographs, between two steps, and adds them to the fit. Until the last one has arrived, repeats a
   part of the recipe, and corrects the number of steps in *progress. Returns 0, or an exit status after a printed
   error. */
int fit_watch_look(fit_watch *watch, fxs_fit *fit, fit_progress *progress);

/* Fits a scene to photographs that were read, and writes and measures it. `block` may be null. */
int fit_make(fit_command *c, const fxs_photos *photos, const fxs_fit_block *block);

/* Opens the fit of the command: a new one, a resumed one, or one of a block, which may be null. */
int fit_open(const fit_command *c, const fxs_photos *photos, const fxs_fit_block *block, fxs_fit **fit);

/* Prints what was read; `begins`: number of Gaussians at the start. */
void fit_say_photos(const fit_command *c, const fxs_photos *photos, size_t begins);

/* Runs the remaining steps of a fit. A signal saves the fit and ends the program. */
int fit_make_steps(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, fit_progress *progress);

/* Writes `fixsplat fit`, PHOTOS `in`, and this command's options except those in the list `left_out`, as words for a
   shell. */
void fit_write_command(FILE *file, const char *in, const char *left_out);

/* Saves the fit in OUT.fit, and prints `why` and the command that resumes the fit. */
int fit_save_for_later(const fit_command *c, fxs_fit *fit, const char *why);

/* Writes the fitted scene, measures it and prints the result. A scene that cannot be written is saved as OUT.fit.
   `block` may be null. */
int fit_end(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
            const fit_progress *progress);

/* Writes the Gaussians of a coarse fit that lie outside of all blocks (parts of the scene). */
int fit_write_outside(const fit_command *c, const fxs_fit_block *block);

void fit_print_measured(const fit_command *c, const fxs_photos *photos, const world *scene, const quality *q);

#endif
