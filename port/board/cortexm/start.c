/* Start of a Cortex-M processor: vector table, start-up code and clock. */
#include "firmware.h"

#include <stdint.h>
#include <string.h>

#include "console.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
/* registers of the system timer: "Armv7-M Architecture Reference Manual", B3.3 */
#define SYST_CSR REGISTER(0xe000e010)
#define SYST_RVR REGISTER(0xe000e014)
#define SYST_CVR REGISTER(0xe000e018)
#define ICSR REGISTER(0xe000ed04)
#define CPACR REGISTER(0xe000ed88)
#define CLOCK_TICKS 0x1000000u
#define PENDSTSET (1u << 26)

extern uint32_t board_stack[], board_stack_end[], board_data[], board_data_end[], board_bss[], board_bss_end[];
extern const uint32_t board_data_in_flash[];

static volatile uint32_t wraps;

static void count_wrap(void)
{
    wraps++;
}

static __attribute__((used)) void say_fault(void)
{
    console_text("error: a fault of the processor\n");
    console_exit(3);
}

/* Handles a fault of the processor. Resets the stack pointer first, because a stack overflow may have caused the
   fault. */
static __attribute__((naked)) void fault(void)
{
    __asm__("ldr r0, =board_stack_end\n\tmov sp, r0\n\tb say_fault");
}

void board_start(void);
void board_start(void)
{
#if defined(__ARM_FEATURE_MVE)
    CPACR |= 15u << 20;
    __asm__ volatile("dsb\n\tisb");
#endif
    memcpy(board_data, board_data_in_flash, (size_t)((char *)board_data_end - (char *)board_data));
    memset(board_bss, 0, (size_t)((char *)board_bss_end - (char *)board_bss));
    SYST_RVR = CLOCK_TICKS - 1;
    SYST_CVR = 0;
    SYST_CSR = 7;
    console_exit(main());
}

/* Vector table of a Cortex-M: initial stack pointer, then handlers of the 15 standard exceptions, from reset to
   SysTick. */
__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {board_stack_end, {board_start, fault, fault, fault, fault, fault, fault, 0, 0, 0, fault, fault, 0, fault,
                               count_wrap}};

/* Returns the time of the system timer. Reads again if the timer wraps during the reads. */
uint64_t board_clock(void *unused)
{
    uint32_t before, ticks, pending;
    (void)unused;
    do {
        before = wraps;
        ticks = CLOCK_TICKS - 1 - SYST_CVR;
        pending = ICSR & PENDSTSET;
    } while (before != wraps || pending);
    return ((uint64_t)before * CLOCK_TICKS + ticks) * 1000 / (BOARD_HZ / 1000000);
}

uint32_t board_stack_used(void)
{
    const uint32_t *at = board_stack;
    while (at < board_stack_end && *at == BOARD_UNUSED)
        at++;
    return (uint32_t)((const char *)board_stack_end - (const char *)at);
}

void board_stack_mark(void)
{
    uint32_t *const here = __builtin_frame_address(0);
    for (volatile uint32_t *at = board_stack; at < here - 16; at++)
        *at = BOARD_UNUSED;
}

uint32_t board_stack_bytes(void)
{
    return (uint32_t)((const char *)board_stack_end - (const char *)board_stack);
}
