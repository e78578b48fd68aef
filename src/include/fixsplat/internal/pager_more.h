/* Sources of bytes for a pager (which streams a scene), and more of its state, for the library's ports and the
   command. */
#ifndef FXS_INTERNAL_PAGER_MORE_H
#define FXS_INTERNAL_PAGER_MORE_H

#include <fixsplat/pager.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a source for a pager that reads a file. If the file is modified while it is open, all later reads fail. */
FXS_EXPERIMENTAL int fxs_pager_file(const char *path, fxs_pager_source *source, fxs_message *message);

/* Returns 1 if a path is an address that begins with http:// or https://. */
FXS_EXPERIMENTAL int fxs_pager_is_url(const char *path);

/* Makes a source for a pager that requests byte ranges from a server (RFC 9110, section 14) with libcurl, which is
   loaded at its first use. A server that ignores ranges, changes the file during the session or sends another answer is
   an error. Errors: FXS_ERR_FILE; FXS_ERR_UNSUPPORTED without libcurl. */
FXS_EXPERIMENTAL int fxs_pager_url(const char *url, fxs_pager_source *source, fxs_message *message);

/* Returns the bytes of the pager's scene before its rows (Gaussian codes), including its header, for fxs_view_of_start
   and similar functions. */
FXS_EXPERIMENTAL const void *fxs_pager_head(const fxs_pager *pager);

/* Returns the capacity of the pager's pool, the memory for loaded chunks, in chunks; 0 for a null pager. */
FXS_EXPERIMENTAL uint32_t fxs_pager_room(const fxs_pager *pager);

#ifdef __cplusplus
}
#endif

#endif
