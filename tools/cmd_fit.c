/* fixsplat fit: fits a scene to photographs. */
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/clock.h>
#include "beside.h"
#include "file_guard.h"
#include "film_frames.h"
#include "fit_log.h"
#include "fit_result.h"
#include "fit_verdict.h"
#include "fit_watcher.h"
#include "reconstruct.h"

typedef struct fit_command {
    frame_options frame;            /* background, cut-off, SH degree, profile, threads, instruction sets */
    fxs_photos_options reading;
    fxs_fit_options options;
    const char *in, *out, *resume, *coarse, *measure, *compare, *cameras, *log_name;
    fit_log *log;
    char *found;                    /* OUT.cameras, where they were found */
    uint32_t frames;
    int quality;                    /* in by_quality, where it is given */
    int cameras_only, crops;
    char *saved;                    /* OUT.fit */
    int saves_itself;               /* it is the file of --resume */
    uint32_t block, blocks;         /* blocks 0: all */
    uint64_t save_every, metrics_every;   /* 0: never */
    int preview;
    uint64_t port;                  /* of the preview */
    const fit_watcher *watcher;     /* of it; or null */
    int json;
} fit_command;

static const char *const recipes[] = {"reference", "mcmc", "fast", 0};   /* of enum fxs_fit_recipe */
static const char *const qualities[] = {"draft", "good", "best", 0};
static const struct {
    enum fxs_fit_recipe recipe;
    uint32_t steps;
    int resolution;                 /* 0: as without --quality */
} by_quality[] = {{FXS_FIT_FAST, 3000, 800}, {FXS_FIT_FAST, 8000, 0}, {FXS_FIT_MCMC, 30000, 0}};
static const char *const exposures[] = {"none", "gain", 0};   /* of enum fxs_fit_exposure */
static const char *const alphas[] = {"compose", "ignore", 0};   /* of fxs_photos_options.ignore_transparent */

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

#define OPTIONS fit_command

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(out), .letter = 'o', .help =
     ".fxs (packed), .ply (floats) or .fit (for --coarse and --resume)"},
    {"quality", "NAME", CHOICE(quality, qualities), .help =
     "draft (small photographs, few steps: to see whether all is well), good (default: of 1200x900 in 12 s on an H200, 28.9 dB) or best (90 s, 29.0 dB): a "
     "recipe with its steps and resolution, where --steps and --resolution do not say others"},
    {"recipe", "NAME", CHOICE(options.recipe, recipes), .help =
     "how Gaussians are added and taken away, by itself: fast (that of draft and good), mcmc (that of best) or reference "
     "(50 s, 28.1 dB; the published one, to compare with)"},
    {"exposure", "NAME", CHOICE(options.exposure, exposures), .help =
     "none (default), or gain: photographs differ in exposure and white balance, and three numbers of each are fitted "
     "beside the scene; of --block those of --coarse"},
    {"refine-poses", 0, FLAG(options.refine_poses), .help =
     "cameras are not quite where they are said to be: their poses are fitted beside the scene, those of photographs "
     "that are held out excepted; of --block those of --coarse"},
    {"steps", "N", UINT32(options.steps, 1, 1000000000), .help = "one photograph each (default 30000, fast 8000)"},
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
     "at most so many (default 4194304, mcmc 1000000, fast 250000)"},
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
     "save the fit after every N steps, in OUT.fit; so does Ctrl-C, and ends"},
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

/* The devices of --backend cuda. */
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
        return fail(EXIT_USAGE, "fit: a batch of %u photographs is not to be shared out among %d devices",
                    (unsigned)(o->batch ? o->batch : 8), count);
    return 0;
}

