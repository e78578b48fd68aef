/* Lets Explorer open scenes by a double click, for this user, by registry keys below HKEY_CURRENT_USER. */
#include "win32.h"

#include <shlobj.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>

enum { PATH_MOST = 4096 };

#define CLASSES L"Software\\Classes\\"
#define CLASS L"fixsplat.scene"

static const wchar_t *const endings[] = {CLASSES L".fxs", CLASSES L".ply"};

static LSTATUS set(const wchar_t *key, const wchar_t *name, const wchar_t *text)
{
    return RegSetKeyValueW(HKEY_CURRENT_USER, key, name, REG_SZ, text, (DWORD)((wcslen(text) + 1) * sizeof *text));
}

/* True if files of this ending open with no other program's class. */
static int is_ours_or_free(const wchar_t *key)
{
    wchar_t text[64];
    DWORD size = sizeof text;
    const LSTATUS error = RegGetValueW(HKEY_CURRENT_USER, key, NULL, RRF_RT_REG_SZ, NULL, text, &size);
    return error == ERROR_FILE_NOT_FOUND || (!error && (!*text || !wcscmp(text, CLASS)));
}

static LSTATUS add(const wchar_t *viewer)
{
    wchar_t command[PATH_MOST], list[64];
    LSTATUS error = 0;
    swprintf(command, PATH_MOST, L"\"%ls\" \"%%1\"", viewer);
    if ((error = set(CLASSES CLASS, NULL, L"Gaussian splatting scene")) != 0 ||
        (error = set(CLASSES CLASS L"\\DefaultIcon", NULL, viewer)) != 0 ||
        (error = set(CLASSES CLASS L"\\shell\\open\\command", NULL, command)) != 0)
        return error;
    for (int i = 0; i < 2 && !error; i++) {
        swprintf(list, 64, L"%ls\\OpenWithProgids", endings[i]);
        error = set(list, CLASS, L"");
        if (!error && is_ours_or_free(endings[i]))
            error = set(endings[i], NULL, CLASS);
    }
    return error;
}

static LSTATUS take_away(void)
{
    wchar_t list[64];
    for (int i = 0; i < 2; i++) {
        swprintf(list, 64, L"%ls\\OpenWithProgids", endings[i]);
        RegDeleteKeyValueW(HKEY_CURRENT_USER, list, CLASS);
        if (is_ours_or_free(endings[i]))
            RegDeleteKeyValueW(HKEY_CURRENT_USER, endings[i], NULL);
    }
    const LSTATUS error = RegDeleteTreeW(HKEY_CURRENT_USER, CLASSES CLASS);
    return error == ERROR_FILE_NOT_FOUND ? 0 : error;
}

int fxs_associate(int is_removed, fxs_message *why)
{
    wchar_t viewer[PATH_MOST];
    const DWORD length = GetModuleFileNameW(NULL, viewer, PATH_MOST - 16);
    wchar_t *ending = length && length < PATH_MOST - 16 ? wcsrchr(viewer, L'\\') : NULL;
    if (!ending)
        return fxs_fail(why, "the path of this program is too long");
    wcscpy(ending, L"\\fixsplat-view.exe");
    if (!is_removed && GetFileAttributesW(viewer) == INVALID_FILE_ATTRIBUTES)
        return fxs_fail(why, "fixsplat-view.exe, which shows scenes, is missing beside fixsplat.exe");
    const LSTATUS error = is_removed ? take_away() : add(viewer);
    SHChangeNotify(SHCNE_ASSOCCHANGED, SHCNF_IDLIST, NULL, NULL);
    return error ? fxs_fail(why, "the registry cannot be changed: error %ld", (long)error) : 0;
}
