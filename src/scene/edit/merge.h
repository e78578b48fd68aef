/* A world as one scene file: its Gaussians, moved, turned and scaled as their objects are. */
#ifndef FXS_MERGE_H
#define FXS_MERGE_H

#include <fixsplat/scene_file.h>
#include <fixsplat/world.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Places the objects of a world anew, as if they were one object that is placed so. */
void fxs_world_place(fxs_world *world, const fxs_placement *whole);

/* Makes one file of those of a world, which are open, each at its place in world->files; `infos` are theirs. It gives
   the Gaussians of each visible object in turn, with its crops, opacity and tint, and SH turned with it. The files are
   its own from then on, also where this fails. All must be anti-aliased, or none. Where there are crops, the files are
   read once, to count what is left. The placements are ones that fxs_object_place takes. Returns 0, or an FXS_ERR_* and
   a message. */
int fxs_world_merge(const fxs_world *world, fxs_scene_file **files, const fxs_scene_file_info *infos,
                    fxs_scene_file **merged, fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
