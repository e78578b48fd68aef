/* The console of a board, which a debugger or an emulator provides by ARM's semihosting ("Semihosting for AArch32 and
 * AArch64", Arm Ltd.). */
#ifndef FXS_CONSOLE_H
#define FXS_CONSOLE_H

#include <stdint.h>

void console_text(const char *text);
void console_number(uint64_t number);
void console_hex(uint64_t number);             /* 16 digits */

/* Writes the program's command line, its name and arguments separated by blanks, to `bytes` bytes; "" where there is
   none. */
void console_command(char *line, int bytes);

/* The number in the word name=NUMBER of such a line; else `otherwise`. */
uint32_t console_option(const char *line, const char *name, uint32_t otherwise);

/* Opens a file of the host, empty, for writing; negative where it cannot. Writes to it: how many bytes were not. */
int console_open(const char *name);
int console_write(int file, const void *bytes, uint32_t count);

/* Ends the program: 0 for success. */
void console_exit(int status);

#endif
