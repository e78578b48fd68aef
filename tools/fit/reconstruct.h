/* Finds the cameras of photographs or of a film with external programs: ffmpeg extracts the frames, COLMAP (or
   GLOMAP) does structure from motion. */
#ifndef RECONSTRUCT_H
#define RECONSTRUCT_H

#include <stdint.h>

typedef struct reconstruct_options {
    const char *in;                /* a film, or a folder of photographs */
    const char *out;               /* output of the fit; everything made here goes to the folder OUT.cameras */
    uint32_t frames;               /* frames to take of a film; 0: chosen by the program */
    uint32_t threads;
    int skip_bad;                  /* leaves out unreadable photographs */
    const char *masks;             /* folder of masks; empty: none; null: IN/masks if it exists */
    int invert_masks;              /* masks are white where a photograph is ignored */
} reconstruct_options;

/* True if the path is a film, or a folder without cameras. */
int reconstruct_is_needed(const char *in);

/* True if the folder, or its subfolder images, contains photographs. */
int reconstruct_is_photographs(const char *folder);

/* Makes OUT.cameras in COLMAP's layout (images, masks, sparse/0), and prints a report. An unfinished OUT.cameras of
   the same photographs is continued; a finished one is used. Returns 0 and the folder's name, which the caller
   frees; or prints the error and returns the exit status. */
int reconstruct(const reconstruct_options *options, char **folder);

#endif
