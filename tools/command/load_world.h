/* The world of a command: its scenes, each loaded once, and the objects that place them. */
#ifndef LOAD_WORLD_H
#define LOAD_WORLD_H

#include <fixsplat/world.h>
#include "load_scene.h"

#define PLACES_MOST 1024

/* All fields 0: the defaults. */
typedef struct world_options {
    const char *file;                       /* value of --scene */
    char *const *scenes;                    /* scene files of the command line */
    int scene_count;
    const char *places[PLACES_MOST];        /* values of --place */
    int place_count;
} world_options;

/* Stores the scene files given to the command `name`. Returns 0, or prints the error and returns EXIT_USAGE. */
int take_scenes(world_options *options, const char *name, int count, char *const *scenes);

/* Reads --scene, or places the scenes as --place says; opens no scene. Free *placed with fxs_world_free. Returns 0,
   or prints the reason and returns the exit status. */
int place_scenes(fxs_world *placed, const world_options *options);

typedef struct world {
    fxs_world placed;                       /* files and placements */
    loaded_scene *scenes;                   /* one for each file */
    fxs_object *objects;
    fxs_crop *crops;                        /* crops of the objects, FXS_MAX_CROPS each */
    uint32_t count, gaussians;              /* objects; Gaussians of all objects after packing */
    double low[3], high[3];                 /* bounds of all centres in visible objects */
    double inner_low[3], inner_high[3];     /* bounds without outliers, for framing */
    uint64_t load_nanoseconds;
} world;

/* Loads the scenes. Returns 0, or prints the reason and returns the exit status; then world_close is not needed. */
int world_open(world *w, const world_options *options, const load_options *load);

/* Loads one scene, unplaced. */
int world_open_file(world *w, const char *path, const load_options *load);

/* Opens all files of a world as one scene file to be read in floats, with each object placed. Close *file with
   fxs_scene_file_close. `name` stands for the whole in messages. Returns 0, or prints the reason and returns
   EXIT_FAILED. */
int open_merged(const fxs_world *placed, const char *name, const load_options *load, fxs_scene_file **file,
                fxs_scene_file_info *info);

/* Opens a world with open_merged and loads it as one scene. */
int world_open_merged(world *w, const fxs_world *placed, const char *name, const load_options *load);

/* A world of one packed scene. The caller keeps ownership; the scene must stay where it is. */
int world_open_packed(world *w, const char *name, fxs_packed_scene *packed);

/* The up direction of the first visible object with one in its file. Returns 0 and leaves `up` unchanged if none has
   one. */
int world_up(const world *w, double up[3]);

/* The bounding box of an object in the world. Returns 0 if its crops leave nothing. */
int world_box(const world *w, uint32_t object, double low[3], double high[3]);

/* Checks that the scenes' files are unchanged since loading. Returns 0, or prints which one changed and returns
   EXIT_FAILED. */
int world_check(const world *w);

/* Paged worlds, where scenes are partly in memory. world_is_paged: true if any scene has a pager. world_want: the
   fxs_want_fn of its frames, with the world as the argument. world_turn, world_wait: call fxs_pager_turn and
   fxs_pager_wait for all pagers; world_turn adds up their states. */
int world_is_paged(const world *w);
fxs_want_fn world_want;
int world_turn(const world *w, fxs_pager_state *sum, fxs_message *message);
int world_wait(const world *w, uint64_t nanoseconds);

/* Also closes a world that failed to open: null scenes are skipped. */
void world_close(world *w);

#endif
