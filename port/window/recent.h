/* List of recently opened scenes. The file `recent` in the user's state folder has one path per line. */
#ifndef FXS_RECENT_H
#define FXS_RECENT_H

#include <fixsplat/internal/message.h>

enum { FXS_RECENT_MOST = 10 };

/* Absolute paths of recently opened scenes, latest first. All zeros: an empty list. */
typedef struct fxs_recent {
    char *paths[FXS_RECENT_MOST];
    int count;
} fxs_recent;

/* Reads the list of recent scenes, without scenes that no longer exist. An unreadable file gives an empty list. */
void fxs_recent_read(fxs_recent *recent);
void fxs_recent_free(fxs_recent *recent);

int fxs_recent_add(const char *path, fxs_message *message);

#endif
