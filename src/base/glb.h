/* The frame of a .glb: a JSON chunk and a chunk of binary data (glTF 2.0, section 4.4). */
#ifndef FXS_GLB_H
#define FXS_GLB_H

#include <stdint.h>
#include <stdio.h>

#include <fixsplat/internal/packed.h>

enum { FXS_GLB_FRAME = 28 };           /* bytes of a .glb without JSON and data */

/* Pads the JSON with spaces to a multiple of 4 bytes. */
static inline void fxs_glb_pad(FILE *json)
{
    while (ftell(json) % 4)
        fputc(' ', json);
}

/* Writes the headers and the padded JSON. `bytes` bytes of data follow, a multiple of 4. Errors show when the file is
   closed. */
static inline void fxs_glb_begin(FILE *file, const char *json, size_t length, uint32_t bytes)
{
    uint32_t head[5] = {0x46546c67, 2, FXS_GLB_FRAME + (uint32_t)length + bytes, (uint32_t)length, 0x4e4f534a};
    uint32_t next[2] = {bytes, 0x004e4942};
    fxs_little_endian(head, 0, 5, 4);
    fxs_little_endian(next, 0, 2, 4);
    fwrite(head, 1, sizeof head, file);
    fwrite(json, 1, length, file);
    fwrite(next, 1, sizeof next, file);
}

#endif
