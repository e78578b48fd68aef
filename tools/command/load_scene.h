/* Loads the scene files of a subcommand. */
#ifndef SCENE_H
#define SCENE_H

#include <fixsplat/renderer.h>
#include <fixsplat/internal/sound.h>
#include "command.h"

typedef struct loaded_scene {
    fxs_opened *opened;
    const char *path;
    void *copy;                             /* a changed .fxs in memory; null: none */
    fxs_sound sound;                        /* with SOUND_KEPT, the sound of a moving scene; data null: none */
    uint64_t load_nanoseconds;
} loaded_scene;

/* True for an .fxs file, which needs no conversion. */
int is_packed(const loaded_scene *loaded);

/* What happens to the sound of a moving scene: nothing, a note that it is not kept, or it is loaded. */
enum sound_use { SOUND_UNUSED, SOUND_LOST, SOUND_KEPT };

typedef struct load_options {
    int lod;                                /* number of the level of detail to read; 0: finest */
    const char *lods;                       /* list of levels of detail, one for each file; null: `lod` for all files */
    int is_one_of_several;                  /* 1: if a file has a single level of detail, `lod` is ignored */
    enum fxs_axes axes;
    uint32_t threads;                       /* threads of the import; 0: one per processor */
    enum fxs_profile profile;
    int tree;                               /* 1: packs a scene with a tree of levels of detail */
    int pages;                              /* 1: an .fxs file may be paged, which keeps only parts in memory */
    size_t pool;                            /* bytes of memory for a paged scene (partly in memory); 0: not given */
    uint32_t budget;                        /* most Gaussians per picture; 0: size alone does not make a scene paged */
    void (*arrived)(void *argument);        /* called when parts of a paged scene (partly in memory) have been loaded */
    void *arrived_argument;
    const fxs_scene_filter *filter;         /* filter that drops Gaussians, unused for an .fxs; may be null */
    uint64_t decimate_count;                /* number of Gaussians to reduce a scene to; 0: no reduction */
    double decimate_share;                  /* share of Gaussians to reduce a scene to; 0: no reduction */
    double rate;
    int has_moment;                         /* 1: a moving scene is read as it is at the time `moment`, seconds, before
                                               it is placed and filtered; 2: after this */
    double moment;
    int has_range;                          /* 1: a moving scene is read from the time `from` to before `to`, seconds */
    double from, to;
    int *moved;                             /* set to 1 if a moving scene is read at the moment; may be null */
    enum sound_use sound;
    const char *still;                      /* why a scene that moves is refused without a moment, the end of the error
                                               "a scene that moves ..."; null: it is read */
    uint64_t max_gaussians;
    size_t import_memory;
    int again;
    fxs_progress progress;                  /* progress callback; if its `call` is null, stderr shows a bar */
} load_options;

/* Returns the progress callback of the options. If they have none, returns a progress bar that begins with `label`. */
fxs_progress progress_of(const load_options *options, char *label);

/* Copies the options for file i of `count` files. The copy has the level of detail that the options give for this
   file. */
int options_of_file(load_options *own, const load_options *options, uint32_t i, uint32_t count);

/* Opens a scene for rendering. After a failure, the caller has nothing to free. */
int load_scene(loaded_scene *loaded, const char *path, const load_options *options);

/* Loads a scene from a file that open_scene or open_merged has opened, and closes the file. */
int load_stream(loaded_scene *loaded, const char *path, const load_options *options, fxs_scene_file *file,
                const fxs_scene_file_info *info);

void note_coarse(const char *path, const fxs_scene_file_info *info);

void note_packed(const char *path, const fxs_pack_report *report);

/* Opens a scene file to read its Gaussians as floats. Close *file with fxs_scene_file_close. */
int open_scene(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);

/* These functions are the two steps of open_scene. filter_scene closes the file on failure. */
int open_unfiltered(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);
int filter_scene(const char *path, const load_options *options, fxs_scene_file *file, fxs_scene_file_info *info);

extern const char *const profile_names[];

int check_scene(const loaded_scene *loaded);

void free_scene(loaded_scene *loaded);

#endif
