/* Reads parts of a scene from a web server by HTTP range requests (RFC 9110, section 14), for the pager, which renders
 * scenes larger than memory. libcurl is loaded at the first use, because libcurl brings about thirty libraries. */
#include <fixsplat/pager.h>

#include <string.h>
#include <strings.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/pager_more.h>

int fxs_pager_is_url(const char *path)
{
    return !strncasecmp(path, "http://", 7) || !strncasecmp(path, "https://", 8);
}

#ifndef FXS_WITH_CURL

int fxs_pager_url(const char *url, fxs_pager_source *source, fxs_message *message)
{
    (void)source;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot be fetched: this program was built without libcurl",
                       url);
}

#else

#include <curl/curl.h>
#include <dlfcn.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "src/base/try_internal.h"

/* An HTTP request fails after SLOW_SECONDS with less than SLOW_RATE bytes a second. */
enum { CONNECT_SECONDS = 15, SLOW_SECONDS = 30, SLOW_RATE = 1000, HEADERS_MOST = 65536, REDIRECTIONS = 5, GAP = 262144,
       VALIDATOR = 200 };

static struct {
    CURLcode (*global_init)(long flags);
    CURL *(*init)(void);
    CURLcode (*setopt)(CURL *handle, CURLoption option, ...);
    CURLcode (*perform)(CURL *handle);
    CURLcode (*getinfo)(CURL *handle, CURLINFO info, ...);
    void (*cleanup)(CURL *handle);
    struct curl_slist *(*append)(struct curl_slist *list, const char *text);
    void (*free_all)(struct curl_slist *list);
    const char *(*error)(CURLcode code);
    int is_here;
} lib;

static int find(void *library, const char *name, void *function)
{
    void *address = dlsym(library, name);
    memcpy(function, &address, sizeof address);
    return address != 0;
}

static void load_library(void)
{
    static const char *const names[] = {"libcurl.so.4", "libcurl-gnutls.so.4", "libcurl.4.dylib"};
    void *library = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names && !library; i++)
        library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    lib.is_here = library && find(library, "curl_global_init", &lib.global_init) &&
                  find(library, "curl_easy_init", &lib.init) && find(library, "curl_easy_setopt", &lib.setopt) &&
                  find(library, "curl_easy_perform", &lib.perform) &&
                  find(library, "curl_easy_getinfo", &lib.getinfo) &&
                  find(library, "curl_easy_cleanup", &lib.cleanup) && find(library, "curl_slist_append", &lib.append) &&
                  find(library, "curl_slist_free_all", &lib.free_all) &&
                  find(library, "curl_easy_strerror", &lib.error) && !lib.global_init(CURL_GLOBAL_DEFAULT);
}

/* Headers of an HTTP response that identify the version of the file. */
typedef struct validators {
    /* values of the headers ETag and Last-Modified; empty: the response has no such header */
    char tag[VALIDATOR], modified[VALIDATOR];
    uint64_t size;
} validators;

typedef struct paged_url {
    CURL *handle;
    char *url;
    int cancelled;                     /* 1 if the request is to be cancelled; accessed atomically */
    int is_open;
    validators file;

    unsigned char *out;
    uint64_t first;
    size_t size, got, headers;
    long status;
    int has_range, too_long;
    uint64_t from, to;   /* first and last byte that the response contains, from the header Content-Range */
    validators said;
} paged_url;

static int is_cancelled(void *argument, curl_off_t a, curl_off_t b, curl_off_t c, curl_off_t d)
{
    const paged_url *u = argument;
    (void)a, (void)b, (void)c, (void)d;
    return __atomic_load_n(&u->cancelled, __ATOMIC_ACQUIRE);
}

/* Receives bytes of an HTTP response. Accepts only status 206 (partial content). Any other content ends the request. */
static size_t take_bytes(char *bytes, size_t size, size_t count, void *argument)
{
    paged_url *u = argument;
    const size_t length = size * count;
    if (u->status != 206)
        return 0;
    if (length > u->size - u->got) {
        u->too_long = 1;
        return 0;
    }
    memcpy(u->out + u->got, bytes, length);
    u->got += length;
    return length;
}

