/* A procedural scene, written as .ply, read and packed as a user would. */
#ifndef PROCEDURAL_SCENE_H
#define PROCEDURAL_SCENE_H

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "../port/formats/pack.h"
#include "../port/formats/ply_write.h"
#include "../tools/procedural.h"

/* *report may be null. Returns 0, or -1 and why not; *packed is for fxs_packed_scene_free. */
static inline int procedural_scene_make(const char *name, uint64_t count, int antialiased, fxs_packed_scene *packed,
                                        fxs_pack_report *report, fxs_message *m)
{
    char path[64];
    fxs_ply_writer *writer;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report unused;
    const fxs_procedural_scene *scene = fxs_procedural_find(name);
    snprintf(path, sizeof path, "/tmp/fixsplat-scene-%ld.ply", (long)getpid());
    if (!scene || fxs_ply_writer_open(path, count, scene->sh_degree, antialiased, &writer, m))
        return -1;
    for (uint64_t i = 0; i < count; i++) {
        fxs_gaussian gaussian;
        scene->gaussian(i, count, 1, &gaussian);
        if (fxs_ply_writer_put(writer, &gaussian, 1, m))
            break;
    }
    if (fxs_ply_writer_close(writer, m) || fxs_scene_file_open(path, NULL, &file, &info, m))
        return -1;
    int result = fxs_pack(file, &info, packed, report ? report : &unused, 0, m);
    fxs_scene_file_close(file);
    unlink(path);
    return result;
}

#endif
