/* The high-level interface: opens a scene file of any format and renders it with any back end. README.md has an
 * example program.
 *
 * Functions return 0, or an FXS_ERR_* and a message; `message` must not be null. Any other null pointer is
 * FXS_ERR_ARGUMENT, unless the function's comment allows it. An open scene is read-only, so several threads may render
 * it. One thread at a time may use a renderer. A renderer that draws with OpenGL belongs to the thread that made it. */
#ifndef FXS_RENDERER_H
#define FXS_RENDERER_H

#include "backend.h"
#include "camera.h"
#include "image.h"
#include "pack.h"
#include "pager.h"
#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* An open scene. fxs_open and similar functions allocate it; later versions may add fields at its end. */
typedef struct fxs_opened {
    const fxs_scene *scene;            /* for fxs_object_init */
    const fxs_scene_file_info *info;   /* format of the scene's file, number of Gaussians and SH degree */
    const fxs_pack_report *report;     /* report of packing: counts and bounds; losses too, unless the file is an
                                          .fxs */
    /* The packed scene, `bytes` long. For an .fxs file, these are the file's bytes. For other formats, fxs_open packed
       them; their checksums are 0 until fxs_file_write or fxs_file_seal. With a pager, only the header is there
       (internal/packed.h). */
    const void *data;
    size_t bytes;
    fxs_pager *pager;                  /* pager that streams the scene; null if it was opened without one */
} fxs_opened;

/* Options for opening a scene. The defaults: finest level, default profile, one thread per processor, no progress,
   memory from malloc. Opening a file that must be packed reports two passes: file->progress while it is opened (some
   formats), then `progress` while it is packed. */
typedef struct fxs_open_options {
    uint32_t size;
    const fxs_scene_file_options *file;   /* options for reading the file; null: the defaults */
    enum fxs_profile profile;          /* profile (packed format) for packing; without effect on an .fxs */
    uint32_t threads;                  /* number of threads, 1 to 64; 0: one per processor */
    int check_all;                     /* 1: checks every chunk of an .fxs, which reads the whole file; 0: checks only
                                          the header */
    fxs_progress progress;             /* progress callback for packing the file */
    /* Callback before the file is packed, for example to filter or decimate its Gaussians; it updates *info. Returns 0,
       or an error and a message, which fxs_open then returns. May be null. */
    int (*prepare)(void *argument, fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message);
    void *prepare_argument;
    int tree;                          /* 1: packs the scene with a tree of levels of detail, as in fxs_pack_options */
    const fxs_pager_options *pager;    /* not null: streams an .fxs with levels of detail through a pager (pager.h).
                                          Then set options.want to fxs_pager_want and call fxs_pager_turn between
                                          frames */
    const fxs_pager_source *source;    /* not null: fxs_open streams the scene from this source, and the path is only a
                                          name for messages. The source is closed by fxs_close, or after an error */
} fxs_open_options;
FXS_INIT(fxs_open_options)

/* Opens a scene file, or a folder with one, as fxs_scene_file_open does. An .fxs file is mapped and rendered from the
   mapping; a damaged chunk is drawn as it is, which is safe, unless check_all refuses the file. If other programs may
   truncate the file, call fxs_map_guard (system.h) once before fxs_open. Files of other formats are packed. `options`
   may be null; for an .fxs only max_gaussians, check_all, the allocator and the pager apply. With a pager, the path may
   be an http(s) address. fxs_close frees *opened, which is null after an error. Errors: as fxs_scene_file_open,
   fxs_pack and fxs_file_check; FXS_ERR_ARGUMENT for more than 64 threads. */
FXS_API int fxs_open(const char *path, const fxs_open_options *options, fxs_opened **opened, fxs_message *message);

/* Opens a scene file of `bytes` bytes in memory, like fxs_open. An .fxs file aligned to 64 must stay in memory
   unchanged until fxs_close; one that is not aligned is copied. Messages begin with `name`. */
FXS_API int fxs_open_memory(const char *name, const void *data, size_t bytes, const fxs_open_options *options,
                            fxs_opened **opened, fxs_message *message);

