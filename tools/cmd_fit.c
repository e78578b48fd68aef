/* fixsplat fit: its options. fit_photos.c reads the photographs and opens the fit, fit_steps.c makes the steps,
   fit_end.c writes, measures and prints the result. */
#include "cmd_fit.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/clock.h>
#include "beside.h"
#include "file_guard.h"
#include "fit_result.h"
#include "task.h"

const char *const fit_recipes[] = {"reference", "mcmc", "fast", 0};
static const char *const qualities[] = {"draft", "good", "best", 0};
static const struct {
    enum fxs_fit_recipe recipe;
    uint32_t steps;
    int resolution;                 /* 0: default */
} by_quality[] = {{FXS_FIT_FAST, 3000, 800}, {FXS_FIT_FAST, 8000, 0}, {FXS_FIT_MCMC, 30000, 0}};
static const char *const exposures[] = {"none", "gain", "affine", 0};   /* enum fxs_fit_exposure */
static const char *const alphas[] = {"compose", "ignore", 0};   /* fxs_photos_options.ignore_transparent */

/* ---- Options ----------------------------------------------------------------------------------------------------- */

static int take_block(const option_row *row, void *field, const char *value)
{
    fit_command *c = field;
    const char *slash = strchr(value, '/');
    const size_t length = slash ? (size_t)(slash - value) : 0;
    char first[8] = "";
    uint64_t block, blocks;
    if (length && length < sizeof first)
        memcpy(first, value, length);
    if (!slash || !parse_count(slash + 1, 1, FXS_FIT_BLOCKS_MOST, &blocks) || !parse_count(first, 0, blocks, &block))
        return wrong_value(row, value);
    c->block = (uint32_t)block;
    c->blocks = (uint32_t)blocks;
    return 0;
}

static int take_sky(const option_row *row, void *field, const char *value)
{
    fit_command *c = field;
    uint64_t directions = FXS_FIT_SKY;
    if (value && !parse_count(value, 1, FXS_FIT_SKY_MOST, &directions))
        return wrong_value(row, value);
    c->options.sky = (uint32_t)directions;
    return 0;
}

