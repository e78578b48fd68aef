/* The front door: opens a scene file of any format and renders it by any back end. docs/library.md has a program.
 *
 * Functions return 0, or an FXS_ERR_* and a message; `message` must not be null. Another null pointer is
 * FXS_ERR_ARGUMENT, unless its function takes it. An open scene is only read, so several threads may render it. One
 * thread at a time uses a renderer; a renderer that draws by OpenGL is only used by the thread that made it.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_RENDERER_H
#define FXS_RENDERER_H

#include "backends.h"
#include "camera.h"
#include "image_file.h"
#include "pack.h"
#include "pager.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* An open scene. The library allocates it, and later versions may add fields at its end. */
typedef struct fxs_opened {
    const fxs_scene *scene;            /* for fxs_object_init */
    const fxs_scene_file_info *info;   /* the file's format, count and SH degree */
    const fxs_pack_report *report;     /* counts and bounds; losses too, unless the file is an .fxs */
    const void *data;                  /* the packed scene, `bytes` long: of an .fxs file its own bytes. Where it was */
    size_t bytes;                      /* packed here, its checksums are 0 until fxs_file_write or fxs_file_seal. Of one
                                          that is read in part, its header (packed.h) */
    fxs_pager *pager;                  /* of one that is read in part; else null */
} fxs_opened;

/* All fields 0: the finest level, profile default, a thread for each processor, no progress, memory from malloc. A file
   that is packed reports two passes: file.progress as it is opened (some formats), then `progress` as it is packed. */
typedef struct fxs_open_options {
    fxs_scene_file_options file;       /* how the file is read */
    enum fxs_profile profile;          /* how it is packed, unless it is an .fxs */
    uint32_t threads;                  /* 1 to 64; 0: one for each processor */
    int check_all;                     /* 1: every chunk of an .fxs is checked, which reads all of it; 0: its header */
    fxs_progress_fn *progress;         /* of packing; may be null */
    void *progress_argument;
    /* Called before the file is packed, for example to filter or decimate it; it updates *info. Returns 0, or an error
       and a message, which fxs_open then returns. May be null. */
    int (*prepare)(void *argument, fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message);
    void *prepare_argument;
    int tree;                          /* 1: packed with levels of detail, as fxs_pack_options has it */
    const fxs_pager_options *pager;    /* not null: the file, an .fxs with levels of detail, is read in part (pager.h):
                                          frames want by fxs_pager_want, and fxs_pager_turn comes between them */
} fxs_open_options;

/* Opens a scene file, or a folder with one, as fxs_scene_file_open does. An .fxs file is mapped and rendered from the
   mapping, and a damaged chunk is drawn as it is, safely (check_all refuses it). Where others may cut the file short,
   call fxs_map_guard (map.h) once before. Any other file is packed. `options` may be null; an .fxs file heeds of them
   max_gaussians, check_all, the allocator and the pager. With a pager the path may be an address of a server.
   fxs_close frees *opened, which is null after an error.
   Errors: those of fxs_scene_file_open, fxs_pack and fxs_file_check; FXS_ERR_ARGUMENT for more than 64 threads. */
FXS_API int fxs_open(const char *path, const fxs_open_options *options, fxs_opened **opened, fxs_message *message);

/* The same for a file of `bytes` bytes in memory. An .fxs file must stay there unchanged until fxs_close; where it is
   not aligned to 64, it is copied instead. Messages begin with `name`. */
FXS_API int fxs_open_memory(const char *name, const void *data, size_t bytes, const fxs_open_options *options,
                            fxs_opened **opened, fxs_message *message);

/* The same for an open stream of Gaussians (gaussian.h), which are packed. The stream is closed, also on an error. */
FXS_API int fxs_open_gaussians(const char *name, fxs_scene_file *file, const fxs_scene_file_info *info,
                               const fxs_open_options *options, fxs_opened **opened, fxs_message *message);

/* Checks, after a frame, that the scene's file is unchanged: another program may write to a mapped file or cut it short
   (map.h). Returns 0, or FXS_ERR_FILE and a message where it did. */
FXS_API int fxs_opened_check(const fxs_opened *opened, fxs_message *message);

/* Chooses the first view of objects that come without cameras: renders small pictures from many sides and from within,
   and takes the one that shows most of them, upright. Returns in `up`, of length 1, which way is up. low..high: the box
   of what is seen of the objects (of one scene the inner bounds of its report). The direction is the same on every machine, whatever
   `fov` (vertical, degrees) and the size of the view are. It takes some 0.2 s. Errors: those of fxs_view_look_at,
   FXS_ERR_SIZE, FXS_ERR_SCENE, FXS_ERR_OBJECT, FXS_ERR_MEMORY. */
FXS_API int fxs_first_view(const fxs_object *objects, uint32_t count, const double low[3], const double high[3],
                           double fov, int32_t width, int32_t height, fxs_file_view *view, double up[3],
                           fxs_message *message);

/* The same where it is known what is up: `up` of any length; all 0: it is found. */
FXS_API int fxs_first_view_upright(const fxs_object *objects, uint32_t count, const double low[3], const double high[3],
                                   const double up[3], double fov, int32_t width, int32_t height, fxs_file_view *view,
                                   fxs_message *message);

/* Makes a camera of the start view of an .fxs (camera.h) where it has one, else of that view for the scene alone, with
   a field of view of 50 degrees, by what the file says is up; one that is read in part is framed whole instead. Errors:
   those of fxs_first_view, FXS_ERR_CAMERA. */
FXS_API int fxs_opened_camera(const fxs_opened *opened, int32_t width, int32_t height, fxs_camera *camera,
                              fxs_message *message);

/* Frees the scene; null is allowed. Renderers must forget it first (fxs_renderer_forget). */
FXS_API void fxs_close(fxs_opened *opened);

/* ---- Renderers --------------------------------------------------------------------------------------------------- */

typedef struct fxs_renderer fxs_renderer;

/* Makes a renderer with the back end of that name (backends.h); null means "auto". `options` may be null.
   fxs_renderer_destroy frees *renderer, which is null after an error. Errors: FXS_ERR_ARGUMENT (the name, or a number
   of the options), FXS_ERR_DEVICE, FXS_ERR_UNSUPPORTED, FXS_ERR_MEMORY. */
FXS_API int fxs_renderer_create(const char *backend, const fxs_backend_options *options, fxs_renderer **renderer,
                                fxs_message *message);

/* Renders a request into its targets, which are in the processor's memory, and returns when they are written. `stats`
   may be null. Errors are those of fxs_render. */
FXS_API int fxs_renderer_render(fxs_renderer *renderer, const fxs_request *request, fxs_stats *stats,
                                fxs_message *message);

/* Finds the Gaussian that the first eye of a request shows at pixel (x, y), as fxs_pick does. Returns 1, 0 where there
   is none, or an error and a message. Where the back end cannot pick, the processor does it. */
FXS_API int fxs_renderer_pick(fxs_renderer *renderer, const fxs_request *request, int32_t x, int32_t y,
                              fxs_pick_result *result, fxs_message *message);

/* Drops the device's copy of a scene; a null renderer has none. To be called before the scene is closed or its bytes
   change. */
FXS_API void fxs_renderer_forget(fxs_renderer *renderer, const fxs_scene *scene);

/* The renderer's back end (null: of none); its field `can` says what it supports. */
FXS_API const fxs_backend *fxs_renderer_backend(const fxs_renderer *renderer);

/* Frees the renderer; null is allowed. */
FXS_API void fxs_renderer_destroy(fxs_renderer *renderer);

#ifdef __cplusplus
}
#endif

#endif
