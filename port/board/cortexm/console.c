/* Semihosting: a special instruction stops the processor, and the debugger or emulator executes the operation whose
   number is in register r0. */
#include "console.h"

#include <string.h>

enum { SYS_OPEN = 0x01, SYS_WRITE0 = 0x04, SYS_WRITE = 0x05, SYS_GET_CMDLINE = 0x15, SYS_EXIT_EXTENDED = 0x20 };
#define MODE_WB 5
#define ADP_STOPPED_APPLICATION_EXIT 0x20026u

#if __ARM_ARCH_PROFILE == 'M'
#define STOP "bkpt 0xab"
#else
#define STOP "svc 0x123456"        /* semihosting instruction of processors that are not Cortex-M, in ARM state */
#endif

static int semihosting(int operation, const void *argument)
{
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile(STOP : "+r"(r0) : "r"(r1) : "memory", "lr");
    return r0;
}

void console_text(const char *text)
{
    semihosting(SYS_WRITE0, text);
}

void console_number(uint64_t number)
{
    char digits[21];
    int at = (int)sizeof digits - 1;
    digits[at] = 0;
    do
        digits[--at] = (char)('0' + number % 10);
    while (number /= 10);
    console_text(digits + at);
}

void console_hex(uint64_t number)
{
    char digits[17];
    for (int i = 0; i < 16; i++)
        digits[i] = "0123456789abcdef"[number >> (60 - 4 * i) & 15];
    digits[16] = 0;
    console_text(digits);
}

void console_command(char *line, int bytes)
{
    struct { char *line; int bytes; } block = {line, bytes};
    line[0] = 0;
    if (semihosting(SYS_GET_CMDLINE, &block))
        line[0] = 0;
}

uint32_t console_option(const char *line, const char *name, uint32_t otherwise)
{
    const size_t length = strlen(name);
    while ((line = strchr(line, ' ')) != 0) {
        line++;
        if (strncmp(line, name, length) || line[length] != '=')
            continue;
        uint32_t value = 0;
        for (line += length + 1; *line >= '0' && *line <= '9'; line++)
            value = value * 10 + (uint32_t)(*line - '0');
        return value;
    }
    return otherwise;
}

int console_open(const char *name)
{
    const struct { const char *name; int mode; size_t length; } block = {name, MODE_WB, strlen(name)};
    return semihosting(SYS_OPEN, &block);
}

int console_write(int file, const void *bytes, uint32_t count)
{
    const struct { int file; const void *bytes; uint32_t count; } block = {file, bytes, count};
    return semihosting(SYS_WRITE, &block);
}

void console_exit(int status)
{
    const uint32_t block[2] = {ADP_STOPPED_APPLICATION_EXIT, (uint32_t)status};
    semihosting(SYS_EXIT_EXTENDED, block);
    for (;;)
        ;
}
