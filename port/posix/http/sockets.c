#define _DEFAULT_SOURCE   /* declares IFF_UP */
#include "port/http/sockets.h"

#include <errno.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>

int fxs_http_sockets_begin(void)
{
    return 0;
}

void fxs_http_socket_claim(MHD_socket s)
{
    const int on = 1;
    fcntl(s, F_SETFD, FD_CLOEXEC);
    setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
}

void fxs_http_socket_close(MHD_socket s)
{
    close(s);
}

void fxs_http_socket_fault(fxs_http_fault *fault)
{
    fault->is_in_use = errno == EADDRINUSE;
    snprintf(fault->words, sizeof fault->words, "%s", strerror(errno));
}

void fxs_http_each_interface(void (*each)(void *self, const fxs_http_address *address), void *self)
{
    struct ifaddrs *all;
    if (getifaddrs(&all))
        return;
    for (const struct ifaddrs *i = all; i; i = i->ifa_next) {
        const int family = i->ifa_addr && (i->ifa_flags & IFF_UP) ? i->ifa_addr->sa_family : AF_UNSPEC;
        fxs_http_address a;
        if (family != AF_INET && family != AF_INET6)
            continue;
        memcpy(&a, i->ifa_addr, family == AF_INET6 ? sizeof a.v6 : sizeof a.v4);
        each(self, &a);
    }
    freeifaddrs(all);
}
