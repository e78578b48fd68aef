/* Serves files with libmicrohttpd, on the library's internal thread. Each request opens its file anew. */
#include "server.h"

#include "gzip.h"
#include "sockets.h"
#include "waiting.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "src/base/os_calls.h"

/* Timeouts of a connection in seconds: while it waits for a request, and during a response. */
enum { WAITING_SECONDS = 10, SENDING_SECONDS = 60 };
/* Largest numbers of connections: in all, and from one client address. A connection takes two of the usual 1024 file
   descriptors. */
enum { CONNECTIONS_MOST = 480, OF_AN_ADDRESS_MOST = 120 };
enum { GZIP_LEAST = 1 << 10, GZIP_MOST = 1 << 23, PEM_BYTES_MOST = 1 << 20 };

struct fxs_http_server {
    const fxs_http_site *site;
    struct MHD_Daemon *daemon;
    fxs_http_address bound;
    char *certificate, *key;
    const char *host;
    char own_name[256];
    fxs_http_waiting waiting;
    fxs_http_gzipped *gzipped;
    char said[256];
};

/* Returns 1 if all parts of a requested name consist of letters, digits, . _ and -, without a dot at the start. Such a
   name cannot lead out of the served folder. */
static int is_inside(const char *name)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    for (;;) {
        if (*name != '/' || !name[1] || !strchr(plain, name[1]))
            return 0;
        name += 1 + strspn(name + 1, plain);
        while (*name == '.')
            name += 1 + strspn(name + 1, plain);
        if (!*name)
            return 1;
    }
}

static int open_of_folder(const char *folder, const char *name)
{
    char path[4096];
    const char *index = name[strlen(name) - 1] == '/' ? "index.html" : "";
    char whole[1024];
    if (snprintf(whole, sizeof whole, "%s%s", name, index) >= (int)sizeof whole || !is_inside(whole) ||
        snprintf(path, sizeof path, "%s%s", folder, whole) >= (int)sizeof path)
        return -1;
    return fxs_descriptor_open(path);
}

static int open_file(const fxs_http_file *file)
{
    return file->open ? file->open(file->self)
         : file->path ? fxs_descriptor_open(file->path) : fxs_descriptor_again(file->descriptor);
}

static int open_named(const fxs_http_site *site, const char *name, fxs_file_facts *facts)
{
    int descriptor = -2;
    for (int i = 0; i < site->file_count && descriptor == -2; i++)
        if (!strcmp(site->files[i].name, name))
            descriptor = open_file(&site->files[i]);
    if (descriptor == -2)
        descriptor = *name == '/' ? open_of_folder(site->folder, name) : -1;
    if (descriptor >= 0 && fxs_descriptor_look(descriptor, facts) != FXS_FILE_REGULAR) {
        fxs_descriptor_close(descriptor);
        return -1;
    }
    return descriptor;
}

/* Returns the target of a short URL path: "/" is the first, "/1" the second. Returns null for any other path. */
static const char *start_of(const fxs_http_site *site, const char *name)
{
    char shorter[16] = "/";
    for (int i = 0; i < site->start_count; i++, snprintf(shorter, sizeof shorter, "/%d", i))
        if (!strcmp(name, shorter))
            return site->starts[i];
    return 0;
}

typedef struct kind {
    const char *ending, *type;
    int shrinks;                            /* 1 if files of this type are worth compressing */
} kind;

static const kind *kind_of(const char *name)
{
    static const kind kinds[] = {
        {"/", "text/html; charset=utf-8", 1}, {".html", "text/html; charset=utf-8", 1},
        {".css", "text/css; charset=utf-8", 1}, {".js", "text/javascript; charset=utf-8", 1},
        {".mjs", "text/javascript; charset=utf-8", 1}, {".wasm", "application/wasm", 1},
        {".json", "application/json", 1}, {".svg", "image/svg+xml", 1}, {".md", "text/plain; charset=utf-8", 1},
        {".ts", "text/plain; charset=utf-8", 1}, {".png", "image/png", 0}, {"", "application/octet-stream", 0}
    };
    const size_t length = strlen(name);
    const kind *k = kinds;
    for (size_t end; (end = strlen(k->ending)) > length || strcasecmp(name + length - end, k->ending);)
        k++;
    return k;
}

/* Decodes %XX in the path of a URL. Leaves a path with %00 unchanged, because a zero would cut off the text after
   it. */
