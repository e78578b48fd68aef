#include "panorama.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* bytes of a .jpg before its first table: the markers SOI and APP0 */
enum { HEAD = 20 };

/* Writes the APP1 segment of an XMP packet with the properties of GPano, and returns its size. */
static size_t make_segment(uint8_t segment[1024], int width, int height)
{
    static const char name[] = "http://ns.adobe.com/xap/1.0/";
    char *packet = (char *)segment + 4 + sizeof name;
    memcpy(segment + 4, name, sizeof name);
    const int size = sprintf(packet,
        "<?xpacket begin=\"\xef\xbb\xbf\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?><x:xmpmeta xmlns:x=\"adobe:ns:meta/\">"
        "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" "
        "xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\" GPano:ProjectionType=\"equirectangular\" "
        "GPano:UsePanoramaViewer=\"True\" GPano:FullPanoWidthPixels=\"%d\" GPano:FullPanoHeightPixels=\"%d\" "
        "GPano:CroppedAreaImageWidthPixels=\"%d\" GPano:CroppedAreaImageHeightPixels=\"%d\" "
        "GPano:CroppedAreaLeftPixels=\"0\" GPano:CroppedAreaTopPixels=\"0\"/></rdf:RDF></x:xmpmeta>"
        "<?xpacket end=\"r\"?>", width, height, width, height);
    const size_t length = 2 + sizeof name + (size_t)size;
    memcpy(segment, (uint8_t[]){0xff, 0xe1, (uint8_t)(length >> 8), (uint8_t)length}, 4);
    return 2 + length;
}

int fxs_panorama_mark(fxs_encoded *jpg, int width, int height)
{
    uint8_t segment[1024];
    const size_t size = make_segment(segment, width, height), wanted = jpg->size + size;
    uint8_t *bytes = wanted > jpg->room ? realloc(jpg->memory, wanted) : jpg->memory;
    if (!bytes)
        return FXS_ERR_MEMORY;
    jpg->room = wanted > jpg->room ? wanted : jpg->room;
    memmove(bytes + HEAD + size, bytes + HEAD, jpg->size - HEAD);
    memcpy(bytes + HEAD, segment, size);
    jpg->bytes = jpg->memory = bytes;
    jpg->size = wanted;
    return 0;
}
