/* Functions and memory that a board provides to the firmware. */
#ifndef FXS_FIRMWARE_H
#define FXS_FIRMWARE_H

#include <stddef.h>
#include <stdint.h>

#define BOARD_UNUSED 0x5a5a5a5au               /* value of unused words of the stack */

uint64_t board_clock(void *unused);

/* Return the size of the stack and the largest use since board_stack_mark, in bytes. */
uint32_t board_stack_bytes(void);
void board_stack_mark(void);
uint32_t board_stack_used(void);

extern unsigned char board_memory[], board_memory_end[];
extern const unsigned char board_scene[], board_scene_end[];

int main(void);

#endif
