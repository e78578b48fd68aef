/* The world of a subcommand: scenes, each loaded once, and objects that place scenes. */
#ifndef LOAD_WORLD_H
#define LOAD_WORLD_H

#include <fixsplat/world.h>
#include "load_scene.h"

#define PLACES_MOST 1024

typedef struct world_options {
    const char *file;
    char *const *scenes;
    int scene_count;
    const char *places[PLACES_MOST];
    int place_count;
} world_options;

int take_scenes(world_options *options, const char *name, int count, char *const *scenes);

/* Reads the file of option --scene or applies the options --place, without opening scenes. Free *placed with
   fxs_world_free. */
int place_scenes(fxs_world *placed, const world_options *options);

typedef struct world {
    fxs_world placed;
    loaded_scene *scenes;
    fxs_object *objects;
    fxs_crop *crops;                        /* FXS_MAX_CROPS crop boxes for each object */
    uint32_t count, gaussians;              /* number of objects; number of Gaussians of all objects */
    double low[3], high[3];                 /* bounds of the Gaussians' centres in visible objects */
    double inner_low[3], inner_high[3];     /* bounds of the Gaussians' centres without outliers */
    uint64_t load_nanoseconds;
} world;

/* Loads the scenes of a world (placed scenes), and refuses options of the command line that do nothing for these
   scenes. After a failure, the caller has nothing to close. */
int world_open(world *w, const world_options *options, const load_options *load);

/* Loads a file that the command line does not name, with its options as far as they apply. */
int world_open_file(world *w, const char *path, const load_options *load);

/* Opens all files of a world (placed scenes) as one scene file, whose placed Gaussians are read as floats. In messages,
   `name` stands for the files. Close *file with fxs_scene_file_close. */
int open_merged(const fxs_world *placed, const char *name, const load_options *load, fxs_scene_file **file,
                fxs_scene_file_info *info);

int world_open_merged(world *w, const fxs_world *placed, const char *name, const load_options *load);

/* Makes a world of one packed scene. The scene remains the caller's, and must not move before world_close. */
int world_open_packed(world *w, const char *name, fxs_packed_scene *packed);

/* Finds the up direction of the first visible object whose file has one. Returns 0 if no object has an up direction. */
int world_up(const world *w, double up[3]);

/* Computes an object's bounding box in the world. Returns 0 if the object's crops leave nothing. */
int world_box(const world *w, uint32_t object, double low[3], double high[3]);

/* Checks that the world's scene files have not changed since they were loaded. */
int world_check(const world *w);

/* A paged world has scenes that are only partly in memory, each with a pager that loads missing parts. world_want is an
   fxs_want_fn with the world as argument. world_turn and world_wait call fxs_pager_turn and fxs_pager_wait for all
   pagers. */
int world_is_paged(const world *w);
fxs_want_fn world_want;
int world_turn(const world *w, fxs_pager_state *sum, fxs_message *message);
int world_wait(const world *w, uint64_t nanoseconds);

void world_close(world *w);

#endif
