/* Options for cameras, scenes and rendering that several subcommands share. */
#ifndef FRAME_OPTIONS_H
#define FRAME_OPTIONS_H

#include <fixsplat/camera.h>
#include <fixsplat/backend.h>
#include "command_line.h"
#include "load_world.h"
#include "frame_times.h"

#define DEVICES_MOST 16

typedef struct frame_options {
    const char *cameras, *view;
    int orbit, frames;                      /* number of frames of an orbit, and of a path */
    const char *path, *track;               /* file of a path's keys, and the track in it */
    double seconds;                         /* length of a path's film; 0: by `frames`, or by the times of its keys */
    rate_option rate;                       /* frames per second of a film */
    times_option times;                     /* the times of a film of scenes that move */
    double shutter;                         /* degrees of 360 that the shutter of a film is open; 0: no motion blur */
    double aperture, focus;                 /* diameter and focus of the lens, scene units; 0: pinhole; 0: automatic */
    int samples;                            /* renderings of which each picture is the mean; 1: no mean */
    point_option eye, look, up;
    int auto_up;                            /* 1: finds the up direction in the scene */
    int framed;                             /* 1: the camera frames the whole scene */
    double fov;                             /* field of view in degrees; 0: default */
    double ortho;                           /* height of an orthographic view in scene units; 0: perspective */
    double near;                            /* near plane in scene units; 0: default */
    int lens;
    int panorama;
    int width, height;
    int has_tangents;
    double tangents[4];    /* tangents of the view's edges: left, right, up, down; with stereo, of the left eye */
    double stereo;                          /* distance of the two eyes, scene units; 0: mono */
    fxs_options render;
    const char *cpu, *backend;
    int is_auto;                            /* 1: settle_backend chose `backend` */
    int devices[DEVICES_MOST];
    int device_count;
    uint32_t threads;
    size_t max_memory;                      /* most bytes for rendering a frame; 0: no limit */
    int gazes, gaze[4];                     /* pixel, radii of the rates 1 and 2; gazes: how many are given */
    load_options load;
    world_options world;
} frame_options;

/* Option tables, one for each topic. FRAME_TABLES lists all of them. */
extern const option_row camera_rows[], world_rows[], frame_rows[], level_rows[], load_rows[];

/* Further rows below the heading of frame_rows and of load_rows. */
extern const option_row background_rows[], gaze_rows[], pool_rows[];
#define POOL_TABLE(options) {pool_rows, offsetof(options, frame.load)}
#define FRAME_TABLES(options) \
    {camera_rows, offsetof(options, frame)}, {world_rows, offsetof(options, frame.world)}, \
    {frame_rows, offsetof(options, frame)}, {background_rows, offsetof(options, frame)}, \
    {level_rows, offsetof(options, frame)}, {load_rows, offsetof(options, frame.load)}

take_option take_frame_size, take_devices, take_threads;

extern const char *const cutoff_names[];

void frame_options_default(frame_options *options);

int frame_options_check(const frame_options *options);

/* Finds the back end that the options name. *how gets the back end's options for a device. */
int choose_backend(const frame_options *options, int device, const fxs_backend **backend, fxs_backend_options *how);

/* Stores the numbers of the devices that the options ask for, and returns how many there are. */
int choose_devices(const frame_options *options, int devices[DEVICES_MOST]);

#endif
