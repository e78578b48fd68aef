/* Prepares a folder of photographs for COLMAP. */
#ifndef PHOTO_FOLDER_H
#define PHOTO_FOLDER_H

#include "src/fit/photos/photo_masks.h"
#include "tools/command/task.h"

typedef struct photographs {
    char **names;                  /* file names in ascending order */
    size_t *lenses;                /* number of the lens of each photograph; null before photographs_look */
    size_t count, room, lens_count;
    size_t looked_at;              /* number of photographs, from the first, that photographs_look has read */
    struct photo_lens *table;      /* sizes and EXIF of the lenses */
    int has_exif;                  /* 1: EXIF of a photograph names its camera, so the set is not of film frames */
} photographs;

/* Lists the photographs of a folder. Returns 0 if memory runs out. */
int photographs_list(photographs *p, const char *folder);
void photographs_free(photographs *p);

/* Adds to the list those photographs of a folder that come after its last one. Returns 0 if memory runs out. */
int photographs_list_more(photographs *p, const char *folder);

/* Makes `to` a link to the folder `from`. If `from` has HEIF photographs, or folders cannot be linked, makes a folder
   of links to photographs instead. HEIF photographs are converted to NAME.heic.jpg. A failed conversion is an error, or
   only a printed note with skip_bad. */
int photo_folder_make(task *t, const photographs *p, const char *from, const char *to, uint32_t threads, int skip_bad);

/* Finds the mask file of a photograph as fxs_photo_mask_in does. A converted NAME.heic.jpg may also use the mask of
   NAME.heic. Returns 1 if found, else 0. */
int photograph_mask(const char *masks, const char *name, char path[FXS_PHOTO_PATH]);

typedef struct photograph_look {
    const char *masks;
    int masks_are_inverse, skip_bad;
    int is_quiet;                  /* 1: shows no progress */
} photograph_look;

/* Reads each photograph that it has not read yet, and its mask, finds damaged files, and groups the photographs by size
   and lens. */
int photographs_look(task *t, photographs *p, const char *folder, const photograph_look *how);

#endif
