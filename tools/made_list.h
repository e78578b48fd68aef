/* What a command makes of files and folders, to be removed where it fails half way. */
#ifndef MADE_LIST_H
#define MADE_LIST_H

#include <stddef.h>

/* All fields 0: nothing. */
typedef struct made_list {
    char **paths;
    size_t count, room;
} made_list;

/* Before a file or a folder is made: takes its path, unless it is there. Where there is no memory, it will stay. */
void made_list_add(made_list *list, const char *path);

/* The same for a folder and those that it is in. */
void made_list_add_folders(made_list *list, const char *path);

/* Removes those that were made, the last first; a folder with other files in it stays. */
void made_list_remove(const made_list *list);

void made_list_free(made_list *list);

#endif
