/* A small static web server on libmicrohttpd. It serves the files of one folder, and other files under given names.
 * Supports GET, HEAD, single ranges, ETags and TLS.
 *
 * Responses have the headers Cross-Origin-Opener-Policy and Cross-Origin-Embedder-Policy, which browsers require for
 * threads. The Host header must be a numeric address, localhost, options.host or, unless the server is local, this
 * machine's name. */
#ifndef FXS_HTTP_SERVER_H
#define FXS_HTTP_SERVER_H

#include <fixsplat/internal/message.h>

typedef struct fxs_http_file {
    const char *name;                       /* path in the URL, such as "/scenes/0/room.ply" */
    /* path of the served file if `open` is null, never a symbolic link; null: `descriptor` is served */
    const char *path;
    int descriptor;                         /* open file, served from its beginning, if `open` and `path` are null */
    /* Returns a descriptor of a file that may change, at each request; -1: no such file. The server closes the
       descriptor. `open` may be null. */
    int (*open)(void *self);
    void *self;
} fxs_http_file;

/* What a server serves. The struct must stay in place until the server is closed. */
typedef struct fxs_http_site {
    /* folder of files to serve; their names have only letters, digits and . _ -, and no part begins with a dot */
    const char *folder;
    const fxs_http_file *files;
    int file_count;
    const char *const *starts;              /* targets of the short URL paths "/", "/1", "/2" and so on */
    int start_count;
} fxs_http_site;

typedef struct fxs_http_options {
    /* numeric IPv4 or IPv6 address to listen on; 0.0.0.0 or :: means all addresses of this machine */
    const char *address;
    uint16_t port;                          /* TCP port; 0: any free port */
    const char *certificate, *key;          /* paths of .pem files for TLS; null: no TLS */
    const char *host;                       /* additional name that the Host header of requests may have; null: none */
} fxs_http_options;

typedef struct fxs_http_server fxs_http_server;

int fxs_http_has_tls(void);

/* Starts a server on a thread of its own, which receives no signals. Returns 0, or an error and a message. */
int fxs_http_open(fxs_http_server **server, const fxs_http_site *site, const fxs_http_options *options,
                  fxs_message *message);

/* Calls the function `each` with a URL such as "http://HOST:PORT" for each address of the server. is_local: 1 if only
   this machine can reach the address. */
void fxs_http_each_address(const fxs_http_server *server, void (*each)(void *self, const char *address, int is_local),
                           void *self);

/* Stops the server at once, even while it sends responses. */
void fxs_http_close(fxs_http_server *server);

#endif
