/* Files and folders that a command has made, to be removed if it fails. */
#ifndef MADE_LIST_H
#define MADE_LIST_H

#include <stddef.h>

/* All fields 0: empty. */
typedef struct made_list {
    char **paths;
    size_t count, room;
} made_list;

/* Call before a file or a folder is made. Records its path unless it exists; without memory the file will not be
   removed. */
void made_list_add(made_list *list, const char *path);

/* As made_list_add, for a folder and its parent folders. */
void made_list_add_folders(made_list *list, const char *path);

/* Removes the recorded files and folders, the last first. A folder with other files stays. */
void made_list_remove(const made_list *list);

void made_list_free(made_list *list);

#endif
