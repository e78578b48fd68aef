/* The scenes that were open last, kept in $XDG_STATE_HOME/fixsplat/recent, or ~/.local/state/fixsplat/recent, a path a
   line; nowhere without either. */
#ifndef FXS_RECENT_H
#define FXS_RECENT_H

#include <fixsplat/message.h>

enum { FXS_RECENT_MOST = 10 };

/* Whole paths, the latest first. All 0: none. */
typedef struct fxs_recent {
    char *paths[FXS_RECENT_MOST];
    int count;
} fxs_recent;

/* Those that are still there, to be freed by fxs_recent_free. What cannot be read is none. */
void fxs_recent_read(fxs_recent *recent);
void fxs_recent_free(fxs_recent *recent);

/* Puts a scene before the others. Returns 0, or an error and a message where they cannot be kept. */
int fxs_recent_add(const char *path, fxs_message *message);

#endif
