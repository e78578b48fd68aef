#include "gzip.h"

#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"

struct fxs_http_gzipped {
    fxs_http_gzipped *next;
    char *name;
    char tag[FXS_HTTP_TAG];
    struct MHD_Response *response;
};

#ifdef FXS_WITH_ZLIB
#include <zlib.h>

static size_t compress_all(unsigned char *out, size_t room, const unsigned char *in, size_t size)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        return 0;
    stream.next_in = (Bytef *)(uintptr_t)in;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    const int ended = deflate(&stream, Z_FINISH);
    deflateEnd(&stream);
    return ended == Z_STREAM_END ? stream.total_out : 0;
}

static struct MHD_Response *compress_file(int descriptor, size_t size)
{
    const size_t room = compressBound((uLong)size) + 32;
    unsigned char *in = malloc(size), *out = malloc(room);
    size_t bytes = 0;
    struct MHD_Response *response = NULL;
    if (in && out && !fxs_descriptor_read(descriptor, in, size))
        bytes = compress_all(out, room, in, size);
    free(in);
    if (bytes)
        response = MHD_create_response_from_buffer(bytes, out, MHD_RESPMEM_MUST_FREE);
    if (!response)
        free(out);
    return response;
}
#else
static struct MHD_Response *compress_file(int descriptor, size_t size)
{
    (void)descriptor;
    (void)size;
    return NULL;
}
#endif

static fxs_http_gzipped *place_of(fxs_http_gzipped **list, const char *name)
{
    fxs_http_gzipped *place = *list;
    while (place && strcmp(place->name, name))
        place = place->next;
    if (place || !(place = calloc(1, sizeof *place)))
        return place;
    place->name = strdup(name);
    if (!place->name) {
        free(place);
        return NULL;
    }
    place->next = *list;
    return *list = place;
}

struct MHD_Response *fxs_http_gzip(fxs_http_gzipped **list, const char *name, const char *tag, int descriptor,
                                   size_t size, int *is_new)
{
    fxs_http_gzipped *place = place_of(list, name);
    *is_new = place && (!place->response || strcmp(place->tag, tag));
    if (!*is_new)
        return place ? place->response : NULL;
    if (place->response)
        MHD_destroy_response(place->response);   /* libmicrohttpd keeps the old response until it has been sent */
    place->response = compress_file(descriptor, size);
    strcpy(place->tag, tag);
    return place->response;
}

void fxs_http_gzip_free(fxs_http_gzipped *list)
{
    while (list) {
        fxs_http_gzipped *next = list->next;
        if (list->response)
            MHD_destroy_response(list->response);
        free(list->name);
        free(list);
        list = next;
    }
}
