/* The options that render, view and bench share: cameras, and how frames are rendered. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <fixsplat/camera.h>
#include <fixsplat/backend.h>
#include "load_world.h"

#define DEVICES_MOST 16

typedef struct foveate_options {
    int on;
    int given;                              /* 0, or of the numbers those that are: 2, 4 or 5 */
    double numbers[5];                      /* gaze x, y; radii of full and half rate; band; pixels */
} foveate_options;

typedef struct frame_options {
    const char *cameras, *view;             /* camera file; number, name, list of numbers or "all" */
    int orbit, frames;                      /* pictures of a turn, and of a way through the views; 0: neither */
    int has_eye, has_look, has_up;
    double eye[3], look[3], up[3], fov;
    double ortho;                           /* height of an orthographic picture, units; 0: perspective */
    double near;                            /* near plane, scene units; 0: as --help says */
    int panorama;                           /* the camera is in the scene's middle where none is given, and level */
    int width, height;                      /* 0: the camera's own size, or 1280x720, or 2048x1024 of a panorama */
    int has_tangents;
    double tangents[4];                     /* left, right, up, down; of two eyes those of the left one */
    double stereo;                          /* between the two eyes, scene units; 0: one picture */
    int stereo_exact;
    foveate_options foveate;
    fxs_options render;
    const char *cpu, *backend;
    int devices[DEVICES_MOST];              /* the first device_count, 0: all that there are */
    int device_count;
    uint32_t threads;
    size_t max_memory;                      /* of a frame, bytes; 0: as much as it takes */
    load_options load;
    world_options world;
} frame_options;

/* Their entries for a getopt_long table. */
#define FRAME_OPTIONS \
    {"cameras", required_argument, 0, OPT_CAMERAS}, {"view", required_argument, 0, OPT_VIEW}, \
    {"eye", required_argument, 0, OPT_EYE}, {"look", required_argument, 0, OPT_LOOK}, \
    {"up", required_argument, 0, OPT_UP}, {"fov", required_argument, 0, OPT_FOV}, \
    {"ortho", required_argument, 0, OPT_ORTHO}, {"near", required_argument, 0, OPT_NEAR}, \
    {"size", required_argument, 0, OPT_SIZE}, {"bg", required_argument, 0, OPT_BG}, \
    {"cutoff", required_argument, 0, OPT_CUTOFF}, {"sh-degree", required_argument, 0, OPT_SH_DEGREE}, \
    {"cpu", required_argument, 0, OPT_CPU}, {"threads", required_argument, 0, OPT_THREADS}, \
    {"max-memory", required_argument, 0, OPT_MAX_MEMORY}, \
    {"backend", required_argument, 0, OPT_BACKEND}, {"device", required_argument, 0, OPT_DEVICE}, \
    {"lod", required_argument, 0, OPT_LOD}, IMPORT_OPTIONS, WORLD_OPTIONS, \
    {"profile", required_argument, 0, OPT_PROFILE}, {"stereo", required_argument, 0, OPT_STEREO}, \
    {"stereo-exact", no_argument, 0, OPT_STEREO_EXACT}, {"tangents", required_argument, 0, OPT_TANGENTS}, \
    {"foveate", optional_argument, 0, OPT_FOVEATE}
extern const char camera_options_help[], frame_options_help[];

void frame_options_default(frame_options *options);

/* Takes one of FRAME_OPTIONS. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int frame_option(frame_options *options, int which, const char *value);

/* Checks the options against each other. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int frame_options_check(const frame_options *options);

/* Takes the value of --max-memory. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int take_max_memory(size_t *bytes, const char *value);

/* The back end that the options name, and how it is to be opened on a device. Returns 0, or prints what is wrong and
   returns EXIT_USAGE. */
int choose_backend(const frame_options *options, int device, const fxs_backend **backend, fxs_backend_options *how);

/* Fills in the devices that the options ask for; the first alone where the back end has no more. Returns how many. */
int choose_devices(const frame_options *options, int devices[DEVICES_MOST]);

/* The views that the options ask for, at their final size, of a film those of its frames. Returns how many, with *views
   allocated; or prints why not and returns -1, with views null if it was null before. */
long choose_views(const frame_options *options, const world *w, fxs_file_view **views);

/* The number of the view that --view asks for, 0 without it; or prints that there is none and returns -1. */
long find_view(const frame_options *options, const fxs_file_view *views, long count);

#endif