#define OPTIONS fit_command

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(out), .letter = 'o', .help =
     ".fxs (packed), .ply (floats) or .fit (for --coarse and --resume)"},
    {"quality", "NAME", CHOICE(quality, qualities), .help =
     "draft (small photographs, few steps: to see whether all is well), good (default: of 1200x900 in 13 s on an H100, "
     "28.7 dB) or best (four times the steps and the Gaussians): a recipe with its steps and resolution, where --steps "
     "and --resolution do not say others"},
    {"recipe", "NAME", CHOICE(options.recipe, fit_recipes), .help =
     "how Gaussians are added and taken away, by itself: fast (that of draft and good), mcmc (that of best) or "
     "reference (54 s, 27.9 dB; the published one, to compare with)"},
    {"exposure", "NAME", CHOICE(options.exposure, exposures), .help =
     "none (default), or photographs differ in exposure and white balance, and numbers of each are fitted beside the "
     "scene: gain (three) or affine (a map of colours: 3x3 factors and a constant for each channel); of --block those "
     "of --coarse"},
    {"refine-poses", 0, FLAG(options.refine_poses), .help =
     "cameras are not quite where they are said to be: their poses are fitted beside the scene, those of photographs "
     "that are held out excepted; of --block those of --coarse"},
    {"antialiased", 0, FLAG(options.antialiased), .help =
     "the scene is to be seen from other distances or at other sizes than the photographs: Gaussians smaller than a "
     "pixel get fainter, and none is finer than the photographs are; of --block as --coarse"},
    {"sky", "[=N]", take_sky, 0, .expected = "1 to 1000000 directions", .help =
     "begin with Gaussians far away too, where photographs look and no points lie: sky, clouds, mountains; of N "
     "directions all around, 1 to 1000000 (default 20000); of --block that of --coarse"},
    {"steps", "N", UINT32(options.steps, 1, 1000000000), .help =
     "one photograph each (default 8000, of the other recipes 30000)"},
    {"resolution", "N", INT(reading.resolution, 1, FXS_MAX_SIZE), .help =
     "pixels of a photograph's longer side, at most: averaged down to it (default 1600)"},
    {"sh-degree", "D", INT(frame.render.sh_degree, 0, 3), .help = "highest SH degree, 0 to 3 (default 3)"},
    {"batch", "N", UINT32(options.batch, 1, 8), .help =
     "photographs of a step, 1 to 8 (default 1; with several devices, one for each)"},
    {"block", "I/N", take_block, 0, .expected = "I/N, I from 1 to N, N up to 4096", .help =
     "only the I-th of N blocks of space (N up to 4096), with the photographs that see it; OUT is a .ply of what "
     "lies in it, and convert makes one scene of all"},
    {"coarse", "FILE.fit", TEXT(coarse), .help =
     "of --block: go on from this short fit of the whole set, of small photographs, say; blocks share its Gaussians "
     "out evenly, and block 0 is what it has outside of all of them"},
    {"max-gaussians", "N", SIZE_T(options.max_gaussians, 1, FXS_MAX_COUNT), .help =
     "at most so many (default 250000, mcmc 1000000, reference 4194304)"},
    {"seed", "N", UINT64(options.seed, 0, INFINITY), .help = "of all that is random (default 0)"},
    {"cutoff", "NAME", CHOICE(frame.render.cutoff, cutoff_names), .help = "mahalanobis (default) or square"},
    {"background", "RRGGBB", COLOUR(frame.render.background), .help =
     "behind the scene, and below photographs with alpha (default 000000)"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .help =
     "how the scene is packed, and what the last tenth of the steps fits: default, compact or small"},
    {"crop-to-subject", 0, FLAG(crops), .help =
     "at the end, leave out what lies around the one thing that the cameras look at; measured is the scene before "
     "that"},
    {"hold-out", "N", UINT32(reading.hold_out, 0, UINT32_MAX), .help =
     "keep every N-th photograph by name, from the first on, for measuring (default 8; 0: none, and those that were "
     "fitted are measured)"},
    {"masks", "FOLDER", TEXT(reading.masks), .help =
     "masks of the photographs, that of IMAGE.jpg named IMAGE.jpg.png or IMAGE.png: white where the photograph counts, "
     "black where it is ignored (default: the folder masks beside images, where there is one; none: no masks)"},
    {"invert-masks", 0, FLAG(reading.invert_masks), .help = "masks are black where the photograph counts"},
    {"alpha", "NAME", CHOICE(reading.ignore_transparent, alphas), .help =
     "transparent pixels of photographs: compose (default: on --background) or ignore, as masks do"},
    {"frames", "N", UINT32(frames, 3, 1000), .help =
     "of a film: this many are taken, the sharpest of each stretch (default: one of ten, 60 to 300)"},
    {"cameras-only", 0, FLAG(cameras_only), .help = "find the cameras, in OUT.cameras, and fit nothing"},
    {"skip-bad", 0, FLAG(reading.skip_bad), .help = "leave out photographs that cannot be read, else an error"},
    {"measure", "SCENE", TEXT(measure), .help =
     "fit nothing: measure this scene, of any format, by the photographs that are held out, without -o"},
    {"compare", "FOLDER", TEXT(compare), .help =
     "write there each photograph that is measured beside its picture, .png"},
    {"write-cameras", "FILE", OUTPUT(cameras), .help =
     "at the end write there the cameras of all photographs as the fit has them, a cameras.json"},
    {"save-every", "N", UINT64(save_every, 1, UINT32_MAX), .help =
     "save the fit after every N steps, in OUT.fit; so do Ctrl-C and SIGTERM, and end"},
    {"metrics-every", "N", UINT64(metrics_every, 1, UINT32_MAX), .help =
     "measure the scene as it is after every N steps too, by the photographs that are held out, and print a line"},
    {"preview", 0, FLAG(preview), .help =
     "serve a page on this machine, and print its address, that shows the scene as it is now and how far it has come; "
     "the scene does not depend on it, and the time by a twentieth"},
    {"port", "N", UINT64(port, 0, 65535), .help =
     "of --preview: 1 to 65535, or 0 for any that is free (default 8080)"},
    {"log", "FILE", TEXT(log_name), .help =
     "write there a line after every hundredth of the steps, and with --metrics-every what was measured: a table with "
     "tabs between the fields and their names above; with --resume behind what is there"},
    {"resume", "FILE", TEXT(resume), .help =
     "go on from there, with the same PHOTOS and options for them; the options of the fit are the file's, --steps "
     "may be others. It ends in the bytes of a fit that was never stopped"},
    {"backend", "NAME", TEXT(frame.backend), .choices = WORDS("cpu", "cuda"), .help =
     "what makes the steps: cpu (default), or cuda; the scene does not depend on it"},
    {"device", "LIST", take_devices, FIELD(frame_options, frame), .help =
     "GPUs of --backend cuda: numbers from 0 on with commas, or all (default 0); a batch's photographs are shared "
     "out among them"},
    {"max-memory", "SIZE", BYTES(frame.max_memory), .help =
     "bytes that are taken of each GPU, at most; 512M, 2G (default: any)"},
    {"threads", "N", take_threads, FIELD(frame_options, frame), 1, 64, .help =
     "threads, 1 to 64 (default: one a processor); the scene does not depend on it"},
    {"cpu", "LIST", TEXT(frame.cpu), .help =
     "instruction sets that may be used: all (default), c for none, or names out of sse41,avx2,avx512,neon; the "
     "scene does not depend on it"},
    {"json", 0, FLAG(json), .help = "print a JSON object instead of the table"},
    {0}
};

