/* A small static server (libmicrohttpd) for the files of one folder and for others under names of their own; the rest
 * of the file system is not served. It has GET, HEAD, ranges and ETags. Every answer has the headers that isolate a
 * page (Cross-Origin-Opener-Policy and -Embedder-Policy), which threads in a browser need. Files are sent from the
 * disk as they are at the time of the request, and are never loaded completely; but files of a page, of 8 MiB at
 * most, are compressed once where the client takes gzip. Requests by another name than an address in digits,
 * localhost, `host` or, on an address that other machines reach, this machine's name are refused. */
#ifndef FXS_HTTP_SERVER_H
#define FXS_HTTP_SERVER_H

#include <fixsplat/message.h>

typedef struct fxs_http_file {
    const char *name;                       /* "/scenes/0/room.ply" */
    const char *path;                       /* not a link, where it is asked for; or null for: */
    int descriptor;                         /* a file that stays open, sent from its beginning */
    int (*open)(void *self);                /* or, where this is not null, for a file that changes: called for each
                                               request, on the server's thread. Returns a descriptor that the answer
                                               closes, or -1 where there is no such file */
    void *self;                             /* of open */
} fxs_http_file;

/* The files that are served; must not move in memory until the server is closed. */
typedef struct fxs_http_site {
    const char *folder;                     /* parts of names: letters, digits and . _ -, not beginning with a point */
    const fxs_http_file *files;
    int file_count;
    const char *const *starts;              /* targets of the addresses "/" (the first), "/1", "/2" and so on */
    int start_count;
} fxs_http_site;

typedef struct fxs_http_options {
    const char *address;                    /* IPv4 or IPv6 in digits; 0.0.0.0 and ::, all of this machine's */
    uint16_t port;                          /* 0: any free port */
    const char *certificate, *key;          /* .pem files: https; or null */
    const char *host;                       /* a name of this machine that requests may have; or null */
} fxs_http_options;

typedef struct fxs_http_server fxs_http_server;

/* Whether there can be a certificate: 1 where libmicrohttpd has TLS, else 0. */
int fxs_http_has_tls(void);

/* Serves from a thread of its own, which gets no signals. Returns 0, or an error and a message. */
int fxs_http_open(fxs_http_server **server, const fxs_http_site *site, const fxs_http_options *options,
                  fxs_message *message);

/* Calls `each` with "http://HOST:PORT" for each address of the server; where it has all of this machine's addresses,
   for each interface. `is_local`: only this machine reaches it. */
void fxs_http_each_address(const fxs_http_server *server, void (*each)(void *self, const char *address, int is_local),
                           void *self);

/* Ends the server at once, even while it sends. */
void fxs_http_close(fxs_http_server *server);

#endif
