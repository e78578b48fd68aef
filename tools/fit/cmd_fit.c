/* Command-line options of `fixsplat fit`. */
#include "cmd_fit.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "tools/command/programs.h"
#include "tools/command/file_guard.h"
#include "fit_result.h"
#include "tools/command/task.h"

const char *const fit_recipes[] = {"reference", "mcmc", "fast", 0};
const char *const fit_qualities[] = {"draft", "good", "best", 0};
const fit_preset fit_presets[] = {{FXS_FIT_FAST, 3000, 800}, {FXS_FIT_FAST, 8000, 1600}, {FXS_FIT_MCMC, 30000, 1600}};
/* What --of sets, unless an option is given itself. */
static const char *const subjects[] = {"thing", "room", "outdoors", 0};
static const struct {
    const char *options;
    int crops, antialiased;
    uint32_t sky;
} by_subject[] = {{"--crop-to-subject", 1, 0, 0}, {"--antialiased", 0, 1, 0}, {"--sky", 0, 0, FXS_FIT_SKY}};
static const char *const sources[] = {"mixed", 0};
static const char *const exposures[] = {"none", "gain", "affine", 0};
static const char *const alphas[] = {"compose", "ignore", 0};

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

static int take_watch(const option_row *row, void *field, const char *value)
{
    fit_command *c = field;
    uint64_t seconds = 300;
    if (value && !parse_count(value, 1, 86400, &seconds))
        return wrong_value(row, value);
    c->watch_seconds = (uint32_t)seconds;
    return 0;
}

