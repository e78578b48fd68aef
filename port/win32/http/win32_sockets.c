#include "port/http/sockets.h"

#include <iphlpapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int fxs_http_sockets_begin(void)
{
    WSADATA unused;
    return WSAStartup(MAKEWORD(2, 2), &unused) ? -1 : 0;
}

/* Prepares a socket before it listens. Does not use SO_REUSEADDR, because that would let another server share the
   port. */
void fxs_http_socket_claim(MHD_socket s)
{
    const BOOL on = TRUE;
    SetHandleInformation((HANDLE)s, HANDLE_FLAG_INHERIT, 0);
    setsockopt(s, SOL_SOCKET, SO_EXCLUSIVEADDRUSE, (const char *)&on, sizeof on);
}

void fxs_http_socket_close(MHD_socket s)
{
    closesocket(s);
}

void fxs_http_socket_fault(fxs_http_fault *fault)
{
    static const struct {
        int error;
        const char *words;
    } rows[] = {
        {WSAEADDRINUSE, "Address already in use"}, {WSAEADDRNOTAVAIL, "Cannot assign requested address"},
        {WSAEACCES, "Permission denied"}, {WSAEAFNOSUPPORT, "Address family not supported by protocol"},
    };
    const int error = WSAGetLastError();
    fault->is_in_use = error == WSAEADDRINUSE;
    snprintf(fault->words, sizeof fault->words, "error %d of the network", error);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].error == error)
            snprintf(fault->words, sizeof fault->words, "%s", rows[i].words);
}

static IP_ADAPTER_ADDRESSES *list_adapters(void)
{
    const ULONG without = GAA_FLAG_SKIP_ANYCAST | GAA_FLAG_SKIP_MULTICAST | GAA_FLAG_SKIP_DNS_SERVER;
    ULONG room = 1 << 14, result;
    IP_ADAPTER_ADDRESSES *all = NULL;
    do {   /* the call is repeated if the list of network adapters has grown since the last call */
        free(all);
        all = malloc(room);
        result = all ? GetAdaptersAddresses(AF_UNSPEC, without, NULL, all, &room) : ERROR_SUCCESS;
    } while (result == ERROR_BUFFER_OVERFLOW);
    if (result == ERROR_SUCCESS)
        return all;
    free(all);
    return NULL;
}

static void take(const SOCKET_ADDRESS *from, void (*each)(void *self, const fxs_http_address *address), void *self)
{
    fxs_http_address a;
    const int family = from->lpSockaddr->sa_family;
    if (family != AF_INET && family != AF_INET6)
        return;
    memcpy(&a, from->lpSockaddr, family == AF_INET6 ? sizeof a.v6 : sizeof a.v4);
    each(self, &a);
}

void fxs_http_each_interface(void (*each)(void *self, const fxs_http_address *address), void *self)
{
    IP_ADAPTER_ADDRESSES *all = list_adapters();
    for (const IP_ADAPTER_ADDRESSES *i = all; i; i = i->Next)
        for (const IP_ADAPTER_UNICAST_ADDRESS *u = i->OperStatus == IfOperStatusUp ? i->FirstUnicastAddress : NULL; u;
             u = u->Next)
            take(&u->Address, each, self);
    free(all);
}
