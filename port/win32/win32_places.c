/* Where a user's files and the fonts of the system lie. */
#include "win32.h"

#include <stdlib.h>

#include <fixsplat/message.h>

enum { PATH_MOST = 4096 };

int fxs_state_path(const char *name, int is_written, char *path, size_t room)
{
    wchar_t wide[PATH_MOST];
    fxs_message unused;                    /* what cannot be written there says so */
    const DWORD size = GetEnvironmentVariableW(L"APPDATA", wide, PATH_MOST);
    char *folder = size && size < PATH_MOST ? win32_narrow_path(wide) : NULL;
    const int length = folder ? snprintf(path, room, "%s/fixsplat/%s", folder, name) : -1;
    if (is_written && length >= 0 && snprintf(path, room, "%s/fixsplat", folder) < (int)room) {
        fxs_folder_make(path, &unused);
        snprintf(path, room, "%s/fixsplat/%s", folder, name);
    }
    free(folder);
    return length < 0 || (size_t)length >= room ? -1 : 0;
}

int fxs_font_find(char *path, size_t room, fxs_message *message)
{
    static const char *const fonts[] = {"segoeui.ttf", "tahoma.ttf", "arial.ttf", "verdana.ttf"};
    wchar_t wide[PATH_MOST];
    const UINT size = GetSystemWindowsDirectoryW(wide, PATH_MOST);
    char *folder = size && size < PATH_MOST ? win32_narrow_path(wide) : NULL;
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
