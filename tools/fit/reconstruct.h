/* Finds the cameras of photographs or of a film by structure from motion, with ffmpeg and COLMAP or GLOMAP. */
#ifndef RECONSTRUCT_H
#define RECONSTRUCT_H

#include <stddef.h>
#include <stdint.h>

enum fit_quality { QUALITY_DRAFT, QUALITY_GOOD, QUALITY_BEST };

typedef struct reconstruct_options {
    const char *in;
    const char *out;               /* output of the fit; cameras go to the folder OUT.cameras */
    uint32_t frames;               /* number of frames to take of a film; 0: automatic */
    uint32_t threads;
    int quality;                   /* enum fit_quality */
    int skip_bad;
    const char *masks;             /* folder of masks; empty: no masks; null: folder IN/masks if it exists */
    int invert_masks;              /* 1: white pixels of a mask are ignored, not black ones */
    int mixed;                     /* 1: photographs of several devices: a lens for each, and all pairs are matched */
} reconstruct_options;

typedef struct reconstruction {
    char *folder;                  /* the folder OUT.cameras; the caller frees it */
    size_t placed, unplaced;       /* numbers of photographs with a camera, and without one */
} reconstruction;

/* The cameras of photographs that arrive one after the other. */
typedef struct reconstruct_work reconstruct_work;

/* True if cameras must be reconstructed: the input is a film, or a folder without cameras. */
int reconstruct_is_needed(const char *in);

/* True if the folder, or its subfolder named images, has photographs. */
int reconstruct_is_photographs(const char *folder);

/* Makes the folder OUT.cameras in COLMAP's layout (images, masks, sparse/0). An unfinished OUT.cameras of the same
   photographs is continued; a finished one is used. */
int reconstruct(const reconstruct_options *options, reconstruction *found);

/* Makes the folder OUT.cameras. The caller then writes photographs into its subfolder images; sorted by name, they are
   in the order of arrival. reconstruct_close ends the work. Returns 0, or an exit status after a printed error. */
int reconstruct_open(const reconstruct_options *options, reconstruct_work **r);
void reconstruct_close(reconstruct_work *r);

/* Returns the path of OUT.cameras. */
const char *reconstruct_folder(const reconstruct_work *r);

/* True if OUT.cameras has cameras, in sparse/0. */
int reconstruct_has_cameras(const reconstruct_work *r);

/* Finds the cameras of the photographs that have arrived since the last call, and tries again those without a place.
   Cameras that were found before stay, byte for byte, and so do the numbers of 3D points that are kept; new points have
   larger ones. Returns 0, RECONSTRUCT_LATER if it needs more photographs, or an exit status after a printed error. */
enum { RECONSTRUCT_LATER = -1 };
int reconstruct_place(reconstruct_work *r);

#endif
