/* Network functions that differ between POSIX and Windows. Only this header includes the system's socket headers. */
#ifndef FXS_HTTP_SOCKETS_H
#define FXS_HTTP_SOCKETS_H

#include <microhttpd.h>
#include <stddef.h>

#ifdef _WIN32
#include <winsock2.h>
#include <ws2tcpip.h>
enum { FXS_HTTP_BOTH_WAYS = SD_BOTH };      /* argument of shutdown() that ends both directions of a connection */
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
enum { FXS_HTTP_BOTH_WAYS = SHUT_RDWR };
#endif

typedef union fxs_http_address {
    struct sockaddr any;
    struct sockaddr_in v4;
    struct sockaddr_in6 v6;
} fxs_http_address;

/* Prepares the network functions; must be called before them. Returns 0, or -1 without a network. */
int fxs_http_sockets_begin(void);

/* Prepares a socket before it listens. Child processes do not inherit the socket, a recently used port can be reused,
   and no other server can share the port. */
void fxs_http_socket_claim(MHD_socket s);

void fxs_http_socket_close(MHD_socket s);

/* Error of the last call of a network function. */
typedef struct fxs_http_fault {
    int is_in_use;
    char words[128];
} fxs_http_fault;

void fxs_http_socket_fault(fxs_http_fault *fault);

/* Calls the function `each` with each IPv4 and IPv6 address of this machine's active network interfaces. */
void fxs_http_each_interface(void (*each)(void *self, const fxs_http_address *address), void *self);

#endif