/* Sets the devices of --backend cuda. */
static int set_devices(fit_command *c, const fxs_backend *backend)
{
    fxs_fit_options *o = &c->options;
    int devices[DEVICES_MOST];
    if (!(backend->can & FXS_CAN_DEVICES))
        return strcmp(backend->name, "cpu") ? fail(EXIT_USAGE, "fit: --backend %s: expected cpu or cuda", backend->name)
                                            : 0;
    const int count = choose_devices(&c->frame, devices);
    for (int i = 0; i < count && i < 8; i++)
        o->devices[i] = devices[i];
    o->device_count = (uint32_t)count;
    o->max_memory = c->frame.max_memory;
    if (count < 1)
        return EXIT_FAILED;
    if (count > 8 || (o->batch && o->batch % o->device_count))
        return fail(EXIT_USAGE, "fit: --batch %u is not a multiple of the %d devices",
                    (unsigned)(o->batch ? o->batch : 8), count);
    return 0;
}

/* Applies options that depend on each other. */
static int finish_options(fit_command *c)
{
    const fxs_backend *backend;
    fxs_backend_options how;
    fxs_fit_options *o = &c->options;
    int status = choose_backend(&c->frame, 0, &backend, &how);
    if (!status)
        status = set_devices(c, backend);
    const int has_quality = is_given("quality");
    if (has_quality)
        o->recipe = by_quality[c->quality].recipe;
    if (has_quality && !is_given("resolution"))
        c->reading.resolution = by_quality[c->quality].resolution;
    if (!is_given("steps"))
        o->steps = c->resume ? 0 : has_quality ? by_quality[c->quality].steps : fxs_fit_recipe_steps(o->recipe);
    if (!is_given("max-gaussians"))
        o->max_gaussians = fxs_fit_recipe_gaussians(o->recipe);
    o->sh_degree = c->frame.render.sh_degree;
    o->cutoff = c->frame.render.cutoff;
    o->profile = c->frame.load.profile;
    o->cpu = ~how.without_cpu;
    o->clock = fxs_clock;
    memcpy(o->background, c->frame.render.background, sizeof o->background);
    memcpy(c->reading.background, o->background, sizeof o->background);
    c->reading.seed = o->seed;
    if (c->reading.masks && !strcmp(c->reading.masks, "none"))
        c->reading.masks = "";
    return status;
}

/* Rejects conflicting options. */
static int check_options(const fit_command *c)
{
    if (!c->out && !c->measure)
        return fail(EXIT_USAGE, "fit: where to? Give -o OUT.fxs or OUT.ply");
    if (is_given("quality") && is_given("recipe"))
        return fail(EXIT_USAGE, "--quality includes a recipe: leave out --recipe");
    if (c->measure && (c->out || c->blocks || c->resume || c->cameras || c->log_name || c->crops))
        return fail(EXIT_USAGE, "--measure: nothing is fitted: leave out -o, --block, --resume, --write-cameras, --log "
                    "and --crop-to-subject");
    if (c->cameras_only && (c->cameras || c->log_name))
        return fail(EXIT_USAGE, "--cameras-only: nothing is fitted: leave out --write-cameras and --log");
    if (c->blocks && !c->block && (c->cameras || c->log_name || c->compare || c->metrics_every))
        return fail(EXIT_USAGE, "--block 0: nothing is fitted: leave out --write-cameras, --log, --compare and "
                    "--metrics-every");
    if (c->options.exposure && c->blocks && !c->coarse)
        return fail(EXIT_USAGE, "--exposure with --block needs --coarse, whose exposures it uses");
    if (c->options.refine_poses && c->blocks && !c->coarse)
        return fail(EXIT_USAGE, "--refine-poses with --block needs --coarse, whose poses it uses");
    if (c->options.sky && c->blocks && !c->coarse)
        return fail(EXIT_USAGE, "--sky with --block needs --coarse, whose sky it uses");
    if (c->crops && (c->blocks || (c->out && ends_with(c->out, ".fit"))))
        return fail(EXIT_USAGE, "--crop-to-subject needs a whole fit, to .fxs or .ply");
    if (c->coarse && !c->blocks)
        return fail(EXIT_USAGE, "--coarse needs --block I/N");
    if (c->blocks && !c->block && !c->coarse)
        return fail(EXIT_USAGE, "--block 0/%u: expected I/N, I from 1 to N; 0 is for --coarse", (unsigned)c->blocks);
    if (c->preview && (c->measure || c->cameras_only || (c->blocks && !c->block)))
        return fail(EXIT_USAGE, "--preview: nothing is fitted: leave out --measure, --cameras-only and --block 0");
    if (is_given("port") && !c->preview)
        return fail(EXIT_USAGE, "--port needs --preview");
    if (c->blocks && !ends_with(c->out, ".ply"))
        return fail(EXIT_USAGE, "--block: %s: expected a name ending in .ply, for convert to merge", c->out);
    return 0;
}

