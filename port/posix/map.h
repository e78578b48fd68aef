/* A file as read-only memory. */
#ifndef FXS_MAP_H
#define FXS_MAP_H

#include <stddef.h>

#include "../formats/message.h"

/* Maps a regular file of at least 1 byte. Returns 0, or -1 and a message. */
int fxs_map(const char *path, void **data, size_t *bytes, fxs_message *message);

void fxs_unmap(void *data, size_t bytes);

#endif