/* What several options make of each other. */
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
    if (!c->out && !c->measure)
        return fail(EXIT_USAGE, "fit: where to? Give -o OUT.fxs or OUT.ply");
    if (is_given("quality") && is_given("recipe"))
        return fail(EXIT_USAGE, "--quality stands for a recipe: leave out --recipe");
    if (c->measure && (c->out || c->blocks || c->resume || c->cameras || c->log_name))
        return fail(EXIT_USAGE, "--measure: nothing is fitted: leave out -o, --block, --resume, --write-cameras and "
                    "--log");
    if (c->options.exposure && c->blocks && !c->coarse)
        return fail(EXIT_USAGE, "--exposure: of --block only with --coarse, whose exposures it has");
    if (c->options.refine_poses && c->blocks && !c->coarse)
        return fail(EXIT_USAGE, "--refine-poses: of --block only with --coarse, whose poses it has");
    if (c->crops && (c->blocks || (c->out && ends_with(c->out, ".fit"))))
        return fail(EXIT_USAGE, "--crop-to-subject: of a whole fit that ends in .fxs or .ply");
    if (c->coarse && !c->blocks)
        return fail(EXIT_USAGE, "--coarse needs --block I/N");
    if (c->blocks && !c->block && !c->coarse)
        return fail(EXIT_USAGE, "--block 0/%u: expected I/N, I from 1 to N; 0 is for --coarse", (unsigned)c->blocks);
    if (c->preview && (c->measure || c->cameras_only || (c->blocks && !c->block)))
        return fail(EXIT_USAGE, "--preview: there is no step to look at: leave out --measure, --cameras-only and "
                    "--block 0");
    if (is_given("port") && !c->preview)
        return fail(EXIT_USAGE, "--port needs --preview");
    if (c->blocks && !ends_with(c->out, ".ply"))
        return fail(EXIT_USAGE, "--block: %s: expected a name ending in .ply, that convert merges", c->out);
    c->in = argv[optind];
    return finish_options(c);
}

/* Before hours of work: where it is to go. */
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

/* The options that were given are to be those of the file. */
static int check_resumed(const fit_command *c, const fxs_fit *fit)
{
    const fxs_fit_options *given = &c->options, *is = fxs_fit_options_of(fit);
    const struct {
        const char *name;
        int same;
    } options[] = {
        {"recipe", given->recipe == is->recipe}, {"quality", given->recipe == is->recipe},
        {"seed", given->seed == is->seed},
        {"batch", given->batch == is->batch}, {"sh-degree", given->sh_degree == is->sh_degree},
        {"max-gaussians", given->max_gaussians == is->max_gaussians}, {"cutoff", given->cutoff == is->cutoff},
        {"profile", given->profile == is->profile}, {"exposure", given->exposure == is->exposure},
        {"refine-poses", given->refine_poses == is->refine_poses},
        {"background", !memcmp(given->background, is->background, sizeof is->background)}
    };
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (is_given(options[i].name) && !options[i].same)
            return fail(EXIT_USAGE, "--%s: %s was begun with another", options[i].name, c->resume);
    return 0;
}

/* ---- Signals ----------------------------------------------------------------------------------------------------- */

/* The first one asks for an end after the step; the next one does what it would have done. */
static const int signals[] = {SIGHUP, SIGINT, SIGTERM};
enum { SIGNALS = sizeof signals / sizeof *signals };
static struct sigaction before[SIGNALS];
static volatile sig_atomic_t asked;

static void restore_signals(void)
{
    for (int i = 0; i < SIGNALS; i++)
        sigaction(signals[i], &before[i], 0);
}

static void ask_for_end(int number)
{
    asked = number;
    restore_signals();
}

/* What is ignored stays so. */
static void listen_to_signals(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = ask_for_end;
    sigfillset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    for (int i = 0; i < SIGNALS; i++)
        sigaction(signals[i], 0, &before[i]);
    for (int i = 0; i < SIGNALS; i++)
        if (before[i].sa_handler != SIG_IGN)
            sigaction(signals[i], &action, 0);
}

/* ---- Progress ---------------------------------------------------------------------------------------------------- */

enum { STAGES = 6 };

typedef struct progress {
    uint32_t first, steps;          /* of this run's, and of all */
    uint32_t counted, reports;      /* the last step that was counted; how many have reported */
    uint32_t saved;                 /* the step that OUT.fit is of; 0: not of this fit */
    uint64_t start, last, shown;    /* nanoseconds: of the run, the last step, the last line */
    size_t gaussians;               /* after the last step that was counted */
    double pace, loss;              /* seconds a step and loss, means of some 50 steps */
    uint64_t stages[STAGES];        /* nanoseconds of the steps that have reported */
} progress;

