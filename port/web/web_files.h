/* Included before every file of a module: what its C library does not declare. */
#ifndef FXS_WEB_FILES_H
#define FXS_WEB_FILES_H

char *realpath(const char *path, char *resolved);

#endif
