/* fixsplat: renders 3D Gaussian splatting scenes in fixed point. */
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/output.h>
#include "src/base/os_calls.h"
#include "file_guard.h"
#include "drawing.h"

static const command *const commands[] = {
    &command_render, &command_view, &command_info, &command_convert, &command_fit, &command_compare,
    &command_mesh, &command_collide, &command_select, &command_publish, &command_make_scene, &command_bench,
    &command_demo, &command_doctor, &command_associate, 0
};

enum { COMMANDS = sizeof commands / sizeof *commands - 1 };

static const char backends_help[] =
    "--backend chooses the renderer; all give the same bytes. fixsplat info --backends lists the back ends of this\n"
    "machine, and why others cannot run; --json lists them for a program. auto (default) takes cpu, but in the window\n"
    "of view, and where render draws over 16777216 pixels (18 pictures of 1280x720), the fastest by a trial, kept in\n"
    "the user's cache folder. fixsplat doctor shows the trial. With --cpu, --threads or --max-memory, and in other\n"
    "commands, auto takes cpu.\n\n";

static void help_backends(void)
{
    const fxs_backend *b;
    fputs(backends_help, stdout);
    for (int i = 0; (b = fxs_backend_at(i)) != 0; i++)
        printf("  %-19s %s\n", b->name, b->does);
}

static void help_cameras(void)
{
    puts("Options of render, view and bench:");
    print_rows(camera_rows);
    print_rows(world_rows);
}

static void help_formats(void)
{
    const fxs_scene_format *f;
    printf("Scenes, by the endings of their names (convert writes by the first):\n\n");
    for (int i = 0; (f = fxs_scene_format_at(i)) != 0; i++) {
        printf("  %-31s %-8s %s\n", f->endings, f->is_read && f->is_written ? "in, out" : f->is_read ? "in" : "out",
               f->about);
        if (f->is_written && f->loses)
            printf("  %40s written: %s\n", "", f->loses);
    }
    printf("\nPictures that are written:\n\n"
           "  .png, .ppm, .raw, .jpg, .webp; depths as .pfm, .exr; films as .mp4, .webm, .gif (ffmpeg), .y4m, .rgba\n");
}

static const struct {
    const char *name, *about;
    void (*print)(void);
} topics[] = {
    {"cameras", "options of cameras and of placing scenes", help_cameras},
    {"formats", "files that are read and written", help_formats},
    {"backends", "renderers for --backend", help_backends},
};

enum { TOPICS = sizeof topics / sizeof *topics };

static void help(void)
{
    puts("fixsplat " FXS_VERSION ": renders 3D Gaussian splatting scenes in fixed point.\n\n"
         "Usage: fixsplat COMMAND [OPTION...]\n"
         "  or:  fixsplat SCENE... [OPTION...]     (as fixsplat view)\n"
         "  or:  fixsplat COMMAND --help [all]\n"
         "  or:  fixsplat help COMMAND [all]\n"
         "  or:  fixsplat help TOPIC\n\n"
         "Commands:");
    for (int i = 0; i < COMMANDS; i++)
        printf("  %-19s %s\n", commands[i]->name, commands[i]->does);
    puts("\nTopics of help:");
    for (int i = 0; i < TOPICS; i++)
        printf("  %-19s %s\n", topics[i].name, topics[i].about);
    print_rows(common_rows);
    puts("  A long option may be shortened to an unambiguous beginning. Later versions may add options.\n"
         "\nInstead of a command:\n"
         "  --kernels           print the version of each stage that runs on this machine\n"
         "\nOutputs:\n"
         "  A complete output replaces the file of its name. An input is never replaced, except by convert --force.\n"
         "  A FIFO or a device is written to directly. For a link, the target is replaced.\n\n"
         "Exit status:\n"
         "  0                   done\n"
         "  1                   failed\n"
         "  2                   wrong usage\n"
         "  A closed pipe ends the program by SIGPIPE (141 in a shell).\n\n"
         "Examples:\n"
         "  $ fixsplat make-scene knot -o knot.ply\n"
         "  $ fixsplat render knot.ply -o knot.png\n"
         "  $ fixsplat render scene.ply --cameras cameras.json --view 0 -o view.png --stats");
}

static int kernels(void)
{
    frame_options options;
    renderer r;
    frame_options_default(&options);
    options.threads = 1;
    if (renderer_open(&r, &options))
        return EXIT_FAILED;
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%-8s %s\n", fxs_stage_name((enum fxs_stage)i), r.backend->version(r.self, (enum fxs_stage)i));
    renderer_close(&r);
    return EXIT_OK;
}

