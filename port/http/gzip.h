/* Files of a page by gzip, each compressed when it is first asked for, and kept as an answer. */
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

/* The answer to a file's name and ETag, without headers where *is_new; the list owns it. Returns null where memory ran
   out or the file cannot be read. */
struct MHD_Response *fxs_http_gzip(fxs_http_gzipped **list, const char *name, const char *tag, int descriptor,
                                   size_t size, int *is_new);
void fxs_http_gzip_free(fxs_http_gzipped *list);

#endif
