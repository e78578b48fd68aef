/* Prints the QR code of an address on a terminal. */
#include <errno.h>
#include <string.h>

#include "src/base/os_calls.h"
#include "tools/command/command.h"
#include "serve.h"

#ifdef FXS_WITH_QRENCODE
#include <qrencode.h>

enum { MARGIN = 4 };                        /* width of the QR code's blank margin in modules (ISO/IEC 18004) */

static int is_dark(const QRcode *code, int x, int y)
{
    return x >= 0 && y >= 0 && x < code->width && y < code->width && (code->data[y * code->width + x] & 1);
}

static void print_code(const QRcode *code)
{
    const int is_coloured = fxs_terminal_takes_codes(stdout);
    static const char *const blocks[] = {"\u2588", "\u2580", "\u2584", " "};
    for (int y = -MARGIN; y < code->width + MARGIN; y += 2) {
        fputs(is_coloured ? "\033[40;97m" : "", stdout);
        for (int x = -MARGIN; x < code->width + MARGIN; x++)
            fputs(blocks[2 * is_dark(code, x, y) + is_dark(code, x, y + 1)], stdout);
        puts(is_coloured ? "\033[0m" : "");
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
