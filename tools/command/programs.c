#include "programs.h"

#include <errno.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "command.h"

#ifdef FXS_WITH_SDL
const separate_program window_program = {"-view", "SDL2"};
#else
const separate_program window_program = {"", "SDL2"};
#endif
#ifdef FXS_WITH_MICROHTTPD
const separate_program server_program = {"-web", "libmicrohttpd"};
#else
const separate_program server_program = {"", "libmicrohttpd"};
#endif

#ifdef _WIN32
#define EXE ".exe"
#else
#define EXE ""
#endif

int run_separate(const separate_program *program, const char *shown, char **argv)
{
    char path[4096];
    if (!*program->ending)
        return fail(EXIT_FAILED, "%s: cannot be shown: this program was built without %s", shown, program->library);
    fxs_program_path(path, sizeof path - sizeof "-view");
    if (!*path)
        strcpy(path, "fixsplat");
    strcat(path, program->ending);
    fxs_program_become(path, argv);
    return fail(EXIT_FAILED, "%s: cannot be shown: %s" EXE ": %s", shown, path, strerror(errno));
}