#define OPTIONS fit_command

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(out), .letter = 'o', .basic = 1, .help =
     "result: .fxs (packed), .ply (floats) or .fit (for --coarse and --resume)"},
    {"quality", "NAME", CHOICE(quality, fit_qualities), .basic = 1, .help =
     "how good the scene gets. draft: a quick check of the photographs, reduced to 800 pixels, in a quarter of the "
     "time. good (default): 28.8 dB in 10 s at 1200x900 on an H200. best: a little more detail (0.1 dB) in 8 times the "
     "time. Sets --recipe, --steps, --resolution and --max-gaussians, unless given, and the search for cameras"},
    {"of", "WHAT", CHOICE_FROM(1, of, subjects), .basic = 1, .help =
     "what the photographs show, which chooses options: thing (--crop-to-subject), room (--antialiased) or outdoors "
     "(--sky, if there are points)"},
    {"photos", "KIND", CHOICE_FROM(1, photos, sources), .help =
     "mixed: photographs of several devices or days, in no order. Chooses --exposure gain, and a lens for each "
     "photograph and all pairs if the cameras must be found"},
    {"recipe", "NAME", CHOICE(options.recipe, fit_recipes), .help =
     "method that adds and removes Gaussians: fast (default; also draft and good), mcmc (also best) or reference "
     "(published method, for comparison: 27.9 dB in 54 s)"},
    {"exposure", "NAME", CHOICE(options.exposure, exposures), .help =
     "correct differences of exposure and white balance between photographs: none (default), gain (3 factors each) or "
     "affine (3x3 factors and 3 constants). Blocks use the corrections of --coarse"},
    {"refine-poses", 0, FLAG(options.refine_poses), .help =
     "fit the camera poses too, but not for held-out photographs. Blocks use the poses of --coarse"},
    {"antialiased", 0, FLAG(options.antialiased), .help =
     "prefilter for views at other distances or sizes than the photographs (Mip-Splatting): Gaussians below a pixel "
     "fade, and none is finer than the photographs. Blocks follow --coarse"},
    {"surfaces", 0, FLAG(options.surfaces), .help =
     "fit for surfaces, for fixsplat mesh: Gaussians become flat and lie along the depths that they render. Blocks "
     "follow --coarse"},
    {"sky", "[=N]", take_sky, 0, .expected = "1 to 1000000 directions", .help =
     "add distant Gaussians where photographs look and no points lie: sky, clouds, mountains. N directions all around, "
     "1 to 1000000 (default 20000). Blocks use the sky of --coarse"},
    {"watch", "[=SECONDS]", take_watch, 0, .expected = "1 to 86400 seconds", .help =
     "take photographs as they arrive in the folder PHOTOS. The fit starts with the first 8, goes on with each new "
     "one, and saves OUT and OUT.fit on the way. When none has arrived for SECONDS, 1 to 86400 (default 300), it makes "
     "the rest of its steps"},
    {"steps", "N", UINT32(options.steps, 1, 1000000000), .basic = 1, .help =
     "number of steps, one photograph each (default 8000; mcmc and reference 30000)"},
    {"resolution", "N", INT(reading.resolution, 1, FXS_MAX_SIZE), .basic = 1, .help =
     "longest side of a photograph, pixels (default 1600); larger photographs are averaged down"},
    {"sh-degree", "D", INT(frame.render.sh_degree, 0, 3), .help = "highest SH degree, 0 to 3 (default 3)"},
    {"moving", 0, FLAG(moving), .basic = 1, .help =
     "fit a scene that moves: photographs of several moments by the same cameras, from a transforms.json with times or "
     "a folder or a film for each camera. OUT is an .fxs"},
    {"moment-steps", "N", UINT32(moment_steps, 1, 1000000), .help =
     "steps of each moment of --moving after the first (default 300)"},
    {"refine-steps", "N", UINT32(refine_steps, 0, 10000), .help =
     "steps for each moment of --moving that refine all moments together, 0 to 10000 (default 250)"},
    {"fps", "N", REAL(fps, ABOVE_0, 1000, "photographs per second above 0, at most 1000"), .help =
     "moments a second of --moving (default: by the times in the file, else 30)"},
    {"batch", "N", UINT32(options.batch, 1, 8), .help =
     "photographs per step, 1 to 8 (default 1; with several devices, one per device)"},
    {"block", "I/N", take_block, 0, .expected = "I/N, I from 1 to N, N up to 4096", .help =
     "fit only block I of N, N up to 4096, with the photographs that see it. OUT is a .ply of the block; convert "
     "merges all blocks"},
    {"coarse", "FILE.fit", TEXT(coarse), .help =
     "start a block from this short fit of the whole set, for example of small photographs. Blocks share its Gaussians "
     "evenly; block 0 is the rest, outside all blocks"},
    {"max-gaussians", "N", SIZE_T(options.max_gaussians, 1, FXS_MAX_COUNT), .help =
     "largest number of Gaussians (default 250000, mcmc 1000000, reference 4194304)"},
    {"seed", "N", UINT64(options.seed, 0, INFINITY), .help = "seed of all random numbers (default 0)"},
    {"cutoff", "NAME", CHOICE(frame.render.cutoff, cutoff_names), .help =
     "where a Gaussian ends: mahalanobis (default) or square"},
    {"background", "RRGGBB", COLOUR(frame.render.background), .help =
     "colour behind the scene, and behind transparent photographs (default 000000)"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .help =
     "how the scene is packed: default, compact or small. The last tenth of the steps fits the packed values"},
    {"crop-to-subject", 0, FLAG(crops), .help =
     "crop the finished scene to the subject that the cameras look at. Measurements are from before the crop"},
    {"hold-out", "N", UINT32(reading.hold_out, 0, UINT32_MAX), .help =
     "keep every N-th photograph by name, from the first, for measurements (default 8). 0: keep none, and measure the "
     "fitted photographs"},
    {"masks", "FOLDER", TEXT(reading.masks), .basic = 1, .help =
     "masks of the photographs, white: used, black: ignored. The mask of IMAGE.jpg is IMAGE.jpg.png or IMAGE.png "
     "(default: the folder masks beside images, if it exists; none: no masks)"},
    {"invert-masks", 0, FLAG(reading.invert_masks), .help =
     "masks are black where a photograph is used, white where it is ignored"},
    {"alpha", "NAME", CHOICE(reading.ignore_transparent, alphas), .help =
     "transparent pixels of photographs: compose (default: over --background) or ignore (like a mask)"},
    {"frames", "N", UINT32(frames, 3, 1000), .help =
     "frames to take from a film, 3 to 1000, the sharpest of each stretch (default: one in ten, 60 to 300)"},
    {"cameras-only", 0, FLAG(cameras_only), .help = "find the cameras, in OUT.cameras, and stop before the fit"},
    {"skip-bad", 0, FLAG(reading.skip_bad), .help =
     "leave out photographs that cannot be read (default: stop with an error)"},
    {"measure", "SCENE", TEXT(measure), .help =
     "measure this scene, of any format, against the held-out photographs; without a fit and -o"},
    {"compare", "FOLDER", TEXT(compare), .basic = 1, .help =
     "write each measured photograph beside its rendering into FOLDER, .png"},
    {"write-cameras", "FILE", OUTPUT(cameras), .help = "write the final cameras of all photographs, a cameras.json"},
    {"save-every", "N", UINT64(save_every, 1, UINT32_MAX), .help =
     "save the fit to OUT.fit after every N steps. Ctrl-C and SIGTERM save it too, and stop"},
    {"metrics-every", "N", UINT64(metrics_every, 1, UINT32_MAX), .help =
     "measure against the held-out photographs after every N steps too, and print a line"},
    {"preview", 0, FLAG(preview), .basic = 1, .help =
     "serve a page on this machine with the scene and the progress, and print its address. The scene does not depend "
     "on it; the fit takes 5 % longer"},
    {"port", "N", UINT64(port, 0, 65535), .help =
     "port of --preview, 1 to 65535, or 0 for any free port (default 8080)"},
    {"log", "FILE", TEXT(log_name), .help =
     "write a table to FILE: a line per hundredth of the steps, and the results of --metrics-every; fields are "
     "separated by tabs, and the first line names them. --resume appends to it"},
    {"resume", "FILE", TEXT(resume), .help =
     "continue a saved fit, with the same PHOTOS and options of photographs. The options of the fit come from FILE, "
     "except --steps. The result is the same, byte for byte, as of an uninterrupted fit"},
    {"backend", "NAME", TEXT(frame.backend), .choices = WORDS("cpu", "cuda", "vulkan"), .basic = 1, .help =
     "where the steps run: cpu (default), cuda (NVIDIA GPUs) or vulkan (any GPU); the scene does not depend on it"},
    {"device", "LIST", take_devices, FIELD(frame_options, frame), .help =
     "GPUs of --backend cuda: numbers from 0, separated by commas, or all (default 0). They share the photographs of a "
     "batch. For --backend vulkan: one number"},
    {"max-memory", "SIZE", BYTES(frame.max_memory), .help =
     "limit of the memory used on each GPU, bytes, also as 512M, 2G (default: none)"},
    {"threads", "N", take_threads, FIELD(frame_options, frame), 1, 64, .help =
     "number of threads, 1 to 64 (default: one per processor); the scene does not depend on it"},
    {"cpu", "LIST", TEXT(frame.cpu), .help =
     "instruction sets to use: all (default), c for none, or a list out of sse41,avx2,avx512,neon; the scene does not "
     "depend on it"},
    {"json", 0, FLAG(json), .help = "print a JSON object instead of the table"},
    {0}
};

