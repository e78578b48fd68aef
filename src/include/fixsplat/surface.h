/* Surfaces: turns rendered depths of a scene into a triangle mesh. All functions are experimental.
 *
 * A volume is a box of voxels. A program renders views of the scene (median depth and colour), marks the bricks of
 * 8x8x8 voxels near the surface (fxs_volume_mark), reserves them (fxs_volume_reserve), adds the same views to their
 * voxels (fxs_volume_add), and takes the mesh (fxs_volume_mesh). Voxels hold integer sums, so the order of the views,
 * the threads and the back end do not change a bit of the mesh. The method is that of Curless and Levoy (1996), a
 * truncated signed distance; the mesh comes from marching cubes (Lorensen and Cline 1987).
 *
 * Functions return 0, or an FXS_ERR_* and a message. One thread at a time may use a volume or a mesh. */
#ifndef FXS_SURFACE_H
#define FXS_SURFACE_H

#include "camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Views ------------------------------------------------------------------------------------------------------- */

/* Makes `count` views from all around the box low..high, 1 or more, evenly spread over the directions. Each shows the
   whole box in a square picture of `size` pixels. The near plane touches the box, so Gaussians in front of it are not
   drawn. Errors: FXS_ERR_ARGUMENT for an empty box or a number out of range. */
FXS_EXPERIMENTAL int fxs_views_around(fxs_view *views, uint32_t count, const double low[3], const double high[3],
                                      int size, fxs_message *message);

/* Makes FXS_VIEWS_WITHIN views from within the box: from 15 places the six directions of the axes, in square pictures
   of `size` pixels with a field of view of 90 degrees. Errors: as fxs_views_around. */
#define FXS_VIEWS_WITHIN 90u
FXS_EXPERIMENTAL int fxs_views_within(fxs_view *views, const double low[3], const double high[3], int size,
                                      fxs_message *message);

/* ---- Depths ------------------------------------------------------------------------------------------------------ */

/* The shapes of the Gaussians of objects, 40 bytes each. Objects that move have none. `objects` must stay valid.
   fxs_shapes_free frees *shapes, which is null after an error: FXS_ERR_MEMORY, FXS_ERR_SCENE. */
typedef struct fxs_shapes fxs_shapes;
FXS_EXPERIMENTAL int fxs_shapes_make(fxs_shapes **shapes, const fxs_object *objects, uint32_t count,
                                     fxs_message *message);

/* Refines the median depths of a view by its ids. A depth of the renderer is that of a Gaussian's centre; it becomes
   the depth at which the pixel's ray passes the Gaussian. The pictures have the size of the view, without gaps between
   rows. */
FXS_EXPERIMENTAL void fxs_shapes_refine(const fxs_shapes *shapes, const fxs_view *view, const fxs_id *ids,
                                        uint32_t *depths, int depth_bits, const fxs_workers *workers);

FXS_EXPERIMENTAL void fxs_shapes_free(fxs_shapes *shapes);

/* ---- Volume ------------------------------------------------------------------------------------------------------ */

#define FXS_VOLUME_RESOLUTION 2048u      /* largest resolution of a volume */
#define FXS_VOLUME_VIEWS 4095u          /* most views of a volume */
#define FXS_VOLUME_FAR 16                /* distance up to which an unbounded volume reaches, in halves of its side */

/* A field of 0 stands for its default. */
typedef struct fxs_volume_options {
    uint32_t size;
    uint32_t resolution;           /* voxels along the longest side of the box, 16 to FXS_VOLUME_RESOLUTION; 0: 512 */
    double low[3], high[3];        /* corners of the box, scene units */
    double truncation;             /* largest distance before a surface that counts, voxels, 1 to 64; half as much
                                      counts behind it. Larger ones average more noise, but thicken thin walls. 0:
                                      resolution / 32, at least 4 */
    uint32_t least_views;          /* a voxel that fewer views saw is unknown; 0: 1 */
    int closed;                    /* 1: unknown voxels count as inside, so the mesh has no holes */
    int is_cave;                   /* 1: the scene is seen from within, and all around the box counts as inside */
    uint64_t max_memory;           /* limit of all memory of the volume and its mesh, bytes; 0: no limit */
    fxs_workers workers;
    int is_unbounded;              /* 1: the box becomes a cube with the same longest side, and what lies outside is
                                      contracted, x to (2 - 1/|x|) x / |x| (Barron et al. 2022) with the largest
                                      coordinate as |x|, so voxels grow with the square of the distance */
} fxs_volume_options;
FXS_INIT(fxs_volume_options)

