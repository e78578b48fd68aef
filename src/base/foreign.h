/* Names the kind of a file that is not of the kind that was expected, for messages. */
#ifndef FXS_FOREIGN_H
#define FXS_FOREIGN_H

#include <stddef.h>

/* Words for the kind of a file by its first bytes, as "a .zip archive"; 512 bytes are enough for every kind. NULL: a
   kind that is not known. */
const char *fxs_foreign(const void *bytes, size_t size);

#endif