static void say_duration(char text[32], double seconds)
{
    const uint64_t s = (uint64_t)seconds;
    if (s < 60)
        snprintf(text, 32, "%d s", (int)s);
    else if (s < 3600)
        snprintf(text, 32, "%d min %02d s", (int)(s / 60), (int)(s % 60));
    else
        snprintf(text, 32, "%" PRIu64 " h %02d min", s / 3600, (int)(s / 60 % 60));
}

/* On a terminal a line that changes, of less than 80 columns; else a line after the first second, every ten seconds,
   and for the last step. */
static void show(progress *p, uint32_t step, size_t gaussians, uint64_t now)
{
    char text[160], left[32];
    const int is_line = isatty(STDERR_FILENO), is_last = step == p->steps && !is_line;
    const uint64_t pause = is_line ? 200000000u : p->shown == p->start ? 1000000000u : 10000000000u;
    if (is_quiet() || (now - p->shown < pause && !is_last))
        return;
    say_duration(left, p->pace * (p->steps - step));
    snprintf(text, sizeof text, "%" PRIu32 "/%" PRIu32 ", loss %.4f, %zu Gaussians, %.1f steps/s, %s left",
             step, p->steps, p->loss, gaussians, p->pace > 0 ? 1 / p->pace : 0, left);
    if (is_line)
        progress_line(text);
    else
        fprintf(stderr, "%s\n", text);
    p->shown = now;
}

static void count_step(progress *p, uint32_t step, const fxs_fit_report *report)
{
    const uint64_t now = fxs_clock(0);
    const double done = step - p->first, more = step - p->counted, all = done < 50 ? done : 50;
    const double share = more < all ? more / all : 1;
    p->pace += share * ((double)(now - p->last) * 1e-9 / more - p->pace);
    p->loss += share * (0.8 * report->absolute + 0.2 * report->dissimilar - p->loss);
    p->last = now;
    p->counted = step;
    p->gaussians = report->gaussians;
    p->reports++;
    for (int i = 0; i < STAGES; i++)
        p->stages[i] += report->nanoseconds[i];
    show(p, step, report->gaussians, now);
}

static fit_now now_of(const progress *p, uint32_t step, size_t gaussians)
{
    return (fit_now){step, p->steps, gaussians, p->loss, p->pace * (p->steps - step)};
}

/* ---- The fit ----------------------------------------------------------------------------------------------------- */

static int save(const fit_command *c, fxs_fit *fit)
{
    fxs_message message;
    return fxs_fit_save(fit, c->saved, &message) ? fail_for(&message) : 0;
}

/* A word as a shell takes it. */
static void print_word(FILE *to, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=,+-";
    if (*word && strspn(word, plain) == strlen(word)) {
        fprintf(to, " %s", word);
        return;
    }
    fputs(" '", to);
    for (; *word; word++)
        fprintf(to, *word == '\'' ? "'\\''" : "%c", *word);
    fputc('\'', to);
}

/* The command that goes on from what is saved. */
static void say_how_to_go_on(const fit_command *c, const char *why, uint32_t step, uint32_t steps, char **argv)
{
    if (is_quiet())
        return;
    progress_end();
    fprintf(stderr, "fixsplat: %s after %" PRIu32 " steps of %" PRIu32 "; to go on: fixsplat", why, step, steps);
    for (; *argv; argv++)
        print_word(stderr, *argv);
    if (!c->saves_itself) {
        fputs(" --resume", stderr);
        print_word(stderr, c->saved);
    }
    fputc('\n', stderr);
}

static int save_for_later(const fit_command *c, fxs_fit *fit, const char *why, char **argv)
{
    if (save(c, fit))
        return EXIT_FAILED;
    say_how_to_go_on(c, why, fxs_fit_steps(fit), fxs_fit_options_of(fit)->steps, argv);
    return 0;
}

static int is_measured(const fit_command *c, const progress *p, uint32_t step)
{
    return c->metrics_every && step % c->metrics_every == 0 && step < p->steps;
}

/* A device works on while it is not asked: it is some times a second, for the log, and for the last step. */
static int wants_report(const fit_command *c, const progress *p, uint32_t step)
{
    return !c->options.device_count || step >= p->steps || fxs_clock(0) - p->last > 200000000u ||
           fit_log_wants(c->log, step) || is_measured(c, p, step);
}

