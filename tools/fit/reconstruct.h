/* Finds the cameras of photographs or of a film with external programs. ffmpeg extracts frames of a film. COLMAP or
   GLOMAP computes structure from motion. */
#ifndef RECONSTRUCT_H
#define RECONSTRUCT_H

#include <stdint.h>

typedef struct reconstruct_options {
    const char *in;                /* a film, or a folder of photographs */
    const char *out;               /* output of the fit; this module writes to the folder OUT.cameras */
    uint32_t frames;               /* frames to take of a film; 0: automatic */
    uint32_t threads;
    int skip_bad;                  /* 1: leave out unreadable photographs */
    const char *masks;             /* folder of masks; empty: none; null: IN/masks if it exists */
    int invert_masks;              /* 1: masks are white where a photograph is ignored */
} reconstruct_options;

/* Tests for a film, or a folder without cameras. */
int reconstruct_is_needed(const char *in);

/* Tests for photographs in a folder or in its subfolder images. */
int reconstruct_is_photographs(const char *folder);

/* Makes the folder OUT.cameras in COLMAP's layout (images, masks, sparse/0), and prints a report. An unfinished
   OUT.cameras of the same photographs is continued; a finished one is used. Returns 0, or prints the error and
   returns the exit status. The caller frees *folder. */
int reconstruct(const reconstruct_options *options, char **folder);

#endif