static size_t unescape(void *self, struct MHD_Connection *connection, char *text)
{
    (void)self;
    (void)connection;
    return strstr(text, "%00") ? strlen(text) : MHD_http_unescape(text);
}

static enum MHD_Result complete(struct MHD_Response *response)
{
    static const char *const headers[][2] = {
        {"Cross-Origin-Opener-Policy", "same-origin"}, {"Cross-Origin-Embedder-Policy", "require-corp"},
        {"Cross-Origin-Resource-Policy", "same-origin"}, {"X-Content-Type-Options", "nosniff"},
        {"Cache-Control", "no-cache"}, {"Vary", "Accept-Encoding"}
    };
    enum MHD_Result done = response ? MHD_YES : MHD_NO;
    for (size_t i = 0; i < sizeof headers / sizeof *headers && done == MHD_YES; i++)
        done = MHD_add_response_header(response, headers[i][0], headers[i][1]);
    return done;
}

static enum MHD_Result send_answer(struct MHD_Connection *connection, unsigned status, struct MHD_Response *response)
{
    enum MHD_Result done = complete(response);
    if (done == MHD_YES)
        done = MHD_queue_response(connection, status, response);
    if (response)
        MHD_destroy_response(response);
    return done;
}

/* Sends a response with the text `text`, which must be a string constant. */
static enum MHD_Result send_words(struct MHD_Connection *connection, unsigned status, const char *text,
                                  const char *header, const char *value)
{
    struct MHD_Response *response = MHD_create_response_from_buffer(strlen(text), (void *)(uintptr_t)text,
                                                                    MHD_RESPMEM_PERSISTENT);
    if (response) {
        MHD_add_response_header(response, "Content-Type", "text/plain; charset=utf-8");
        if (header)
            MHD_add_response_header(response, header, value);
    }
    return send_answer(connection, status, response);
}

static const char *take_digits(const char *text, uint64_t *value)
{
    char *end;
    errno = 0;
    *value = strtoull(text, &end, 10);
    return *text >= '0' && *text <= '9' && !errno ? end : 0;
}

/* Reads a Range header: "bytes=FIRST-LAST", "bytes=FIRST-" or "bytes=-LENGTH". Returns 1 and the range of bytes; 0 if
   the whole file must be sent; -1 if the file has no such bytes. */
static int take_range(const char *range, uint64_t size, uint64_t *first, uint64_t *length)
{
    uint64_t from = 0, last = UINT64_MAX;
    if (!range || strncmp(range, "bytes=", 6))
        return 0;
    const int from_end = range[6] == '-';
    const char *at = from_end ? range + 6 : take_digits(range + 6, &from);
    if (!at || *at != '-')
        return 0;
    if (from_end || at[1])
        at = take_digits(at + 1, &last);
    else
        at++;
    if (!at || *at || (!from_end && last < from))
        return 0;
    if (from_end)
        from = last < size ? size - last : 0;
    if (from >= size)
        return -1;
    *first = from;
    *length = (from_end || last >= size ? size : last + 1) - from;
    return 1;
}

static const char *header_of(struct MHD_Connection *connection, const char *name)
{
    return MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
}

static int takes_gzip(struct MHD_Connection *connection)
{
    const char *taken = header_of(connection, "Accept-Encoding"), *gzip = taken ? strstr(taken, "gzip") : 0;
    return gzip && strncmp(gzip, "gzip;q=0", 8);
}

static enum MHD_Result send_gzipped(fxs_http_server *server, struct MHD_Connection *connection, const char *name,
                                    const char *tag, int descriptor, size_t size)
{
    int is_new;
    struct MHD_Response *response = fxs_http_gzip(&server->gzipped, name, tag, descriptor, size, &is_new);
    fxs_descriptor_close(descriptor);
    if (!response)
        return MHD_NO;
    if (is_new) {
        MHD_add_response_header(response, "Content-Type", kind_of(name)->type);
        MHD_add_response_header(response, "Content-Encoding", "gzip");
        MHD_add_response_header(response, "ETag", tag);
        complete(response);
    }
    return MHD_queue_response(connection, MHD_HTTP_OK, response);
}