/* A rendered view. The pictures have the size of the view, without gaps between rows. */
typedef struct fxs_depth_picture {
    const fxs_view *view;          /* perspective or orthographic */
    const uint32_t *depths;        /* median depths, as of fxs_targets */
    const uint8_t *colours;        /* FXS_FORMAT_RGBA8_COVERAGE */
    int depth_bits;                /* fraction bits of the depths */
} fxs_depth_picture;

typedef struct fxs_volume fxs_volume;

/* Makes an empty volume. fxs_volume_free frees *volume, which is null after an error: FXS_ERR_ARGUMENT, FXS_ERR_MEMORY
   (also if the limit is too low for any mesh of this resolution). */
FXS_EXPERIMENTAL int fxs_volume_make(fxs_volume **volume, const fxs_volume_options *options, fxs_message *message);

/* Marks the bricks near the surface of a view. A picture of half the size that fxs_volume_add gets is enough. */
FXS_EXPERIMENTAL int fxs_volume_mark(fxs_volume *volume, const fxs_depth_picture *picture, fxs_message *message);

/* What a volume takes. */
typedef struct fxs_volume_size {
    uint32_t bricks;               /* number of marked bricks of 8x8x8 voxels */
    uint64_t bytes;                /* bytes of the volume and, by estimate, of its mesh */
    double voxel;                  /* side of a voxel, scene units */
    uint64_t reserved[4];
} fxs_volume_size;

/* Reserves the voxels of the marked bricks. Errors: FXS_ERR_MEMORY, with message->bytes_needed, if they exceed
   max_memory; *size is valid then too. `size` may be null. */
FXS_EXPERIMENTAL int fxs_volume_reserve(fxs_volume *volume, fxs_volume_size *size, fxs_message *message);

/* Adds a view to the reserved voxels. Errors: FXS_ERR_ARGUMENT for more than FXS_VOLUME_VIEWS views. */
FXS_EXPERIMENTAL int fxs_volume_add(fxs_volume *volume, const fxs_depth_picture *picture, fxs_message *message);

FXS_EXPERIMENTAL void fxs_volume_free(fxs_volume *volume);

/* ---- Mesh -------------------------------------------------------------------------------------------------------- */

/* A mesh. Vertices are shared by their triangles, whose corners are counterclockwise seen from outside. The position of
   a vertex is origin + step * place, in scene units. */
typedef struct fxs_mesh {
    uint32_t vertex_count, triangle_count;
    int32_t *places;               /* three numbers per vertex: voxels, Q16 */
    uint8_t *colours;              /* red, green, blue per vertex, then 255; 0 if no view shows the vertex */
    uint32_t *triangles;           /* three numbers of vertices per triangle */
    double origin[3], step;
    uint64_t max_memory;           /* as of the volume */
    uint32_t half_q16, middle_q16; /* not 0: contracted places, until fxs_mesh_expand */
    uint64_t reserved[3];
} fxs_mesh;

/* Takes the mesh of a volume. The bricks are freed; the volume can only be freed afterwards. fxs_mesh_free frees *mesh,
   which is null after an error: FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_volume_mesh(fxs_volume *volume, fxs_mesh **mesh, fxs_message *message);

/* True if a file holds a mesh that fxs_mesh_open reads, by its content: a .ply with faces, an .obj, or a glTF without
   Gaussians. */
FXS_EXPERIMENTAL int fxs_mesh_is_file(const char *path);

/* Reads the triangles of a .glb, .gltf, .ply or .obj of any program, in the file's units and axes. Larger faces are
   split, nodes of a glTF are applied. Vertices at the same place become one; triangles with two corners at the same
   place are left out. A triangle is split where a side of it, parallel to an axis, touches smaller ones, as in the .glb
   of fxs_voxels_write. A place is a multiple of 2^-27 of the longest side of the box (a power of two), so mesh->step is
   that times 65536. Colours are not read: all are 0. max_memory: limit of the memory for reading; 0: in proportion to
   the file's size. fxs_mesh_free frees *mesh, which is null after an error: FXS_ERR_FILE (also for a glTF with Draco or
   meshopt compression), FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED if built without glTF. */
