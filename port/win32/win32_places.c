/* Finds this program's folders of user data, and a font of the system. */
#include "win32.h"

#include <stdlib.h>

#include <fixsplat/internal/message.h>

enum { PATH_MOST = 4096 };

static char *folder_of(const wchar_t *wide, DWORD size)
{
    char *folder = size && size < PATH_MOST ? win32_narrow(wide) : NULL;
    if (folder)
        fxs_path_take(folder);
    return folder;
}

static int user_path(const wchar_t *variable, const char *name, int is_written, char *path, size_t room)
{
    wchar_t wide[PATH_MOST];
    fxs_message unused;
    char *folder = folder_of(wide, GetEnvironmentVariableW(variable, wide, PATH_MOST));
    int length = folder ? snprintf(path, room, "%s/fixsplat", folder) : -1;
    if (length >= 0 && (size_t)length < room) {
        if (is_written)
            fxs_folder_make(path, &unused);
        length += snprintf(path + length, room - (size_t)length, "/%s", name);
    }
    free(folder);
    return length >= 0 && (size_t)length < room ? 0 : -1;
}

int fxs_state_path(const char *name, int is_written, char *path, size_t room)
{
    return user_path(L"APPDATA", name, is_written, path, room);
}

int fxs_cache_path(const char *name, int is_written, char *path, size_t room)
{
    return user_path(L"LOCALAPPDATA", name, is_written, path, room);
}

int fxs_font_find(char *path, size_t room, fxs_message *message)
{
    static const char *const fonts[] = {"segoeui.ttf", "tahoma.ttf", "arial.ttf", "verdana.ttf"};
    wchar_t wide[PATH_MOST];
    char *folder = folder_of(wide, GetSystemWindowsDirectoryW(wide, PATH_MOST));
    int result = -1;
    for (size_t i = 0; folder && result && i < sizeof fonts / sizeof *fonts; i++)
        if (snprintf(path, room, "%s/Fonts/%s", folder, fonts[i]) < (int)room &&
            fxs_file_kind(path) == FXS_FILE_REGULAR)
            result = 0;
    if (result)
        fxs_fail(message, "no font Segoe UI, Tahoma, Arial or Verdana in %s/Fonts", folder ? folder : "");
    free(folder);
    return result;
}
