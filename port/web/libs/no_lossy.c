/* Stubs for libwebp's functions that decode lossy pictures. The reader of .sog files refuses lossy pictures. */
#include "src/dec/vp8_dec.h"
#include "src/dec/webpi_dec.h"

int VP8GetInfo(const uint8_t *data, size_t size, size_t chunk, int *width, int *height)
{
    (void)data, (void)size, (void)chunk, (void)width, (void)height;
    return 0;
}

int VP8InitIoInternal(VP8Io *io, int version)
{
    (void)version;
    memset(io, 0, sizeof *io);
    return 1;
}

void WebPInitCustomIo(WebPDecParams *params, VP8Io *io)
{
    io->opaque = params;             /* libwebp's lossless decoder reads its output buffer from `opaque` */
}

VP8Decoder *VP8New(void)
{
    return NULL;
}

int VP8GetHeaders(VP8Decoder *decoder, VP8Io *io)
{
    (void)decoder, (void)io;
    return 0;
}

int VP8Decode(VP8Decoder *decoder, VP8Io *io)
{
    (void)decoder, (void)io;
    return 0;
}

void VP8Delete(VP8Decoder *decoder)
{
    (void)decoder;
}

int VP8GetThreadMethod(const WebPDecoderOptions *options, const WebPHeaderStructure *headers, int width, int height)
{
    (void)options, (void)headers, (void)width, (void)height;
    return 0;
}

void VP8InitDithering(const WebPDecoderOptions *options, VP8Decoder *decoder)
{
    (void)options, (void)decoder;
}
