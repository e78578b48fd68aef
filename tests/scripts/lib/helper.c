/* helper hash FILE: the FNV-1a 64 hash of its bytes. helper peak COMMAND...: runs it, and prints its peak KiB.
   helper signal NUMBER COMMAND...: sends it when the command has begun a temporary file, and prints how that ended. */
#define _GNU_SOURCE
#include <glob.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static int hash(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint64_t value = 0xcbf29ce484222325u;
    if (!file)
        return 1;
    for (int c; (c = getc(file)) != EOF;)
        value = (value ^ (uint64_t)c) * 0x100000001b3u;
    fclose(file);
    printf("%016" PRIx64 "\n", value);
    return 0;
}

static int peak(char **command)
{
    int status;
    struct rusage usage;
    pid_t child = fork();
    if (child == 0) {
        execvp(command[0], command);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0 || getrusage(RUSAGE_CHILDREN, &usage))
        return 1;
    printf("%ld\n", usage.ru_maxrss);
    return status != 0;
}

/* A background job of a shell ignores SIGINT; this does not. */
static int end_by(int number, char **command)
{
    char pattern[64];
    int status, ended = 0;
    pid_t child = fork();
    if (child == 0) {
        signal(number, SIG_DFL);
        execvp(command[0], command);
        _exit(127);
    }
    snprintf(pattern, sizeof pattern, ".fixsplat-%ld-*.tmp", (long)child);
    for (glob_t found; !ended && glob(pattern, 0, NULL, &found); usleep(1000))
        ended = waitpid(child, &status, WNOHANG);
    if (!ended) {
        kill(child, number);
        ended = waitpid(child, &status, 0);
    }
    if (ended != child)
        return 1;
    printf(WIFSIGNALED(status) ? "signal %d\n" : "status %d\n",
           WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 3 && !strcmp(argv[1], "hash"))
        return hash(argv[2]);
    if (argc > 3 && !strcmp(argv[1], "signal"))
        return end_by(atoi(argv[2]), argv + 3);
    return argc > 2 && !strcmp(argv[1], "peak") ? peak(argv + 2) : 2;
}