/* Sends a file, or a range of its bytes. Closes the descriptor when all is sent. */
static enum MHD_Result send_file(fxs_http_server *server, struct MHD_Connection *connection, const char *name,
                                 int descriptor, const fxs_file_facts *facts)
{
    const uint64_t size = facts->size;
    const int gzipped = FXS_HTTP_HAS_GZIP && kind_of(name)->shrinks && size >= GZIP_LEAST && size <= GZIP_MOST &&
                        takes_gzip(connection) && !header_of(connection, "Range");
    uint64_t first = 0, length = size;
    char tag[FXS_HTTP_TAG], text[96];
    snprintf(tag, sizeof tag, "\"%" PRIx64 "-%" PRIx64 "%s\"", facts->modified, size, gzipped ? "-gzip" : "");
    const char *known = header_of(connection, "If-None-Match"), *same = header_of(connection, "If-Range");
    if (known && strstr(known, tag)) {
        fxs_descriptor_close(descriptor);
        return send_words(connection, MHD_HTTP_NOT_MODIFIED, "", "ETag", tag);
    }
    if (gzipped)
        return send_gzipped(server, connection, name, tag, descriptor, (size_t)size);
    const int part = same && strcmp(same, tag) ? 0 : take_range(header_of(connection, "Range"), size, &first, &length);
    if (part < 0) {
        fxs_descriptor_close(descriptor);
        snprintf(text, sizeof text, "bytes */%" PRIu64, size);
        return send_words(connection, MHD_HTTP_RANGE_NOT_SATISFIABLE, "no such bytes\n", "Content-Range", text);
    }
    struct MHD_Response *response = MHD_create_response_from_fd_at_offset64(length, descriptor, first);
    if (!response) {
        fxs_descriptor_close(descriptor);
        return MHD_NO;
    }
    MHD_add_response_header(response, "Content-Type", kind_of(name)->type);
    MHD_add_response_header(response, "Accept-Ranges", "bytes");
    MHD_add_response_header(response, "ETag", tag);
    if (part) {
        snprintf(text, sizeof text, "bytes %" PRIu64 "-%" PRIu64 "/%" PRIu64, first, first + length - 1, size);
        MHD_add_response_header(response, "Content-Range", text);
    }
    return send_answer(connection, part ? MHD_HTTP_PARTIAL_CONTENT : MHD_HTTP_OK, response);
}

static int is_local(const fxs_http_address *a)
{
    return a->any.sa_family == AF_INET6 ? IN6_IS_ADDR_LOOPBACK(&a->v6.sin6_addr)
                                        : ntohl(a->v4.sin_addr.s_addr) >> 24 == 127;
}

static int is_name(const char *host, size_t length, const char *name, const char *behind)
{
    const size_t first = strlen(name);
    return first && length == first + strlen(behind) && !strncasecmp(host, name, first) &&
           !strncasecmp(host + first, behind, length - first);
}

/* Returns 1 for an allowed Host header, to prevent DNS rebinding. Accepts numeric addresses, localhost, options.host
   and, unless the server is local, this machine's names. */
static int is_own_host(const fxs_http_server *server, const char *host)
{
    const size_t length = host ? strcspn(host, ":") : 0;
    if (!host || *host == '[' || strspn(host, "0123456789.") == length || is_name(host, length, "localhost", "") ||
        (server->host && is_name(host, length, server->host, "")))
        return 1;
    return !is_local(&server->bound) && (is_name(host, length, server->own_name, "") ||
                                         is_name(host, length, server->own_name, ".local"));
}

static enum MHD_Result answer(void *self, struct MHD_Connection *connection, const char *name, const char *method,
                              const char *version, const char *body, size_t *body_bytes, void **state)
{
    fxs_http_server *server = self;
    const fxs_http_site *site = server->site;
    fxs_file_facts facts;
    (void)version;
    (void)body;
    if (strcmp(method, "GET") && strcmp(method, "HEAD"))
        return send_words(connection, MHD_HTTP_METHOD_NOT_ALLOWED, "only GET and HEAD\n", "Allow", "GET, HEAD");
    /* libmicrohttpd calls this function several times for a request; the first call must not send a response */
    if (!*state) {
        *state = server;
        return MHD_YES;
    }
    if (*body_bytes) {
        *body_bytes = 0;
        return MHD_YES;
    }
    fxs_http_note_request(&server->waiting, connection);
    MHD_set_connection_option(connection, MHD_CONNECTION_OPTION_TIMEOUT, (unsigned)SENDING_SECONDS);
    if (!is_own_host(server, header_of(connection, "Host")))
        return send_words(connection, MHD_HTTP_MISDIRECTED_REQUEST, "not by this name: --host names it\n", 0, 0);
    const char *start = start_of(site, name);
    if (start)
        return send_words(connection, MHD_HTTP_FOUND, "", "Location", start);
    const int descriptor = open_named(site, name, &facts);
    if (descriptor < 0)
        return send_words(connection, MHD_HTTP_NOT_FOUND, "there is no such file here\n", 0, 0);
    return send_file(server, connection, name, descriptor, &facts);
}

