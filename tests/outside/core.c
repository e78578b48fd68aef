/* core PACKED: draws a packed scene with the core library (the renderer alone). */
#include "picture.h"

#include <fixsplat/internal/packed.h>

int main(int argc, char **argv)
{
    static unsigned char file[1 << 20];
    FILE *in = argc == 2 ? fopen(argv[1], "rb") : 0;
    if (!in)
        return 1;
    const size_t bytes = fread(file, 1, sizeof file, in);
    void *data = aligned(bytes);
    fclose(in);
    if (!data)
        return 1;
    memcpy(data, file, bytes);

    fxs_scene scene;
    return fxs_scene_open(&scene, data, bytes) || picture(&scene);
}
