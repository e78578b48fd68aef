/* all SCENE PACKED: reads a scene file, packs and draws it, and writes the packed scene. */
#include "picture.h"

#include <fixsplat/image_file.h>
#include <fixsplat/pack.h>
#include <fixsplat/pool.h>

int main(int argc, char **argv)
{
    fxs_message message;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_scene scene;
    if (argc != 3 || fxs_scene_file_open(argv[1], 0, &file, &info, &message))
        return 1;
    if (fxs_pack(file, &info, &packed, &report, 0, &message) || fxs_scene_open(&scene, packed.data, packed.bytes))
        return 1;
    fxs_scene_file_close(file);
    FILE *out = fopen(argv[2], "wb");
    if (!out || fwrite(packed.data, packed.bytes, 1, out) != 1 || fclose(out) || picture(&scene))
        return 1;
    fxs_packed_scene_free(&packed);
    fxs_pool_destroy(fxs_pool_create(2));
    return fxs_image_file_known("picture.png") != 1;
}
