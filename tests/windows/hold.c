/* hold FILE: locks a file against other writers until standard input ends. Prints "held" once the file is locked. */
#include <stdio.h>
#include <windows.h>

int main(int argc, char **argv)
{
    HANDLE file = argc == 2 ? CreateFileA(argv[1], GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL)
                            : INVALID_HANDLE_VALUE;
    if (file == INVALID_HANDLE_VALUE)
        return 1;
    puts("held");
    fflush(stdout);
    while (getchar() != EOF)
        ;
    return 0;
}
