/* What the two modules share with fixsplat.js. */
#ifndef FXS_WEB_H
#define FXS_WEB_H

#define EXPORT(name) __attribute__((export_name(#name)))

/* Where numbers go in and come out, in the order that each function says. */
enum { NUMBERS = 64 };

#endif
