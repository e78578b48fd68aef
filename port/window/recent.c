#define _XOPEN_SOURCE 700   /* realpath */

#include "recent.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/base/output_internal.h"

/* Relative paths are ignored, as https://specifications.freedesktop.org/basedir-spec says. Returns 0 where there is no
   folder for the list. */
static int find_list(char path[PATH_MAX])
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    const int has_state = state && *state == '/';
    if (!has_state && !(home && *home == '/'))
        return 0;
    return snprintf(path, PATH_MAX, "%s%s/fixsplat/recent", has_state ? state : home,
                    has_state ? "" : "/.local/state") < PATH_MAX;
}

void fxs_recent_read(fxs_recent *recent)
{
    char list[PATH_MAX], line[PATH_MAX + 1];
    memset(recent, 0, sizeof *recent);
    FILE *file = find_list(list) ? fopen(list, "r") : 0;
    while (file && recent->count < FXS_RECENT_MOST && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = 0;
        if (*line == '/' && !access(line, F_OK) && (recent->paths[recent->count] = strdup(line)) != 0)
            recent->count++;
    }
    if (file)
        fclose(file);
}

void fxs_recent_free(fxs_recent *recent)
{
    for (int i = 0; i < recent->count; i++)
        free(recent->paths[i]);
    recent->count = 0;
}

/* Makes the folders of a file that will be written. */
static void make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        mkdir(path, 0700);
        *slash = '/';
    }
}

static int write_list(const char *list, const char *first, const fxs_recent *others, fxs_message *message)
{
    fxs_output output;
    int kept = 1;
    const int error = fxs_output_open(&output, list, 0, message);
    if (error)
        return error;
    fprintf(output.file, "%s\n", first);
    for (int i = 0; i < others->count && kept < FXS_RECENT_MOST; i++)
        if (strcmp(others->paths[i], first)) {
            fprintf(output.file, "%s\n", others->paths[i]);
            kept++;
        }
    return fxs_output_close(&output, message);
}

int fxs_recent_add(const char *path, fxs_message *message)
{
    char list[PATH_MAX];
    fxs_recent others;
    int error = 0;
    char *whole = realpath(path, 0);
    if (whole && !strchr(whole, '\n') && find_list(list)) {
        make_folders(list);
        fxs_recent_read(&others);
        error = write_list(list, whole, &others, message);
        fxs_recent_free(&others);
    }
    free(whole);
    return error;
}
