/* Caches gzip answers for files of a page. Each file is compressed at its first request and again when its ETag
   changes. */
#ifndef FXS_HTTP_GZIP_H
#define FXS_HTTP_GZIP_H

#include <microhttpd.h>
#include <stddef.h>

enum { FXS_HTTP_TAG = 72 };   /* room for an ETag */

typedef struct fxs_http_gzipped fxs_http_gzipped;   /* a list of answers */

#ifdef FXS_WITH_ZLIB
enum { FXS_HTTP_HAS_GZIP = 1 };
#else
enum { FXS_HTTP_HAS_GZIP = 0 };
#endif

/* Returns the answer for a file's name and ETag; the list owns it. *is_new: 1 if the answer has no headers yet. Returns
   null if memory ran out or the file cannot be read. */
struct MHD_Response *fxs_http_gzip(fxs_http_gzipped **list, const char *name, const char *tag, int descriptor,
                                   size_t size, int *is_new);
void fxs_http_gzip_free(fxs_http_gzipped *list);

#endif
