/* Finds the cameras of photographs, or of a film, by programs that are there for it: ffmpeg takes frames out of a film,
   COLMAP (or GLOMAP) does structure from motion. */
#ifndef RECONSTRUCT_H
#define RECONSTRUCT_H

#include <stdint.h>

typedef struct reconstruct_options {
    const char *in;                /* a film, or a folder of photographs */
    const char *out;               /* of the command: all that is made lies in the folder OUT.cameras */
    uint32_t frames;               /* of a film; 0: as many as seem right */
    uint32_t threads;
    int skip_bad;                  /* photographs that cannot be read are left out */
    const char *masks;             /* a folder of masks, or empty: none; null: IN/masks, where there is one */
    int invert_masks;              /* they are white where a photograph is ignored */
} reconstruct_options;

/* Whether at a path is a film, or a folder without cameras. */
int reconstruct_is_needed(const char *in);

/* Whether there are photographs in a folder, or in its folder images. */
int reconstruct_is_photographs(const char *folder);

/* Makes OUT.cameras, as COLMAP lays out what it makes (images, masks, sparse/0), and says what was found. What an earlier call
   left there of the same photographs is gone on from, or is the answer. Returns 0 and the folder's name, which the caller
   frees, or prints what is wrong and returns the exit status. */
int reconstruct(const reconstruct_options *options, char **folder);

#endif
