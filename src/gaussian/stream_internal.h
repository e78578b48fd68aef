/* A stream of Gaussians: a reader for one file format, and its source of bytes. */
#ifndef FXS_STREAM_INTERNAL_H
#define FXS_STREAM_INTERNAL_H

#include <fixsplat/scene.h>

#include "src/base/source_internal.h"

typedef struct fxs_head {
    const fxs_scene_source *source;
    const char *bytes;    /* start of the file: up to 4095 bytes after an optional UTF-8 mark, then a 0 */
    size_t size;
    const char *name;     /* first name in a JSON object, after the opening quote; NULL: no JSON object */
} fxs_head;

typedef struct fxs_reader {
    /* Returns 1 if a file has the reader's format, 0 if not, or an error and a message. If this pointer is null, no
       file has the format. */
    int (*is)(const fxs_head *head, fxs_message *message);
    size_t size;
    /* Opens the source, which outlives `data`, the reader's zeroed state. Returns 0 and fills in *info, or an error and
       a message. In *info, these fields may stay unset: the format, a number of levels of 1, and a stored SH degree
       equal to the SH degree. `close` is called in either case. */
    int (*open)(void *data, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message);
    long (*read)(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);
    int (*rewind)(void *data, fxs_message *message);
    void (*close)(void *data);
    /* The motions of the Gaussians that `read` returned last. Null: the reader's scenes are still. */
    const fxs_motion *(*motions)(const void *data);
} fxs_reader;

struct fxs_scene_file {
    fxs_scene_source source;
    const fxs_reader *reader;
    void *data;
    fxs_import import;
};

/* Allocates a stream *made without a reader. Returns 0, or an error and a message with *made = NULL. */
int fxs_stream_create(fxs_scene_file **made, const char *path, const fxs_scene_file_options *options,
                      fxs_message *message);

/* Opens the stream's source with a reader. Returns 0, or an error and a message. Close the stream in either case. */
int fxs_stream_begin(fxs_scene_file *file, const char *format, const fxs_reader *reader, fxs_scene_file_info *info,
                     fxs_message *message);

/* Reads the next Gaussians of a reader. An opacity logit of +infinity becomes FXS_OPAQUE; -infinity stays. */
long fxs_stream_read(const fxs_reader *reader, void *data, fxs_gaussian *gaussians, size_t capacity,
                     fxs_message *message);

enum { FXS_MOTIONS = 256 };    /* most moving Gaussians that a reader which changes others gives at once */

/* The motion of a Gaussian that does not move. */
extern const fxs_motion fxs_still;

/* Exchanges the reader and the state of an open stream. From then on the stream's origin is fixed. The new reader may
   read from the old state. */
void fxs_stream_swap(fxs_scene_file *file, const fxs_reader **reader, void **data);

/* Counts the Gaussians of a stream, from its beginning, and rewinds it. Returns 0, or an error and a message. */
int fxs_stream_count(fxs_scene_file *file, uint64_t *count, fxs_message *message);

/* Returns 0 if a scene is still, else FXS_ERR_UNSUPPORTED and a message that says what is not done with moving ones. */
int fxs_stream_check_still(const fxs_scene_file_info *info, const char *what, fxs_message *message);

const fxs_allocator *fxs_stream_allocator(const fxs_scene_file *file);

#endif
