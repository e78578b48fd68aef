/* Scenes that a page lists: given files, and the scenes of given folders. */
#ifndef SCENE_LIST_H
#define SCENE_LIST_H

#include <stddef.h>

enum { LISTED_NAME = 80 };

typedef struct listed_scene {
    char *path;
    char name[LISTED_NAME];        /* unique name for its files, without an ending: letters, digits and dashes */
    char title[LISTED_NAME];       /* last component of its path, without the ending */
} listed_scene;

/* All fields 0: empty. */
typedef struct scene_list {
    listed_scene *scenes;
    size_t count, room;
} scene_list;

/* Adds a scene, or the scenes of a folder sorted by name. A folder that is itself a scene of several files (for
   example with a tileset.json) counts as one scene. Returns 0, or prints the reason and returns EXIT_FAILED if a
   folder has no scene. */
int scene_list_add(scene_list *list, const char *path);

/* True if scene_list_add would add the scenes inside of the path. */
int is_folder_of_scenes(const char *path);

void scene_list_free(scene_list *list);

#endif
