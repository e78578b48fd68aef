/* Stubs for unused functions of libzip and cJSON: compression, encryption, writing. */
#include "zipint.h"

#include <zlib.h>

int deflateInit2_(z_stream *stream, int level, int method, int bits, int memory, int strategy, const char *version,
                  int size)
{
    (void)stream, (void)level, (void)method, (void)bits, (void)memory, (void)strategy, (void)version, (void)size;
    return Z_STREAM_ERROR;
}

int deflate(z_stream *stream, int flush)
{
    (void)stream, (void)flush;
    return Z_STREAM_ERROR;
}

int deflateEnd(z_stream *stream)
{
    (void)stream;
    return Z_STREAM_ERROR;
}

zip_encryption_implementation _zip_get_encryption_implementation(zip_uint16_t method, int operation)
{
    (void)method, (void)operation;
    return NULL;
}

/* Returns time 0, since the module has no clock. */
time_t time(time_t *now)
{
    return now ? *now = 0 : 0;
}

time_t mktime(struct tm *time)
{
    (void)time;
    return 0;
}

struct tm *localtime(const time_t *time)
{
    static struct tm none;
    (void)time;
    return &none;
}

/* A stub for cJSON, which calls sscanf only when writing. */
int sscanf(const char *text, const char *format, ...)
{
    (void)text, (void)format;
    return 0;
}
