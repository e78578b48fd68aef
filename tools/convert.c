/* fixsplat convert */
#include <stdlib.h>
#include <string.h>

#include "../port/formats/fxs_file.h"
#include "../port/formats/ply_write.h"
#include "command.h"

static const char help[] =
    "Usage: fixsplat convert IN OUT [--lod LEVEL]\n\n"
    "Writes a scene file as another, by the ending of OUT:\n\n"
    "  .fxs    packed: opens at once and is rendered from the file as it lies, at most 64 bytes a Gaussian\n"
    "  .ply    Inria's, floats; not from an .fxs\n\n"
    "Examples:\n"
    "  fixsplat convert scene.ply scene.fxs\n"
    "  fixsplat render scene.fxs -o scene.png\n";

static int ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), tail = strlen(ending);
    return length > tail && !strcmp(name + length - tail, ending);
}

static int to_fxs(const char *in, const char *out, int lod)
{
    loaded_scene loaded;
    fxs_message message;
    if (load_scene(&loaded, in, lod, fxs_processors()))
        return EXIT_FAILED;
    int result = fxs_file_write(out, loaded.packed.data, loaded.packed.bytes, &message);
    free_scene(&loaded);
    return result ? fail(EXIT_FAILED, "%s", message.text) : EXIT_OK;
}

static int copy(fxs_scene_file *file, fxs_ply_writer *writer, uint64_t count, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    char label[] = "converting";
    uint64_t done = 0;
    for (long n; (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0; done += (uint64_t)n) {
        if (n < 0 || fxs_ply_writer_put(writer, batch, (size_t)n, message))
            return -1;
        if (done % (BATCH * 256) == 0)
            progress_bar(label, (double)done / (double)count);
    }
    return 0;
}

static int to_ply(const char *in, const char *out, int lod)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_ply_writer *writer;
    fxs_message message, closing;
    if (fxs_scene_file_open_lod(in, lod, &file, &info, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    int result = fxs_ply_writer_open(out, info.count, info.sh_degree, info.antialiased, &writer, &message);
    if (!result) {
        result = copy(file, writer, info.count, &message);
        if (fxs_ply_writer_close(writer, &closing) && !result) {
            message = closing;
            result = -1;
        }
    }
    fxs_scene_file_close(file);
    progress_end();
    return result ? fail(EXIT_FAILED, "%s", message.text) : EXIT_OK;
}

int command_convert(int argc, char **argv)
{
    static const struct option table[] = {{"lod", required_argument, 0, OPT_LOD}, {"help", no_argument, 0, OPT_HELP},
                                          {0, 0, 0, 0}};
    int lod = 0;
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;) {
        if (c == OPT_HELP) {
            fputs(help, stdout);
            return EXIT_OK;
        }
        if (c != OPT_LOD)
            return wrong_option(argv);
        if (take_lod(&lod, optarg))
            return EXIT_USAGE;
    }
    if (optind != argc - 2)
        return fail(EXIT_USAGE, "convert takes two files, IN and OUT; see: fixsplat convert --help");
    const char *in = argv[optind], *out = argv[optind + 1];
    if (ends_with(out, ".fxs"))
        return to_fxs(in, out, lod);
    if (ends_with(out, ".ply"))
        return to_ply(in, out, lod);
    return fail(EXIT_USAGE, "%s: expected a name ending in .fxs or .ply", out);
}
