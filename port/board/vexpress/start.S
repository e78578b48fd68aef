/* Cortex-A9 of the Versatile Express: start-up code, in ARM state, with caches and MMU off. */
    .arm
    .section .start, "ax"
    .global board_start
board_start:
    ldr sp, =board_stack_end
    ldr r0, =vectors
    mcr p15, 0, r0, c12, c0, 0     /* VBAR: "ARM Architecture Reference Manual ARMv7-A", B4.1.156 */
    ldr r0, =board_bss
    ldr r1, =board_bss_end
    mov r2, #0
1:  cmp r0, r1
    strlo r2, [r0], #4
    blo 1b
    bl main
    bl console_exit

    .balign 32
vectors:
    b board_start
    .rept 7
    b fault
    .endr

fault:
    ldr sp, =board_stack_end
    b board_fault
