/* A small static web server on libmicrohttpd, for the files of one folder and other files under given names.
 * Supports GET, HEAD, single ranges, ETags and TLS.
 *
 * Responses have the headers Cross-Origin-Opener-Policy and Cross-Origin-Embedder-Policy, which browsers require for
 * threads. The Host header must be a numeric address, localhost, options.host or, unless the server is local, this
 * machine's name. */
#ifndef FXS_HTTP_SERVER_H
#define FXS_HTTP_SERVER_H

#include <fixsplat/internal/message.h>

typedef struct fxs_http_file {
    const char *name;                       /* name in the URL, such as "/scenes/0/room.ply" */
    const char *path;                       /* used if open is null; must not be a symbolic link; null: use
                                               descriptor */
    int descriptor;                         /* used if open and path are null: an open file, sent from its beginning */
    int (*open)(void *self);                /* for a file that changes; may be null. Returns a descriptor for each
                                               request; -1: no such file. The server closes the descriptor */
    void *self;
} fxs_http_file;

/* The struct must stay in place until the server is closed. */
typedef struct fxs_http_site {
    const char *folder;                     /* serves names of letters, digits and . _ -, without a dot at the start
                                               of a part */
    const fxs_http_file *files;
    int file_count;
    const char *const *starts;              /* targets of the short addresses "/", "/1", "/2" and so on */
    int start_count;
} fxs_http_site;

typedef struct fxs_http_options {
    const char *address;                    /* numeric, IPv4 or IPv6; 0.0.0.0 or ::, all addresses of this machine */
    uint16_t port;                          /* 0: any free port */
    const char *certificate, *key;          /* .pem files for TLS; null: no TLS */
    const char *host;                       /* additional name that requests may use; null: none */
} fxs_http_options;

typedef struct fxs_http_server fxs_http_server;

int fxs_http_has_tls(void);

/* Starts a server on its own thread, which receives no signals. Returns 0, or an error and a message. */
int fxs_http_open(fxs_http_server **server, const fxs_http_site *site, const fxs_http_options *options,
                  fxs_message *message);

/* Calls `each` with a URL such as "http://HOST:PORT" for each address of the server. is_local: only this machine can
   reach the address. */
void fxs_http_each_address(const fxs_http_server *server, void (*each)(void *self, const char *address, int is_local),
                           void *self);

/* Stops the server at once, also during responses. */
void fxs_http_close(fxs_http_server *server);

#endif