static void write_log(const fit_command *c, const progress *p, const quality *measured)
{
    fit_log_write(c->log, p->counted, (double)(p->last - p->start) * 1e-9, p->gaussians, p->loss, measured);
}

/* A fit that a step failed in is not to be saved: what is left of it is the last save. */
static int fail_step(const fit_command *c, const progress *p, uint32_t made, const fxs_message *why, char **argv)
{
    char needed[64];
    fail(EXIT_FAILED, "%s%s (after some %" PRIu32 " steps)", why->text, needed_bytes(needed, why), made);
    if (p->saved)
        say_how_to_go_on(c, "the last save is", p->saved, p->steps, argv);
    return EXIT_FAILED;
}

/* As the fit has it. */
static frame_options frame_of(const fit_command *c, const fxs_fit *fit)
{
    const fxs_fit_options *o = fxs_fit_options_of(fit);
    frame_options frame = c->frame;
    frame.render.cutoff = o->cutoff;
    memcpy(frame.render.background, o->background, sizeof o->background);
    return frame;
}

/* The photographs with the poses that the fit has found: those that were held out as they were given. Returns 0, and
   *fitted to be freed; or prints why not and returns the exit status. */
static int pose_photos(fxs_fit *fit, const fxs_photos *photos, fxs_fit_photo **fitted)
{
    fxs_message message;
    *fitted = malloc(photos->fit_count * sizeof **fitted);
    if (!*fitted)
        return fail(EXIT_FAILED, "out of memory");
    memcpy(*fitted, photos->fit, photos->fit_count * sizeof **fitted);
    return fxs_fit_pose_photos(fit, *fitted, &message) ? fail_for(&message) : 0;
}

static int write_cameras(const char *path, const fxs_photos *photos)
{
    const size_t count = photos->fit_count + photos->held_out_count;
    fxs_message message;
    fxs_file_view *views = malloc(count * sizeof *views);
    if (!views)
        return fail(EXIT_FAILED, "out of memory");
    for (size_t i = 0; i < count; i++)
        views[i] = i < photos->fit_count ? photos->fit[i].view : photos->held_out[i - photos->fit_count].view;
    const int status = fxs_camera_file_write(path, views, count, &message) ? fail_for(&message) : 0;
    free(views);
    return status;
}

/* What has been fitted so far, packed as it would be at the end. Where that fails, the fit goes on. */
static void measure_so_far(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const progress *p)
{
    const frame_options frame = frame_of(c, fit);
    fxs_photos posed = *photos;
    fxs_packed_scene packed;
    fxs_message message;
    quality q = {0};
    posed.fit = 0;
    world scene = {0};
    char psnr[32], affine[32];
    int status = fxs_fit_pack(fit, &packed, 0, &message) ? fail_for(&message) : 0;
    status = status ? status : world_open_packed(&scene, c->out, &packed);
    status = status ? status : pose_photos(fit, photos, &posed.fit);
    status = status ? status : result_measure(&q, &scene, &posed, &frame, 0);
    free(posed.fit);
    if (!status)
        note("step %" PRIu32 ": %s dB, after the best affine map %s, SSIM %.4f; %" PRIu32 " Gaussians", p->counted,
             fxs_metrics_psnr(psnr, q.psnr, "no"), fxs_metrics_psnr(affine, q.affine_psnr, "no"), q.ssim,
             scene.gaussians);
    write_log(c, p, status ? 0 : &q);
    if (!status && c->watcher)
        c->watcher->measured(p->counted, &q);
    quality_free(&q);
    world_close(&scene);
    fxs_packed_scene_free(&packed);
}

/* Where a save fails, the last one is still there, and the fit goes on. */
static int make_steps(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, progress *p, char **argv)
{
    fxs_fit_report report;
    fxs_message message;
    while (fxs_fit_steps(fit) < p->steps && !asked) {
        const uint32_t made = fxs_fit_steps(fit), step = made + 1;
        const int is_reported = wants_report(c, p, step);
        if (fxs_fit_step(fit, is_reported ? &report : NULL, &message))
            return fail_step(c, p, made, &message, argv);
        if (is_reported)
            count_step(p, step, &report);
        if (is_reported && c->watcher) {
            const fit_now now = now_of(p, step, report.gaussians);
            c->watcher->look(fit, &now);
        }
        if (c->save_every && step % c->save_every == 0 && step < p->steps && !save(c, fit))
            p->saved = step;
        if (is_measured(c, p, step))
            measure_so_far(c, fit, photos, p);
        else if (fit_log_wants(c->log, step) && step < p->steps)
            write_log(c, p, 0);
    }
    progress_end();
    return 0;
}

