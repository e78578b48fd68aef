/* fixsplat doctor: lists the libraries, programs and devices of this machine, and tells what each missing one is good
   for. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "auto_backend.h"
#include "programs.h"
#include "drawing.h"
#include "tools/serve/page_folder.h"
#include "task.h"

/* The macro expands to 1 if its argument is a macro defined as 1, else to 0. */
#define IS_BUILT(macro) IS_BUILT_OF(macro)
#define IS_BUILT_OF(value) SECOND_OF(BEFORE_##value 1, 0, 0)
#define BEFORE_1 0,
#define SECOND_OF(...) SECOND(__VA_ARGS__)
#define SECOND(first, second, ...) second

static const struct {
    const char *name;
    int is_built;
    const char *gives;
} parts[] = {
    {"cJSON", IS_BUILT(FXS_WITH_CJSON), "reads .gltf, .glb, .sog, .lcc, 3D Tiles, worlds and cameras"},
    {"libzip", IS_BUILT(FXS_WITH_ZIP), "reads and writes .sog"},
    {"zlib", IS_BUILT(FXS_WITH_ZLIB), "reads and writes .spz and .rad, writes .png"},
    {"libdeflate", IS_BUILT(FXS_WITH_DEFLATE), "writes .png smaller and sooner"},
    {"zstd", IS_BUILT(FXS_WITH_ZSTD), "reads and writes .spz of version 4"},
    {"libpng", IS_BUILT(FXS_WITH_PNG), "reads photographs and masks of .png"},
    {"libjpeg", IS_BUILT(FXS_WITH_JPEG), "reads photographs of .jpg"},
    {"libwebp", IS_BUILT(FXS_WITH_WEBP), "reads .sog and photographs of .webp, writes both"},
    {"libexif", IS_BUILT(FXS_WITH_EXIF), "reads which way up a photograph is, and its lens"},
    {"expat", IS_BUILT(FXS_WITH_EXPAT), "reads cameras of Metashape, .xml"},
};

static const struct {
    const char *name, *library, *package;
    int is_built;
    const char *gives;
} helpers[] = {
    {"ffmpeg", 0, "ffmpeg", 1, "fit takes films, render writes .mp4, .webm and .gif"},
    {"colmap", 0, "colmap", 1, "fit finds the cameras of photographs that come without"},
#ifndef _WIN32
    {"xdg-open", 0, "xdg-utils", 1, "view --web opens the browser"},
#endif
    {"libheif", "libheif.so.1", "libheif1", IS_BUILT(FXS_WITH_HEIF), "fit takes photographs of .heic"},
    {"libcurl", "libcurl.so.4", "libcurl4", IS_BUILT(FXS_WITH_CURL), "view and render take the address of a scene"},
};

static void line(const char *name, int is_here, const char *what, const char *words)
{
    printf("%-14s %s%s%s\n", name, is_here ? "here" : "not here", *words ? ": " : "", words);
    if (!is_here)
        printf("%-14s   with it: %s\n", "", what);
}

static void print_processor(void)
{
    frame_options options;
    renderer r;
    frame_options_default(&options);
    options.threads = 1;
    printf("%-14s %u threads", "processor", (unsigned)fxs_processors());
    if (!renderer_open(&r, &options)) {
        for (int i = 0; i < FXS_STAGES; i++)
            printf("%s %s by %s", i ? "," : ";", fxs_stage_name((enum fxs_stage)i),
                   r.backend->version(r.self, (enum fxs_stage)i));
        renderer_close(&r);
    }
    puts("");
}

/* Adds what the trial says of a back end to its line. */
static void add_trial(char *words, size_t room, const trial_result *r)
{
    const size_t length = strlen(words);
    if (r->state >= TRIAL_SLOW)
        snprintf(words + length, room - length, "; trial: %.1f ms a %sframe, opened in %.0f ms", r->frame_us / 1e3,
                 r->state == TRIAL_SLOW ? "small " : "", r->open_us / 1e3);
    else
        snprintf(words + length, room - length, "; never taken by auto: %s", r->state == TRIAL_DIFFERS
                 ? "its picture differs from the processor's" : r->text);
}

