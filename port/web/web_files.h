/* Declarations that the module's C library lacks; included before every file of a module. */
#ifndef FXS_WEB_FILES_H
#define FXS_WEB_FILES_H

char *realpath(const char *path, char *resolved);

#endif
