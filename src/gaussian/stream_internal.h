/* A stream of Gaussians: the functions of its reader, and where its bytes come from. */
#ifndef FXS_STREAM_INTERNAL_H
#define FXS_STREAM_INTERNAL_H

#include <fixsplat/gaussian.h>

#include "src/base/source_internal.h"

/* How a file begins. */
typedef struct fxs_head {
    const fxs_scene_source *source;
    const char *bytes;    /* the first ones, up to 4095, and a 0 behind them */
    size_t size;
    const char *name;     /* the first name of a JSON object, without its quotation mark in front; or NULL */
} fxs_head;

/* What a reader of Gaussians is: of a scene format, of a program's Gaussians, or of another reader's. */
typedef struct fxs_reader {
    /* Whether a file that begins so is of this format: 1 or 0, or an error and a message. Null: no file is. */
    int (*is)(const fxs_head *head, fxs_message *message);
    size_t size;          /* bytes of its own data */
    /* Is given data that are all 0 and a source that outlives them. Returns 0 with *info filled in, but for its format,
       for its levels where there is one, and for its stored SH degree where that is its SH degree; or an error and a
       message. Either way, close is called. */
    int (*open)(void *data, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message);
    long (*read)(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);
    int (*rewind)(void *data, fxs_message *message);
    void (*close)(void *data);   /* frees what the reader holds; NULL: nothing */
} fxs_reader;

struct fxs_scene_file {
    fxs_scene_source source;
    const fxs_reader *reader;
    void *data;                  /* the reader's own, or NULL */
    fxs_import import;
};

/* Allocates a stream without a reader. Returns NULL, and a message for FXS_ERR_MEMORY, where there is no memory. */
fxs_scene_file *fxs_stream_create(const char *path, const fxs_scene_file_options *options, fxs_message *message);

/* Lets the reader of a format open the stream's source. Returns 0, or an error and a message; the stream is to be closed also then. */
int fxs_stream_begin(fxs_scene_file *file, const char *format, const fxs_reader *reader, fxs_scene_file_info *info,
                     fxs_message *message);

/* Swaps the reader of an open stream, and its data, for another whose functions read from it. */
void fxs_stream_swap(fxs_scene_file *file, const fxs_reader **reader, void **data);

/* What readers allocate from. */
const fxs_allocator *fxs_stream_allocator(const fxs_scene_file *file);

#endif
