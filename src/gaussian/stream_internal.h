/* A stream of Gaussians: a reader and its source of bytes. */
#ifndef FXS_STREAM_INTERNAL_H
#define FXS_STREAM_INTERNAL_H

#include <fixsplat/scene.h>

#include "src/base/source_internal.h"

/* The beginning of a file, for recognising its format. */
typedef struct fxs_head {
    const fxs_scene_source *source;
    const char *bytes;    /* up to 4095 bytes after an optional UTF-8 mark, then a 0 */
    size_t size;
    const char *name;     /* first name in a JSON object, after its opening quote; or NULL */
} fxs_head;

/* A reader of Gaussians: for a file format, the program's callback, or a filter of another reader. */
typedef struct fxs_reader {
    /* Returns 1 if the file has the reader's format, else 0, or an error and a message. Null: never recognised. */
    int (*is)(const fxs_head *head, fxs_message *message);
    size_t size;          /* bytes of the reader's state */
    /* Opens the source, which outlives the state. `data` is the state, all 0. Returns 0 and fills in *info, or an
       error and a message. Need not set: the format; the number of levels if 1; the stored SH degree if equal to the
       SH degree. `close` is called in either case. */
    int (*open)(void *data, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message);
    long (*read)(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);
    int (*rewind)(void *data, fxs_message *message);
    void (*close)(void *data);   /* frees memory of the state; NULL: none */
} fxs_reader;

struct fxs_scene_file {
    fxs_scene_source source;
    const fxs_reader *reader;
    void *data;                  /* the reader's state, or NULL */
    fxs_import import;
};

/* Allocates a stream without a reader. Returns NULL and a message for FXS_ERR_MEMORY if out of memory. */
int fxs_stream_create(fxs_scene_file **made, const char *path, const fxs_scene_file_options *options,
                      fxs_message *message);

/* Opens the stream's source with a reader. Returns 0, or an error and a message; close the stream in either case. */
int fxs_stream_begin(fxs_scene_file *file, const char *format, const fxs_reader *reader, fxs_scene_file_info *info,
                     fxs_message *message);

/* Reads the next Gaussians, as fxs_scene_file_read. +infinity as an opacity logit becomes FXS_OPAQUE. -infinity
   stays; later fxs_drawable drops that Gaussian. */
long fxs_stream_read(const fxs_reader *reader, void *data, fxs_gaussian *gaussians, size_t capacity,
                     fxs_message *message);

/* Swaps the reader and state of an open stream for others, which may read from the old ones. Fixes the stream's
   origin. */
void fxs_stream_swap(fxs_scene_file *file, const fxs_reader **reader, void **data);

/* The allocator for the stream's reader. */
const fxs_allocator *fxs_stream_allocator(const fxs_scene_file *file);

#endif
