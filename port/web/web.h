/* What the two modules share with fixsplat.js. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#define EXPORT(name) __attribute__((export_name(#name)))

/* Numbers go in and come out at one place, in the order that each function says; an object with 8 crops has 71. */
enum { NUMBERS = 80 };

#endif
