/* line FILE: runs the first line of a file as a command line, with unchanged quotes. Exits with the command's
   status. */
#include <stdio.h>
#include <string.h>
#include <windows.h>

int main(int argc, char **argv)
{
    STARTUPINFOA how = {.cb = sizeof how};
    PROCESS_INFORMATION started;
    char line[4096];
    DWORD status;
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    const size_t size = file ? fread(line, 1, sizeof line - 1, file) : 0;
    line[size] = 0;
    line[strcspn(line, "\n")] = 0;
    if (!size || !CreateProcessA(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &how, &started))
        return 99;
    WaitForSingleObject(started.hProcess, INFINITE);
    GetExitCodeProcess(started.hProcess, &status);
    return (int)status;
}
