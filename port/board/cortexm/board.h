/* Functions and memory that a board provides to the firmware. */
#ifndef FXS_BOARD_H
#define FXS_BOARD_H

#include <stddef.h>
#include <stdint.h>

#define BOARD_UNUSED 0x5a5a5a5au               /* marks unused words of the stack */

/* Returns the time in nanoseconds, as an fxs_clock_fn. */
uint64_t board_clock(void *unused);

/* Return the size of the stack and the largest use since board_stack_mark, in bytes. board_stack_mark marks the
   stack below the caller as unused. */
uint32_t board_stack_bytes(void);
void board_stack_mark(void);
uint32_t board_stack_used(void);

/* From the linker script: free RAM, and the scene in flash. */
extern unsigned char board_memory[], board_memory_end[];
extern const unsigned char board_scene[], board_scene_end[];

int main(void);

#endif
