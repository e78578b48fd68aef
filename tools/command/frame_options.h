/* The options that render, view and bench share: cameras, scenes and how frames are rendered; and their rows. */
#ifndef FRAME_OPTIONS_H
#define FRAME_OPTIONS_H

#include <fixsplat/camera.h>
#include <fixsplat/backend.h>
#include "command_line.h"
#include "load_world.h"

#define DEVICES_MOST 16

typedef struct frame_options {
    const char *cameras, *view;             /* camera file; number, name, list of numbers or "all" */
    int orbit, frames;                      /* frames of an orbit; frames of a path through the views; 0: neither */
    point_option eye, look, up;
    int auto_up;                            /* 1: find the up direction in the scene */
    int framed;                             /* 1: without a camera, frame the whole scene, to compare measurements */
    double fov;                             /* degrees; 0: default */
    double ortho;                           /* height of an orthographic picture, units; 0: perspective */
    double near;                            /* near plane, scene units; 0: default, see --help */
    int lens;                               /* 1: draw a camera file's views through their lenses */
    int panorama;                           /* 1: a level panorama, by default from the scene's middle */
    int width, height;                      /* 0: the camera's own size, or 1280x720, or 2048x1024 for a panorama */
    int has_tangents;
    double tangents[4];                     /* left, right, up, down; stereo: of the left eye */
    double stereo;                          /* distance of the two eyes, scene units; 0: mono */
    fxs_options render;
    const char *cpu, *backend;
    int devices[DEVICES_MOST];              /* device_count of them are set; 0: all devices */
    int device_count;
    uint32_t threads;
    size_t max_memory;                      /* bytes for a frame; 0: unlimited */
    load_options load;
    world_options world;
} frame_options;

/* Rows by topic: cameras, scenes and placement, rendering, levels of detail, reading of scenes. FRAME_TABLES lists
   them all for a command whose options contain frame_options as the member `frame`. */
extern const option_row camera_rows[], world_rows[], frame_rows[], level_rows[], load_rows[];

/* The row --pool of load_options, for commands that load chunks on demand. */
extern const option_row pool_rows[];
#define POOL_TABLE(options) {pool_rows, offsetof(options, frame.load)}
#define FRAME_TABLES(options) \
    {camera_rows, offsetof(options, frame)}, {world_rows, offsetof(options, frame.world)}, \
    {frame_rows, offsetof(options, frame)}, {level_rows, offsetof(options, frame)}, \
    {load_rows, offsetof(options, frame.load)}

/* For rows of other commands with the offset of frame_options: --size, --device, and --threads from 1 to 64. */
take_option take_frame_size, take_devices, take_threads;

/* Names of enum fxs_cutoff. */
extern const char *const cutoff_names[];

void frame_options_default(frame_options *options);

/* Checks the options against each other. Returns 0, or prints the error and returns EXIT_USAGE. */
int frame_options_check(const frame_options *options);

/* Finds the back end that the options name, and its options for a device. Returns 0, or prints the error and returns
   EXIT_USAGE. */
int choose_backend(const frame_options *options, int device, const fxs_backend **backend, fxs_backend_options *how);

/* Lists the devices that the options ask for, or the first only if the back end drives a single one. Returns their
   number. */
int choose_devices(const frame_options *options, int devices[DEVICES_MOST]);

#endif