static int open_fit(const fit_command *c, const fxs_photos *photos, const fxs_fit_block *block, fxs_fit **fit)
{
    fxs_message message;
    const int error = c->resume   ? fxs_fit_resume(fit, c->resume, photos->fit, photos->fit_count, &c->options, &message)
                      : c->coarse ? fxs_fit_create_block(fit, block->coarse, block, &c->options, &message)
                                  : fxs_fit_create(fit, photos->fit, photos->fit_count, photos->points,
                                                   photos->point_count, &c->options, &message);
    if (error)
        return fail_for(&message);
    if (c->coarse && is_given("exposure") && c->options.exposure != fxs_fit_options_of(*fit)->exposure)
        return fail(EXIT_USAGE, "--exposure: %s was begun with another", c->coarse);
    if (c->coarse && c->options.refine_poses && !fxs_fit_options_of(*fit)->refine_poses)
        return fail(EXIT_USAGE, "--refine-poses: %s was begun without", c->coarse);
    return c->resume ? check_resumed(c, *fit) : 0;
}

/* ---- What is printed --------------------------------------------------------------------------------------------- */

static void print_text(const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, const fit_result *r)
{
    const fxs_fit_options *o = fxs_fit_options_of(fit);
    printf("%s: %" PRIu64 " Gaussians, %zu bytes in the profile %s; %" PRIu32 " steps, recipe %s, seed %" PRIu64 "\n",
           c->out, r->report.packed, r->bytes, profile_names[o->profile], fxs_fit_steps(fit), recipes[o->recipe],
           o->seed);
    if (photos->held_out_count)
        printf("Photographs fitted: %zu. Of the %zu held out:\n", photos->fit_count, photos->held_out_count);
    else
        printf("Photographs fitted: %zu. None was held out; of those fitted:\n", photos->fit_count);
    quality_print_text(&r->quality);
}

/* How good it is, and what to do next. */
static int print_verdict(const fit_command *c, const fxs_photos *photos, world *scene, const frame_options *frame,
                         const quality *measured)
{
    static const char *const next[][3] = {{"to look at it:", "fixsplat view", ""},
                                          {"a folder for any web server:", "fixsplat publish", " site"}};
    double fitted;
    const int status = result_measure_fitted(&fitted, scene, photos, frame);
    if (status)
        return status;
    verdict_print(measured, fitted);
    for (int i = 0; i < 2 && !ends_with(c->out, ".fit"); i++) {
        printf("%-29s %s", next[i][0], next[i][1]);
        print_word(stdout, c->out);
        puts(next[i][2]);
    }
    return 0;
}

static void print_measured(const fit_command *c, const fxs_photos *photos, const world *scene, const quality *q)
{
    const char *kind = photos->held_out_count ? "held out" : "fitted";
    if (c->json) {
        printf("{\"scene\": ");
        print_json_string(c->measure);
        printf(", \"gaussians\": %" PRIu32 ", \"measured\": \"%s\", \"photographs\": ", scene->gaussians, kind);
        quality_print_json(q);
        puts("}");
        return;
    }
    printf("%s: %" PRIu32 " Gaussians. Of the %ld photographs %s:\n", c->measure, scene->gaussians, q->count, kind);
    quality_print_text(q);
}

/* Milliseconds a step. */
static void print_json_stages(const progress *p)
{
    static const char *const names[STAGES] = {"project", "bin", "blend", "loss", "back", "update"};
    printf("{");
    for (int i = 0; i < STAGES; i++)
        printf("%s\"%s\": %.3f", i ? ", " : "", names[i],
               p->reports ? (double)p->stages[i] * 1e-6 / p->reports : 0);
    printf("}");
}

