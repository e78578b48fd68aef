/* What `fixsplat view --web` does for people at a terminal: a browser, and a QR code. */
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "command.h"
#include "serve.h"

/* In a process group of its own, which Ctrl-C here does not end, and without words in the terminal. */
static void run_browser(const char *address)
{
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, 0);
    signal(SIGPIPE, SIG_DFL);
    setsid();
    if (freopen("/dev/null", "r", stdin) && freopen("/dev/null", "w", stdout) && freopen("/dev/null", "w", stderr))
        execlp("xdg-open", "xdg-open", address, (char *)0);
    _exit(127);
}

/* Of two children the first ends at once, so that nobody has to wait for the second. */
void open_browser(const char *address)
{
    if (!getenv("DISPLAY") && !getenv("WAYLAND_DISPLAY"))
        return;
    const pid_t child = fork();
    if (child < 0)
        note("no browser is opened: %s", strerror(errno));
    else if (child)
        waitpid(child, 0, 0);
    else if (fork())
        _exit(0);
    else
        run_browser(address);
}

#ifdef FXS_WITH_QRENCODE
#include <qrencode.h>

enum { MARGIN = 4 };                        /* modules without ink around a code, of ISO/IEC 18004 */

static int is_dark(const QRcode *code, int x, int y)
{
    return x >= 0 && y >= 0 && x < code->width && y < code->width && (code->data[y * code->width + x] & 1);
}

/* Two rows of modules a line: white blocks on black, whatever the colours of the terminal are. */
static void print_code(const QRcode *code)
{
    static const char *const blocks[] = {"\u2588", "\u2580", "\u2584", " "};   /* light: both, the upper, the lower */
    for (int y = -MARGIN; y < code->width + MARGIN; y += 2) {
        fputs("\033[40;97m", stdout);
        for (int x = -MARGIN; x < code->width + MARGIN; x++)
            fputs(blocks[2 * is_dark(code, x, y) + is_dark(code, x, y + 1)], stdout);
        puts("\033[0m");
    }
}

int print_qr_code(const char *address)
{
    QRcode *code = QRcode_encodeString8bit(address, 0, QR_ECLEVEL_L);
    if (!code)
        return fail(-1, "%s: no QR code: %s", address, strerror(errno));
    print_code(code);
    QRcode_free(code);
    return 0;
}
#else
int print_qr_code(const char *address)
{
    (void)address;
    return -1;
}
#endif
