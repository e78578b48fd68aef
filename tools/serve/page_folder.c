#include "page_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "tools/command/command.h"

static int has_page(const char *folder)
{
    char path[4200];
    const int length = snprintf(path, sizeof path, "%s/viewer/index.html", folder);
    return length < (int)sizeof path && fxs_file_kind(path) == FXS_FILE_REGULAR;
}

int page_folder_look(char folder[PAGE_PATH])
{
    static const char *const places[] = {"web/package", "../share/fixsplat/web"};
    const char *given = getenv("FIXSPLAT_WEB");
    char path[2048];
    if (given)
        return snprintf(folder, PAGE_PATH, "%s", given) < PAGE_PATH && has_page(folder);
    fxs_program_path(path, sizeof path);
    char *end = strrchr(path, '/');
    for (size_t i = 0; end && i < sizeof places / sizeof *places; i++) {
        snprintf(folder, PAGE_PATH, "%.*s/%s", (int)(end - path), path, places[i]);
        if (has_page(folder))
            return 1;
    }
    return 0;
}

int page_folder_find(char folder[PAGE_PATH])
{
    const char *given = getenv("FIXSPLAT_WEB");
    if (page_folder_look(folder))
        return 0;
    if (given)
        return fail(EXIT_FAILED, "FIXSPLAT_WEB=%s: the page is not there: no viewer/index.html", given);
    return fail(EXIT_FAILED, "the page is not built: make setup web, or FIXSPLAT_WEB=FOLDER where it is elsewhere");
}
