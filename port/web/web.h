/* What the two modules share with fixsplat.js. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#include <stdint.h>

#define EXPORT(name) __attribute__((export_name(#name)))

/* Numbers go in and come out at one place, in the order that each function says; an object with 8 crops has 71. */
enum { NUMBERS = 80 };

/* Of pool.c; null in a module without it. */
__attribute__((weak)) void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument,
                                       uint32_t jobs);

#endif