/* Opens and packs an open stream of Gaussians (scene.h), like fxs_open. The stream is closed, also after an error. */
FXS_API int fxs_open_gaussians(const char *name, fxs_scene_file *file, const fxs_scene_file_info *info,
                               const fxs_open_options *options, fxs_opened **opened, fxs_message *message);

/* Checks, after a frame, that the scene's file is unchanged, since another program may write to a mapped file or
   truncate it (system.h). Returns 0, or FXS_ERR_FILE and a message if it changed. */
FXS_API int fxs_opened_check(const fxs_opened *opened, fxs_message *message);

/* Chooses a first view of objects without cameras: renders small pictures from many sides and from inside, and takes
   the view that shows most of the objects, upright. box: least and greatest corner of the objects' visible part (for
   one scene the inner bounds of its report). `up`: the up direction, of any length, or all 0 if it is unknown; receives
   the up direction of length 1. The direction of the view is the same on every machine, for any picture. Takes about
   0.2 s. Errors: as fxs_view_look_at, FXS_ERR_SIZE, FXS_ERR_SCENE, FXS_ERR_OBJECT, FXS_ERR_MEMORY. */
FXS_API int fxs_first_view(const fxs_object *objects, uint32_t count, double box[2][3], double up[3],
                           const fxs_picture *picture, fxs_view *view, fxs_message *message);

/* Makes a camera for an open scene: from the start view in its .fxs (camera.h), if it has one. Otherwise it uses
   fxs_first_view on the scene alone, with a field of view of 50 degrees and the file's up direction. A scene with a
   pager but no start view is framed as a whole. Errors: as fxs_first_view, FXS_ERR_CAMERA. */
FXS_API int fxs_opened_camera(const fxs_opened *opened, int32_t width, int32_t height, fxs_camera *camera,
                              fxs_message *message);

/* Chooses a start view for the packed scene of `bytes` bytes at `data`: fxs_first_view of the scene alone, with the
   scene's up direction, for a picture of 16:9. Stores view and up direction in the scene. Call fxs_file_write or
   fxs_file_seal afterwards. Errors: as fxs_first_view. */
FXS_API int fxs_start_choose(void *data, size_t bytes, fxs_message *message);

/* Frees an open scene; null is allowed. First call fxs_renderer_forget for each renderer that has rendered the
   scene. */
FXS_API void fxs_close(fxs_opened *opened);

/* ---- Renderers --------------------------------------------------------------------------------------------------- */

typedef struct fxs_renderer fxs_renderer;

/* Creates a renderer with the back end of the given name (backend.h); null means "auto". `options` may be null.
   fxs_renderer_destroy frees *renderer, which is null after an error: FXS_ERR_ARGUMENT (the name, or an option),
   FXS_ERR_DEVICE, FXS_ERR_UNSUPPORTED, FXS_ERR_MEMORY. */
FXS_API int fxs_renderer_create(const char *backend, const fxs_backend_options *options, fxs_renderer **renderer,
                                fxs_message *message);

/* Renders a request into its targets (output pictures), which are in host memory, and returns when they are written.
   `stats` may be null. Errors: as fxs_render. */
FXS_API int fxs_renderer_render(fxs_renderer *renderer, const fxs_request *request, fxs_stats *stats,
                                fxs_message *message);

/* Finds the Gaussian that the first eye of a request shows at pixel (x, y), as fxs_pick does. Returns 1, 0 if no
   Gaussian contributes, or an error and a message. If the back end cannot pick, the processor does. */
FXS_API int fxs_renderer_pick(fxs_renderer *renderer, const fxs_request *request, int32_t x, int32_t y,
                              fxs_pick_result *result, fxs_message *message);

/* Drops the device's copy of a scene. Call it before the scene is closed or its bytes change. It does nothing for a
   null renderer. */
FXS_API void fxs_renderer_forget(fxs_renderer *renderer, const fxs_scene *scene);

/* Returns the renderer's back end (null for a null renderer). The back end's field `can` lists the supported
   features. */
FXS_API const fxs_backend *fxs_renderer_backend(const fxs_renderer *renderer);

/* Frees the renderer; null is allowed. */
FXS_API void fxs_renderer_destroy(fxs_renderer *renderer);

#ifdef __cplusplus
}
#endif

#endif
