/* Connections that wait for a request, or for the rest of one. There may be a few of them: the one that has waited
 * longest is ended for a new one, so that nobody keeps others out by requests that never end. */
#ifndef FXS_HTTP_WAITING_H
#define FXS_HTTP_WAITING_H

#include <microhttpd.h>

typedef struct fxs_http_waiting {
    struct fxs_http_guest *oldest, *newest;
    int count;
} fxs_http_waiting;

/* For MHD_OPTION_NOTIFY_CONNECTION, with an fxs_http_waiting. */
void fxs_http_note_connection(void *waiting, struct MHD_Connection *connection, void **socket_context,
                              enum MHD_ConnectionNotificationCode event);

/* The request is there and will be answered. */
void fxs_http_note_request(fxs_http_waiting *waiting, struct MHD_Connection *connection);

/* For MHD_OPTION_NOTIFY_COMPLETED, with an fxs_http_waiting: the connection waits for the next request. */
void fxs_http_note_answered(void *waiting, struct MHD_Connection *connection, void **state,
                            enum MHD_RequestTerminationCode why);

#endif
