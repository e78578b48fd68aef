/* Edits by hand of the viewer, for option --edits of convert. */
#ifndef HAND_EDITS_H
#define HAND_EDITS_H

#include "load_scene.h"

/* Does the edits of a file on a scene, packed as the viewer packs it. *deleted receives a byte for each of the *count
   Gaussians of the scene's file, not 0 if an edit deletes the Gaussian; the caller frees it. */
int edits_find(const char *edits, const char *scene, const load_options *load, uint8_t **deleted,
               uint64_t *count);

#endif
