/* Lets the desktop open scenes by a double click, for this user, by xdg-mime and a desktop entry. The types and the
   entry are files that `make install` puts into share, beside the program's folder bin. */
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "src/base/files_internal.h"
#include "src/base/output_internal.h"

#define ENTRY "applications/fixsplat-view.desktop"

static void ignore(void *argument, const char *data, size_t size)
{
    (void)argument, (void)data, (void)size;
}

static int xdg_mime(const char *const *arguments, fxs_message *why)
{
    const int status = fxs_program_run(arguments, stderr, ignore, 0);
    return status == FXS_PROGRAM_MISSING ? fxs_fail(why, "needs xdg-mime: sudo apt install xdg-utils")
         : status ? fxs_fail(why, "xdg-mime %s failed", arguments[1]) : 0;
}

/* Stores the folder above the program's folder. */
static int find_prefix(char *prefix, size_t room, fxs_message *why)
{
    fxs_program_path(prefix, room);
    for (int i = 0; i < 2 && strchr(prefix, '/'); i++)
        *strrchr(prefix, '/') = 0;
    if (strpbrk(prefix, "\"\\$`%\n"))
        return fxs_fail(why, "%s: a desktop entry cannot name a folder with one of \" \\ $ ` %% in its name", prefix);
    return 0;
}

/* Stores the path of the user's desktop entry, and makes its folder. */
static int find_entry(char *path, size_t room, fxs_message *why)
{
    const char *data = getenv("XDG_DATA_HOME"), *home = getenv("HOME");
    const int has_data = data && *data == '/';
    if (!has_data && !(home && *home == '/'))
        return fxs_fail(why, "the environment has no HOME");
    const int length = snprintf(path, room, "%s%s/" ENTRY, has_data ? data : home, has_data ? "" : "/.local/share");
    if (length < 0 || (size_t)length >= room)
        return fxs_fail(why, "HOME is too long");
    for (char *slash = path; (slash = strchr(slash + 1, '/')) != 0; *slash = '/') {
        *slash = 0;
        mkdir(path, 0700);
    }
    return 0;
}

/* Copies the installed desktop entry, with whole paths of program and icon. */
static int copy_entry(const char *prefix, const char *to, fxs_message *why)
{
    char from[PATH_MAX + 64], line[256];
    fxs_output output;
    FILE *in;
    snprintf(from, sizeof from, "%s/share/" ENTRY, prefix);
    if (fxs_file_open(from, &in, 0, why))
        return FXS_ERR_FILE;
    int error = fxs_output_open(&output, to, 0, why);
    while (!error && fgets(line, sizeof line, in)) {
        if (!strncmp(line, "TryExec=", 8))
            fprintf(output.file, "TryExec=%s/bin/fixsplat-view\n", prefix);
        else if (!strncmp(line, "Exec=", 5))
            fprintf(output.file, "Exec=\"%s/bin/fixsplat\" view %%F\n", prefix);
        else if (!strncmp(line, "Icon=", 5))
            fprintf(output.file, "Icon=%s/share/icons/hicolor/scalable/apps/fixsplat.svg\n", prefix);
        else
            fputs(line, output.file);
    }
    fclose(in);
    return error ? error : fxs_output_close(&output, why);
}

int fxs_associate(int is_removed, fxs_message *why)
{
    char prefix[PATH_MAX], types[PATH_MAX + 64], entry[PATH_MAX];
    if (find_prefix(prefix, sizeof prefix, why) || find_entry(entry, sizeof entry, why))
        return FXS_ERR_FILE;
    snprintf(types, sizeof types, "%s/share/mime/packages/fixsplat.xml", prefix);
    if (fxs_file_kind(types) != FXS_FILE_REGULAR)
        return fxs_fail(why, "%s is missing: start the fixsplat of a package, or of make install", types);
    const char *const change[] = {"xdg-mime", is_removed ? "uninstall" : "install", "--mode", "user", "--novendor",
                                  types, 0};
    const char *const prefer[] = {"xdg-mime", "default", strrchr(ENTRY, '/') + 1, "model/x-fixsplat", "model/x-ply", 0};
    if (is_removed) {
        if (fxs_file_remove(entry) && errno != ENOENT)
            return fxs_fail(why, "%s: %s", entry, strerror(errno));
        return xdg_mime(change, why);
    }
    return xdg_mime(change, why) || copy_entry(prefix, entry, why) || xdg_mime(prefer, why) ? FXS_ERR_FILE : 0;
}
