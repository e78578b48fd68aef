/* The scenes of `fixsplat view --web`: each is packed where that makes it smaller, told of while that goes on, and
 * taken anew when its file has changed. One thread takes them, that of scenes_work; the server's thread sends what
 * there is. */
#ifndef SERVE_SCENES_H
#define SERVE_SCENES_H

#include "load_scene.h"
#include "port/http/server.h"

typedef struct served_scenes served_scenes;

/* How scenes are taken; to stay as long as they do. */
typedef struct served_options {
    load_options load;
    uint8_t background[3];                  /* of pictures */
    int has_list;                           /* a picture of each, and each is taken when somebody looks; else there is
                                               one scene, which is taken at once, or the program ends */
} served_options;

/* Null: out of memory. For scenes_free. */
served_scenes *scenes_new(const served_options *options, int most);

/* Adds a scene. `is_sure`: it is looked at now, and an error if it cannot be read. Returns 0, or prints why not and
   returns EXIT_FAILED. */
int scenes_add(served_scenes *all, const char *path, int is_sure);

/* The address of a scene's first version, and what a list calls it. */
const char *scenes_address(const served_scenes *all, int scene);
const char *scenes_title(const served_scenes *all, int scene);

/* What the server has of them, for as long as they are there: SCENE_FILES files of each and one of all, as many as
   scenes_file_count says. */
enum { SCENE_FILES = 4 };
int scenes_file_count(const served_scenes *all);
void scenes_files(served_scenes *all, fxs_http_file *files);

/* Takes the next scene that is wanted, and those that have changed; to be called a few times a second. Returns 1 where
   there was one to take, 0 where there was none, and -1 where the only scene could not be taken at first. */
int scenes_work(served_scenes *all);

void scenes_free(served_scenes *all);

#endif
