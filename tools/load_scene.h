/* The scene files of the command. */
#ifndef SCENE_H
#define SCENE_H

#include <fixsplat/renderer.h>
#include <fixsplat/scene_filter.h>
#include "command.h"

typedef struct loaded_scene {
    fxs_opened *opened;
    const char *path;
    uint64_t load_nanoseconds;
} loaded_scene;

/* 1 where it was an .fxs file, which is rendered as it lies. */
int is_packed(const loaded_scene *loaded);

/* All 0 is a default. */
typedef struct load_options {
    int lod;                                /* level of detail, 0 the finest, of a file that has several */
    const char *lods;                       /* a level for each file, L,M,...; null: lod for all that have levels */
    int is_one_of_several;                  /* 1: without levels of its own, the file is read all the same */
    enum fxs_axes axes;                     /* of an .spz */
    uint32_t threads;                       /* of the import; 0: one a processor */
    enum fxs_profile profile;               /* of what is not packed yet */
    int tree;                               /* 1: it is packed with levels of detail */
    int pages;                              /* 1: an .fxs may be read in part: where a pool is given, and of a server */
    size_t pool;                            /* bytes for that; 0: none given */
    uint32_t budget;                        /* Gaussians of a picture, where a large .fxs may be read in part of itself,
                                               as that takes a small part of it; 0: it may not */
    void (*arrived)(void *argument);        /* as in fxs_pager_options */
    void *arrived_argument;
    const fxs_scene_filter *filter;         /* what to leave out, or null; an .fxs file is mapped whole */
    uint64_t decimate_count;                /* of what that leaves, so many are left by merging, 0: all; or so much, */
    double decimate_share;                  /* 0 to 1, 0: all. The filter leaves what can be drawn then */
    uint64_t max_gaussians;                 /* in a file that is imported, and the memory that reading it may take: */
    size_t import_memory;                   /* as in fxs_scene_file_options */
    int again;                              /* what is left out or changed has been said */
    fxs_progress_fn *progress;              /* null: a bar on stderr */
    void *progress_argument;
} load_options;

/* Where progress goes, and with which argument: by default a bar behind its label. */
fxs_progress_fn *progress_of(const load_options *options, char *label, void **argument);

/* The options for file i of `count`. Returns 0, or prints that there is not a level for each and returns EXIT_USAGE. */
int options_of_file(load_options *own, const load_options *options, uint32_t i, uint32_t count);

/* Opens a scene to be rendered, and says on stderr what is left out of it. Returns 0, or prints why not and returns
   EXIT_FAILED, with nothing to free. */
int load_scene(loaded_scene *loaded, const char *path, const load_options *options);

/* The same for a file that open_scene or open_merged opened; it is closed. */
int load_stream(loaded_scene *loaded, const char *path, const load_options *options, fxs_scene_file *file,
                const fxs_scene_file_info *info);

/* Says that parts of a scene are too far from the others for floats, if they are. */
void note_coarse(const char *path, const fxs_scene_file_info *info);

/* Says what packing left out or moved. */
void note_packed(const char *path, const fxs_pack_report *report);

/* Opens a scene file to be read in floats, and says on stderr what the filter (or null) leaves out. Returns 0 and a
   file for fxs_scene_file_close, or prints why not and returns EXIT_FAILED. */
int open_scene(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);

/* The two steps of that: without the filter; and the filter, which closes the file where it fails. */
int open_unfiltered(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);
int filter_scene(const char *path, const load_options *options, fxs_scene_file *file, fxs_scene_file_info *info);

/* Of enum fxs_profile: "default", "compact" and "small", and a null. */
extern const char *const profile_names[];

/* Whether the scene is still what was loaded: an .fxs file may be written to. Returns 0, or prints that it is not and
   returns EXIT_FAILED. */
int check_scene(const loaded_scene *loaded);

void free_scene(loaded_scene *loaded);

#endif
