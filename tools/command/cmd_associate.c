/* fixsplat associate: opens scenes by a double click. */
#include <stdlib.h>

#include "src/base/os_calls.h"
#include "command.h"
#include "command_line.h"

typedef struct associate_options {
    int is_removed;
} associate_options;

#define OPTIONS associate_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"remove", 0, FLAG(is_removed), .help = "undo what associate did"},
    {0}
};

static int run(int argc, char **argv)
{
    associate_options o = {0};
    fxs_message why;
    if (take_options(&command_associate, &o, argc, argv))
        return EXIT_USAGE;
    if (optind != argc)
        return fail(EXIT_USAGE, "associate takes no '%s'; see: fixsplat associate --help", argv[optind]);
    if (fxs_associate(o.is_removed, &why))
        return fail(EXIT_FAILED, "associate: %s", why.text);
    note(o.is_removed ? ".fxs and .ply files no longer open in fixsplat's viewer"
                      : ".fxs and .ply files open in fixsplat's viewer; to undo it: fixsplat associate --remove");
    return EXIT_OK;
}

const command command_associate = {
    "associate", "opens .fxs and .ply files by a double click", run,
    "Usage: fixsplat associate [--remove]\n\n"
    "Lets this user open .fxs and .ply files in the viewer by a double click. On Windows, it sets keys below\n"
    "HKEY_CURRENT_USER\\Software\\Classes; a program that already opens .ply files keeps them, and fixsplat joins\n"
    "the list of Open with. On Linux, it adds file types and a desktop entry by xdg-mime. Run it again if fixsplat\n"
    "moves to another folder.\n",
    0,
    "  $ fixsplat associate\n"
    "  $ fixsplat associate --remove\n",
    {{own_rows, 0}, COMMON_TABLE}
};
