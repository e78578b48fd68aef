/* Caches gzip-compressed copies of served files. A file is compressed at its first request, and again when its ETag
   changes. */
#ifndef FXS_HTTP_GZIP_H
#define FXS_HTTP_GZIP_H

#include <microhttpd.h>
#include <stddef.h>

enum { FXS_HTTP_TAG = 72 };

typedef struct fxs_http_gzipped fxs_http_gzipped;

#ifdef FXS_WITH_ZLIB
enum { FXS_HTTP_HAS_GZIP = 1 };
#else
enum { FXS_HTTP_HAS_GZIP = 0 };
#endif

/* Returns an HTTP response with the compressed file, or null on failure. The cache owns the response. *is_new = 1: the
   response has no headers yet. */
struct MHD_Response *fxs_http_gzip(fxs_http_gzipped **list, const char *name, const char *tag, int descriptor,
                                   size_t size, int *is_new);
void fxs_http_gzip_free(fxs_http_gzipped *list);

#endif
