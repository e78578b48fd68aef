/* Files and folders that a command has made, to be removed if the command fails. */
#ifndef MADE_LIST_H
#define MADE_LIST_H

#include <stddef.h>

typedef struct made_list {
    char **paths;
    size_t count, room;
} made_list;

/* Records a path that does not exist yet. Call before making the file or folder. */
void made_list_add(made_list *list, const char *path);

/* Records a folder and its parent folders that do not exist yet, like made_list_add. */
void made_list_add_folders(made_list *list, const char *path);

/* Removes the recorded files and folders in reverse order. A folder with other files stays. */
void made_list_remove(const made_list *list);

void made_list_free(made_list *list);

#endif
