/* The list of scenes that a web page shows: single scene files, and all scenes in folders. */
#ifndef SCENE_LIST_H
#define SCENE_LIST_H

#include <stddef.h>

enum { LISTED_NAME = 80 };

typedef struct listed_scene {
    char *path;
    char name[LISTED_NAME];        /* unique name for web addresses: letters, digits and dashes */
    char title[LISTED_NAME];       /* file name without its ending, shown as the title */
} listed_scene;

typedef struct scene_list {
    listed_scene *scenes;
    size_t count, room;
} scene_list;

/* Adds a scene file, or all scenes of a folder in ascending order of name. A folder that has a tileset.json or a
   similar file is itself a scene. */
int scene_list_add(scene_list *list, const char *path);

/* True if scene_list_add would add the scenes inside of the folder. */
int is_folder_of_scenes(const char *path);

void scene_list_free(scene_list *list);

#endif
