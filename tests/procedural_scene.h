#include "scene_writer.h"
/* Generates a procedural scene, writes it to a .ply, then reads and packs the .ply. */
#ifndef PROCEDURAL_SCENE_H
#define PROCEDURAL_SCENE_H

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <fixsplat/pack.h>
#include <fixsplat/internal/message.h>
#include "tools/command/procedural.h"

/* Returns 0 and a scene to be freed with fxs_packed_scene_free. Returns -1 on failure. report may be null. */
static inline int procedural_scene_make(const char *name, uint64_t count, int antialiased, fxs_packed_scene *packed,
                                        fxs_pack_report *report, fxs_message *m)
{
    char path[] = "/tmp/fixsplat-scene-XXXXXX";
    fxs_scene_writer *writer;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report unused;
    const fxs_procedural_scene *scene = fxs_procedural_find(name);
    int descriptor = scene ? mkstemp(path) : -1;
    if (descriptor < 0)
        return fxs_fail(m, "%s: no such scene, or no file %s", name, path);
    close(descriptor);
    if (open_writer("ply", path, count, scene->sh_degree, antialiased, &writer, m)) {
        unlink(path);
        return -1;
    }
    for (uint64_t i = 0; i < count; i++) {
        fxs_gaussian gaussian;
        scene->gaussian(i, count, 1, &gaussian);
        if (fxs_scene_writer_put(writer, &gaussian, 1, m))
            break;
    }
    int result = close_writer(writer, m) || fxs_scene_file_open(path, NULL, &file, &info, m) ? -1 : 0;
    if (!result) {
        result = fxs_pack(file, &info, packed, report ? report : &unused, 0, m);
        fxs_scene_file_close(file);
    }
    unlink(path);
    return result;
}

#endif
