/* fixsplat demo: makes a first picture with the commands make-scene and render. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include "command.h"
#include "command_line.h"

enum { PATH_MOST = 4096 };

typedef struct demo_options {
    const char *output;
    int view;
} demo_options;

#define OPTIONS demo_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(output), .letter = 'o', .help =
     "picture: .png, .ppm, .raw, .jpg or .webp (default demo.png). The scene gets the same name, as .ply"},
    {"view", 0, FLAG(view), .help = "then show the scene in a window"},
    {0}
};

static void print_command(char **argv)
{
    fputs("$ fixsplat", stdout);
    while (*argv)
        write_shell_word(stdout, *argv++);
    puts("");
    fflush(stdout);
}

static int run_command(const command *c, char **argv)
{
    int argc = 0;
    while (argv[argc])
        argc++;
    if (!is_quiet())
        print_command(argv);
    optind = 1;
    return c->run(argc, argv);
}

static int run_demo(const demo_options *o, char *picture)
{
    char scene[PATH_MOST + 4];
    const char *ending = strrchr(picture, '.');
    sprintf(scene, "%.*s.ply", (int)(ending - picture), picture);
    char *make[] = {"make-scene", "knot", "--count", "200000", "-o", scene, 0};
    char *render[] = {"render", scene, "--eye", "0.9,-2.6,-12.8", "--look", "0,0.42,0", "--fov", "36", "--bg", "11131b",
                      "-o", picture, "--stats", 0};
    char *view[] = {"view", scene, 0};
    int status = run_command(&command_make_scene, make);
    status = status ? status : run_command(&command_render, render);
    if (status)
        return status;
    printf("%s: 200,000 Gaussians with view-dependent colour of degree 3, from %s\n", picture, scene);
    return o->view ? run_command(&command_view, view) : EXIT_OK;
}

static int run(int argc, char **argv)
{
    demo_options o = {0};
    char picture[PATH_MOST];
    if (take_options(&command_demo, &o, argc, argv))
        return EXIT_USAGE;
    if (optind != argc)
        return fail(EXIT_USAGE, "demo takes no '%s'; see: fixsplat demo --help", argv[optind]);
    o.output = o.output ? o.output : "demo.png";
    if (!fxs_image_file_known(o.output) || strlen(o.output) >= sizeof picture)
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", o.output);
    return run_demo(&o, strcpy(picture, o.output));
}

const command command_demo = {
    "demo", "makes a scene and renders a first picture", run,
    "Usage: fixsplat demo [OPTION...]\n\n"
    "Makes a procedural scene, demo.ply, and renders it to demo.png. Prints the two commands that do it. Needs no\n"
    "display.\n",
    0,
    "  $ fixsplat demo\n"
    "  $ fixsplat demo -o first.jpg --view\n",
    {{own_rows, 0}, COMMON_TABLE}
};
