/* Limits the number of connections that have sent no complete request to 64. A further connection ends the one that has
 * waited longest. Unfinished requests thus cannot block other clients. */
#ifndef FXS_HTTP_WAITING_H
#define FXS_HTTP_WAITING_H

#include <microhttpd.h>

typedef struct fxs_http_waiting {
    struct fxs_http_guest *oldest, *newest;
    int count;
} fxs_http_waiting;

/* Registers new connections and removes closed ones. The function is for MHD_OPTION_NOTIFY_CONNECTION, with an
   fxs_http_waiting as argument. */
void fxs_http_note_connection(void *waiting, struct MHD_Connection *connection, void **socket_context,
                              enum MHD_ConnectionNotificationCode event);

/* Marks a connection as no longer waiting. Must be called when its request is complete. */
void fxs_http_note_request(fxs_http_waiting *waiting, struct MHD_Connection *connection);

/* Marks a connection as waiting again after a response. The function is for MHD_OPTION_NOTIFY_COMPLETED. */
void fxs_http_note_answered(void *waiting, struct MHD_Connection *connection, void **state,
                            enum MHD_RequestTerminationCode why);

#endif
