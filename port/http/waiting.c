#include "waiting.h"

#include <stdlib.h>

#include "sockets.h"

enum { WAITING_MOST = 64 };

typedef struct fxs_http_guest {
    struct fxs_http_guest *older, *newer;
    struct MHD_Connection *connection;
    int waits;
} guest;

static void remove_guest(fxs_http_waiting *w, guest *g)
{
    if (!g->waits)
        return;
    *(g->older ? &g->older->newer : &w->oldest) = g->newer;
    *(g->newer ? &g->newer->older : &w->newest) = g->older;
    g->waits = 0;
    w->count--;
}

/* Ends a waiting connection. Shuts its socket down, so that the server finds the connection closed. On Windows, the
   timeout of 1 second closes the connection instead. */
static void end_guest(const guest *g)
{
    shutdown(MHD_get_connection_info(g->connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd, FXS_HTTP_BOTH_WAYS);
    MHD_set_connection_option(g->connection, MHD_CONNECTION_OPTION_TIMEOUT, 1u);
}

static void add_guest(fxs_http_waiting *w, guest *g)
{
    remove_guest(w, g);
    g->older = w->newest;
    g->newer = NULL;
    *(w->newest ? &w->newest->newer : &w->oldest) = g;
    w->newest = g;
    g->waits = 1;
    if (++w->count <= WAITING_MOST)
        return;
    end_guest(w->oldest);
    remove_guest(w, w->oldest);
}

static guest *guest_of(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info ? info->socket_context : NULL;
}

static guest *guest_new(struct MHD_Connection *connection)
{
    guest *g = calloc(1, sizeof *g);
    if (g)
        g->connection = connection;
    return g;
}

void fxs_http_note_connection(void *waiting, struct MHD_Connection *connection, void **socket_context,
                              enum MHD_ConnectionNotificationCode event)
{
    if (event == MHD_CONNECTION_NOTIFY_STARTED)
        *socket_context = guest_new(connection);
    guest *g = *socket_context;
    if (g && event == MHD_CONNECTION_NOTIFY_STARTED) {
        add_guest(waiting, g);
    } else if (g) {
        remove_guest(waiting, g);
        free(g);
    }
}

void fxs_http_note_request(fxs_http_waiting *waiting, struct MHD_Connection *connection)
{
    guest *g = guest_of(connection);
    if (g)
        remove_guest(waiting, g);
}

void fxs_http_note_answered(void *waiting, struct MHD_Connection *connection, void **state,
                            enum MHD_RequestTerminationCode why)
{
    guest *g = guest_of(connection);
    (void)state;
    (void)why;
    if (g)
        add_guest(waiting, g);
}
