/* The list of recently opened scenes, kept in the user's file `recent` (fxs_state_path), a path a line. Where there is
   no folder for it, no list is kept. */
#ifndef FXS_RECENT_H
#define FXS_RECENT_H

#include <fixsplat/message.h>

enum { FXS_RECENT_MOST = 10 };

/* Whole paths, the latest first. All 0: none. */
typedef struct fxs_recent {
    char *paths[FXS_RECENT_MOST];
    int count;
} fxs_recent;

/* Lists the scenes that still exist; fxs_recent_free frees the list. It is empty where the file cannot be read. */
void fxs_recent_read(fxs_recent *recent);
void fxs_recent_free(fxs_recent *recent);

/* Adds a scene at the beginning. Returns 0, or an error and a message where the list cannot be written. */
int fxs_recent_add(const char *path, fxs_message *message);

#endif
