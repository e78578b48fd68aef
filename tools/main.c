/* fixsplat: renders 3D Gaussian splatting scenes in fixed point. */
#include <string.h>

#include "../port/files/output.h"
#include "renderer.h"

static const struct {
    const char *name, *does;
    int (*run)(int argc, char **argv);
} commands[] = {
    {"render", "scene file -> picture", command_render},
    {"view", "scene file -> window, or --web: page", command_view},
    {"info", "what a scene holds, and what it needs", command_info},
    {"convert", "scene file -> .fxs (packed), .ply, .splat or .spz", command_convert},
    {"fit", "photographs -> scene", command_fit},
    {"compare", "how far two pictures are apart", command_compare},
    {"make-scene", "writes a procedural scene", command_make_scene},
    {"bench", "times each stage", command_bench},
};

enum { COMMANDS = sizeof commands / sizeof *commands };

static void help(void)
{
    puts("fixsplat " FXS_VERSION ": renders 3D Gaussian splatting scenes in fixed point.\n\n"
         "Usage: fixsplat COMMAND [OPTION...]     (fixsplat COMMAND --help tells more)\n");
    for (int i = 0; i < COMMANDS; i++)
        printf("  %-12s %s\n", commands[i].name, commands[i].does);
    puts("  --kernels    which version of each stage runs here\n"
         "  --version\n"
         "\nExamples:\n"
         "  fixsplat make-scene knot -o knot.ply\n"
         "  fixsplat render knot.ply -o knot.png\n"
         "  fixsplat render scene.ply --cameras cameras.json --view 0 -o view.png --stats\n\n"
         "Exit status: 0 done, 1 failed, 2 wrong usage.");
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

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";
    fxs_output_remove_at_signals();
    check_printed_at_exit();
    if (!strcmp(name, "--help") || !strcmp(name, "-h") || !strcmp(name, "help")) {
        help();
        return EXIT_OK;
    }
    if (!strcmp(name, "--version")) {
        puts("fixsplat " FXS_VERSION);
        return EXIT_OK;
    }
    if (!strcmp(name, "--kernels"))
        return kernels();
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(name, commands[i].name))
            return commands[i].run(argc - 1, argv + 1);
    if (!*name)
        return fail(EXIT_USAGE, "no command; see: fixsplat --help");
    return fail(EXIT_USAGE, "no command '%s'; see: fixsplat --help", name);
}