static void take_value(const char *line, const char *name, char value[VALIDATOR])
{
    const size_t length = strlen(name);
    if (strncasecmp(line, name, length))
        return;
    line += length + strspn(line + length, " \t");
    const size_t end = strcspn(line, "\r\n");
    if (end < VALIDATOR)
        snprintf(value, VALIDATOR, "%.*s", (int)end, line);
}

/* Receives a header line of an HTTP response. After redirects, only the headers of the last response count. */
static size_t take_header(char *bytes, size_t size, size_t count, void *argument)
{
    paged_url *u = argument;
    char line[512], range[VALIDATOR] = "";
    const size_t length = size * count;
    u->headers += length;
    if (u->headers > HEADERS_MOST)
        return 0;
    snprintf(line, sizeof line, "%.*s", (int)(length < sizeof line ? length : sizeof line - 1), bytes);
    if (!strncmp(line, "HTTP/", 5)) {
        const char *space = strchr(line, ' ');
        u->status = space ? strtol(space, 0, 10) : 0;
        u->has_range = 0;
        memset(&u->said, 0, sizeof u->said);
    }
    take_value(line, "ETag:", u->said.tag);
    take_value(line, "Last-Modified:", u->said.modified);
    take_value(line, "Content-Range:", range);
    if (*range)
        u->has_range = sscanf(range, "bytes %" SCNu64 "-%" SCNu64 "/%" SCNu64, &u->from, &u->to, &u->said.size) == 3;
    return length;
}

/* Returns the value for the header If-Range: an ETag or a date. Weak ETags are excluded, because they may stay the same
   when bytes change. */
static const char *validator_of(const paged_url *u)
{
    return *u->file.tag == '"' ? u->file.tag : *u->file.tag ? "" : u->file.modified;
}

static int differ(const char *a, const char *b)
{
    return *a && *b && strcmp(a, b) != 0;
}

/* Returns 1 if the file on the server has changed. Compares only headers that are present: a response to If-Range may
   omit some (RFC 9110, 15.3.7). */
static int has_changed(const paged_url *u)
{
    return u->said.size != u->file.size || differ(u->said.tag, u->file.tag) ||
           differ(u->said.modified, u->file.modified);
}

static int judge(const paged_url *u, CURLcode code, fxs_message *message)
{
    const uint64_t last = u->first + u->size - 1;
    if (__atomic_load_n(&u->cancelled, __ATOMIC_ACQUIRE))
        return fxs_fail_as(FXS_ERR_STOPPED, message, "%s: no longer wanted", u->url);
    if (u->headers > HEADERS_MOST)
        return fxs_fail(message, "%s: the server sends more than %d bytes of headers", u->url, HEADERS_MOST);
    if (u->status == 200 || u->status == 416)
        return u->is_open ? fxs_fail(message, "%s: changed while it was read", u->url)
               : u->status == 416
                   ? fxs_fail(message, "%s: not an .fxs file: it has fewer than %zu bytes", u->url, u->size)
                   : fxs_fail(message, "%s: the server sends whole files alone, no ranges of bytes", u->url);
    if (u->status && u->status != 206)
        return fxs_fail(message, "%s: the server answers %ld", u->url, u->status);
    if (u->status && (!u->has_range || u->from != u->first || u->to != last || u->said.size <= last))
        return fxs_fail(message, "%s: the server does not say that it sends bytes %" PRIu64 " to %" PRIu64, u->url,
                        u->first, last);
    if (u->status && u->is_open && has_changed(u))
        return fxs_fail(message, "%s: changed while it was read", u->url);
    if (u->too_long)
        return fxs_fail(message, "%s: the server sends more than it was asked for", u->url);
    if (u->status && code == CURLE_OPERATION_TIMEDOUT)
        return fxs_fail(message, "%s: the server is too slow: below %d bytes a second for %d seconds", u->url,
                        SLOW_RATE, SLOW_SECONDS);
    if (code == CURLE_PARTIAL_FILE || (!code && u->got < u->size))
        return fxs_fail(message, "%s: the server ended early: %zu of %zu bytes", u->url, u->got, u->size);
    return code ? fxs_fail(message, "%s: %s", u->url, lib.error(code)) : 0;
}

