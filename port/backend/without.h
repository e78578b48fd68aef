/* Error message of a back end (a way to render) that was built without the headers of some Debian packages. */
#ifndef FXS_WITHOUT_H
#define FXS_WITHOUT_H

#ifdef _WIN32
#define FXS_WITHOUT_HEADERS(packages) "not in the build for Windows"
#else
#define FXS_WITHOUT_HEADERS(packages) "built without the headers in " packages
#endif

#endif
