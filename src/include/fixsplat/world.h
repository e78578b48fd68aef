/* Places scene files in a world, in doubles. Rounds the placements to objects of the renderer, or merges the files into
 * one stream of Gaussians.
 * Stable from version 1.0 on. */
#ifndef FXS_WORLD_H
#define FXS_WORLD_H

#include "message.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A box in the file's own units. */
typedef struct fxs_world_crop {
    double low[3], high[3];
    int outside;                   /* 0: keeps the Gaussians inside the box; 1: keeps those outside */
} fxs_world_crop;

/* The placement of a file in the world: world = translation + scale * rotation * position. */
typedef struct fxs_placement {
    uint32_t file;                 /* index in fxs_world.files */
    double translation[3];         /* world units, within +-2^28 */
    double rotation[4];            /* quaternion w, x, y, z, of any length but 0 */
    double scale;                  /* 2^-16 to 2^16 */
    double opacity;                /* factor of opacities, 0 to 1 */
    double tint[3];                /* factors of red, green, blue, 0 to 4 */
    int visible;
    uint32_t id;                   /* 0 to 2^32 - 2 */
    uint32_t crop_count;
    fxs_world_crop crops[FXS_MAX_CROPS];
} fxs_placement;

/* All fields 0: an empty world. */
typedef struct fxs_world {
    char **files;                  /* different paths */
    fxs_placement *objects;
    uint32_t file_count, count, room;
    double up[3];                  /* the direction that is up, of any length; all 0: as the files say */
} fxs_world;

/* Sets a placement that changes nothing: at the origin, visible. */
FXS_API void fxs_placement_init(fxs_placement *placement, uint32_t file, uint32_t id);

/* 1 where a placement changes no Gaussian, whatever its crops, else 0. */
FXS_API int fxs_placement_is_plain(const fxs_placement *placement);

/* The first function sets the rotation of a placement to the shortest one that turns the direction `up`, which is not
   0, to 0, -1, 0. The second turns it further by some degrees about the world's axis x, y or z (0, 1 or 2). */
FXS_API void fxs_placement_turn_up(fxs_placement *placement, const double up[3]);
FXS_API void fxs_placement_turn(fxs_placement *placement, int axis, double degrees);

/* Adds a path, unless the world has it already, and sets *file to its index. The second function adds an object, a copy
   of *placement. Both return 0, or an FXS_ERR_* and a message. */
FXS_API int fxs_world_add_file(fxs_world *world, const char *path, uint32_t *file, fxs_message *message);
FXS_API int fxs_world_add(fxs_world *world, const fxs_placement *placement, fxs_message *message);

/* Reads a world from JSON:
 *
 *     {"objects": [{"file": "a.fxs", "translation": [x, y, z], "rotation": [w, x, y, z], "scale": s, "opacity": o,
 *                   "tint": [r, g, b], "visible": true, "id": n,
 *                   "crops": [{"low": [x, y, z], "high": [x, y, z], "keep": "inside"}]}]}
 *
 * Only "file" is required; its path is relative to the folder of the JSON file, and stays in it. "keep" is "inside" or
 * "outside". The default of "id" is the object's place in the list. Returns 0 and a world that fxs_world_free frees, or
 * an FXS_ERR_* and a message with the object: FXS_ERR_FILE, FXS_ERR_OBJECT, FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED
 * (without cJSON). */
FXS_API int fxs_world_read(fxs_world *world, const char *path, fxs_message *message);

FXS_API void fxs_world_free(fxs_world *world);

/* Checks a placement and rounds it to an object of the renderer. The object's crop_count boxes are written to `crops`.
   Returns 0, or FXS_ERR_OBJECT and a message with the number that is out of range. */
FXS_API int fxs_object_place(fxs_object *object, const fxs_scene *scene, const fxs_placement *placement,
                             fxs_crop *crops, fxs_message *message);

/* The rows of scale * rotation, followed by the translation. fxs_object_place must accept the placement. */
FXS_API void fxs_placement_matrix(const fxs_placement *placement, double rows[3][4]);

/* Turns and moves what a file says of its start, as an object of it is placed. A start view whose camera would be out
   of range is dropped. */
FXS_API void fxs_placement_start(const fxs_placement *placement, fxs_start *start);

/* Finds the box in the world around the part of the file's box that the crops keep. Returns 0 where they keep none. */
FXS_API int fxs_placement_box(const fxs_placement *placement, const double low[3], const double high[3],
                              double world_low[3], double world_high[3]);

/* Applies a placement to all objects of a world, and to what is up in it, as if they were one object. */
FXS_API void fxs_world_place(fxs_world *world, const fxs_placement *whole);

/* Makes one stream of the open files of a world, which are in the order of world->files, as are `infos`. It gives the
   Gaussians of each visible object in turn, with the object's crops, opacity and tint, and with SH turned. It owns the
   files from then on, also where this fails. All files must be anti-aliased, or none. Where there are crops, the files
   are read once to count the Gaussians that are left. info->start has what is up in the world, or where that is not
   known in the first object of which a file says it, and the start view of the first object that has one.
   fxs_object_place must accept the placements. Returns 0, or an FXS_ERR_* and a message. */
FXS_API int fxs_world_merge(const fxs_world *world, fxs_scene_file **files, const fxs_scene_file_info *infos,
                            fxs_scene_file **merged, fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
