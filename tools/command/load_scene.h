/* Loading of a command's scene files. */
#ifndef SCENE_H
#define SCENE_H

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include "command.h"

typedef struct loaded_scene {
    fxs_opened *opened;
    const char *path;
    uint64_t load_nanoseconds;
} loaded_scene;

/* 1 for an .fxs file, which is rendered without conversion. */
int is_packed(const loaded_scene *loaded);

/* All fields 0: the defaults. */
typedef struct load_options {
    int lod;                                /* level of detail, 0 the finest, for a file with several */
    const char *lods;                       /* a level for each file, L,M,...; null: `lod` for all files with levels */
    int is_one_of_several;                  /* 1: `lod` is ignored for a file with a single level */
    enum fxs_axes axes;                     /* axes of an .spz */
    uint32_t threads;                       /* threads of the import; 0: one for each processor */
    enum fxs_profile profile;               /* for files that are not packed yet */
    int tree;                               /* 1: packs with levels of detail */
    int pages;                              /* 1: an .fxs may be paged: if a pool is given, or from a server */
    size_t pool;                            /* pool of the pager, bytes; 0: none given */
    uint32_t budget;                        /* Gaussians a picture: a large .fxs may be paged if that is a small part
                                               of it; 0: not allowed */
    void (*arrived)(void *argument);        /* as in fxs_pager_options */
    void *arrived_argument;
    const fxs_scene_filter *filter;         /* Gaussians to leave out, or null; an .fxs file is always mapped whole */
    uint64_t decimate_count;                /* merges the Gaussians left by the filter down to this number, 0: all, */
    double decimate_share;                  /* or to this share, 0 to 1, 0: all. The filter then keeps drawable
                                               Gaussians only */
    uint64_t max_gaussians;                 /* limit for an imported file; import_memory: limit for the memory of its
                                               import, */
    size_t import_memory;                   /* both as in fxs_scene_file_options */
    int again;                              /* 1: notes about left-out or changed Gaussians were printed before */
    fxs_progress_fn *progress;              /* null: a bar on stderr */
    void *progress_argument;
} load_options;

/* The progress function and its argument: the options', or by default a bar after `label`. */
fxs_progress_fn *progress_of(const load_options *options, char *label, void **argument);

/* The options for file i of `count`. Returns 0, or prints that --lod has a wrong number of levels and returns
   EXIT_USAGE. */
int options_of_file(load_options *own, const load_options *options, uint32_t i, uint32_t count);

/* Opens a scene for rendering, and notes on stderr which Gaussians are left out. Returns 0, or prints the reason and
   returns EXIT_FAILED, with nothing to free. */
int load_scene(loaded_scene *loaded, const char *path, const load_options *options);

/* As load_scene, for a file from open_scene or open_merged; closes the file. */
int load_stream(loaded_scene *loaded, const char *path, const load_options *options, fxs_scene_file *file,
                const fxs_scene_file_info *info);

/* Notes if parts of a scene are too far from the others for the precision of floats. */
void note_coarse(const char *path, const fxs_scene_file_info *info);

/* Notes which Gaussians packing left out or moved. */
void note_packed(const char *path, const fxs_pack_report *report);

/* Opens a scene file to be read in floats, and notes on stderr which Gaussians the filter (or null) leaves out.
   Returns 0 and a file for fxs_scene_file_close, or prints the reason and returns EXIT_FAILED. */
int open_scene(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);

/* The two steps of open_scene: opening, and filtering. filter_scene closes the file if it fails. */
int open_unfiltered(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);
int filter_scene(const char *path, const load_options *options, fxs_scene_file *file, fxs_scene_file_info *info);

/* Names of enum fxs_profile, ended by null. */
extern const char *const profile_names[];

/* Checks that an .fxs file was not written to since loading. Returns 0, or prints that it was and returns
   EXIT_FAILED. */
int check_scene(const loaded_scene *loaded);

void free_scene(loaded_scene *loaded);

#endif
