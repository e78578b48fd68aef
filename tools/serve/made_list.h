/* The files and folders that a command has made, so that they can be removed if the command fails. */
#ifndef MADE_LIST_H
#define MADE_LIST_H

#include <stddef.h>

/* All fields 0: empty. */
typedef struct made_list {
    char **paths;
    size_t count, room;
} made_list;

/* Records a path that does not exist yet. Call this function before the file or folder is made. Without memory the
   path is not recorded. */
void made_list_add(made_list *list, const char *path);

/* Records a folder and its parents like made_list_add. */
void made_list_add_folders(made_list *list, const char *path);

/* Removes the recorded files and folders in reverse order. A folder with other files stays. */
void made_list_remove(const made_list *list);

void made_list_free(made_list *list);

#endif