static int set_devices(fit_command *c, const fxs_backend *backend)
{
    fxs_fit_options *o = &c->options;
    int devices[DEVICES_MOST];
    const char *of_devices = is_given("device") ? "device" : is_given("max-memory") ? "max-memory" : 0;
    if (strcmp(backend->name, "cpu") && !(backend->can & FXS_CAN_DEVICES))
        return fail(EXIT_USAGE, "fit: --backend %s: expected cpu, cuda or vulkan", backend->name);
    if (!(backend->can & FXS_CAN_DEVICES))
        return of_devices ? fail(EXIT_USAGE, "--%s is for --backend cuda or vulkan, not for %s", of_devices,
                                 backend->name) : 0;
    const int count = choose_devices(&c->frame, devices);
    for (int i = 0; i < count && i < 8; i++)
        o->devices[i] = devices[i];
    o->device_count = (uint32_t)count;
    o->max_memory = c->frame.max_memory;
    o->vulkan = !strcmp(backend->name, "vulkan");
    if (count < 1)
        return EXIT_FAILED;
    if (o->vulkan && count > 1)
        return fail(EXIT_USAGE, "fit: --backend vulkan takes one device");
    if (count > 8 || (o->batch && o->batch % o->device_count))
        return fail(EXIT_USAGE, "fit: --batch %u is not a multiple of the %d devices",
                    (unsigned)(o->batch ? o->batch : 8), count);
    return 0;
}