static int parse_address(fxs_http_address *out, const fxs_http_options *o, fxs_message *message)
{
    memset(out, 0, sizeof *out);
    if (inet_pton(AF_INET, o->address, &out->v4.sin_addr) == 1) {
        out->v4.sin_family = AF_INET;
        out->v4.sin_port = htons(o->port);
        return 0;
    }
    if (inet_pton(AF_INET6, o->address, &out->v6.sin6_addr) == 1) {
        out->v6.sin6_family = AF_INET6;
        out->v6.sin6_port = htons(o->port);
        return 0;
    }
    return fxs_fail(message, "%s: expected an address in digits, as 127.0.0.1, 0.0.0.0 or ::1", o->address);
}

static socklen_t size_of(const fxs_http_address *a)
{
    return a->any.sa_family == AF_INET6 ? sizeof a->v6 : sizeof a->v4;
}

static MHD_socket listen_at(fxs_http_address *address, const fxs_http_options *o, fxs_message *message)
{
    const int off = 0;
    socklen_t size = size_of(address);
    fxs_http_fault fault;
    const MHD_socket s = socket(address->any.sa_family, SOCK_STREAM, 0);
    if (s != MHD_INVALID_SOCKET) {
        fxs_http_socket_claim(s);
        if (address->any.sa_family == AF_INET6)
            setsockopt(s, IPPROTO_IPV6, IPV6_V6ONLY, (const void *)&off, sizeof off);
        if (!bind(s, &address->any, size) && !listen(s, SOMAXCONN) && !getsockname(s, &address->any, &size))
            return s;
    }
    fxs_http_socket_fault(&fault);
    if (s != MHD_INVALID_SOCKET)
        fxs_http_socket_close(s);
    fxs_fail(message, "%s, port %u: %s%s", o->address, o->port, fault.words,
             fault.is_in_use ? "; port 0 is any that is free" : "");
    return MHD_INVALID_SOCKET;
}

static int read_text(char **out, const char *path, fxs_message *message)
{
    FILE *file = fxs_stream_open(path, "r");
    if (!file)
        return fxs_fail_errno(message, path, errno);
    *out = calloc(1, PEM_BYTES_MOST);
    const size_t bytes = *out ? fread(*out, 1, PEM_BYTES_MOST, file) : 0;
    const int why = ferror(file) ? errno : 0;
    fclose(file);
    if (!*out)
        return fxs_fail_memory(message, path, 0);
    if (why)
        return fxs_fail_errno(message, path, why);
    return bytes && bytes < PEM_BYTES_MOST ? 0 : fxs_fail(message, "%s: this is no .pem file", path);
}

int fxs_http_has_tls(void)
{
    return MHD_is_feature_supported(MHD_FEATURE_TLS) == MHD_YES;
}

static int read_pem(fxs_http_server *server, const fxs_http_options *o, fxs_message *message)
{
    if (!fxs_http_has_tls())
        return fxs_fail(message, "%s: this libmicrohttpd was built without TLS", o->certificate);
    const int result = read_text(&server->certificate, o->certificate, message);
    return result ? result : read_text(&server->key, o->key, message);
}

static void note(void *self, const char *format, va_list arguments)
{
    fxs_http_server *server = self;
    vsnprintf(server->said, sizeof server->said, format, arguments);
    server->said[strcspn(server->said, "\n")] = 0;
}

