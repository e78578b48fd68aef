/* Loads the scene files of a command. */
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

/* Returns 1 for an .fxs file, which needs no conversion. */
int is_packed(const loaded_scene *loaded);

/* Options of loading. All fields 0: the defaults. */
typedef struct load_options {
    int lod;                                /* level of detail of the file; 0: finest */
    const char *lods;                       /* levels for the files, L,M,...; null: `lod` for all */
    int is_one_of_several;                  /* 1: `lod` is ignored for a file with a single level */
    enum fxs_axes axes;                     /* axes of an .spz file */
    uint32_t threads;                       /* of the import; 0: one per processor */
    enum fxs_profile profile;               /* for packing */
    int tree;                               /* 1: packs with levels of detail */
    int pages;                              /* 1: an .fxs may be paged from a pool or a server */
    size_t pool;                            /* memory of a paged scene, bytes; 0: not given */
    uint32_t budget;                        /* Gaussians per picture; 0: no paging by size */
    void (*arrived)(void *argument);        /* called when chunks have been loaded; may be null */
    void *arrived_argument;
    const fxs_scene_filter *filter;         /* leaves out Gaussians, except of an .fxs; may be null */
    uint64_t decimate_count;                /* merges Gaussians down to a number; 0: no merging */
    double decimate_share;                  /* merges Gaussians down to a share, 0 to 1; 0: no merging */
    uint64_t max_gaussians;                 /* limit of Gaussians for an imported file */
    size_t import_memory;                   /* limit of memory for an import, bytes */
    int again;                              /* 1: repeats no notes on left-out Gaussians */
    fxs_progress_fn *progress;              /* null: a bar on stderr */
    void *progress_argument;
} load_options;

/* Returns the progress function of the options, or else of a bar after `label`. */
fxs_progress_fn *progress_of(const load_options *options, char *label, void **argument);

/* Copies the options for file i of `count`, with its level of detail. Returns 0, or prints the error and returns
   EXIT_USAGE. */
int options_of_file(load_options *own, const load_options *options, uint32_t i, uint32_t count);

/* Opens a scene for rendering, and notes on stderr which Gaussians are left out. Returns 0, or prints the reason and
   returns EXIT_FAILED; then nothing is to be freed. */
int load_scene(loaded_scene *loaded, const char *path, const load_options *options);

/* Loads a scene from a file of open_scene or open_merged, and closes the file. Returns like load_scene. */
int load_stream(loaded_scene *loaded, const char *path, const load_options *options, fxs_scene_file *file,
                const fxs_scene_file_info *info);

/* Prints a note if a scene is too wide for the precision of floats. */
void note_coarse(const char *path, const fxs_scene_file_info *info);

/* Prints a note about Gaussians that packing left out or moved. */
void note_packed(const char *path, const fxs_pack_report *report);

/* Opens a scene file to read its Gaussians as floats, with the filter of the options. Returns 0, or prints the
   reason and returns EXIT_FAILED. Close *file with fxs_scene_file_close. */
int open_scene(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);

/* The two steps of open_scene. filter_scene closes the file on failure. */
int open_unfiltered(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);
int filter_scene(const char *path, const load_options *options, fxs_scene_file *file, fxs_scene_file_info *info);

/* Names of enum fxs_profile, ended by null. */
extern const char *const profile_names[];

/* Checks that an .fxs is unchanged since loading. Returns 0, or prints the error and returns EXIT_FAILED. */
int check_scene(const loaded_scene *loaded);

void free_scene(loaded_scene *loaded);

#endif
