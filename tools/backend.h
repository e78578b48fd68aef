/* The back ends of render and bench, by name: cpu, auto (the same), gles, gles-quads, osmesa. */
#ifndef BACKEND_H
#define BACKEND_H

#include "../port/files/message.h"
#include "../src/fixsplat.h"

typedef struct backend backend;

/* Whether there is a back end of that name, here or elsewhere. */
int backend_known(const char *name);

/* Opens one on this thread and enters it into *config; null for the processor. Returns 0, or -1 and why not. */
int backend_open(backend **out, const char *name, fxs_config *config, fxs_message *message);

/* The device's own time for the last frame; 0 where it is not known. */
uint64_t backend_nanoseconds(const backend *b);

void backend_close(backend *b);

/* Prints each, and the device that it is on or why it is not here. */
void backend_list(void);

#endif