/* Sets the options that --of and --photos choose, unless they are given. */
static void take_presets(fit_command *c)
{
    if (c->of) {
        c->crops |= by_subject[c->of - 1].crops;
        c->options.antialiased |= by_subject[c->of - 1].antialiased;
        c->options.sky = is_given("sky") ? c->options.sky : by_subject[c->of - 1].sky;
    }
    if (c->photos && !is_given("exposure"))
        c->options.exposure = FXS_FIT_EXPOSURE_GAIN;
}

/* Prints what --quality has set, as far as other options left it. */
static void say_quality(const fit_command *c)
{
    const char *name = fit_qualities[c->quality];
    const char *search = !reconstruct_is_needed(c->in) ? ""
                         : c->quality == QUALITY_DRAFT ? "a quick search for the cameras"
                                                       : "a thorough search for the cameras";
    if (!c->cameras_only)
        note("--quality %s: %" PRIu32 " steps of the recipe %s, photographs of at most %d pixels, at most %zu Gaussians"
             "%s%s", name, c->options.steps, fit_recipes[c->options.recipe], c->reading.resolution,
             c->options.max_gaussians, *search ? ", " : "", search);
    else if (*search)
        note("--quality %s: %s", name, search);
}

static void say_presets(const fit_command *c)
{
    if (is_given("quality") && !c->resume && !c->measure)
        say_quality(c);
    if (c->of)
        note("--of %s: %s", subjects[c->of - 1], by_subject[c->of - 1].options);
    if (c->photos)
        note("--photos mixed: --exposure %s, a lens for each photograph, all pairs", exposures[c->options.exposure]);
}

/* Sets steps, recipe, number of Gaussians and resolution, unless they are given: as --quality says, else as the recipe
   does. A resumed fit has its own steps. */
static void take_quality(fit_command *c)
{
    const fit_preset *preset = is_given("quality") ? &fit_presets[c->quality] : 0;
    fxs_fit_options *o = &c->options;
    if (preset && !is_given("recipe"))
        o->recipe = preset->recipe;
    if (preset && !is_given("resolution"))
        c->reading.resolution = preset->resolution;
    if (!is_given("steps"))
        o->steps = c->resume ? 0 : preset ? preset->steps : fxs_fit_recipe_steps(o->recipe);
    if (!is_given("max-gaussians"))
        o->max_gaussians = fxs_fit_recipe_gaussians(preset ? preset->recipe : o->recipe);
}

