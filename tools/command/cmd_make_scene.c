/* fixsplat make-scene: writes a procedural scene. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include "command.h"
#include "command_line.h"
#include "procedural.h"

typedef struct make_options {
    const char *output;
    uint64_t count, seed;                   /* number of Gaussians; 0: the scene's default number */
} make_options;

#define OPTIONS make_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(output), .letter = 'o', .help = "output file, .ply"},
    {"count", "N", UINT64(count, 1, 100000000), .help = "number of Gaussians, 1 to 100000000 (default: listed below)"},
    {"seed", "S", UINT64(seed, 0, UINT32_MAX), .help = "seed of the random numbers, 0 to 4294967295 (default 1)"},
    {0}
};

static void list_scenes(void)
{
    size_t count;
    const fxs_procedural_scene *scenes = fxs_procedural_list(&count);
    puts("\nScenes:");
    for (size_t i = 0; i < count; i++)
        printf("  %-12s %s (degree %d, %" PRIu64 " Gaussians)\n", scenes[i].name, scenes[i].description,
               scenes[i].sh_degree, scenes[i].count);
}

static int write_scene(const fxs_procedural_scene *scene, uint64_t count, uint32_t seed, const char *output)
{
    enum { BATCH = 512 };
    fxs_gaussian batch[BATCH];
    const fxs_scene_write_options options = {.size = sizeof(fxs_scene_write_options), .count = count,
                                             .sh_degree = scene->sh_degree, .format = "ply"};
    fxs_scene_writer *writer;
    fxs_message message;
    char label[] = "writing";
    if (fxs_scene_writer_open(output, &options, &writer, &message))
        return fail_for(&message);
    int result = 0;
    for (uint64_t i = 0; i < count && !result;) {
        size_t n = 0;
        while (n < BATCH && i < count)
            scene->gaussian(i++, count, seed, &batch[n++]);
        result = fxs_scene_writer_put(writer, batch, n, &message);
        if (i % (BATCH * 64) == 0)
            progress_bar(label, (double)i / (double)count);
    }
    progress_end();
    fxs_message closing;
    if (fxs_scene_writer_close(writer, 0, 0, &closing) && !result)
        return fail_for(&closing);
    return result ? fail_for(&message) : 0;
}

static int is_of_another_format(const char *name)
{
    const fxs_scene_format *format = fxs_scene_format_of(name, 1);
    return format && strcmp(format->name, "ply");
}

static int run(int argc, char **argv)
{
    make_options o = {.seed = 1};
    if (take_options(&command_make_scene, &o, argc, argv))
        return EXIT_USAGE;
    if (optind != argc - 1 || !o.output)
        return fail(EXIT_USAGE, "make-scene takes a name and -o OUT.ply; see: fixsplat make-scene --help");
    if (is_of_another_format(o.output))
        return fail(EXIT_USAGE, "%s: expected a name ending in .ply; convert writes other formats", o.output);
    const fxs_procedural_scene *scene = fxs_procedural_find(argv[optind]);
    if (!scene)
        return fail(EXIT_USAGE, "no scene '%s'; see: fixsplat make-scene --help", argv[optind]);
    return write_scene(scene, o.count ? o.count : scene->count, (uint32_t)o.seed, o.output);
}

const command command_make_scene = {
    "make-scene", "writes a procedural scene", run,
    "Usage: fixsplat make-scene NAME -o OUT.ply [OPTION...]\n\n"
    "Writes a procedural scene as .ply. The same name, count and seed give the same bytes on every machine.\n",
    list_scenes,
    "  $ fixsplat make-scene knot -o knot.ply\n"
    "  $ fixsplat make-scene landscape --count 10000000 -o landscape.ply\n",
    {{own_rows, 0}, COMMON_TABLE}
};
