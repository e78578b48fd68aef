/* Finds this program's folders of user data, and a font of the system. */
#include "src/base/os_calls.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/internal/message.h>

static void make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        mkdir(path, 0700);
        *slash = '/';
    }
}

/* Stores the path of a file in this program's folder below a user folder: the variable's, or `otherwise` in the home
   folder. Ignores a relative path in the variable, as the XDG Base Directory Specification demands. */
static int user_path(const char *variable, const char *otherwise, const char *name, int is_written, char *path,
                     size_t room)
{
    const char *folder = getenv(variable), *home = getenv("HOME");
    const int has_folder = folder && *folder == '/';
    if (!has_folder && !(home && *home == '/'))
        return -1;
    const int length = snprintf(path, room, "%s%s/fixsplat/%s", has_folder ? folder : home,
                                has_folder ? "" : otherwise, name);
    if (length < 0 || (size_t)length >= room)
        return -1;
    if (is_written)
        make_folders(path);
    return 0;
}

int fxs_state_path(const char *name, int is_written, char *path, size_t room)
{
    return user_path("XDG_STATE_HOME", "/.local/state", name, is_written, path, room);
}

int fxs_cache_path(const char *name, int is_written, char *path, size_t room)
{
    return user_path("XDG_CACHE_HOME", "/.cache", name, is_written, path, room);
}

int fxs_font_find(char *path, size_t room, fxs_message *message)
{
    /* Paths of fonts on Debian, Fedora, Arch, openSUSE, Alpine and macOS. */
    static const char *const fonts[] = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
        "/usr/share/fonts/TTF/DejaVuSans.ttf", "/usr/share/fonts/truetype/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
        "/usr/share/fonts/noto/NotoSans-Regular.ttf", "/usr/share/fonts/google-noto/NotoSans-Regular.ttf",
        "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
        "/usr/share/fonts/liberation-sans/LiberationSans-Regular.ttf",
        "/usr/share/fonts/liberation/LiberationSans-Regular.ttf", "/System/Library/Fonts/Supplemental/Arial.ttf"
    };
    for (size_t i = 0; i < sizeof fonts / sizeof *fonts; i++)
        if (!access(fonts[i], R_OK))
            return snprintf(path, room, "%s", fonts[i]), 0;
    return fxs_fail(message, "no font of DejaVu, Noto or Liberation found");
}