static void print_backends(const trial *t)
{
    const fxs_backend *b;
    for (int i = 0; (b = fxs_backend_at(i)) != 0; i++) {
        char words[512];
        fxs_message why;
        const int is_here = !b->device(0, words, 256, &why);
        if (!is_here)
            snprintf(words, sizeof words, "%s", why.text);
        for (int k = 0; k < t->count && is_here; k++)
            if (t->results[k].backend == b)
                add_trial(words, sizeof words, &t->results[k]);
        line(b->name, is_here, b->does, words);
    }
}

/* True if a kept trial names the devices that are here now. */
static int is_of_today(const trial *t)
{
    for (int i = 0; i < t->count; i++) {
        const trial_result *r = &t->results[i];
        char name[TRIAL_TEXT];
        fxs_message why;
        const int is_here = !r->backend->device(0, name, sizeof name, &why);
        if (is_here == (r->state == TRIAL_ABSENT) ||
            (r->state >= TRIAL_DIFFERS && strcmp(name, r->text)))
            return 0;
    }
    return 1;
}

static void print_auto(int is_anew)
{
    trial t;
    fxs_message why;
    int error = trial_get(&t, is_anew, &why);
    if (!error && !is_anew && !is_of_today(&t))
        error = trial_get(&t, 1, &why);
    print_backends(&t);
    printf("%-14s takes %s for a window and for many pictures%s%s\n", "auto", trial_fastest(&t, 0)->backend->name,
           error ? "; its trial is not kept: " : "", error ? why.text : "");
}

static void print_formats(void)
{
    char text[512];
    fxs_scene_format_endings(text, sizeof text, 0);
    printf("%-14s %s\n", "scenes read", text);
    fxs_scene_format_endings(text, sizeof text, 1);
    printf("%-14s %s\n", "and written", text);
}

static void print_page(void)
{
    char folder[PAGE_PATH];
    const int is_here = page_folder_look(folder);
    line("page", is_here,
         "view --web and publish show scenes in a browser: share/fixsplat/web beside bin, or make setup web",
         is_here ? folder : "");
}

static void print_helpers(void)
{
    for (size_t i = 0; i < sizeof helpers / sizeof *helpers; i++) {
        const char *const name = helpers[i].name, *const library = helpers[i].library;
        const int is_built = helpers[i].is_built;
        char words[TO_INSTALL], what[160];
        snprintf(what, sizeof what, "%s: %s%s", helpers[i].gives, is_built ? "" : "built with ",
                 is_built ? to_install(words, helpers[i].package, library ? "" : TO_PATH) : name);
        line(name, is_built && (library ? fxs_library_is_here(library) : fxs_program_is_here(name)), what, "");
    }
}

typedef struct doctor_options {
    int trial;
} doctor_options;

#define OPTIONS doctor_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"trial", 0, FLAG(trial), .help = "make the trial of the back ends anew by which --backend auto chooses"},
    {0}
};

static int run(int argc, char **argv)
{
    doctor_options o = {0};
    if (take_options(&command_doctor, &o, argc, argv))
        return EXIT_USAGE;
    if (optind != argc)
        return fail(EXIT_USAGE, "doctor takes no '%s'; see: fixsplat doctor --help", argv[optind]);
    print_version();
    print_processor();
    print_auto(o.trial);
    print_formats();
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        line(parts[i].name, parts[i].is_built, parts[i].gives, "");
    line("window", *window_program.ending != 0, "view has a window: built with SDL2", "");
    line("server", *server_program.ending != 0, "view --web has a server: built with libmicrohttpd", "");
    print_page();
    print_helpers();
    return EXIT_OK;
}

const command command_doctor = {
    "doctor", "lists libraries, programs and devices of this machine", run,
    "Usage: fixsplat doctor [--trial]\n\n"
    "Lists threads, instruction sets, GPUs, formats, libraries and programs of this machine, one per line, and the\n"
    "use of each missing one. A missing one is no error: the exit status is 0.\n\n"
    "Also shows the trial of the back ends for --backend auto: each draws a small scene. It is kept in the file\n"
    "$XDG_CACHE_HOME/fixsplat/trial (default ~/.cache/fixsplat/trial; Windows: %LOCALAPPDATA%\\fixsplat\\trial), and\n"
    "made anew for another version, processor, device or driver.\n",
    0,
    "  $ fixsplat doctor\n"
    "  $ fixsplat doctor --trial\n",
    {{own_rows, 0}, COMMON_TABLE}
};
