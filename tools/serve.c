/* fixsplat-web: what `fixsplat view --web` and `fixsplat fit --preview` run, with the same arguments. */
#define _XOPEN_SOURCE 700   /* realpath */
#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fixsplat/camera_file.h>
#include "port/http/server.h"
#include "src/camera/view_print.h"
#include <fixsplat/fxs_file.h>
#include "load_scene.h"
#include "cmd_view.h"
#include "page_folder.h"
#include "serve.h"
#include "views.h"

typedef struct site {
    fxs_http_site served;
    fxs_http_file *files;                   /* the scenes, then the views where there are any */
    const char **starts;                    /* an address for each scene */
    char folder[4096];
} site;

static char *text_of(const char *format, ...)
{
    va_list arguments;
    char *text = 0;
    va_start(arguments, format);
    const int length = vsnprintf(0, 0, format, arguments);
    va_end(arguments);
    if (length >= 0)
        text = malloc((size_t)length + 1);
    va_start(arguments, format);
    if (text)
        vsnprintf(text, (size_t)length + 1, format, arguments);
    va_end(arguments);
    return text;
}

/* ---- What it shows ----------------------------------------------------------------------------------------------- */

int keep_written(FILE *file)
{
    const int written = file && !fflush(file) && !ferror(file);
    const int descriptor = written ? fcntl(fileno(file), F_DUPFD_CLOEXEC, 0) : -1;
    const int why = errno;
    if (file)
        fclose(file);
    errno = why;
    return descriptor;
}

int keep(const void *data, size_t bytes)
{
    FILE *file = tmpfile();
    if (file)
        fwrite(data, 1, bytes, file);
    return keep_written(file);
}

/* Whether it is a file that is there for as long as this is, and none in JSON, which names others. */
static int is_one_file(const char *path)
{
    struct stat information;
    if (stat(path, &information) || !S_ISREG(information.st_mode))
        return 0;
    FILE *file = fopen(path, "rb");
    int c = ' ';
    while (file && isspace(c))
        c = getc(file);
    if (file)
        fclose(file);
    return c != '{';
}

/* Whether it is sent as it is: one file, and nothing asked about its import. */
static int is_sent(const char *path, const load_options *o)
{
    return !o->lod && !o->axes && !o->profile && !o->max_gaussians && !o->import_memory && is_one_file(path);
}

/* That it can be read is found out here and not first by the page: of an .fxs file as it is rendered. */
static int check_file(const char *path, const load_options *o, int *is_fxs)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    loaded_scene packed;
    if (open_scene(path, o, &file, &info))
        return EXIT_FAILED;
    fxs_scene_file_close(file);
    *is_fxs = !strcmp(info.format, "fxs");
    if (!*is_fxs)
        return 0;
    const int status = load_scene(&packed, path, o);
    if (!status)
        free_scene(&packed);
    return status;
}

static int pack(const char *path, const load_options *o, int *descriptor)
{
    loaded_scene scene;
    if (load_scene(&scene, path, o))
        return EXIT_FAILED;
    fxs_file_seal((void *)scene.opened->data, scene.opened->bytes);   /* packed here, so the bytes are no file's */
    *descriptor = keep(scene.opened->data, scene.opened->bytes);
    free_scene(&scene);
    return *descriptor < 0 ? fail(EXIT_FAILED, "%s: a temporary file: %s", path, strerror(errno)) : 0;
}

/* The last part of a path. Returns its length. */
static int base_of(const char **base, const char *path)
{
    const char *end = path + strlen(path);
    while (end > path && end[-1] == '/')
        end--;
    for (*base = end; *base > path && (*base)[-1] != '/'; --*base)
        ;
    return (int)(end - *base);
}

static int add_scene(site *s, const char *path, const load_options *o)
{
    const int i = s->served.file_count++;
    fxs_http_file *file = &s->files[i];
    const char *base;
    int is_fxs;
    int status = check_file(path, o, &is_fxs);
    if (status)
        return status;
    if (!is_fxs && !is_sent(path, o))
        status = pack(path, o, &file->descriptor);
    else if (!(file->path = realpath(path, 0)))   /* links are followed now, not later */
        status = fail(EXIT_FAILED, "%s: %s", path, strerror(errno));
    if (status)
        return status;
    const int length = base_of(&base, path);
    file->name = text_of("/scenes/%d/%.*s%s", i, length, base, file->path ? "" : ".fxs");
    return file->name ? 0 : fail(EXIT_FAILED, "out of memory");
}

