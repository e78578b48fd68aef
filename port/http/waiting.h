/* Limits connections without a complete request to 64. A further connection ends the one that has waited longest, so
 * unfinished requests cannot block other clients. */
#ifndef FXS_HTTP_WAITING_H
#define FXS_HTTP_WAITING_H

#include <microhttpd.h>

typedef struct fxs_http_waiting {
    struct fxs_http_guest *oldest, *newest;
    int count;
} fxs_http_waiting;

/* Registers new connections and removes closed ones. MHD_OPTION_NOTIFY_CONNECTION takes this function, with an
   fxs_http_waiting as argument. */
void fxs_http_note_connection(void *waiting, struct MHD_Connection *connection, void **socket_context,
                              enum MHD_ConnectionNotificationCode event);

/* Must be called when a request is complete. */
void fxs_http_note_request(fxs_http_waiting *waiting, struct MHD_Connection *connection);

/* Marks a connection as waiting after a response. MHD_OPTION_NOTIFY_COMPLETED takes this function. */
void fxs_http_note_answered(void *waiting, struct MHD_Connection *connection, void **state,
                            enum MHD_RequestTerminationCode why);

#endif