static const command *find_command(const char *name)
{
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(name, commands[i]->name))
            return commands[i];
    return 0;
}

static int wrong_command(const char *name)
{
    suggestion s = {0, 0};
    if (!*name)
        return fail(EXIT_USAGE, "no command; see: fixsplat --help");
    for (int i = 0; i < COMMANDS; i++)
        suggest(&s, name, strlen(name), commands[i]->name);
    suggest(&s, name, strlen(name), "help");
    return s.name ? fail(EXIT_USAGE, "no command '%s'; did you mean %s? See: fixsplat --help", name, s.name)
                  : fail(EXIT_USAGE, "no command '%s'; see: fixsplat --help", name);
}

static void skip_line(void)
{
    int c = getchar();
    while (c != '\n' && c != EOF)
        c = getchar();
}

/* For a program that was started by a double click: its console closes when the program ends. */
static int wait_for_enter(int status)
{
    fputs("\nPress Enter to close this window.\n", stderr);
    skip_line();
    return status;
}

static int greet(void)
{
    puts("fixsplat shows, renders, converts and fits scenes of 3D Gaussian splatting.\n\n"
         "To see a scene:      drop its file onto fixsplat.exe, or open fixsplat-view.exe.\n"
         "To render, convert:  open a console in this folder (type cmd into Explorer's address bar), then type\n"
         "                     fixsplat --help\n"
         "To open .fxs and .ply files by a double click from now on: type a and Enter.");
    fflush(stdout);
    const int key = getchar();
    if (key != 'a' && key != 'A')
        return EXIT_USAGE;
    skip_line();
    return wait_for_enter(command_associate.run(1, (char *[]){"associate", 0}));
}

/* Shows the scenes of a command line without a command, such as that of a file dropped onto the program. */
static int show(int argc, char **argv)
{
    const int status = command_view.run(argc, argv);
    return status && fxs_terminal_ends_with_this() ? wait_for_enter(status) : status;
}

static void help_table(void)
{
    for (int i = 0; i < COMMANDS; i++)
        print_table(commands[i]);
}

static int help_about(const char *name, int all)
{
    const command *c = find_command(name);
    suggestion s = {0, 0};
    if (c) {
        print_help(c, all);
        return EXIT_OK;
    }
    for (int i = 0; i < TOPICS; i++)
        if (!strcmp(name, topics[i].name)) {
            topics[i].print();
            return EXIT_OK;
        }
    for (int i = 0; i < COMMANDS; i++)
        suggest(&s, name, strlen(name), commands[i]->name);
    for (int i = 0; i < TOPICS; i++)
        suggest(&s, name, strlen(name), topics[i].name);
    return s.name ? fail(EXIT_USAGE, "no help on '%s'; did you mean %s? See: fixsplat help", name, s.name)
                  : fail(EXIT_USAGE, "no help on '%s'; see: fixsplat help", name);
}

int main(int argc, char **argv)
{
    fxs_program_begin(&argc, &argv);
    fxs_output_remove_at_signals();
    check_printed_at_exit();
    files_begin();
    all_commands = commands;
    for (; argc > 1 && !strcmp(argv[1], "--quiet"); argc--, argv++)
        be_quiet();
    const char *name = argc > 1 ? argv[1] : "";
    if (!strcmp(name, "help") && argc > 2 && argv[2][0] != '-') {
        const int all = argc == 4 && !strcmp(argv[3], "all");
        return argc == 3 || all ? help_about(argv[2], all) : fail(EXIT_USAGE, "help takes one command or topic");
    }
    if (!strcmp(name, "help") && argc == 3 && !strcmp(argv[2], "--table")) {
        help_table();
        return EXIT_OK;
    }
    if (!strcmp(name, "--help") || !strcmp(name, "-h") || !strcmp(name, "help")) {
        help();
        return EXIT_OK;
    }
    if (!strcmp(name, "--version") || !strcmp(name, "-V") || !strcmp(name, "version")) {
        print_version();
        return EXIT_OK;
    }
    if (!strcmp(name, "--kernels"))
        return kernels();
    const command *c = find_command(name);
    if (c)
        return c->run(argc - 1, argv + 1);
    if (!*name && fxs_terminal_ends_with_this())
        return greet();
    return fxs_file_kind(name) != FXS_FILE_NONE ? show(argc, argv) : wrong_command(name);
}
