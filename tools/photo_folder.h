/* A folder of photographs as COLMAP can read them. */
#ifndef PHOTO_FOLDER_H
#define PHOTO_FOLDER_H

#include "src/fit/photo_masks.h"
#include "task.h"

typedef struct photographs {
    char **names;                  /* sorted */
    size_t *lenses;                /* by photograph, the number of its size and lens, in the order of their first; null
                                      before photographs_look */
    size_t count, room, lens_count;
} photographs;

/* Lists what the fit reads. Returns 0 where memory ran out. */
int photographs_list(photographs *p, const char *folder);
void photographs_free(photographs *p);

/* Makes `to` a link to the folder `from`; or where it has photographs of HEIF, or the system has no links to folders, a
   folder with links to the others and each of these as a .jpg, NAME.heic.jpg, which is made once. One that cannot be
   converted is an error, or with skip_bad named. Returns 0, or prints what is wrong and returns the exit status. */
int photo_folder_make(task *t, const photographs *p, const char *from, const char *to, uint32_t threads, int skip_bad);

/* Finds the mask of a photograph of such a folder, as fxs_photo_mask_in; that of NAME.heic may have been made for
   NAME.heic.jpg. Returns whether there is one. */
int photograph_mask(const char *masks, const char *name, char path[FXS_PHOTO_PATH]);

typedef struct photograph_look {
    const char *masks;             /* their folder, or empty */
    int masks_are_inverse, skip_bad;
} photograph_look;

/* Reads each photograph and its mask, to find those that are damaged and which are of one size and lens. Returns as
   above. */
int photographs_look(task *t, photographs *p, const char *folder, const photograph_look *how);

#endif
