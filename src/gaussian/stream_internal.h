/* A stream of Gaussians: the functions of its reader and the source of its bytes. */
#ifndef FXS_STREAM_INTERNAL_H
#define FXS_STREAM_INTERNAL_H

#include <fixsplat/gaussian.h>

#include "src/base/source_internal.h"

/* The beginning of a file. */
typedef struct fxs_head {
    const fxs_scene_source *source;
    const char *bytes;    /* the first bytes behind a mark of UTF-8, up to 4095, and a 0 */
    size_t size;
    const char *name;     /* the first name in a JSON object, after its opening quotation mark; or NULL */
} fxs_head;

/* A reader of Gaussians: from a scene format, from the program, or from another reader. */
typedef struct fxs_reader {
    /* 1 where a file with this beginning has the reader's format, else 0, or an error and a message. Null: never. */
    int (*is)(const fxs_head *head, fxs_message *message);
    size_t size;          /* bytes of the reader's own data */
    /* Gets data that are all 0 and a source that outlives them. Returns 0 and fills in *info, or an error and a
       message. It need not set the format, the number of levels where that is 1, and the stored SH degree where that is
       the SH degree. `close` is called in either case. */
    int (*open)(void *data, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message);
    long (*read)(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);
    int (*rewind)(void *data, fxs_message *message);
    void (*close)(void *data);   /* frees the reader's memory; NULL: it has none */
} fxs_reader;

struct fxs_scene_file {
    fxs_scene_source source;
    const fxs_reader *reader;
    void *data;                  /* the reader's own, or NULL */
    fxs_import import;
};

/* Allocates a stream without a reader. Returns NULL, and a message for FXS_ERR_MEMORY, where memory ran out. */
fxs_scene_file *fxs_stream_create(const char *path, const fxs_scene_file_options *options, fxs_message *message);

/* Lets the reader of a format open the stream's source. Returns 0, or an error and a message; the stream must be closed
   in either case. */
int fxs_stream_begin(fxs_scene_file *file, const char *format, const fxs_reader *reader, fxs_scene_file_info *info,
                     fxs_message *message);

/* Reads the next Gaussians of a reader, as fxs_scene_file_read does. An infinite logit becomes FXS_OPAQUE; minus
   infinity stays, and fxs_drawable leaves the Gaussian out. */
long fxs_stream_read(const fxs_reader *reader, void *data, fxs_gaussian *gaussians, size_t capacity,
                     fxs_message *message);

/* Exchanges the reader and the reader's data of an open stream for others, which may read from the old ones. The
   stream's origin is fixed from then on. */
void fxs_stream_swap(fxs_scene_file *file, const fxs_reader **reader, void **data);

/* The allocator of the stream's reader. */
const fxs_allocator *fxs_stream_allocator(const fxs_scene_file *file);

#endif
