/* fixsplat-web: the web server program that `fixsplat view --web` and `fixsplat fit --preview` start, with the same
   arguments. */
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include "port/http/server.h"
#include "src/base/os_calls.h"
#include "src/camera/view_print.h"
#include "tools/command/cmd_view.h"
#include "page_folder.h"
#include "scene_list.h"
#include "scene_pages.h"
#include "serve.h"
#include "serve_scenes.h"
#include "tools/command/views.h"

typedef struct site {
    fxs_http_site served;
    fxs_http_file *files;
    const char **starts;
    scene_list list;
    served_options how;
    served_scenes *scenes;
    char folder[4096];
} site;

char *text_of(const char *format, ...)
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

int keep_written(FILE *file)
{
    const int written = file && !fflush(file) && !ferror(file);
    const int descriptor = written ? fxs_descriptor_of(file) : -1;
    const int why = errno;
    if (file)
        fclose(file);
    errno = why;
    return descriptor;
}

int keep(const void *data, size_t bytes)
{
    FILE *file = fxs_stream_temporary();
    if (file)
        fwrite(data, 1, bytes, file);
    return keep_written(file);
}

static int add_kept(site *s, const char *name, const char *of, int descriptor)
{
    s->files[s->served.file_count++] = (fxs_http_file){name, .descriptor = descriptor};
    return descriptor < 0 ? fail(EXIT_FAILED, "%s: a temporary file: %s", of, strerror(errno)) : 0;
}

/* Serves the views of a camera file as cameras.json, starting with the view that --view names. */
static int add_views(site *s, const frame_options *o)
{
    fxs_message message;
    fxs_view *views;
    const long count = fxs_camera_file_read(o->cameras, &views, &message);
    if (count < 0)
        return fail_for(&message);
    const long first = find_view(o, views, count);
    FILE *file = first < 0 ? 0 : fxs_stream_temporary();
    for (long i = 0; file && i < count; i++) {
        fputs(i ? ",\n" : "[", file);
        fxs_view_print(file, &views[(first + i) % count]);
    }
    free(views);
    if (first < 0)
        return EXIT_FAILED;
    if (file)
        fputs("]\n", file);
    return add_kept(s, "/cameras.json", o->cameras, keep_written(file));
}

/* Escapes a text for a URL. `out` must have room for 3 times the text's length + 1 bytes. */
static void escape(char *out, const char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.~/";
    for (; *text; text++)
        out += sprintf(out, strchr(plain, *text) ? "%c" : "%%%02X", (unsigned char)*text);
    *out = 0;
}

static char *page_of(const site *s, int scene, const frame_options *o)
{
    const uint8_t *bg = o->render.background;
    const char *address = scenes_address(s->scenes, scene);
    char *name = malloc(3 * strlen(address) + 1), colour[32] = "", *page = 0;
    if (bg[0] || bg[1] || bg[2])
        snprintf(colour, sizeof colour, "&background=%%23%02x%02x%02x", bg[0], bg[1], bg[2]);
    if (name) {
        escape(name, address);
        page = text_of("/viewer/served.html?scene=%s%s%s", name, o->cameras ? "&cameras=/cameras.json" : "", colour);
    }
    free(name);
    return page;
}

static int add_start(site *s, const char *start)
{
    s->starts[s->served.start_count++] = start;
    return start ? 0 : fail(EXIT_FAILED, "out of memory");
}

static int add_list(site *s, int scenes)
{
    FILE *file = fxs_stream_temporary();
    if (file)
        print_list_head(file, "Scenes", "/viewer");
    for (int i = 0; file && i < scenes; i++) {
        char address[16];
        snprintf(address, sizeof address, "/%d", i + 1);
        print_listed(file, address, 0, scenes_title(s->scenes, i));
    }
    if (file)
        fputs("</main>\n<script type=\"module\" src=\"/viewer/list.js\"></script>\n", file);
    const int status = add_kept(s, "/list.html", "the list of scenes", keep_written(file));
    return status ? status : add_start(s, "/list.html");
}

/* True if the command line names the scene itself, rather than its folder. Such scenes are read before serving. */
static int is_named(const world_options *given, const char *path)
{
    for (int i = 0; i < given->scene_count; i++)
        if (!strcmp(given->scenes[i], path))
            return 1;
    return 0;
}