static void print_json(const fit_command *c, const fxs_fit *fit, const fxs_photos *photos, const fit_result *r,
                       const progress *p)
{
    const fxs_fit_options *o = fxs_fit_options_of(fit);
    printf("{\"scene\": ");
    print_json_string(c->out);
    printf(", \"gaussians\": %" PRIu64 ", \"bytes\": %zu, \"profile\": \"%s\", \"recipe\": \"%s\", \"steps\": %" PRIu32
           ", \"seed\": %" PRIu64 ", \"seconds\": %.3f, \"fitted\": %zu, \"held_out\": %zu, \"skipped\": %zu, "
           "\"measured\": \"%s\", \"photographs\": ", r->report.packed, r->bytes, profile_names[o->profile],
           recipes[o->recipe], fxs_fit_steps(fit), o->seed, (double)(p->last - p->start) * 1e-9, photos->fit_count,
           photos->held_out_count, photos->skipped, photos->held_out_count ? "held out" : "fitted");
    quality_print_json(&r->quality);
    printf(", \"stages_ms\": ");
    print_json_stages(p);
    puts("}");
}

/* `whole`: packed before, to be measured. Where the cameras look at nothing, the scene stays as it is. */
static int crop(const fit_command *c, fxs_fit *fit, fxs_packed_scene *whole)
{
    fxs_fit_subject s;
    fxs_message why;
    int error = fxs_fit_pack(fit, whole, 0, &why);
    if (error)
        return fail_for(&why);
    error = fxs_fit_crop_to_subject(fit, &s, &why);
    if (error && error != FXS_ERR_ARGUMENT) {
        fxs_packed_scene_free(whole);
        return fail_for(&why);
    }
    if (error)
        note("%s: not cropped: %s", c->out, why.text);
    else
        note("%s: cropped to %.4g units around %.4g,%.4g,%.4g: %zu Gaussians left out", c->out, s.radius, s.middle[0],
             s.middle[1], s.middle[2], s.dropped);
    return 0;
}

/* A scene that cannot be written is not lost. */
static int finish(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const fxs_fit_block *block,
                  const progress *p, char **argv)
{
    const frame_options frame = frame_of(c, fit);
    fxs_photos posed = *photos;
    fit_result result;
    world scene = {0};
    fxs_packed_scene whole = {0};
    posed.fit = 0;
    int status = c->crops ? crop(c, fit, &whole) : 0;
    if (status)
        return status;
    status = result_write(&result, fit, photos, block, c->out);
    if (!status && !isatty(STDERR_FILENO))
        note("measuring %s", c->out);
    if (!status && c->watcher)
        c->watcher->written(&result.packed);
    if (status)
        save_for_later(c, fit, "saved", argv);
    else
        status = world_open_packed(&scene, c->out, c->crops ? &whole : &result.packed);
    if (!status)
        status = pose_photos(fit, photos, &posed.fit);
    if (!status && c->cameras)
        status = write_cameras(c->cameras, &posed);
    if (!status)
        status = result_measure(&result.quality, &scene, &posed, &frame, c->compare);
    if (p->counted > p->first)
        write_log(c, p, status ? 0 : &result.quality);
    if (!status && c->watcher)
        c->watcher->measured(fxs_fit_steps(fit), &result.quality);
    if (!status && c->json)
        print_json(c, fit, photos, &result, p);
    else if (!status)
        print_text(c, fit, photos, &result);
    if (!status && !c->json && !c->blocks && !is_quiet())
        status = print_verdict(c, &posed, &scene, &frame, &result.quality);
    world_close(&scene);
    result_free(&result);
    fxs_packed_scene_free(&whole);
    free(posed.fit);
    return status;
}

static void begin_watching(const fit_command *c, fxs_fit *fit, const fxs_photos *photos, const progress *p)
{
    const frame_options frame = frame_of(c, fit);
    const fit_now now = now_of(p, p->first, 0);
    if (c->watcher)
        c->watcher->begin(fit, photos, &frame, !c->metrics_every, &now);
}