static int finish_options(fit_command *c)
{
    const fxs_backend *backend;
    fxs_backend_options how;
    fxs_fit_options *o = &c->options;
    int status = choose_backend(&c->frame, 0, &backend, &how);
    if (!status)
        status = set_devices(c, backend);
    take_quality(c);
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

static const option_rule rules[] = {
    {FIT_NOT_MEASURED, "measure", 0, "nothing is fitted"},
    {"of photos", "block", 0, "a block follows its --coarse fit"},
    {"coarse", 0, "block", "I/N"},
    {"port", 0, "preview", 0},
    {"moment-steps refine-steps fps", 0, "moving", 0},
    {"sky block coarse moving cameras-only frames masks invert-masks skip-bad measure", "watch", 0,
     "the photographs are not known at the start"},
    {"exposure refine-poses surfaces block coarse crop-to-subject cameras-only save-every measure write-cameras "
     "preview photos of frames", "moving", 0, "it is for still scenes"},
    {0}
};

static int check_options(const fit_command *c)
{
    const char *other = c->cameras_only ? given_beside("cameras-only output quality photos frames masks invert-masks "
                                                       "skip-bad threads quiet") : 0;
    if (!c->out && !c->measure)
        return fail(EXIT_USAGE, "fit: where to? Give -o OUT.fxs or OUT.ply");
    if (check_rules(rules))
        return EXIT_USAGE;
    if (c->moving && !ends_with(c->out, ".fxs"))
        return fail(EXIT_USAGE, "--moving: %s: expected a name ending in .fxs", c->out);
    if (other)
        return fail(EXIT_USAGE, "--cameras-only: nothing is fitted: leave out --%s", other);
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
    if (c->blocks && !c->block && !c->coarse)
        return fail(EXIT_USAGE, "--block 0/%u: expected I/N, I from 1 to N; 0 is for --coarse", (unsigned)c->blocks);
    if (c->preview && c->blocks && !c->block)
        return fail(EXIT_USAGE, "--preview: nothing is fitted: leave out --block 0");
    if (c->watch_seconds && c->options.sky)
        return fail(EXIT_USAGE, "--of %s does not go with --watch: the photographs are not known at the start",
                    subjects[c->of - 1]);
    if (c->blocks && !ends_with(c->out, ".ply"))
        return fail(EXIT_USAGE, "--block: %s: expected a name ending in .ply, for convert to merge", c->out);
    return 0;
}

static int read_options(fit_command *c, int argc, char **argv)
{
    memset(c, 0, sizeof *c);
    frame_options_default(&c->frame);
    fxs_fit_options_init(&c->options);
    fxs_photos_options_init(&c->reading);
    c->reading.hold_out = 8;
    c->port = 8080;
    c->moment_steps = 300;
    c->refine_steps = 250;
    c->quality = QUALITY_GOOD;
    if (take_options(&command_fit, c, argc, argv))
        return EXIT_USAGE;
    if (optind != argc - 1)
        return fail(EXIT_USAGE, "fit takes one folder or file of photographs; see: fixsplat fit --help");
    c->in = c->photographs = argv[optind];
    take_presets(c);
    const int status = check_options(c);
    return status ? status : finish_options(c);
}

/* Checks that all output files can be written, before hours of work. */
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

int fit_run(int argc, char **argv, const fit_watcher *watcher)
{
    static fit_command c;
    fit_log log = {0};
    int status = read_options(&c, argc, argv);
    c.log = &log;
    if (!status && c.preview && !watcher)
        return run_separate(&server_program, "--preview", argv);
    c.watcher = c.preview ? watcher : 0;
    status = status ? status : check_outputs(&c);
    if (!status)
        say_presets(&c);
    if (!status && c.watcher)
        status = c.watcher->open(c.out, c.port);
    if (!status) {
        status = fit_photos(&c);
        if (c.watcher)
            c.watcher->close(status);
    }
    fit_log_close(&log);
    free(c.saved);
    free(c.found.folder);
    return status;
}

static int run(int argc, char **argv)
{
    return fit_run(argc, argv, 0);
}

const command command_fit = {
    "fit", "photographs -> scene", run,
    "Usage: fixsplat fit PHOTOS -o OUT [OPTION...]\n\n"
    "Fits a scene to photographs, on the processor or on NVIDIA GPUs. The same photographs, options and seed give the\n"
    "same file on every machine, byte for byte. PHOTOS is one of:\n\n"
    "  a COLMAP folder     images (or input, images_4), and sparse/0, sparse or colmap/sparse/0 with .bin or .txt\n"
    "                      files\n"
    "  a camera file       with images beside it: transforms.json of nerfstudio or Blender, Inria's cameras.json,\n"
    "                      Metashape .xml, RealityCapture .csv or Bundler .out; or a folder with one of them\n"
    "  photographs         a folder of them, or a film: COLMAP and ffmpeg find the cameras, in OUT.cameras; with\n"
    "                      --watch, photographs that arrive in a folder during the fit\n"
    "  moments             with --moving: a transforms.json with times, or a camera file with a folder or film for\n"
    "                      each camera\n\n"
    "At the end, the packed scene is rendered from the cameras of the held-out photographs, and PSNR and SSIM are\n"
    "printed.\n",
    0,
    "  $ fixsplat fit garden -o garden.fxs\n"
    "  $ fixsplat fit walk.mp4 -o walk.fxs --quality draft --compare pictures\n"
    "  $ fixsplat fit statue -o statue.fxs --of thing --photos mixed\n"
    "  $ fixsplat fit garden -o garden.fxs --preview --backend cuda --device 0,1\n"
    "  $ fixsplat fit garden -o garden.ply --resolution 600 --steps 7000 --compare pictures\n"
    "  $ fixsplat fit lego/transforms_train.json -o lego.fxs --background ffffff --json\n"
    "  $ fixsplat fit rig -o rig.fxs --moving --fps 30\n"
    "  $ fixsplat fit arriving -o scene.fxs --watch --preview\n"
    "  $ fixsplat fit garden -o garden.fxs --resume garden.fxs.fit\n"
    "  $ fixsplat fit city -o coarse.fit --recipe reference --resolution 400 --steps 3000\n"
    "  $ fixsplat fit city -o part-1.ply --recipe reference --coarse coarse.fit --block 1/16\n",
    {{own_rows, 0}, COMMON_TABLE}
};
