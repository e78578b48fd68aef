/* The front door: opens a scene file of any format, and renders it by any back end. docs/c.md has a program.
 *
 * Stable: from version 1.0 on, a program that uses this header goes on compiling and linking with every 1.x.
 *
 * Functions return 0, or an FXS_ERR_* and a message. A scene that is open is only read, so several threads may render
 * it; a renderer is used by one thread at a time, and one that draws by OpenGL by the thread that made it. */
#ifndef FXS_RENDERER_H
#define FXS_RENDERER_H

#include "backends.h"
#include "camera.h"
#include "image_file.h"
#include "pack.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* A scene that is open to be rendered. The library allocates it, and later versions may add fields at its end. */
typedef struct fxs_opened {
    const fxs_scene *scene;            /* what fxs_object_init takes */
    const fxs_scene_file_info *info;   /* of the file: its format, count, SH degree */
    const fxs_pack_report *report;     /* counts and bounds; of a file that was packed here, losses too */
    const void *data;                  /* the packed scene: the bytes of an .fxs file, but for their checksums where */
    size_t bytes;                      /* it was packed here (fxs_file_write and fxs_file_seal fill them in) */
} fxs_opened;

/* All 0: the finest level, profile default, a thread for each processor, no progress, malloc. */
typedef struct fxs_open_options {
    fxs_scene_file_options file;       /* how a file is read that is to be packed */
    enum fxs_profile profile;          /* and packed */
    uint32_t threads;                  /* 1 to 64; 0: one for each processor */
    fxs_progress_fn *progress;         /* of packing; may be null */
    void *progress_argument;
    /* Called with the file before it is packed, to filter or decimate it, say; it fills in *info anew. Returns 0, or an
       error and a message, which fxs_open returns. May be null. */
    int (*prepare)(void *argument, fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message);
    void *prepare_argument;
} fxs_open_options;

/* Opens a scene file, or a folder of one, as fxs_scene_file_open. An .fxs file is mapped and rendered as it lies; any
   other is packed. `options` may be null. *opened is for fxs_close, and null after an error. Errors: those of
   fxs_scene_file_open, fxs_pack and fxs_file_check; FXS_ERR_ARGUMENT where there are more than 64 threads. */
int fxs_open(const char *path, const fxs_open_options *options, fxs_opened **opened, fxs_message *message);

/* The same for the `bytes` bytes of a file in memory. Those of an .fxs file stay as they are until fxs_close; where they
   are not aligned to 64, they are copied. `name` begins messages. */
int fxs_open_memory(const char *name, const void *data, size_t bytes, const fxs_open_options *options,
                    fxs_opened **opened, fxs_message *message);

/* The same for Gaussians that are open as a stream (gaussian.h), which are packed, and closed whatever comes of it. */
int fxs_open_gaussians(const char *name, fxs_scene_file *file, const fxs_scene_file_info *info,
                       const fxs_open_options *options, fxs_opened **opened, fxs_message *message);

/* Whether the scene still is what was opened, to be asked after a frame: another program may write to a mapped file, or
   cut it short (map.h). Returns 0, or FXS_ERR_FILE and a message. */
int fxs_opened_check(const fxs_opened *opened, fxs_message *message);

/* A camera that shows what is seen of the scene: y down, 50 degrees from top to bottom. */
int fxs_opened_camera(const fxs_opened *opened, int32_t width, int32_t height, fxs_camera *camera,
                      fxs_message *message);

/* Null is allowed. Renderers forget the scene first (fxs_renderer_forget). */
void fxs_close(fxs_opened *opened);

/* ---- Renderers --------------------------------------------------------------------------------------------------- */

typedef struct fxs_renderer fxs_renderer;

/* A renderer by the back end of that name (backends.h), null: "auto". `options` may be null. *renderer is for
   fxs_renderer_destroy, and null after an error. Errors: FXS_ERR_ARGUMENT (the name, a number of the options),
   FXS_ERR_DEVICE, FXS_ERR_UNSUPPORTED, FXS_ERR_MEMORY. */
int fxs_renderer_create(const char *backend, const fxs_backend_options *options, fxs_renderer **renderer,
                        fxs_message *message);

/* Renders a request into its targets, which are in the processor's memory, and returns when they are written. *stats
   may be null. Errors as fxs_render. */
int fxs_renderer_render(fxs_renderer *renderer, const fxs_request *request, fxs_stats *stats, fxs_message *message);

/* Finds out what the first eye of a request shows at pixel (x, y), as fxs_pick: 1, 0 where there is nothing, or an
   error and a message. Where the back end cannot, the processor does. */
int fxs_renderer_pick(fxs_renderer *renderer, const fxs_request *request, int32_t x, int32_t y,
                      fxs_pick_result *result, fxs_message *message);

/* Before a scene is closed or its bytes change: what a device keeps of it is dropped. */
void fxs_renderer_forget(fxs_renderer *renderer, const fxs_scene *scene);

/* The back end, to ask what it can do. */
const fxs_backend *fxs_renderer_backend(const fxs_renderer *renderer);

/* Null is allowed. */
void fxs_renderer_destroy(fxs_renderer *renderer);

#ifdef __cplusplus
}
#endif

#endif
