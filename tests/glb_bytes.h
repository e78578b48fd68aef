/* Makes .glb files for fuzzing. */
#ifndef GLB_BYTES_H
#define GLB_BYTES_H

#include "spz_bytes.h"

/* Makes a .glb with a valid container, of size + 26 bytes at most. Two bytes of the input give the size of the JSON. The
   JSON and the binary chunk follow. */
static inline size_t make_glb(const uint8_t *data, size_t size, uint8_t *out)
{
    size_t json = size < 2 ? 0 : data[0] | (size_t)data[1] << 8, left = size < 2 ? 0 : size - 2;
    json = json < left ? json : left;
    uint8_t *to = spz_put(spz_put(spz_put(out, 0x46546c67, 4), 2, 4), 28 + left, 4);
    to = spz_put(spz_put(to, json, 4), 0x4e4f534a, 4);
    if (left)
        memcpy(to, data + 2, json);
    to = spz_put(spz_put(to + json, left - json, 4), 0x004e4942, 4);
    if (left)
        memcpy(to, data + 2 + json, left - json);
    return 28 + left;
}

#endif
