/* What the firmware is given by the board it runs on. */
#ifndef FXS_BOARD_H
#define FXS_BOARD_H

#include <stddef.h>
#include <stdint.h>

#define BOARD_UNUSED 0x5a5a5a5au               /* on the stack */

/* Nanoseconds: an fxs_clock_fn. */
uint64_t board_clock(void *unused);

/* The stack's bytes; marks those below the caller as unused; how many were used since at most. */
uint32_t board_stack_bytes(void);
void board_stack_mark(void);
uint32_t board_stack_used(void);

/* The linker script's: RAM that nothing else has, and the scene in flash. */
extern unsigned char board_memory[], board_memory_end[];
extern const unsigned char board_scene[], board_scene_end[];

int main(void);

#endif
