/* Interface of the readers and writers of scene formats. Functions return 0, or an error and a message. */
#ifndef FXS_FORMATS_INTERNAL_H
#define FXS_FORMATS_INTERNAL_H

#include <fixsplat/scene.h>

#include "src/gaussian/stream_internal.h"

typedef struct fxs_writer {
    size_t size;          /* size of the writer's state in bytes */
    /* Begins a file. `data` is the writer's state, zeroed by the caller. After an error, do not call `close`. */
    int (*open)(void *data, const char *path, const fxs_scene_write_options *options, fxs_message *message);
    int (*put)(void *data, const fxs_gaussian *gaussians, size_t n, fxs_message *message);
    /* Completes the file, adds what this format loses to the report, and frees memory, also after an error. */
    int (*close)(void *data, fxs_scene_write_report *report, const fxs_progress *progress,
                 fxs_message *message);
    /* As `put`, for Gaussians of a moving scene; null if the format does not keep motion. */
    int (*put_moving)(void *data, const fxs_gaussian *gaussians, const fxs_motion *motions, size_t n,
                      fxs_message *message);
} fxs_writer;

typedef struct fxs_format_row {
    fxs_scene_format about;
    const fxs_reader *reader;   /* reader of the format; null: the format cannot be read */
    const fxs_writer *writer;   /* writer of the format; null: the format cannot be written */
} fxs_format_row;

int fxs_format_by_content(const fxs_scene_source *source, const fxs_format_row **format, fxs_message *message);

/* Returns the output format called `name`. If `name` is null, the ending of `path` decides. Returns null for an unknown
   format. */
const fxs_format_row *fxs_format_to_write(const char *name, const char *path);

/* Returns the name of the index file of a scene that fills a whole folder, such as tileset.json. number: 0 for the
   first name. Returns null after the last name. The name ends at a space or a zero. */
const char *fxs_format_index_name(int number);

extern const fxs_reader fxs_read_fxs, fxs_read_compressed_ply, fxs_read_ply, fxs_read_ksplat, fxs_read_spz,
                        fxs_read_rad, fxs_read_tileset, fxs_read_gltf, fxs_read_lcc, fxs_read_lcc2, fxs_read_tsog,
                        fxs_read_sog, fxs_read_gsplat, fxs_read_splat, fxs_read_splatv, fxs_read_splat4d,
                        fxs_read_fourdgs, fxs_read_numbered;
extern const fxs_writer fxs_write_compressed_ply, fxs_write_ply, fxs_write_spz, fxs_write_rad, fxs_write_glb,
                        fxs_write_sog, fxs_write_streamed_sog,
                        fxs_write_splat, fxs_write_splat4d, fxs_write_csv;

#endif
