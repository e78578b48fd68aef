/* The list of recently opened scenes, stored in the file `recent` of the user's state folder (fxs_state_path), one path
   a line. Without such a folder, no list is kept. */
#ifndef FXS_RECENT_H
#define FXS_RECENT_H

#include <fixsplat/internal/message.h>

enum { FXS_RECENT_MOST = 10 };

/* Absolute paths, latest first. All 0: an empty list. */
typedef struct fxs_recent {
    char *paths[FXS_RECENT_MOST];
    int count;
} fxs_recent;

/* Reads the list and drops scenes that no longer exist; free it with fxs_recent_free. Empty if the file cannot be
   read. */
void fxs_recent_read(fxs_recent *recent);
void fxs_recent_free(fxs_recent *recent);

/* Adds a scene at the front. Returns 0, or an error and a message if the list cannot be written. */
int fxs_recent_add(const char *path, fxs_message *message);

#endif
