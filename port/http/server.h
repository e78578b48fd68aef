/* A small static server (libmicrohttpd) for the files of one folder and for other files under given names; it serves
 * nothing else. It supports GET, HEAD, single ranges, ETags, and https if libmicrohttpd has TLS. Every answer has the
 * headers Cross-Origin-Opener-Policy and Cross-Origin-Embedder-Policy, because browsers allow threads only in isolated
 * pages. Each request sends the current contents of the file from the disk. Page files of 1 KiB to 8 MiB are compressed
 * once and kept, for clients that accept gzip. The Host header of a request must be a numeric address, localhost,
 * options.host or, if other machines can reach the server, this machine's name; other requests are refused. */
#ifndef FXS_HTTP_SERVER_H
#define FXS_HTTP_SERVER_H

#include <fixsplat/internal/message.h>

typedef struct fxs_http_file {
    const char *name;                       /* name in the URL: "/scenes/0/room.ply" */
    const char *path;                       /* used if open is null; must not be a symbolic link. Null: use
                                               descriptor */
    int descriptor;                         /* used if open and path are null: an open file, sent from its beginning */
    int (*open)(void *self);                /* for a file that changes; or null. Called for each request, on the
                                               server's thread. Returns a descriptor that the answer closes, or -1 if no
                                               such file exists */
    void *self;                             /* argument of open */
} fxs_http_file;

/* The files to serve; must not move until the server is closed. */
typedef struct fxs_http_site {
    const char *folder;                     /* its files have names of letters, digits and . _ -, without a dot at the
                                               start of a part */
    const fxs_http_file *files;
    int file_count;
    const char *const *starts;              /* targets of the short addresses "/", "/1", "/2" and so on */
    int start_count;
} fxs_http_site;

typedef struct fxs_http_options {
    const char *address;                    /* numeric, IPv4 or IPv6; 0.0.0.0 or ::, all addresses of this machine */
    uint16_t port;                          /* 0: any free port */
    const char *certificate, *key;          /* .pem files, for https; or null */
    const char *host;                       /* additional name that requests may use; or null */
} fxs_http_options;

typedef struct fxs_http_server fxs_http_server;

/* Returns 1 if libmicrohttpd has TLS, so that certificates can be used, else 0. */
int fxs_http_has_tls(void);

/* Starts a server on its own thread, which receives no signals. Returns 0, or an error and a message. */
int fxs_http_open(fxs_http_server **server, const fxs_http_site *site, const fxs_http_options *options,
                  fxs_message *message);

/* Calls `each` with "http://HOST:PORT" (or https) for each address of the server. If it listens on all addresses, that
   is one call per interface that is up. `is_local`: only this machine can reach the address. */
void fxs_http_each_address(const fxs_http_server *server, void (*each)(void *self, const char *address, int is_local),
                           void *self);

/* Stops the server at once, also during answers. */
void fxs_http_close(fxs_http_server *server);

#endif
