/* A small static server (libmicrohttpd): the files of one folder, and others under names of their own. Of the rest of
 * the file system there is nothing. GET and HEAD, ranges, ETags; every answer has the headers that isolate a page
 * (Cross-Origin-Opener-Policy and -Embedder-Policy), which threads in a browser need. Files are sent as they are on the
 * disk when they are asked for, never as a whole in memory. */
#ifndef FXS_HTTP_SERVER_H
#define FXS_HTTP_SERVER_H

#include <fixsplat/message.h>

typedef struct fxs_http_file {
    const char *name;                       /* "/scenes/0/room.ply" */
    const char *path;                       /* or null: */
    int descriptor;                         /* of a file that stays open, sent from its beginning */
} fxs_http_file;

/* What is served; it stays where it is until the server is closed. */
typedef struct fxs_http_site {
    const char *folder;                     /* parts of names have letters, digits and . _ -, and begin with no point */
    const fxs_http_file *files;
    int file_count;
    const char *const *starts;              /* addresses that "/" (the first), "/1", "/2" and so on lead to */
    int start_count;
} fxs_http_site;

typedef struct fxs_http_options {
    const char *address;                    /* of IPv4 or IPv6, in digits; 0.0.0.0 and ::, all of this machine's */
    uint16_t port;                          /* 0: any that is free */
    const char *certificate, *key;          /* .pem files: https; or null */
} fxs_http_options;

typedef struct fxs_http_server fxs_http_server;

/* Serves from a thread of its own, which has the caller's signal mask. Returns 0, or an error and a message. */
int fxs_http_open(fxs_http_server **server, const fxs_http_site *site, const fxs_http_options *options,
                  fxs_message *message);

/* Calls `each` with "http://HOST:PORT" for each address that the server is reached at: those of this machine's
   interfaces where it has them all. `is_local`: from this machine alone. */
void fxs_http_each_address(const fxs_http_server *server, void (*each)(void *self, const char *address, int is_local),
                           void *self);

/* Ends it at once, whatever is being sent. */
void fxs_http_close(fxs_http_server *server);

#endif
