/* Scenes that a page lists: those that are given, and those of folders. */
#ifndef SCENE_LIST_H
#define SCENE_LIST_H

#include <stddef.h>

enum { LISTED_NAME = 80 };

typedef struct listed_scene {
    char *path;
    char name[LISTED_NAME];        /* of its files, without an ending: letters, digits and dashes, each name once */
    char title[LISTED_NAME];       /* the last part of its path, without the ending */
} listed_scene;

/* All 0: none. */
typedef struct scene_list {
    listed_scene *scenes;
    size_t count, room;
} scene_list;

/* Adds a scene, or the scenes of a folder in the order of their names. A folder that is one scene of several files (it
   has a tileset.json, say) counts as a scene. Returns 0, or prints why not and returns EXIT_FAILED: a folder without a
   scene. */
int scene_list_add(scene_list *list, const char *path);

/* Whether that adds the scenes of a folder. */
int is_folder_of_scenes(const char *path);

void scene_list_free(scene_list *list);

#endif
