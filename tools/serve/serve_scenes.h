/* The scenes that `fixsplat view --web` serves. Scenes are packed if that makes them smaller. Function scenes_work
   packs them, on a single thread. The server's thread sends the ready files. */
#ifndef SERVE_SCENES_H
#define SERVE_SCENES_H

#include "tools/command/load_scene.h"
#include "port/http/server.h"

typedef struct served_scenes served_scenes;

/* Options of packing served scenes. They must outlive the list of scenes. */
typedef struct served_options {
    load_options load;
    uint8_t background[3];
    int has_list;                           /* 1: serves a list of scenes, and packs them on demand */
} served_options;

/* Allocates a list of at most `most` scenes. Null: out of memory. Free the list with scenes_free. */
served_scenes *scenes_new(const served_options *options, int most);

/* Adds a scene to the list of served scenes. is_sure 1: reads the scene's file, and fails if it cannot be read. */
int scenes_add(served_scenes *all, const char *path, int is_sure);

const char *scenes_address(const served_scenes *all, int scene);
const char *scenes_title(const served_scenes *all, int scene);

/* Describes the files that the server sends, valid until scenes_free. `files` must have room for scenes_file_count
   entries. */
enum { SCENE_FILES = 4 };
int scenes_file_count(const served_scenes *all);
void scenes_files(served_scenes *all, fxs_http_file *files);

/* Packs the next scene that a page wants or whose file has changed. Call a few times a second. Returns 1: packed, 0:
   idle, -1: the only scene failed. */
int scenes_work(served_scenes *all);

void scenes_free(served_scenes *all);

#endif
