/* Console of a board: text goes to a debugger or an emulator ("Semihosting for AArch32 and AArch64", Arm Ltd.). */
#ifndef FXS_CONSOLE_H
#define FXS_CONSOLE_H

#include <stdint.h>

void console_text(const char *text);
void console_number(uint64_t number);
void console_hex(uint64_t number);             /* prints 16 hexadecimal digits */

/* Writes the program's command line to `line`, which has room for `bytes` bytes. An empty string means that no command
   line exists. */
void console_command(char *line, int bytes);

/* Finds a word name=NUMBER in a command line and returns the number. Returns `otherwise` if the word is missing. */
uint32_t console_option(const char *line, const char *name, uint32_t otherwise);

/* console_open creates an empty file on the computer with the debugger, and returns a negative number on failure.
   console_write returns the number of bytes not written. */
int console_open(const char *name);
int console_write(int file, const void *bytes, uint32_t count);

void console_exit(int status);

#endif
