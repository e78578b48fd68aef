/* Opens a writer of scene files by the name of the format. */
#ifndef SCENE_WRITER_H
#define SCENE_WRITER_H

#include <fixsplat/scene.h>

static inline int open_writer(const char *format, const char *path, uint64_t count, int sh_degree, int antialiased,
                              fxs_scene_writer **writer, fxs_message *message)
{
    const fxs_scene_write_options options = {.size = sizeof(fxs_scene_write_options), .count = count,
                                             .sh_degree = sh_degree, .antialiased = antialiased,
                                             .format = format};
    return fxs_scene_writer_open(path, &options, writer, message);
}

static inline int open_spz(const char *path, int version, uint64_t count, int sh_degree, int antialiased,
                           fxs_scene_writer **writer, fxs_message *message)
{
    const fxs_scene_write_options options = {.size = sizeof(fxs_scene_write_options), .count = count,
                                             .sh_degree = sh_degree, .antialiased = antialiased,
                                             .spz_version = version, .spz_fine = 1, .format = "spz"};
    return fxs_scene_writer_open(path, &options, writer, message);
}

static inline int close_writer(fxs_scene_writer *writer, fxs_message *message)
{
    return fxs_scene_writer_close(writer, NULL, NULL, message);
}

#endif