static int add_scenes(site *s, const frame_options *o)
{
    const int scenes = (int)s->list.count;
    int status = 0;
    s->how.has_list = scenes > 1 || is_folder_of_scenes(o->world.scenes[0]);
    s->scenes = scenes_new(&s->how, scenes);
    s->files = calloc(s->scenes ? (size_t)scenes * SCENE_FILES + 3 : 1, sizeof *s->files);
    s->starts = calloc((size_t)scenes + 1, sizeof *s->starts);
    if (!s->scenes || !s->files || !s->starts)
        return fail(EXIT_FAILED, "out of memory");
    for (int i = 0; i < scenes && !status; i++)
        status = scenes_add(s->scenes, s->list.scenes[i].path, is_named(&o->world, s->list.scenes[i].path));
    if (!status)
        scenes_files(s->scenes, s->files);
    s->served.file_count = scenes_file_count(s->scenes);
    return status;
}

static int add_pages(site *s, const frame_options *o)
{
    const int scenes = (int)s->list.count;
    int status = o->cameras ? add_views(s, o) : 0;
    if (!status && s->how.has_list)
        status = add_list(s, scenes);
    for (int i = 0; i < scenes && !status; i++)
        status = add_start(s, page_of(s, i, o));
    return status;
}

/* Refuses options of packing if every scene is an .fxs, which is served as it is. */
static int check_packing(const site *s)
{
    const char *option = is_given("profile") ? "profile" : is_given("levels") ? "levels" : 0;
    if (!option)
        return 0;
    for (size_t i = 0; i < s->list.count; i++)
        if (!ends_with(s->list.scenes[i].path, ".fxs"))
            return 0;
    return fail(EXIT_USAGE, "--%s: %s is served as it is; convert --%s packs it anew", option,
                s->list.scenes[0].path, option);
}

static int fill_site(site *s, const frame_options *o)
{
    int status = page_folder_find(s->folder);
    s->how.load = o->load;
    s->how.load.threads = o->threads;
    memcpy(s->how.background, o->render.background, sizeof s->how.background);
    for (int i = 0; i < o->world.scene_count && !status; i++)
        status = scene_list_add(&s->list, o->world.scenes[i]);
    status = status ? status : check_packing(s);
    status = status ? status : add_scenes(s, o);
    status = status ? status : add_pages(s, o);
    s->served.files = s->files;
    s->served.starts = s->starts;
    s->served.folder = s->folder;
    return status;
}

typedef struct told {
    char near[128], far[128];               /* first local and first public web address of the server; empty: none */
} told;

static void tell(void *self, const char *address, int is_local)
{
    told *t = self;
    char *first = is_local ? t->near : t->far;
    if (!*first)
        snprintf(first, sizeof t->near, "%s/", address);
    printf("%s/\n", address);
}

static void tell_people(const told *t, const view_options *o)
{
    const int is_terminal = fxs_is_terminal(stdout);
    if ((o->qr || (is_terminal && *t->far)) && print_qr_code(*t->far ? t->far : t->near) && o->qr)
        note("--qr: this program was built without libqrencode");
    fflush(stdout);
    if (is_terminal && !o->no_open && !getenv("FIXSPLAT_NO_OPEN") && fxs_browse(*t->near ? t->near : t->far))
        note("no browser is opened: %s", strerror(errno));
}

static void tell_all(const fxs_http_server *server, const view_options *o)
{
    told t = {"", ""};
    fxs_http_each_address(server, tell, &t);
    if (*t.far && !o->key)
        printf("Browsers of other machines have no threads and no headset over http: %sfor a headset on a cable adb "
               "reverse (docs/web.md)\n", fxs_http_has_tls() ? "--cert and --key, or " : "");
    tell_people(&t, o);
}

static int work(site *s)
{
    int did;
    do
        did = scenes_work(s->scenes);
    while (did >= 0 && !fxs_end_wait(did ? 0 : 250));
    return did < 0 ? EXIT_FAILED : EXIT_OK;
}

static int serve(site *s, const view_options *o)
{
    const fxs_http_options options = {o->bind, (uint16_t)o->port, o->certificate, o->key, o->host};
    fxs_http_server *server;
    fxs_message message;
    fxs_end_hold();
    if (fxs_http_open(&server, &s->served, &options, &message))
        return fail_for(&message);
    tell_all(server, o);
    const int status = work(s);
    fxs_http_close(server);
    return status;
}

/* True if an argument is --preview or an abbreviation of it. argv[0] does not tell the program's name, because
   emulators change it. */
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
    fxs_program_begin(&argc, &argv);
    check_printed_at_exit();
    if (is_fit(argc, argv))
        return serve_fit(argc, argv);
    int status = view_options_take(&o, argc, argv);
    if (!status && !o.frame.world.scene_count)
        status = fail(EXIT_USAGE, "view --web takes a scene file, or several; see: fixsplat view --help");
    if (!status)
        status = fill_site(&s, &o.frame);
    if (!status)
        status = serve(&s, &o);
    scenes_free(s.scenes);
    return status;
}
