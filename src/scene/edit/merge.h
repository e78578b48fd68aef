/* Merges a world into one stream: its Gaussians are moved, turned and scaled with their objects. */
#ifndef FXS_MERGE_H
#define FXS_MERGE_H

#include <fixsplat/scene_file.h>
#include <fixsplat/world.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Applies a placement to all objects of a world, as if they were one object. */
void fxs_world_place(fxs_world *world, const fxs_placement *whole);

/* Makes one stream of the open files of a world, which are in the order of world->files, as are `infos`. It gives the
   Gaussians of each visible object in turn, with the object's crops, opacity and tint, and with SH turned. It owns the
   files from then on, also where this fails. All files must be anti-aliased, or none. Where there are crops, the files
   are read once to count the Gaussians that are left. fxs_object_place must accept the placements. Returns 0, or an
   FXS_ERR_* and a message. */
int fxs_world_merge(const fxs_world *world, fxs_scene_file **files, const fxs_scene_file_info *infos,
                    fxs_scene_file **merged, fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
