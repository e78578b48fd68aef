#include "recent.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/output_internal.h"
#include "src/base/os_calls.h"

enum { PATH_MOST = 4096 };

void fxs_recent_read(fxs_recent *recent)
{
    char list[PATH_MOST], line[PATH_MOST + 1];
    memset(recent, 0, sizeof *recent);
    FILE *file = fxs_state_path("recent", 0, list, sizeof list) ? 0 : fxs_stream_open(list, "r");
    while (file && recent->count < FXS_RECENT_MOST && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = 0;
        if (fxs_path_is_whole(line) && fxs_file_kind(line) != FXS_FILE_NONE &&
            (recent->paths[recent->count] = strdup(line)) != 0)
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
    char list[PATH_MOST];
    fxs_recent others;
    int error = 0;
    char *whole = fxs_path_whole(path);
    if (whole && !strchr(whole, '\n') && !fxs_state_path("recent", 1, list, sizeof list)) {
        fxs_recent_read(&others);
        error = write_list(list, whole, &others, message);
        fxs_recent_free(&others);
    }
    free(whole);
    return error;
}