static int read_options(fit_command *c, int argc, char **argv)
{
    memset(c, 0, sizeof *c);
    frame_options_default(&c->frame);
    fxs_fit_options_init(&c->options);
    c->reading.hold_out = 8;
    c->port = 8080;
    if (take_options(&command_fit, c, argc, argv))
        return EXIT_USAGE;
    if (optind != argc - 1)
        return fail(EXIT_USAGE, "fit takes one folder or file of photographs; see: fixsplat fit --help");
    c->argv = argv;
    c->in = argv[optind];
    const int status = check_options(c);
    return status ? status : finish_options(c);
}

/* Checks that the outputs can be written, before hours of work. */
static int check_outputs(fit_command *c)
{
    int wrong = c->measure ? 0 : result_check(c->out);
    if (!wrong && c->cameras)
        wrong = result_check_place(c->cameras);
    if (wrong)
        return wrong;
    const size_t room = strlen(c->measure ? "" : c->out) + sizeof ".fit";
    c->saved = c->measure ? 0 : malloc(room);
    if (!c->saved && !c->measure)
        return fail(EXIT_FAILED, "out of memory");
    if (c->saved)
        snprintf(c->saved, room, "%s.fit", c->out);
    c->saves_itself = c->resume && files_same(c->resume, c->saved);
    files_read(c->in);
    files_read(c->saves_itself ? 0 : c->resume);
    files_read(c->coarse);
    files_read(c->reading.masks);
    files_read(c->measure);
    files_write(c->out);
    files_write(c->saved);
    files_write(c->cameras);
    files_write(c->log_name);
    const int taken = files_check();
    if (taken)
        return taken;
    const int status = c->compare ? make_folder(c->compare) : 0;
    return status ? status : fit_log_open(c->log, c->log_name);
}

/* ---- The command ------------------------------------------------------------------------------------------------- */

int fit_run(int argc, char **argv, const fit_watcher *watcher)
{
    static fit_command c;
    fit_log log = {0};
    int status = read_options(&c, argc, argv);
    c.log = &log;
    if (!status && c.preview && !watcher)
        return run_beside(&server_program, "--preview", argv);
    c.watcher = c.preview ? watcher : 0;
    status = status ? status : check_outputs(&c);
    if (!status && c.watcher)
        status = c.watcher->open(c.out, c.port);
    if (!status) {
        status = fit_photos(&c);
        if (c.watcher)
            c.watcher->close(status);
    }
    fit_log_close(&log);
    free(c.saved);
    free(c.found);
    return status;
}

static int run(int argc, char **argv)
{
    return fit_run(argc, argv, 0);
}

const command command_fit = {
    "fit", "photographs -> scene", run,
    "Usage: fixsplat fit PHOTOS -o OUT [OPTION...]\n\n"
    "Fits a scene to photographs, on the processor or on NVIDIA GPUs: the same file, byte for byte, for the same\n"
    "photographs, options and seed, whatever the machine and the threads. PHOTOS is a COLMAP folder (images, and\n"
    "sparse/0 or sparse with .bin or .txt), a transforms.json of nerfstudio or Blender, Inria's cameras.json, .xml of\n"
    "Metashape, .csv of RealityCapture or .out of Bundler with images beside it, or a folder with one of those. Of a\n"
    "folder of photographs without cameras, or of a film, they are found first, by COLMAP and ffmpeg, in the folder\n"
    "OUT.cameras. At the end the packed scene is rendered from where photographs were held out, and PSNR and SSIM are\n"
    "printed.\n",
    0,
    "  $ fixsplat fit garden -o garden.fxs\n"
    "  $ fixsplat fit walk.mp4 -o walk.fxs --quality draft --compare pictures\n"
    "  $ fixsplat fit garden -o garden.ply --resolution 600 --steps 7000 --compare pictures\n"
    "  $ fixsplat fit garden -o garden.fxs --preview --backend cuda --device 0,1\n"
    "  $ fixsplat fit lego/transforms_train.json -o lego.fxs --background ffffff --json\n"
    "  $ fixsplat fit garden -o garden.fxs --resume garden.fxs.fit\n"
    "  $ fixsplat fit city -o coarse.fit --recipe reference --resolution 400 --steps 3000\n"
    "  $ fixsplat fit city -o part-1.ply --recipe reference --coarse coarse.fit --block 1/16\n",
    {{own_rows, 0}, COMMON_TABLE}
};
