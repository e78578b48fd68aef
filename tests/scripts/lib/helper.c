/* Tools for the test scripts:
     helper hash FILE                       prints the FNV-1a 64 hash of the file
     helper peak COMMAND...                 runs COMMAND and prints its peak memory in KiB
     helper signal NUMBER COMMAND...        sends the signal once a temporary file exists; prints how COMMAND ended
     helper hang PORT COUNT COMMAND...      runs COMMAND while COUNT connections send unfinished requests */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <glob.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
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

/* Runs a command and ends it by a signal. The signal's default action is restored first, since background jobs of a
   shell ignore SIGINT. */
static int end_by(int number, char **command)
{
    int status, ended = 0;
    pid_t child = fork();
    if (child == 0) {
        signal(number, SIG_DFL);
        execvp(command[0], command);
        _exit(127);
    }
    for (glob_t found; !ended && glob(".fixsplat-*.tmp", 0, NULL, &found); usleep(1000))
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

static int hang(int port, int count, char **command)
{
    static const char begun[] = "GET / HTTP/1.1\r\nHost: localhost\r\nX: ";
    const struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port),
                                   .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const struct timeval limit = {3, 0};
    struct rlimit files;
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    for (int i = 0; i < count; i++) {
        const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        setsockopt(s, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
        if (connect(s, (const struct sockaddr *)&to, sizeof to))
            break;
        send(s, begun, sizeof begun - 1, MSG_NOSIGNAL);
    }
    const pid_t child = fork();
    int status;
    if (child == 0) {
        execvp(command[0], command);
        _exit(127);
    }
    return child < 0 || waitpid(child, &status, 0) < 0 || status != 0;
}

int main(int argc, char **argv)
{
    if (argc == 3 && !strcmp(argv[1], "hash"))
        return hash(argv[2]);
    if (argc > 3 && !strcmp(argv[1], "signal"))
        return end_by(atoi(argv[2]), argv + 3);
    if (argc > 4 && !strcmp(argv[1], "hang"))
        return hang(atoi(argv[2]), atoi(argv[3]), argv + 4);
    return argc > 2 && !strcmp(argv[1], "peak") ? peak(argv + 2) : 2;
}