FXS_EXPERIMENTAL int fxs_mesh_open(fxs_mesh **mesh, const char *path, uint64_t max_memory, fxs_message *message);

/* Size of a mesh. A mesh is closed if at each edge as many triangles run one way as the other. */
typedef struct fxs_mesh_measures {
    uint32_t parts;                /* connected by shared vertices */
    uint64_t open_edges;           /* edges of a single triangle */
    uint64_t turned_edges;         /* other edges where a mesh is not closed: triangles face opposite ways there */
    double low[3], high[3];        /* corners of the box, scene units */
    double area;
    double volume;                 /* of a closed mesh, below 0 if its triangles face inwards; else 0 */
    uint64_t reserved[4];
} fxs_mesh_measures;

/* Measures a mesh with sums of integers. The volume is the sum of tetrahedra between the triangles and a point. Errors:
   FXS_ERR_MEMORY; FXS_ERR_ARGUMENT if places differ by 2^28 or more. */
FXS_EXPERIMENTAL int fxs_mesh_measure(fxs_mesh_measures *measures, const fxs_mesh *mesh, fxs_message *message);

/* A way along the surface. */
typedef struct fxs_mesh_route {
    double from[3], to[3];         /* the points of the mesh nearest to the given ones */
    double straight, along;        /* length of the straight line, and of the way */
    double (*points)[3];           /* the way, a point at each edge that it crosses */
    uint32_t count;
    uint64_t reserved[4];
} fxs_mesh_route;

/* Finds a shortest way along a mesh between the points of the mesh nearest to two given ones. A search over points on
   the edges (Lanthier, Maheshwari and Sack 1997) finds the triangles that the way passes. The way through them is then
   straightened exactly, also around their corners (Xin and Wang 2007), so it is the shortest among its neighbours.
   fxs_mesh_route_free frees the route, which is empty after an error: FXS_ERR_ARGUMENT if no way joins the points or a
   number is not finite, FXS_ERR_MEMORY (also beyond mesh->max_memory, if it is not 0). */
FXS_EXPERIMENTAL int fxs_mesh_find_route(fxs_mesh_route *route, const fxs_mesh *mesh, const double from[3],
                                         const double to[3], fxs_message *message);

/* Writes a route as an .obj with one line (element l), under a temporary name, and renames the file. */
FXS_EXPERIMENTAL int fxs_mesh_route_write(const char *path, const fxs_mesh_route *route, fxs_message *message);

FXS_EXPERIMENTAL void fxs_mesh_route_free(fxs_mesh_route *route);

/* Drops connected parts with fewer than `least` triangles. *parts, which may be null, gets the number of parts that are
   left. */
FXS_EXPERIMENTAL int fxs_mesh_drop_parts(fxs_mesh *mesh, uint32_t least, uint32_t *parts, fxs_message *message);

/* Reduces the mesh to at most `triangles` triangles where its shape allows it, by quadric error metrics (Garland and
   Heckbert 1997). Edges are collapsed one after the other, on the calling thread. */
FXS_EXPERIMENTAL int fxs_mesh_decimate(fxs_mesh *mesh, uint32_t triangles, fxs_message *message);

/* Maps the contracted places of an unbounded volume's mesh to those of the scene. Call it after decimation, which then
   keeps details in proportion to their distance. Of another mesh, it changes nothing. */
FXS_EXPERIMENTAL void fxs_mesh_expand(fxs_mesh *mesh);

/* Options for writing a mesh. */
typedef struct fxs_mesh_write_options {
    uint32_t size;
    double scale;                  /* metres per scene unit; 0: 1 */
    double up[3];                  /* up direction of the scene, which becomes y in a .glb; all 0: 0, -1, 0 */
} fxs_mesh_write_options;
FXS_INIT(fxs_mesh_write_options)

/* Writes an expanded mesh with normals and colours, in metres. The ending of the name is the format: .glb (binary glTF
   2.0, y up), .ply (binary) or .obj (colours behind the positions); the last two keep the scene's axes. The file is
   written under a temporary name and renamed. */
FXS_EXPERIMENTAL int fxs_mesh_write(const char *path, const fxs_mesh *mesh, const fxs_mesh_write_options *options,
                                    fxs_message *message);

FXS_EXPERIMENTAL void fxs_mesh_free(fxs_mesh *mesh);

#ifdef __cplusplus
}
#endif

#endif