static int fit_photos(const fit_command *c, const fxs_photos *photos, const fxs_fit_block *block, char **argv)
{
    fxs_fit *fit = 0;
    if (c->compare)
        result_tell_pictures(photos, c->compare);
    int status = files_check();     /* photographs are known now */
    if (!status)
        status = open_fit(c, photos, block, &fit);
    if (!status) {
        const uint64_t now = fxs_clock(0);
        const uint32_t first = fxs_fit_steps(fit);
        progress p = {.first = first, .counted = first, .steps = fxs_fit_options_of(fit)->steps, .start = now,
                      .last = now, .shown = now, .saved = c->saves_itself ? first : 0};
        fit_log_begin(c->log, c->resume != 0, p.steps);
        listen_to_signals();
        begin_watching(c, fit, photos, &p);
        status = make_steps(c, fit, photos, &p, argv);
        restore_signals();
        if (!status && asked) {
            status = EXIT_FAILED;
            if (c->watcher)
                c->watcher->stopped();
            if (!save_for_later(c, fit, "stopped", argv))
                raise(asked);      /* and it ends as the signal would have */
        } else if (!status)
            status = finish(c, fit, photos, block, &p, argv);
    }
    fxs_fit_free(fit);
    return status;
}

static void say_sizes(const fxs_photos *photos, size_t begins)
{
    int width = 0, height = 0;
    for (size_t i = 0; i < photos->fit_count; i++) {
        const fxs_file_view *view = &photos->fit[i].view;
        width = view->width > width ? view->width : width;
        height = view->height > height ? view->height : height;
    }
    note("%zu photographs to fit, %zu held out, up to %dx%d; %zu points", photos->fit_count,
         photos->held_out_count, width, height, begins);
}

/* Photographs without a camera were named when cameras were looked for here. */
static void say_left_out(void *argument, const char *why)
{
    const fit_command *c = argument;
    const size_t length = c->found ? strlen(c->found) : 0;
    if (!length || strncmp(why, c->found, length) || strncmp(why + length, "/images: ", 9))
        note("left out: %s", why);
}

/* A bar on a terminal, else a line every ten seconds. */
static int show_reading(void *argument, double done)
{
    static char label[] = "reading";
    static uint64_t shown;
    const uint64_t now = fxs_clock(0);
    (void)argument;
    shown = shown ? shown : now;
    if (!isatty(STDERR_FILENO) && now - shown >= 10000000000u) {
        note("%s photographs: %d %%", label, (int)(100 * done));
        shown = now;
    }
    return progress_bar(label, done);
}

static double share_ignored(const fxs_photos *photos)
{
    const fxs_fit_photo *lists[] = {photos->fit, photos->held_out};
    const size_t counts[] = {photos->fit_count, photos->held_out_count};
    double pixels = 0, ignored = 0;
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < counts[k]; i++) {
            const fxs_fit_photo *photo = &lists[k][i];
            const size_t size = (size_t)photo->view.width * (size_t)photo->view.height;
            pixels += (double)size;
            for (size_t p = 0; p < size && photo->mask; p++)
                ignored += !photo->mask[p];
        }
    return pixels > 0 ? ignored / pixels : 0;
}

static void say_masks(const fit_command *c, const fxs_photos *photos)
{
    if (photos->with_mask)
        note("%s: masks of %zu photographs", c->in, photos->with_mask);
    if (photos->without_mask)
        note("%s: no mask of %zu photograph%s, of which all is used", c->in, photos->without_mask,
             photos->without_mask > 1 ? "s" : "");
    if (photos->with_mask || c->reading.ignore_transparent)
        note("%s: %.1f %% of the pixels are ignored", c->in, 100 * share_ignored(photos));
}

static void say_photos(const fit_command *c, const fxs_photos *photos, size_t begins)
{
    if (photos->skipped)
        note("%s: photographs left out: %zu, taken: %zu", c->in, photos->skipped,
             photos->fit_count + photos->held_out_count);
    say_masks(c, photos);
    if (photos->points_are_random && !c->resume)
        note("%s: no points: begins with %zu random ones", c->in, photos->point_count);
    say_sizes(photos, begins);
}

static int fit_whole(fit_command *c, char **argv)
{
    fxs_photos photos;
    fxs_message message;
    const int error = fxs_photos_read(c->in, &c->reading, &photos, &message);
    progress_end();
    if (error)
        return fail_for(&message);
    say_photos(c, &photos, photos.point_count);
    const int status = fit_photos(c, &photos, 0, argv);
    fxs_photos_free(&photos);
    return status;
}

