/* The fixsplat command: what its sub-commands share. */
#ifndef COMMAND_H
#define COMMAND_H

#include <getopt.h>
#include <stdint.h>
#include <stdio.h>

#include "../port/camera/camera.h"
#include "../port/import/pack.h"
#include "../port/scene/scene_filter.h"
#include "../port/posix/map.h"
#include "../port/posix/pool.h"
#include "../src/fixsplat.h"
#include "backend.h"

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* The sub-commands; argv[0] is their name. They return the exit status. */
int command_render(int argc, char **argv);
int command_view(int argc, char **argv);
int command_bench(int argc, char **argv);
int command_info(int argc, char **argv);
int command_convert(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_make_scene(int argc, char **argv);

/* For main to call first: where what was printed does not arrive, the program says so and fails, wherever it ends. */
void check_printed_at_exit(void);

/* Prints "fixsplat: ..." on stderr and returns the status. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int fail(int status, const char *format, ...);

/* After getopt_long met a wrong option (opterr is 0): names it, points at --help and returns EXIT_USAGE. */
int wrong_option(char **argv);

/* Whole numbers and lists of numbers, checked; they return 0 where the text is anything else. */
int parse_count(const char *text, uint64_t low, uint64_t high, uint64_t *out);
int parse_bytes(const char *text, size_t *out);                     /* 1 or more; 64K, 3M, 2G: times 2^10, 2^20, 2^30 */
int parse_size(const char *text, int *width, int *height);          /* WxH, each 1 to 16384 */
int parse_vector(const char *text, int count, double *out);         /* X,Y,... */
int parse_colour(const char *text, uint8_t rgb[3]);                 /* RRGGBB */

/* A bar on stderr where that is a terminal, after a word on what is being done: an fxs_progress_fn. progress_end takes
   it away, before anything else is printed and between two labels. */
int progress_bar(void *label, double done);
void progress_end(void);

/* ---- A scene: imported and packed, or mapped --------------------------------------------------------------------- */

typedef struct loaded_scene {
    fxs_scene_file_info info;
    fxs_packed_scene packed;
    fxs_pack_report report;                 /* of an .fxs file: counts and bounds only */
    fxs_scene scene;
    const char *path;
    fxs_mapping mapping;                    /* what `packed` is of an .fxs file */
    uint64_t load_nanoseconds;
} loaded_scene;

/* Whether a file begins as an .fxs file does. */
int is_packed(const char *path);

/* All 0 is a default. */
typedef struct load_options {
    int lod;                                /* level of detail, 0 the finest, of a file that has several */
    enum fxs_axes axes;                     /* of an .spz */
    uint32_t threads;                       /* of the import; 0: one a processor */
    enum fxs_profile profile;               /* of what is not packed yet */
    const fxs_scene_filter *filter;         /* what to leave out, or null; an .fxs file is mapped whole */
    uint64_t max_gaussians;                 /* in a file that is imported, and the memory that reading it may take: */
    size_t import_memory;                   /* as in fxs_scene_file_options */
    int again;                              /* what is left out or changed has been said */
} load_options;

/* Returns 0, or prints why not and returns EXIT_FAILED. */
int load_scene(loaded_scene *loaded, const char *path, const load_options *options);

/* Opens a scene file to be read in floats, and says on stderr what the filter (or null) leaves out. Returns 0 and a
   file for fxs_scene_file_close, or prints why not and returns EXIT_FAILED. */
int open_scene(const char *path, const load_options *options, fxs_scene_file **file, fxs_scene_file_info *info);

/* Takes the value of --max-memory. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int take_max_memory(size_t *bytes, const char *value);

/* Takes the value of one of IMPORT_OPTIONS. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int take_import_option(load_options *options, int which, const char *value);

/* Takes the value of --lod. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int take_lod(load_options *options, const char *value);

/* Takes the value of --profile. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int take_profile(load_options *options, const char *value);

/* "default", "compact" or "small". */
const char *profile_name(enum fxs_profile profile);

/* Whether the scene is still what was loaded: an .fxs file may be written to. Returns 0, or prints that it is not and
   returns EXIT_FAILED. */
int check_scene(const loaded_scene *loaded);

void free_scene(loaded_scene *loaded);

/* ---- The options of render, view and bench --------------------------------------------------------------------- */

#define DEVICES_MOST 16

typedef struct view_options {
    const char *cameras, *view;             /* camera file; number, name or "all" */
    int has_eye, has_look, has_up;
    double eye[3], look[3], up[3], fov;
    double near;                            /* near plane, scene units; 0: as --help says */
    int width, height;                      /* 0: the camera's own size, or 1280x720 */
    double stereo;                          /* between the two eyes, scene units; 0: one picture */
    int stereo_exact;
    fxs_options render;
    enum fxs_format format;
    const char *cpu, *backend;
    int devices[DEVICES_MOST];              /* of --backend cuda; the first device_count, 0: all there are */
    int device_count;
    uint32_t threads;
    size_t max_memory;                      /* of a frame, bytes; 0: as much as it takes */
    load_options load;
} view_options;

/* Their entries for a getopt_long table, and the value that each returns there. */
enum { OPT_CAMERAS = 256, OPT_VIEW, OPT_EYE, OPT_LOOK, OPT_UP, OPT_FOV, OPT_NEAR, OPT_SIZE, OPT_BG, OPT_CUTOFF,
       OPT_SH_DEGREE, OPT_CPU, OPT_THREADS, OPT_MAX_MEMORY, OPT_BACKEND, OPT_DEVICE, OPT_LOD, OPT_PROFILE, OPT_STEREO,
       OPT_STEREO_EXACT, OPT_MAX_GAUSSIANS, OPT_IMPORT_MEMORY, OPT_AXES, OPT_HELP, OPT_OWN };
#define IMPORT_OPTIONS \
    {"axes", required_argument, 0, OPT_AXES}, {"max-gaussians", required_argument, 0, OPT_MAX_GAUSSIANS}, \
    {"import-memory", required_argument, 0, OPT_IMPORT_MEMORY}
#define IMPORT_HELP \
    "  --axes AXES         of an .spz: rub (right, up, back) or rdf (right, down, front: files of\n" \
    "                      splat-transform 3); default: as the file says, without a word rub\n" \
    "  --max-gaussians N   refuse to import a scene of more Gaussians (default: 1000000 and one for each byte of\n" \
    "                      its files, 67108864 at most); each takes about 100 bytes while it is packed\n" \
    "  --import-memory BYTES\n" \
    "                      refuse to import a scene that takes more memory to read and decompress, also as 64K,\n" \
    "                      3M, 2G (default: 96 bytes for each Gaussian of that limit, for 1000000 at least)\n"
#define VIEW_OPTIONS \
    {"cameras", required_argument, 0, OPT_CAMERAS}, {"view", required_argument, 0, OPT_VIEW}, \
    {"eye", required_argument, 0, OPT_EYE}, {"look", required_argument, 0, OPT_LOOK}, \
    {"up", required_argument, 0, OPT_UP}, {"fov", required_argument, 0, OPT_FOV}, \
    {"near", required_argument, 0, OPT_NEAR}, \
    {"size", required_argument, 0, OPT_SIZE}, {"bg", required_argument, 0, OPT_BG}, \
    {"cutoff", required_argument, 0, OPT_CUTOFF}, {"sh-degree", required_argument, 0, OPT_SH_DEGREE}, \
    {"cpu", required_argument, 0, OPT_CPU}, {"threads", required_argument, 0, OPT_THREADS}, \
    {"max-memory", required_argument, 0, OPT_MAX_MEMORY}, \
    {"backend", required_argument, 0, OPT_BACKEND}, {"device", required_argument, 0, OPT_DEVICE}, \
    {"lod", required_argument, 0, OPT_LOD}, IMPORT_OPTIONS, \
    {"profile", required_argument, 0, OPT_PROFILE}, {"stereo", required_argument, 0, OPT_STEREO}, \
    {"stereo-exact", no_argument, 0, OPT_STEREO_EXACT}, \
    {"help", no_argument, 0, OPT_HELP}
extern const char view_options_help[];

void view_options_default(view_options *options);

/* Takes one of VIEW_OPTIONS. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int view_option(view_options *options, int which, const char *value);

/* Checks the options against each other. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int view_options_check(const view_options *options);

/* The views that the options ask for, at their final size. Returns how many, with *views allocated; or prints why not
 * and returns -1, with views null if it was null before. */
long choose_views(const view_options *options, const fxs_pack_report *report, fxs_file_view **views);

/* The number of the view that --view asks for, 0 without it; or prints that there is none and returns -1. */
long find_view(const view_options *options, const fxs_file_view *views, long count);

/* ---- A renderer: context, threads and memory for one picture size ----------------------------------------------- */

struct fxs_cuda;

typedef struct renderer {
    fxs_context context;
    struct fxs_cuda *cuda;                  /* null: frames are rendered by the context */
    const loaded_scene *on_device;          /* the scene that cuda has */
    fxs_pool *pool;
    backend *backend;
    void *memory, *allocation;
    size_t memory_bytes, pixel_bytes;
    size_t max_memory;                      /* max_memory, stereo, stereo_exact: as in view_options */
    double stereo;
    int stereo_exact;
    enum fxs_format format;
    uint8_t *pixels;                        /* RGBA; of two eyes side by side, the left one left */
    int width, height;                      /* of the pixels */
} renderer;

/* Returns 0, or prints why not and returns EXIT_FAILED or EXIT_USAGE (an unknown --cpu or --backend). */
int renderer_init(renderer *r, const view_options *options);
void renderer_free(renderer *r);

/* The CUDA back end of a renderer; without one in this build, cuda_open fails. They return 0, or print why not and
   return EXIT_FAILED. `pixels`: RGBA. */
int cuda_open(renderer *r, int device);
void cuda_close(renderer *r);
int cuda_render(renderer *r, const loaded_scene *loaded, const fxs_camera *camera, const fxs_options *options,
                uint8_t *pixels, ptrdiff_t stride, fxs_stats *stats);

/* Fills in the devices that the options ask for; 1 without --backend cuda. Returns how many. */
int cuda_devices(const view_options *options, int devices[DEVICES_MOST]);

/* Prints a line for each device, or why there is none. */
void cuda_list(void);

/* Renders into r->pixels, making room where the size has changed. Returns 0, or prints why not and returns
   EXIT_FAILED. */
int renderer_render(renderer *r, const loaded_scene *loaded, const fxs_file_view *view, const fxs_options *options,
                    fxs_stats *stats);

#endif
