/* Prints the size of a mesh, and distances along it, for the command info. */
#ifndef MESH_INFO_H
#define MESH_INFO_H

#include <stddef.h>

typedef struct mesh_info_options {
    int has_distance, json;
    double ends[6];                         /* the two points of the distance */
    const char *output;                     /* file for the way along the surface; null: none */
    size_t max_memory;
} mesh_info_options;

int print_mesh_info(const char *path, const mesh_info_options *options);

#endif
