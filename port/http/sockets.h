/* The network as the server asks for it, beside libmicrohttpd: port/posix/http and port/win32/http. This header alone
   names the system's own, and the functions that it has everywhere are called as they are. */
#ifndef FXS_HTTP_SOCKETS_H
#define FXS_HTTP_SOCKETS_H

#include <microhttpd.h>                     /* MHD_socket */
#include <stddef.h>

#ifdef _WIN32
#include <winsock2.h>
#include <ws2tcpip.h>
enum { FXS_HTTP_BOTH_WAYS = SD_BOTH };      /* for shutdown */
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>                         /* gethostname */
enum { FXS_HTTP_BOTH_WAYS = SHUT_RDWR };
#endif

typedef union fxs_http_address {
    struct sockaddr any;
    struct sockaddr_in v4;
    struct sockaddr_in6 v6;
} fxs_http_address;

/* Before all else. Returns 0, or -1 where there is no network. */
int fxs_http_sockets_begin(void);

/* A socket that is to listen: no program that is run from here has it, its port may be one that was served before, and
   is nobody else's at the same time. */
void fxs_http_socket_claim(MHD_socket s);

void fxs_http_socket_close(MHD_socket s);

/* What was wrong with the last call. */
typedef struct fxs_http_fault {
    int is_in_use;                          /* the address */
    char words[128];
} fxs_http_fault;

void fxs_http_socket_fault(fxs_http_fault *fault);

/* Calls a function with each address, IPv4 or IPv6, of the interfaces that are up. */
void fxs_http_each_interface(void (*each)(void *self, const fxs_http_address *address), void *self);

#endif
