/* The scenes that `fixsplat view --web` serves. Each is packed if that makes it smaller, with its progress reported
 * to the page, and packed again when its file changes. One thread, which calls scenes_work, packs them; the server's
 * thread sends the files that are ready. */
#ifndef SERVE_SCENES_H
#define SERVE_SCENES_H

#include "tools/command/load_scene.h"
#include "port/http/server.h"

typedef struct served_scenes served_scenes;

/* How scenes are packed. Must outlive the scenes. */
typedef struct served_options {
    load_options load;
    uint8_t background[3];                  /* background of pictures */
    int has_list;                           /* 1: several scenes in a list with pictures, each packed once somebody
                                               looks at it; 0: one scene, packed at once, and the program ends if
                                               that fails */
} served_options;

/* Room for `most` scenes. Returns null if memory runs out. Free with scenes_free. */
served_scenes *scenes_new(const served_options *options, int most);

/* Adds a scene. With is_sure its file is read now, and a failure is an error. Returns 0, or prints the reason and
   returns EXIT_FAILED. */
int scenes_add(served_scenes *all, const char *path, int is_sure);

/* scenes_address: the address of a scene's first version. scenes_title: its name in a list. */
const char *scenes_address(const served_scenes *all, int scene);
const char *scenes_title(const served_scenes *all, int scene);

/* The files that the server sends, valid until scenes_free: SCENE_FILES for each scene, and one about all scenes.
   `files` must have room for scenes_file_count of them. */
enum { SCENE_FILES = 4 };
int scenes_file_count(const served_scenes *all);
void scenes_files(served_scenes *all, fxs_http_file *files);

/* Packs the next wanted or changed scene. Call it a few times a second. Returns 1 if it packed one, 0 if not, and -1
   if the first packing of the only scene failed. */
int scenes_work(served_scenes *all);

void scenes_free(served_scenes *all);

#endif
