/* What the parts of fixsplat-web share. */
#ifndef SERVE_H
#define SERVE_H

#include <stddef.h>
#include <stdio.h>

#include <fixsplat/camera_file.h>

/* The descriptor, that no program run from here has, of what was written to a file of tmpfile, which it closes. Returns
   -1, with errno, where that or the file (null) failed. */
int keep_written(FILE *file);

/* The same of bytes. */
int keep(const void *data, size_t bytes);

/* `fixsplat fit --preview`: returns its exit status. */
int serve_fit(int argc, char **argv);

#endif