static int start(fxs_http_server *server, const fxs_http_options *o, fxs_message *message)
{
    const struct MHD_OptionItem tls[] = {{MHD_OPTION_HTTPS_MEM_CERT, 0, server->certificate},
                                         {MHD_OPTION_HTTPS_MEM_KEY, 0, server->key},
                                         {MHD_OPTION_END, 0, 0}};
    const unsigned flags = MHD_USE_AUTO_INTERNAL_THREAD | MHD_USE_ERROR_LOG | (server->key ? MHD_USE_TLS : 0) |
                           (server->bound.any.sa_family == AF_INET6 ? MHD_USE_IPv6 : 0);
    const MHD_socket s = listen_at(&server->bound, o, message);
    if (s == MHD_INVALID_SOCKET)
        return FXS_ERR_FILE;
    server->daemon = MHD_start_daemon(flags, 0, 0, 0, answer, server, MHD_OPTION_EXTERNAL_LOGGER, note, server,
                                      MHD_OPTION_LISTEN_SOCKET, s, MHD_OPTION_CONNECTION_TIMEOUT,
                                      (unsigned)WAITING_SECONDS, MHD_OPTION_CONNECTION_LIMIT,
                                      (unsigned)CONNECTIONS_MOST, MHD_OPTION_PER_IP_CONNECTION_LIMIT,
                                      (unsigned)OF_AN_ADDRESS_MOST, MHD_OPTION_UNESCAPE_CALLBACK, unescape, server,
                                      MHD_OPTION_NOTIFY_CONNECTION, fxs_http_note_connection, &server->waiting,
                                      MHD_OPTION_NOTIFY_COMPLETED, fxs_http_note_answered, &server->waiting,
                                      MHD_OPTION_ARRAY, server->key ? tls : tls + 2, MHD_OPTION_END);
    if (server->daemon)
        return 0;
    fxs_http_socket_close(s);
    return server->key ? fxs_fail(message, "%s, %s: not a certificate and its key as .pem", o->certificate, o->key)
                       : fxs_fail(message, "the server does not start: %s", server->said);
}

typedef struct starting {
    fxs_http_server *server;
    const fxs_http_options *options;
    fxs_message *message;
    int result;
} starting;

static void start_server(void *argument)
{
    starting *s = argument;
    s->result = start(s->server, s->options, s->message);
}

int fxs_http_open(fxs_http_server **out, const fxs_http_site *site, const fxs_http_options *options,
                  fxs_message *message)
{
    if (fxs_http_sockets_begin())
        return fxs_fail(message, "the server does not start: there is no network here");
    fxs_http_server *server = calloc(1, sizeof *server);
    starting s = {server, options, message, 0};
    if (!server)
        return fxs_fail_memory(message, 0, 0);
    server->site = site;
    server->host = options->host;
    gethostname(server->own_name, sizeof server->own_name - 1);
    int result = parse_address(&server->bound, options, message);
    if (!result && options->certificate)
        result = read_pem(server, options, message);
    if (!result)
        fxs_without_signals(start_server, &s);
    result = result ? result : s.result;
    if (result)
        fxs_http_close(server);
    else
        *out = server;
    return result;
}

void fxs_http_close(fxs_http_server *server)
{
    if (server->daemon)
        MHD_stop_daemon(server->daemon);
    fxs_http_gzip_free(server->gzipped);
    free(server->certificate);
    free(server->key);
    free(server);
}

static int is_any(const fxs_http_address *a)
{
    return a->any.sa_family == AF_INET6 ? IN6_IS_ADDR_UNSPECIFIED(&a->v6.sin6_addr)
                                        : a->v4.sin_addr.s_addr == htonl(INADDR_ANY);
}

static void tell(const fxs_http_server *server, const fxs_http_address *a,
                 void (*each)(void *self, const char *address, int is_local), void *self)
{
    const int is_v6 = a->any.sa_family == AF_INET6;
    const unsigned port = ntohs(server->bound.any.sa_family == AF_INET6 ? server->bound.v6.sin6_port
                                                                        : server->bound.v4.sin_port);
    char host[INET6_ADDRSTRLEN], text[INET6_ADDRSTRLEN + 32];
    if (!inet_ntop(a->any.sa_family, is_v6 ? (const void *)&a->v6.sin6_addr : &a->v4.sin_addr, host, sizeof host))
        return;
    snprintf(text, sizeof text, is_v6 ? "%s://[%s]:%u" : "%s://%s:%u", server->key ? "https" : "http", host, port);
    each(self, text, is_local(a));
}

typedef struct telling {
    const fxs_http_server *server;
    void (*each)(void *self, const char *address, int is_local);
    void *self;
} telling;

/* Reports the URL of one address of this machine. Skips link-local IPv6 addresses, which URLs cannot contain. */
static void tell_interface(void *self, const fxs_http_address *a)
{
    const telling *t = self;
    if (a->any.sa_family == AF_INET ||
        (t->server->bound.any.sa_family == AF_INET6 && !IN6_IS_ADDR_LINKLOCAL(&a->v6.sin6_addr)))
        tell(t->server, a, t->each, t->self);
}

void fxs_http_each_address(const fxs_http_server *server, void (*each)(void *self, const char *address, int is_local),
                           void *self)
{
    telling t = {server, each, self};
    if (is_any(&server->bound))
        fxs_http_each_interface(tell_interface, &t);
    else
        tell(server, &server->bound, each, self);
}
