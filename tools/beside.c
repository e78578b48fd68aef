#include "beside.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "command.h"

#ifdef FXS_WITH_SDL
const beside_program window_program = {"-view", "SDL2"};
#else
const beside_program window_program = {"", "SDL2"};
#endif
#ifdef FXS_WITH_MICROHTTPD
const beside_program server_program = {"-web", "libmicrohttpd"};
#else
const beside_program server_program = {"", "libmicrohttpd"};
#endif

int run_beside(const beside_program *program, const char *shown, char **argv)
{
    char path[4096] = "fixsplat";
    if (!*program->ending)
        return fail(EXIT_FAILED, "%s: cannot be shown: this program was built without %s", shown, program->library);
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - sizeof "-view");
    strcpy(path + (length > 0 ? (size_t)length : strlen(path)), program->ending);
    execvp(path, argv);
    return fail(EXIT_FAILED, "%s: cannot be shown: %s: %s", shown, path, strerror(errno));
}