static int fetch(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message)
{
    paged_url *u = argument;
    char range[64], condition[VALIDATOR + 16];
    struct curl_slist *headers = 0;
    u->out = out;
    u->first = offset;
    u->size = size;
    u->got = u->headers = 0;
    u->status = u->has_range = u->too_long = 0;
    snprintf(range, sizeof range, "%" PRIu64 "-%" PRIu64, offset, offset + size - 1);
    if (u->is_open && *validator_of(u)) {
        snprintf(condition, sizeof condition, "If-Range: %s", validator_of(u));
        headers = lib.append(0, condition);
    }
    lib.setopt(u->handle, CURLOPT_RANGE, range);
    lib.setopt(u->handle, CURLOPT_HTTPHEADER, headers);
    const CURLcode code = lib.perform(u->handle);
    lib.setopt(u->handle, CURLOPT_HTTPHEADER, (struct curl_slist *)0);
    lib.free_all(headers);
    return judge(u, code, message);
}

static void cancel(void *argument)
{
    paged_url *u = argument;
    __atomic_store_n(&u->cancelled, 1, __ATOMIC_RELEASE);
}

static void close_url(void *argument)
{
    paged_url *u = argument;
    if (u->handle)
        lib.cleanup(u->handle);
    free(u->url);
    free(u);
}

/* An https address is never redirected to http. */
static int prepare(paged_url *u)
{
    CURL *h = u->handle;
    const char *redirected = strncasecmp(u->url, "https:", 6) ? "http,https" : "https";
    return lib.setopt(h, CURLOPT_URL, u->url) || lib.setopt(h, CURLOPT_PROTOCOLS_STR, "http,https") ||
           lib.setopt(h, CURLOPT_REDIR_PROTOCOLS_STR, redirected) ||
           lib.setopt(h, CURLOPT_FOLLOWLOCATION, 1L) || lib.setopt(h, CURLOPT_MAXREDIRS, (long)REDIRECTIONS) ||
           lib.setopt(h, CURLOPT_NOSIGNAL, 1L) || lib.setopt(h, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_SECONDS) ||
           lib.setopt(h, CURLOPT_LOW_SPEED_LIMIT, (long)SLOW_RATE) ||
           lib.setopt(h, CURLOPT_LOW_SPEED_TIME, (long)SLOW_SECONDS) ||
           lib.setopt(h, CURLOPT_WRITEFUNCTION, take_bytes) || lib.setopt(h, CURLOPT_WRITEDATA, u) ||
           lib.setopt(h, CURLOPT_HEADERFUNCTION, take_header) || lib.setopt(h, CURLOPT_HEADERDATA, u) ||
           lib.setopt(h, CURLOPT_NOPROGRESS, 0L) || lib.setopt(h, CURLOPT_XFERINFOFUNCTION, is_cancelled) ||
           lib.setopt(h, CURLOPT_XFERINFODATA, u);
}

static int open_url(paged_url *u, fxs_message *message)
{
    unsigned char header[192];
    u->handle = lib.init();
    if (!u->handle || prepare(u))
        return fxs_fail(message, "%s: cannot be fetched by this libcurl", u->url);
    FXS_TRY(fetch(u, 0, header, sizeof header, message));
    u->file = u->said;
    u->is_open = 1;
    return 0;
}

int fxs_pager_url(const char *url, fxs_pager_source *source, fxs_message *message)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, load_library);
    if (!lib.is_here)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot be fetched: there is no libcurl here", url);
    paged_url *u = calloc(1, sizeof *u);
    if (!u || !(u->url = strdup(url))) {
        free(u);
        return fxs_fail_memory(message, url, sizeof *u);
    }
    const int error = open_url(u, message);
    if (error)
        close_url(u);
    else
        *source = (fxs_pager_source){.size = u->file.size, .read = fetch, .cancel = cancel, .close = close_url,
                                     .argument = u, .gap = GAP};
    return error;
}

#endif
