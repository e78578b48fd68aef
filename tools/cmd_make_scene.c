/* fixsplat make-scene */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/formats.h>
#include <fixsplat/scene_write.h>
#include "command.h"
#include "src/scene/make/procedural.h"

static void help(void)
{
    size_t count;
    const fxs_procedural_scene *scenes = fxs_procedural_list(&count);
    puts("Usage: fixsplat make-scene NAME -o OUT.ply [--count N] [--seed S]\n\n"
         "Writes a procedural scene as .ply: the same bytes for the same name, count and seed, everywhere.\n");
    for (size_t i = 0; i < count; i++)
        printf("  %-12s %s (degree %d, %" PRIu64 " Gaussians)\n", scenes[i].name, scenes[i].description,
               scenes[i].sh_degree, scenes[i].count);
    puts("\n"
         "  -o, --output OUT    the file\n"
         "  --count N           Gaussians, 1 to 100000000 (default: the scene's own, above)\n"
         "  --seed S            0 to 4294967295 (default 1)\n\n"
         "Examples:\n"
         "  fixsplat make-scene knot -o knot.ply\n"
         "  fixsplat make-scene landscape --count 10000000 -o landscape.ply");
}

static int write_scene(const fxs_procedural_scene *scene, uint64_t count, uint32_t seed, const char *output)
{
    enum { BATCH = 512 };
    fxs_gaussian batch[BATCH];
    const fxs_scene_write_options options = {.count = count, .sh_degree = scene->sh_degree, .format = "ply"};
    fxs_scene_writer *writer;
    fxs_message message;
    char label[] = "writing";
    if (fxs_scene_writer_open(output, &options, &writer, &message))
        return fail(EXIT_FAILED, "%s", message.text);
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
    if (fxs_scene_writer_close(writer, 0, 0, 0, &closing) && !result)
        return fail(EXIT_FAILED, "%s", closing.text);
    return result ? fail(EXIT_FAILED, "%s", message.text) : 0;
}

/* By its ending; standard output and devices have none. */
static int is_of_another_format(const char *name)
{
    const fxs_scene_format *format = fxs_scene_format_of(name, 1);
    return format && strcmp(format->name, "ply");
}

int command_make_scene(int argc, char **argv)
{
    enum { OPT_COUNT = OPT_OWN, OPT_SEED };
    static const struct option table[] = {{"output", required_argument, 0, 'o'},
                                          {"count", required_argument, 0, OPT_COUNT},
                                          {"seed", required_argument, 0, OPT_SEED},
                                          COMMON_OPTIONS};
    const char *output = 0;
    uint64_t count = 0, seed = 1;
    for (int c; (c = next_option(argc, argv, "o:" COMMON_LETTERS, table, 0, help)) != -1;)
        switch (c) {
        case 'o':
            if (take_output("output", optarg, &output))
                return EXIT_USAGE;
            break;
        case OPT_COUNT:
            if (!parse_count(optarg, 1, 100000000, &count))
                return fail(EXIT_USAGE, "--count %s: expected 1 to 100000000", optarg);
            break;
        case OPT_SEED:
            if (!parse_count(optarg, 0, UINT32_MAX, &seed))
                return fail(EXIT_USAGE, "--seed %s: expected 0 to 4294967295", optarg);
            break;
        default: return EXIT_USAGE;
        }
    if (optind != argc - 1 || !output)
        return fail(EXIT_USAGE, "make-scene takes a name and -o OUT.ply; see: fixsplat make-scene --help");
    if (is_of_another_format(output))
        return fail(EXIT_USAGE, "%s: a .ply is written; convert makes others of it", output);
    const fxs_procedural_scene *scene = fxs_procedural_find(argv[optind]);
    if (!scene)
        return fail(EXIT_USAGE, "no scene '%s'; see: fixsplat make-scene --help", argv[optind]);
    return write_scene(scene, count ? count : scene->count, (uint32_t)seed, output);
}
