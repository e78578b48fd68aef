/* The options that render, view and bench share (cameras, scenes, how frames are rendered), and their rows. */
#ifndef FRAME_OPTIONS_H
#define FRAME_OPTIONS_H

#include <fixsplat/camera.h>
#include <fixsplat/backend.h>
#include "command_line.h"
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
    point_option eye, look, up;
    int auto_up;                            /* up is found in the scene */
    int framed;                             /* without a camera the scene is framed whole, so that measures compare */
    double fov;                             /* degrees; 0: none given */
    double ortho;                           /* height of an orthographic picture, units; 0: perspective */
    double near;                            /* near plane, scene units; 0: as --help says */
    int lens;                               /* views of a file are drawn through its lenses */
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

/* The rows of cameras, of scenes and where they are, of how frames are rendered, of which levels of detail, and of how
   scenes are read; and all of them, for a command whose options have frame_options as their member `frame`. */
extern const option_row camera_rows[], world_rows[], frame_rows[], level_rows[], load_rows[];

/* Of load_options: --pool, for commands whose frames take what is not in memory as it comes. */
extern const option_row pool_rows[];
#define POOL_TABLE(options) {pool_rows, offsetof(options, frame.load)}
#define FRAME_TABLES(options) \
    {camera_rows, offsetof(options, frame)}, {world_rows, offsetof(options, frame.world)}, \
    {frame_rows, offsetof(options, frame)}, {level_rows, offsetof(options, frame)}, \
    {load_rows, offsetof(options, frame.load)}

/* For rows of other commands, whose offset is that of frame_options: --size, --device, and --threads from 1 to 64. */
take_option take_frame_size, take_devices, take_threads;

/* Of enum fxs_cutoff. */
extern const char *const cutoff_names[];

void frame_options_default(frame_options *options);

/* Checks the options against each other. Returns 0, or prints what is wrong and returns EXIT_USAGE. */
int frame_options_check(const frame_options *options);

/* The back end that the options name, and how it is to be opened on a device. Returns 0, or prints what is wrong and
   returns EXIT_USAGE. */
int choose_backend(const frame_options *options, int device, const fxs_backend **backend, fxs_backend_options *how);

/* Fills in the devices that the options ask for; the first alone where the back end has no more. Returns how many. */
int choose_devices(const frame_options *options, int devices[DEVICES_MOST]);

#endif