static int measure_scene(fit_command *c)
{
    fxs_photos photos;
    fxs_message message;
    quality q = {0};
    world scene = {0};
    c->reading.held_out_alone = 1;
    const int error = fxs_photos_read(c->in, &c->reading, &photos, &message);
    progress_end();
    if (error)
        return fail_for(&message);
    say_masks(c, &photos);
    if (c->compare)
        result_tell_pictures(&photos, c->compare);
    int status = files_check();
    if (!status)
        status = world_open_file(&scene, c->measure, &c->frame.load);
    if (!status)
        status = result_measure(&q, &scene, &photos, &c->frame, c->compare);
    if (!status)
        print_measured(c, &photos, &scene, &q);
    quality_free(&q);
    world_close(&scene);
    fxs_photos_free(&photos);
    return status;
}

/* What the coarse fit has outside of all blocks is written as it is. */
static int write_outside(const fit_command *c, const fxs_fit_block *block)
{
    const int status = result_write_outside(block, c->out);
    if (!status && c->json) {
        printf("{\"scene\": ");
        print_json_string(c->out);
        printf(", \"gaussians\": %zu}\n", block->gaussian_count);
    } else if (!status)
        printf("%s: %zu Gaussians of %s outside of all blocks\n", c->out, block->gaussian_count, c->coarse);
    return status;
}

/* As if the whole set were what the block needs of it. */
static int fit_block(fit_command *c, char **argv)
{
    fxs_fit_block block;
    fxs_fit_coarse *coarse = 0;
    fxs_message message;
    if (c->coarse && fxs_fit_coarse_read(&coarse, c->coarse, &message))
        return fail_for(&message);
    const int error = fxs_fit_block_read(c->in, &c->reading, coarse, c->block, c->blocks, &block, &message);
    progress_end();
    int status = error ? fail_for(&message) : 0;
    if (!status && c->block) {
        c->options.extent = block.extent;
        c->options.block = c->block;
        c->options.blocks = c->blocks;
        c->options.coarse = coarse ? fxs_fit_coarse_number(coarse) : 0;
        say_photos(c, &block.photos, coarse ? block.gaussian_count : block.photos.point_count);
        status = fit_photos(c, &block.photos, &block, argv);
    } else if (!status) {
        status = write_outside(c, &block);
    }
    if (!error)
        fxs_fit_block_free(&block);
    fxs_fit_coarse_free(coarse);
    return status;
}

/* Where there are none yet. */
static int find_cameras(fit_command *c)
{
    const reconstruct_options how = {c->in, c->out, c->frames, c->frame.threads, c->reading.skip_bad,
                                     c->reading.masks, c->reading.invert_masks};
    if (c->frames && !film_is_named(c->in))
        return fail(EXIT_USAGE, "--frames: %s is not a film", c->in);
    if (c->measure || !reconstruct_is_needed(c->in))
        return c->cameras_only ? fail(EXIT_USAGE, "--cameras-only: %s has cameras", c->in) : 0;
    const int status = reconstruct(&how, &c->found);
    if (status)
        return status;
    c->in = c->found;
    if (c->reading.masks && *c->reading.masks)
        c->reading.masks = 0;      /* they are in the folder, white where photographs count */
    c->reading.invert_masks = 0;
    return 0;
}

static int fit_set(fit_command *c, char **argv)
{
    const int status = find_cameras(c);
    if (status || c->cameras_only)
        return status;
    fxs_pool *pool = fxs_pool_create(c->frame.threads);
    c->options.run = c->reading.run = pool ? fxs_pool_run : 0;
    c->options.pool = c->reading.pool = pool;
    c->options.threads = pool ? c->frame.threads : 1;
    c->reading.progress = show_reading;
    c->reading.left_out = say_left_out;
    c->reading.argument = c;
    const int made = c->measure ? measure_scene(c) : c->blocks ? fit_block(c, argv) : fit_whole(c, argv);
    fxs_pool_destroy(pool);
    return made;
}

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
        status = fit_set(&c, argv);
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
    "  $ fixsplat fit city -o coarse.fit --resolution 400 --steps 3000\n"
    "  $ fixsplat fit city -o part-1.ply --coarse coarse.fit --block 1/16\n",
    {{own_rows, 0}, COMMON_TABLE}
};