/* The views of any camera file as a cameras.json, from the one that --view names. */
static int add_views(site *s, const frame_options *o)
{
    fxs_message message;
    fxs_file_view *views;
    const long count = fxs_camera_file_read(o->cameras, &views, &message);
    if (count < 0)
        return fail_for(&message);
    const long first = find_view(o, views, count);
    FILE *file = first < 0 ? 0 : tmpfile();
    for (long i = 0; file && i < count; i++) {
        fputs(i ? ",\n" : "[", file);
        fxs_view_print(file, &views[(first + i) % count]);
    }
    free(views);
    if (first < 0)
        return EXIT_FAILED;
    fxs_http_file *to = &s->files[s->served.file_count++];
    if (file)
        fputs("]\n", file);
    *to = (fxs_http_file){"/cameras.json", .descriptor = keep_written(file)};
    return to->descriptor < 0 ? fail(EXIT_FAILED, "%s: a temporary file: %s", o->cameras, strerror(errno)) : 0;
}

/* The same as a part of an address: what is not plain as %XX. Room for three times its length and a 0. */
static void escape(char *out, const char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.~/";
    for (; *text; text++)
        out += sprintf(out, strchr(plain, *text) ? "%c" : "%%%02X", (unsigned char)*text);
    *out = 0;
}

static int add_starts(site *s, const frame_options *o)
{
    const uint8_t *bg = o->render.background;
    const int has_background = bg[0] || bg[1] || bg[2];
    for (int i = 0; i < o->world.scene_count; i++) {
        char *name = malloc(3 * strlen(s->files[i].name) + 1), colour[32] = "";
        if (has_background)
            snprintf(colour, sizeof colour, "&background=%%23%02x%02x%02x", bg[0], bg[1], bg[2]);
        if (name)
            escape(name, s->files[i].name);
        s->starts[i] = name ? text_of("/viewer/?scene=%s%s%s", name, o->cameras ? "&cameras=/cameras.json" : "", colour)
                            : 0;
        free(name);
        if (!s->starts[i])
            return fail(EXIT_FAILED, "out of memory");
        s->served.start_count++;
    }
    return 0;
}

static int fill_site(site *s, const frame_options *o)
{
    const size_t scenes = (size_t)o->world.scene_count;
    load_options load = o->load;
    load.threads = o->threads;
    s->files = calloc(scenes + 1, sizeof *s->files);
    s->starts = calloc(scenes, sizeof *s->starts);
    if (!s->files || !s->starts)
        return fail(EXIT_FAILED, "out of memory");
    s->served.files = s->files;
    s->served.starts = s->starts;
    s->served.folder = s->folder;
    int status = page_folder_find(s->folder);
    for (size_t i = 0; i < scenes && !status; i++)
        status = add_scene(s, o->world.scenes[i], &load);
    if (!status && o->cameras)
        status = add_views(s, o);
    return status ? status : add_starts(s, o);
}

/* ---- Serving ----------------------------------------------------------------------------------------------------- */

typedef struct told {
    const site *site;
    int far;                                /* addresses of other machines */
} told;

static void tell(void *self, const char *address, int is_local)
{
    told *t = self;
    t->far += !is_local;
    for (int i = 0; i < t->site->served.start_count; i++)
        if (is_local)
            printf("%s%s\n", address, t->site->starts[i]);
        else if (i)
            printf("%s/%d\n", address, i);
        else
            printf("%s/\n", address);
}

static void tell_all(const fxs_http_server *server, const site *s, int is_https)
{
    told t = {s, 0};
    fxs_http_each_address(server, tell, &t);
    if (t.far && !is_https)
        puts("Browsers of other machines have no threads and no headset over http: --cert and --key, or for a headset "
             "on a cable adb reverse (docs/web.md)");
    fflush(stdout);
}

/* The signals that end it, but for those that are ignored. */
static sigset_t ending_signals(void)
{
    static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
    sigset_t set;
    struct sigaction now;
    sigemptyset(&set);
    for (size_t i = 0; i < sizeof ending / sizeof *ending; i++)
        if (!sigaction(ending[i], 0, &now) && now.sa_handler != SIG_IGN)
            sigaddset(&set, ending[i]);
    return set;
}

static int serve(const site *s, const view_options *o)
{
    const fxs_http_options options = {o->bind, (uint16_t)o->port, o->certificate, o->key, o->host};
    fxs_http_server *server;
    fxs_message message;
    sigset_t ending = ending_signals();
    int which;
    signal(SIGPIPE, SIG_IGN);
    sigprocmask(SIG_BLOCK, &ending, 0);
    if (fxs_http_open(&server, &s->served, &options, &message))
        return fail_for(&message);
    tell_all(server, s, o->key != 0);
    sigwait(&ending, &which);
    fxs_http_close(server);
    return EXIT_OK;
}

/* By its option, or the beginning of that: emulators have another argv[0]. */
static int is_fit(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        const size_t length = strlen(argv[i]);
        if (length >= sizeof "--pre" - 1 && !strncmp(argv[i], "--preview", length))
            return 1;
    }
    return 0;
}

int main(int argc, char **argv)
{
    view_options o;
    static site s;
    check_printed_at_exit();
    if (is_fit(argc, argv))
        return serve_fit(argc, argv);
    int status = view_options_take(&o, argc, argv);
    if (!status)
        status = fill_site(&s, &o.frame);
    return status ? status : serve(&s, &o);
}
