/* The world of a command: its scenes, each loaded once, and the objects that they are placed as. */
#ifndef LOAD_WORLD_H
#define LOAD_WORLD_H

#include <fixsplat/world.h>
#include "load_scene.h"

#define PLACES_MOST 1024

/* All 0: nothing asked for. */
typedef struct world_options {
    const char *file;                       /* of --scene */
    char *const *scenes;                    /* files as given */
    int scene_count;
    const char *places[PLACES_MOST];        /* values of --place */
    int place_count;
} world_options;

/* Takes the files that the command of that name is given. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int take_scenes(world_options *options, const char *name, int count, char *const *scenes);

/* Reads --scene, or places the scenes as --place says, before a scene is opened; fxs_world_free frees *placed. Returns
   0, or prints why not and returns the exit status. */
int place_scenes(fxs_world *placed, const world_options *options);

typedef struct world {
    fxs_world placed;                       /* files and placements */
    loaded_scene *scenes;                   /* of each file */
    fxs_object *objects;
    fxs_crop *crops;                        /* of the objects */
    uint32_t count, gaussians;              /* objects, and Gaussians in all of them, as packed */
    double low[3], high[3];                 /* bounds of what is visible: of the centres, */
    double inner_low[3], inner_high[3];     /* and of what is seen, to frame it */
    uint64_t load_nanoseconds;
} world;

/* Loads the scenes. Returns 0, or prints why not and returns the exit status, with nothing to close. */
int world_open(world *w, const world_options *options, const load_options *load);

/* Loads one scene, as it is. */
int world_open_file(world *w, const char *path, const load_options *load);

/* Opens the files of a world as one, to be read in floats, each object as it is placed; for fxs_scene_file_close.
   `name` is that of the whole, for messages. Returns 0, or prints why not and returns EXIT_FAILED. */
int open_merged(const fxs_world *placed, const char *name, const load_options *load, fxs_scene_file **file,
                fxs_scene_file_info *info);

/* Loads that as one scene. */
int world_open_merged(world *w, const fxs_world *placed, const char *name, const load_options *load);

/* One of a packed scene, which stays the caller's and where it is. */
int world_open_packed(world *w, const char *name, fxs_packed_scene *packed);

/* What is up in the world by the first visible object of which a file says it. Returns 0 and leaves `up` as it is where
   none does. */
int world_up(const world *w, double up[3]);

/* The world's box of an object. Returns 0 where its crops leave nothing. */
int world_box(const world *w, uint32_t object, double low[3], double high[3]);

/* Whether the scenes are still what was loaded. Returns 0, or prints that one is not and returns EXIT_FAILED. */
int world_check(const world *w);

/* Whether a part of it is in memory, and then: what its frames want, an fxs_want_fn with the world as its argument; the
   turn of its pagers, whose numbers are added up; and waiting for them. As fxs_pager_turn and fxs_pager_wait. */
int world_is_paged(const world *w);
fxs_want_fn world_want;
int world_turn(const world *w, fxs_pager_state *sum, fxs_message *message);
int world_wait(const world *w, uint64_t nanoseconds);

/* Also of a world that was not opened: its scenes are null. */
void world_close(world *w);

#endif
