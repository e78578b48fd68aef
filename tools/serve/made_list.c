#include "made_list.h"

#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "tools/command/task.h"

void made_list_add(made_list *list, const char *path)
{
    char *copy = fxs_file_is_named(path) ? 0 : strdup(path);
    if (copy && list->count == list->room) {
        const size_t room = 2 * list->room + 16;
        char **larger = realloc(list->paths, room * sizeof *larger);
        list->paths = larger ? larger : list->paths;
        list->room = larger ? room : list->room;
    }
    if (copy && list->count < list->room)
        list->paths[list->count++] = copy;
    else
        free(copy);
}

void made_list_add_folders(made_list *list, const char *path)
{
    char *part = strdup(path);
    for (char *slash = part; slash && (slash = strchr(slash + 1, '/')) != 0; *slash = '/') {
        *slash = 0;
        made_list_add(list, part);
    }
    free(part);
    made_list_add(list, path);
}

void made_list_remove(const made_list *list)
{
    for (size_t i = list->count; i-- > 0;)
        (is_folder(list->paths[i]) ? fxs_folder_remove : fxs_file_remove)(list->paths[i]);
}

void made_list_free(made_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->paths[i]);
    free(list->paths);
}
