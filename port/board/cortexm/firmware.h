/* Functions and memory that each board provides to the firmware program. */
#ifndef FXS_FIRMWARE_H
#define FXS_FIRMWARE_H

#include <stddef.h>
#include <stdint.h>

#define BOARD_UNUSED 0x5a5a5a5au   /* pattern that fills the unused part of the stack, to measure the stack's use */

uint64_t board_clock(void *unused);

/* board_stack_bytes returns the size of the stack in bytes. board_stack_used returns the most bytes used since
   board_stack_mark. */
uint32_t board_stack_bytes(void);
void board_stack_mark(void);
uint32_t board_stack_used(void);

extern unsigned char board_memory[], board_memory_end[];
extern const unsigned char board_scene[], board_scene_end[];

int main(void);

#endif
