/* Places scene files in a world, in doubles. Rounds the placements to objects of the renderer, or merges the files into
 * one stream of Gaussians. */
#ifndef FXS_WORLD_H
#define FXS_WORLD_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A crop box of a placement, in the units of the scene file. */
typedef struct fxs_world_crop {
    double low[3], high[3];
    int outside;                   /* 0: keeps the Gaussians inside the box; 1: keeps the Gaussians outside */
} fxs_world_crop;

/* The placement of a scene file in the world: world = translation + scale * rotation * position. */
typedef struct fxs_placement {
    uint32_t file;                 /* number of the scene file: an index in fxs_world.files */
    double translation[3];         /* position of the file's origin, world units, within +-2^28 */
    double rotation[4];            /* rotation from file to world: quaternion w, x, y, z, of any length except 0 */
    double scale;                  /* size of the file's unit in world units, 2^-16 to 2^16 */
    double opacity;                /* factor for all opacities of the file, 0 to 1 */
    double tint[3];                /* factors for red, green and blue of the file, 0 to 4 */
    int visible;
    uint32_t id;                   /* number of the object, for id targets and fxs_pick: 0 to 2^32 - 2 */
    uint32_t crop_count;
    fxs_world_crop crops[FXS_MAX_CROPS];
} fxs_placement;

/* A world: scene files and their placements. All fields 0: an empty world. */
typedef struct fxs_world {
    char **files;                  /* paths of the scene files, all different */
    fxs_placement *objects;
    uint32_t file_count, count, room;
    double up[3];                  /* up direction of the world, of any length; all 0: taken from the files */
} fxs_world;

/* Initialises a placement: at the origin of the world, unscaled and visible. */
FXS_API void fxs_placement_init(fxs_placement *placement, uint32_t file, uint32_t id);

/* Add to a world. fxs_world_add_file adds a scene file's path, unless the world has it already, and sets *file to its
   index. fxs_world_add adds an object, a copy of *placement. Both return 0, or an FXS_ERR_* and a message. */
FXS_API int fxs_world_add_file(fxs_world *world, const char *path, uint32_t *file, fxs_message *message);
FXS_API int fxs_world_add(fxs_world *world, const fxs_placement *placement, fxs_message *message);

/* Reads a world from JSON:
 *
 *     {"objects": [{"file": "a.fxs", "translation": [x, y, z], "rotation": [w, x, y, z], "scale": s, "opacity": o,
 *                   "tint": [r, g, b], "visible": true, "id": n,
 *                   "crops": [{"low": [x, y, z], "high": [x, y, z], "keep": "inside"}]}]}
 *
 * Only "file" is required; its path is relative to the folder of the JSON file and must stay in it. "keep" is "inside"
 * or "outside". "id" defaults to the object's index in the list. Returns 0 and a world that fxs_world_free frees, or an
 * FXS_ERR_* and a message that names the object: FXS_ERR_FILE, FXS_ERR_OBJECT, FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED
 * (without cJSON). */
FXS_API int fxs_world_read(fxs_world *world, const char *path, fxs_message *message);

FXS_API void fxs_world_free(fxs_world *world);

/* Checks a placement and rounds it to an object of the renderer. `crops` receives the object's crop_count crop boxes.
   Returns 0, or FXS_ERR_OBJECT and a message with the number that is out of range. */
FXS_API int fxs_object_place(fxs_object *object, const fxs_scene *scene, const fxs_placement *placement,
                             fxs_crop *crops, fxs_message *message);

/* Applies a placement to all objects and the up direction of a world, as if the objects were one. */
FXS_API void fxs_world_place(fxs_world *world, const fxs_placement *whole);

/* Merges the open files of a world into one stream. `files` and `infos` are in the order of world->files. The stream
   gives the Gaussians of each visible object in turn, with the object's crops, opacity and tint applied and SH rotated.
   The function takes over the files, also after an error. All files must be anti-aliased, or none. If an object has
   crops, the files are read once to count the remaining Gaussians. info->start gets the world's up direction, or else
   the up direction of the first object with a known one, and the start view of the first object that has one.
   fxs_object_place must accept the placements.

   Moving files give a moving stream, with the longest duration and the highest rate. A shorter file goes on until then:
   one that loops is repeated, at most 4096 times, and another stays at its last moment. A still file is always there.
   Crops keep a Gaussian if they keep a place on its way, as fxs_scene_file_filter does.

   Returns 0, or an FXS_ERR_* and a message. */
FXS_API int fxs_world_merge(const fxs_world *world, fxs_scene_file **files, const fxs_scene_file_info *infos,
                            fxs_scene_file **merged, fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
