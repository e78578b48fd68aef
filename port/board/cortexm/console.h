/* A board's console: what a debugger or an emulator shows by ARM's semihosting ("Semihosting for AArch32 and AArch64",
 * Arm Ltd.). */
#ifndef FXS_CONSOLE_H
#define FXS_CONSOLE_H

#include <stdint.h>

void console_text(const char *text);
void console_number(uint64_t number);
void console_hex(uint64_t number);             /* 16 digits */

/* What the program was called with: words apart by blanks, the first its name; "" where there is nothing. Into
   `bytes` bytes. */
void console_command(char *line, int bytes);

/* The value of the word name=VALUE, a number, in such a line; or `otherwise`. */
uint32_t console_option(const char *line, const char *name, uint32_t otherwise);

/* Ends the program: 0 for success. */
void console_exit(int status);

#endif
