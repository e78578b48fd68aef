/* Tests meshes of files: reading, area, volume, and ways along the surface, with shapes that are known. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/surface.h>
#include "folder.h"

#define PI 3.14159265358979324

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static const char *write_bytes(const char *name, const void *bytes, size_t size)
{
    put_file(name, bytes, size);
    return in_folder(name);
}

static const char *write_text(const char *name, const char *content)
{
    return write_bytes(name, content, strlen(content));
}

static fxs_mesh *open_mesh(const char *path)
{
    fxs_mesh *mesh;
    fxs_message m;
    CHECK(fxs_mesh_is_file(path));
    if (!CHECK(!fxs_mesh_open(&mesh, path, 0, &m)))
        printf("  %s\n", m.text);
    return mesh;
}

/* Opens a file that must fail with some words. */
static void fails(const char *path, const char *words)
{
    fxs_mesh *mesh;
    fxs_message m = {.text = ""};
    CHECK(fxs_mesh_open(&mesh, path, 0, &m) < 0 && !mesh);
    if (!CHECK(strstr(m.text, words) && strstr(m.text, path)))
        printf("  %s\n", m.text);
}

static fxs_mesh_measures measure(const fxs_mesh *mesh)
{
    fxs_mesh_measures measures = {.parts = 0};
    fxs_message m;
    CHECK(mesh && !fxs_mesh_measure(&measures, mesh, &m));
    return measures;
}

static int is_near(double x, double truth, double share)
{
    if (fabs(x - truth) <= share * fabs(truth))
        return 1;
    printf("  %.12g, not %.12g\n", x, truth);
    return 0;
}

/* ---- Shapes ------------------------------------------------------------------------------------------------------ */

/* A grid of a x b cells that is closed in one or two directions, as an .obj of quads or triangles. */
typedef void point_fn(double u, double v, double at[3]);

static const char *write_grid(const char *name, int a, int b, int closed_a, int closed_b, int is_triangles,
                              point_fn *point)
{
    FILE *file = fopen(in_folder(name), "wb");
    const int across = a + !closed_a, down = b + !closed_b;
    fputs("# a grid\no shape\n", file);
    for (int j = 0; j < down; j++)
        for (int i = 0; i < across; i++) {
            double at[3];
            point((double)i / a, (double)j / b, at);
            fprintf(file, "v %.9g %.9g %.9g\n", at[0], at[1], at[2]);
        }
    for (int j = 0; j < b; j++)
        for (int i = 0; i < a; i++) {
            const int p = j * across + i + 1, q = j * across + (i + 1) % across + 1;
            const int s = (j + 1) % down * across + i + 1, r = (j + 1) % down * across + (i + 1) % across + 1;
            fprintf(file, is_triangles ? "f %d %d %d\nf %d %d %d\n" : "f %d %d %d %d\n", p, q, r, is_triangles ? p : s,
                    r, s);
        }
    fclose(file);
    return in_folder(name);
}

/* Poles are exact, so that the vertices of a pole are one. */
static void on_sphere(double u, double v, double at[3])
{
    const double wide = v <= 0 || v >= 1 ? 0 : sin(PI * v);
    at[0] = wide * cos(2 * PI * u);
    at[1] = wide * sin(2 * PI * u);
    at[2] = -cos(PI * v);
}

#define RING 1.0
#define TUBE 0.35

static void on_torus(double u, double v, double at[3])
{
    at[0] = (RING + TUBE * cos(2 * PI * v)) * cos(2 * PI * u);
    at[1] = (RING + TUBE * cos(2 * PI * v)) * sin(2 * PI * u);
    at[2] = TUBE * sin(2 * PI * v);
}

static uint32_t noise(uint32_t x)
{
    x = (x ^ x >> 16) * 0x45d9f3bu;
    x = (x ^ x >> 16) * 0x45d9f3bu;
    return x ^ x >> 16;
}

static double random_of(double u, double v, uint32_t seed)
{
    return noise((uint32_t)(u * 4096) * 8191 + (uint32_t)(v * 4096) + seed * 77777) / 4294967296.0 - 0.5;
}

/* A square of 2 x 2 whose inner vertices are moved in it. */
static void on_plane(double u, double v, double at[3])
{
    const int is_inner = u > 0 && u < 1 && v > 0 && v < 1;
    at[0] = 2 * u + is_inner * random_of(u, v, 1) / 18;
    at[1] = 2 * v + is_inner * random_of(u, v, 2) / 18;
    at[2] = 0;
}

static void on_hills(double u, double v, double at[3])
{
    at[0] = 2 * u;
    at[1] = 2 * v;
    at[2] = 0.5 * random_of(u, v, 3);
}

static const char cube_quads[] =
    "v 0 0 0\nv 0 0 2\nv 0 2 0\nv 0 2 2\nv 2 0 0\nv 2 0 2\nv 2 2 0\nv 2 2 2\n"
    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1/1/1 3/2/1 7//1 5\nf -7 -3 -1 -5\n";

/* ---- Area and volume --------------------------------------------------------------------------------------------- */

static void check_cube(const char *path)
{
    fxs_mesh *mesh = open_mesh(path);
    const fxs_mesh_measures m = measure(mesh);
    CHECK(mesh->triangle_count == 12 && mesh->vertex_count == 8 && m.parts == 1 && !m.open_edges && !m.turned_edges);
    CHECK(m.area == 24 && m.volume == 8);
    for (int i = 0; i < 3; i++)
        CHECK(m.low[i] == 0 && m.high[i] == 2);
    fxs_mesh_free(mesh);
}

static void put_u32(uint8_t *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

/* A .glb with 24 vertices, as Blender writes a cube: 2 floats wide, moved by a node, in a turned parent. */
static const char *write_glb(const char *name, const char *extra, const char *nodes)
{
    static uint8_t file[4096];
    char json[2048];
    uint8_t data[24 * 12 + 36 * 2];
    for (uint32_t i = 0; i < 24; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t axis = i / 8, corner = i % 4, high = i / 4 % 2;
            const uint32_t bit = k == axis ? high : k == (axis + 1) % 3 ? corner == 1 || corner == 2 : corner > 1;
            put_u32(data + 12 * i + 4 * k, bit ? 0x3f800000 : 0xbf800000);
        }
    for (uint32_t i = 0; i < 36; i++) {
        static const uint8_t turns[2][6] = {{0, 2, 1, 0, 3, 2}, {0, 1, 2, 0, 2, 3}};
        data[288 + 2 * i] = (uint8_t)(i / 6 * 4 + turns[i / 6 % 2][i % 6]);
        data[288 + 2 * i + 1] = 0;
    }
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":%s,"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1%s},"
             "{\"attributes\":{\"POSITION\":0},\"indices\":2}]}],\"accessors\":[{\"bufferView\":0,"
             "\"componentType\":5126,\"count\":24,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5123,"
             "\"count\":12,\"type\":\"SCALAR\"},{\"bufferView\":1,\"byteOffset\":24,\"componentType\":5123,"
             "\"count\":24,\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":288},"
             "{\"buffer\":0,\"byteOffset\":288,\"byteLength\":72}],\"buffers\":[{\"byteLength\":360}]}", nodes, extra);
    const uint32_t padded = (uint32_t)(strlen(json) + 3) / 4 * 4;
    memset(file, ' ', sizeof file);
    memcpy(file + 20, json, strlen(json));
    put_u32(file, 0x46546c67);
    put_u32(file + 4, 2);
    put_u32(file + 8, 28 + padded + 360);
    put_u32(file + 12, padded);
    put_u32(file + 16, 0x4e4f534a);
    put_u32(file + 20 + padded, 360);
    put_u32(file + 24 + padded, 0x004e4942);
    memcpy(file + 28 + padded, data, 360);
    return write_bytes(name, file, 28 + padded + 360);
}

static const char placed[] = "[{\"children\":[1],\"rotation\":[0,0.6,0,0.8],\"translation\":[1,1,1]},"
                             "{\"mesh\":0,\"scale\":[1,1,1]}]";

static void test_cube(void)
{
    check_cube(write_text("cube.obj", cube_quads));
    check_cube(write_text("text.ply", "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
                                      "property float z\nproperty uchar red\nelement face 6\nproperty uchar flags\n"
                                      "property list uchar uint vertex_index\nproperty list uchar float texcoord\n"
                                      "end_header\n0 0 0 9\n0 0 2 9\n0 2 0 9\n0 2 2 9\n2 0 0 9\n2 0 2 9\n2 2 0 9\n"
                                      "2 2 2 9\n0 4 0 1 3 2 0\n1 4 4 6 7 5 2 0.5 0.5\n0 4 0 4 5 1 0\n0 4 2 3 7 6 0\n"
                                      "0 4 0 2 6 4 0\n0 4 1 5 7 3 0\n"));
    check_cube(write_glb("cube.glb", "", "[{\"mesh\":0,\"translation\":[1,1,1]}]"));
    check_cube(write_glb("mirrored.glb", "", "[{\"mesh\":0,\"matrix\":[-1,0,0,0,0,1,0,0,0,0,1,0,1,1,1,1]}]"));
    fxs_mesh *mesh = open_mesh(write_glb("turned.glb", "", placed));
    const fxs_mesh_measures m = measure(mesh);
    CHECK(is_near(m.volume, 8, 1e-7) && is_near(m.area, 24, 1e-7) && is_near(m.high[0], 1 + 1.24, 1e-7));
    fxs_mesh_free(mesh);
}

/* The own writer's files are read as they were: a shape, in all three formats. */
static void test_own_files(void)
{
    static const char *const names[] = {"own.glb", "own.ply", "own.obj"};
    fxs_mesh *made = open_mesh(write_text("cube.obj", cube_quads));
    fxs_mesh_write_options options;
    fxs_message m;
    fxs_mesh_write_options_init(&options);
    memset(made->colours, 255, 4 * made->vertex_count);
    for (int i = 0; i < 3; i++) {
        CHECK(!fxs_mesh_write(in_folder(names[i]), made, &options, &m));
        fxs_mesh *mesh = open_mesh(in_folder(names[i]));
        const fxs_mesh_measures measures = measure(mesh);
        CHECK(measures.volume == 8 && measures.area == 24 && mesh->vertex_count == 8);
        fxs_mesh_free(mesh);
    }
    fxs_mesh_free(made);
}

/* The truth is that of the polyhedra for the cube, and of the smooth shapes here, which finer grids come nearer to. */
static void test_round_shapes(void)
{
    const double sphere[2] = {4 * PI, 4 * PI / 3};
    const double torus[2] = {4 * PI * PI * RING * TUBE, 2 * PI * PI * RING * TUBE * TUBE};
    double last[2] = {1, 1};
    for (int n = 32; n <= 128; n *= 2) {
        fxs_mesh *mesh = open_mesh(write_grid("sphere.obj", 2 * n, n, 1, 0, 0, on_sphere));
        const fxs_mesh_measures m = measure(mesh);
        const double off[2] = {1 - m.area / sphere[0], 1 - m.volume / sphere[1]};
        CHECK(!m.open_edges && m.parts == 1 && mesh->vertex_count == (uint32_t)(2 * n * (n - 1) + 2));
        for (int i = 0; i < 2; i++) {
            CHECK(off[i] > 0 && off[i] < last[i] / 3.5);
            last[i] = off[i];
        }
        fxs_mesh_free(mesh);
    }
    CHECK(last[0] < 5e-4 && last[1] < 5e-4);
    fxs_mesh *mesh = open_mesh(write_grid("torus.obj", 256, 128, 1, 1, 1, on_torus));
    const fxs_mesh_measures m = measure(mesh);
    CHECK(is_near(m.area, torus[0], 5e-4) && is_near(m.volume, torus[1], 1e-3) && !m.open_edges && m.parts == 1);
    fxs_mesh_free(mesh);
}

/* Quads that are split in any way, faces with dents, triangles that touch without sharing vertices. */
static void test_faces(void)
{
    fxs_mesh *mesh = open_mesh(write_text("dent.obj", "v 0 0 5\nv 4 0 5\nv 4 4 5\nv 2 1 5\nv 0 4 5\nf 1 2 3 4 5\n"));
    fxs_mesh_measures m = measure(mesh);
    CHECK(mesh->triangle_count == 3 && is_near(m.area, 10, 1e-9) && m.open_edges == 5);
    fxs_mesh_free(mesh);
    mesh = open_mesh(write_text("arrow.obj", "v 0 0 0\nv 0 3 1\nv 0 0 4\nv 0 1 1\nf 1 \\\n 2 3 \\\r\n4\r\n"));
    m = measure(mesh);
    CHECK(is_near(m.area, 4, 1e-9));
    fxs_mesh_free(mesh);
    mesh = open_mesh(write_text("two.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 1 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 0\n"
                                           "f 1 2 3 4\nf 4 5 7 6\nf 5 3 8 7\n"));
    m = measure(mesh);
    CHECK(m.open_edges == 7 && m.area == 4 && m.parts == 1 && mesh->triangle_count == 7);
    fxs_mesh_free(mesh);
    mesh = open_mesh(write_text("turned.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3\nf 1 4 3\n"));
    m = measure(mesh);
    CHECK(m.open_edges == 4 && m.turned_edges == 1 && m.volume == 0);
    fxs_mesh_free(mesh);
    mesh = open_mesh(write_text("inward.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                              "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"));
    m = measure(mesh);
    CHECK(is_near(m.volume, -1 / 6.0, 1e-15) && !m.open_edges);
    fxs_mesh_free(mesh);
}

/* ---- Ways -------------------------------------------------------------------------------------------------------- */

/* Returns the length along the surface. The line must have this length, and lie on the mesh. */
static double along(const fxs_mesh *mesh, const double from[3], const double to[3])
{
    fxs_mesh_route route, back, near;
    fxs_message m;
    double sum = 0;
    if (!CHECK(!fxs_mesh_find_route(&route, mesh, from, to, &m)))
        return 0;
    CHECK(!fxs_mesh_find_route(&back, mesh, to, from, &m) && is_near(back.along, route.along, 1e-5));
    for (uint32_t i = 1; i < route.count; i++) {
        const double *p = route.points[i - 1], *q = route.points[i];
        const double middle[3] = {(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
        sum += hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
        CHECK(!fxs_mesh_find_route(&near, mesh, middle, middle, &m) && near.count == 2 && near.along == 0);
        for (int k = 0; k < 3; k++)
            CHECK(fabs(near.from[k] - middle[k]) < 1e-6);
        fxs_mesh_route_free(&near);
    }
    CHECK(is_near(sum, route.along, 1e-6) && route.along >= route.straight * (1 - 1e-9));
    sum = route.along;
    fxs_mesh_route_free(&route);
    fxs_mesh_route_free(&back);
    return sum;
}

static void test_plane(void)
{
    fxs_mesh *mesh = open_mesh(write_grid("plane.obj", 16, 16, 0, 0, 1, on_plane));
    for (uint32_t i = 0; i < 20; i++) {
        double p[2][3] = {{0}};
        for (uint32_t k = 0; k < 4; k++)
            p[k / 2][k % 2] = 2 * (noise(4 * i + k) / 4294967296.0);
        CHECK(is_near(along(mesh, p[0], p[1]), hypot(p[0][0] - p[1][0], p[0][1] - p[1][1]), 1e-6));
    }
    fxs_mesh_free(mesh);
}

static void test_sphere(void)
{
    fxs_mesh *mesh = open_mesh(write_grid("sphere.obj", 64, 32, 1, 0, 1, on_sphere));
    for (uint32_t i = 0; i < 12; i++) {
        double p[2][3], cosine = 0;
        for (uint32_t k = 0; k < 2; k++)
            on_sphere(noise(4 * i + k) / 4294967296.0, noise(4 * i + k + 2) / 4294967296.0, p[k]);
        for (int k = 0; k < 3; k++)
            cosine += p[0][k] * p[1][k];
        CHECK(is_near(along(mesh, p[0], p[1]), acos(cosine), 2e-3));
    }
    CHECK(is_near(along(mesh, (double[]){0, 0, -1}, (double[]){0, 0, 1}), PI, 2e-3));
    fxs_mesh_free(mesh);
}

/* From the middle of a side to a point on another, on the way over one edge, and around a corner of three sides. */
static void test_box(void)
{
    fxs_mesh *mesh = open_mesh(write_text("cube.obj", cube_quads));
    CHECK(is_near(along(mesh, (double[]){0, 0, 0}, (double[]){2, 2, 2}), 2 * sqrt(5), 1e-12));
    CHECK(is_near(along(mesh, (double[]){0.2, 0.4, 0}, (double[]){2, 1.8, 1.4}), hypot(1.8 + 1.4, 1.4), 1e-7));
    CHECK(is_near(along(mesh, (double[]){1, 1, 0}, (double[]){1, 1, 2}), 4, 1e-7));
    /* Over x = 2 between: 1.6 up, and 0.1 + 2 + 0.1 across; over y = 2 as well: 0.3 + 2 + 0.3, and 1.8 across. */
    CHECK(is_near(along(mesh, (double[]){1.9, 0.1, 0}, (double[]){1.9, 1.7, 2}), hypot(2.2, 1.6), 1e-7));
    fxs_mesh_free(mesh);
    mesh = open_mesh(write_text("l.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 1 1 0\nv 1 4 0\nv 0 4 0\nf 1 2 3 4 5 6\n"));
    CHECK(is_near(along(mesh, (double[]){3, 0.5, 0}, (double[]){0.5, 3, 0}), 2 * hypot(2, 0.5), 1e-12));
    fxs_mesh_free(mesh);
}

/* Over hills, the way is not longer than one over vertices and edges alone, and a little shorter at least. */
static double over_edges(const fxs_mesh *mesh, uint32_t from, uint32_t to)
{
    double *lengths = malloc(mesh->vertex_count * sizeof *lengths), found;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        lengths[i] = i == from ? 0 : INFINITY;
    for (int changed = 1; changed;) {
        changed = 0;
        for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
            const uint32_t ends[2] = {mesh->triangles[i], mesh->triangles[i % 3 == 2 ? i - 2 : i + 1]};
            double square = 0;
            for (uint32_t k = 0; k < 3; k++) {
                const double step = (double)mesh->places[3 * ends[0] + k] - mesh->places[3 * ends[1] + k];
                square += step * step;
            }
            for (int k = 0; k < 2; k++) {
                const double sum = lengths[ends[k]] + sqrt(square) * mesh->step / 65536;
                changed |= sum < lengths[ends[!k]];
                lengths[ends[!k]] = fmin(sum, lengths[ends[!k]]);
            }
        }
    }
    found = lengths[to];
    free(lengths);
    return found;
}

static void place_at(const fxs_mesh *mesh, uint32_t vertex, double at[3])
{
    for (uint32_t k = 0; k < 3; k++)
        at[k] = mesh->origin[k] + mesh->step / 65536 * mesh->places[3 * vertex + k];
}

static void test_hills(void)
{
    fxs_mesh *mesh = open_mesh(write_grid("hills.obj", 24, 24, 0, 0, 1, on_hills));
    double least = 1, most = 0;
    for (uint32_t i = 0; i < 10; i++) {
        const uint32_t a = noise(i) % mesh->vertex_count, b = noise(i + 99) % mesh->vertex_count;
        double p[2][3];
        place_at(mesh, a, p[0]);
        place_at(mesh, b, p[1]);
        const double share = along(mesh, p[0], p[1]) / over_edges(mesh, a, b);
        least = fmin(least, share);
        most = fmax(most, share);
    }
    CHECK(most <= 1 + 1e-9 && least < 0.97 && least > 0.5);
    fxs_mesh_free(mesh);
}

static void test_no_way(void)
{
    const double p[3] = {0.1, 0.1, 0}, far[3] = {0.1, 0.1, 5}, nowhere[3] = {NAN, 0, 0}, farther[3] = {1e200, 0, 0};
    fxs_mesh *mesh = open_mesh(write_text("apart.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 4\nv 1 0 4\nv 0 1 4\n"
                                                       "f 1 2 3\nf 4 5 6\n"));
    fxs_mesh_route route;
    fxs_message m;
    CHECK(measure(mesh).parts == 2);
    CHECK(fxs_mesh_find_route(&route, mesh, p, far, &m) == FXS_ERR_ARGUMENT && strstr(m.text, "not joined"));
    CHECK(!route.points);
    CHECK(fxs_mesh_find_route(&route, mesh, nowhere, p, &m) == FXS_ERR_ARGUMENT && strstr(m.text, "not finite"));
    CHECK(fxs_mesh_find_route(&route, mesh, p, farther, &m) == FXS_ERR_ARGUMENT && !route.points);
    mesh->max_memory = 1;
    CHECK(fxs_mesh_find_route(&route, mesh, p, far, &m) == FXS_ERR_MEMORY && !route.points);
    fxs_mesh_free(mesh);
}

/* ---- Bad files --------------------------------------------------------------------------------------------------- */

static void test_bad_files(void)
{
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                              "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    char content[1024];
    const struct {
        const char *rows, *words;
    } rows[] = {
        {"0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "does not exist"}, {"0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "not valid"},
        {"0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "fewer than 3"}, {"0 0 0\n1 0 0\nnan 1 0\n3 0 1 2\n", "not finite"},
        {"0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n", "no triangle with an area"}, {"0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "too few"},
        {"0 0 0\n1 0 0\n0 1 0\n3 0 0 2\n", "no triangle with an area"}, {"0 0 0\n1 0 0\n0 1\n3 0 1 2\n", "too few"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        snprintf(content, sizeof content, "%s%s", ply, rows[i].rows);
        fails(write_text("bad.ply", content), rows[i].words);
    }
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"), "does not exist");
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n"), "line 4");
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n"), "line 4");
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"), "line 2: v without three numbers");
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0 x\nv 0 1 0\nf 1 2 3\n"), "line 2");
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n"), "no faces");
    fails(write_text("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n"), "not before it");
    fails(write_text("bad.txt", "this is not a mesh at all, in any way\n"), "not a mesh");
    CHECK(!fxs_mesh_is_file(in_folder("bad.txt")) && !fxs_mesh_is_file(in_folder("none.obj")));
    CHECK(!fxs_mesh_is_file(folder));
    fails(write_glb("draco.glb", ",\"extensions\":{\"KHR_draco_mesh_compression\":{}}", "[{\"mesh\":0}]"), "Draco");
    fails(write_glb("points.glb", ",\"mode\":0", "[{\"mesh\":7}]"), "does not exist");
    fails(write_glb("empty.glb", "", "[{}]"), "no mesh in the scene");
    fails(write_glb("many.glb", "", "[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}]"), "instances");
    CHECK(!fxs_mesh_is_file(write_glb("gaussians.glb", ",\"extensions\":{\"KHR_gaussian_splatting\":{}}", "[{}]")));
}

/* Each truncated file is refused, or read without a fault; a .ply of a scene is no mesh. */
static void test_truncated(void)
{
    static char bytes[8192];
    FILE *file = fopen(write_glb("whole.glb", "", placed), "rb");
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    for (size_t cut = 0; cut < size; cut += 7) {
        fxs_mesh *mesh;
        fxs_message m;
        CHECK(fxs_mesh_open(&mesh, write_bytes("cut.glb", bytes, cut), 0, &m) < 0 && !mesh);
    }
    CHECK(!fxs_mesh_is_file(write_text("scene.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                                    "property float y\nproperty float z\nproperty float scale_0\n"
                                                    "element face 1\nproperty list uchar int vertex_indices\n"
                                                    "end_header\n0 0 0 0\n3 0 0 0\n")));
    fxs_mesh *mesh;
    fxs_message m;
    CHECK(fxs_mesh_open(&mesh, write_text("cube.obj", cube_quads), 100, &m) == FXS_ERR_MEMORY && !mesh);
}

/* A triangle fan around one edge, many corners at one vertex, long rows of splits: the time follows the size. */
static void test_hostile(void)
{
    FILE *file = fopen(in_folder("fan.obj"), "wb");
    const int count = 200000;
    fputs("v 0 0 0\nv 1 0 0\n", file);
    for (int i = 0; i < count; i++)
        fprintf(file, "v %.9g %d 1\nf 1 2 %d\n", i / (double)count, i, i + 3);
    fclose(file);
    fxs_mesh *mesh = open_mesh(in_folder("fan.obj"));
    const fxs_mesh_measures m = measure(mesh);
    CHECK(m.turned_edges == 1 && m.open_edges == 2 * (uint64_t)count && m.parts == 1);
    CHECK(along(mesh, (double[]){0.5, 0.5 * count, 0.5}, (double[]){0.5, 0.25 * count, 0.25}) > 0);
    fxs_mesh_free(mesh);
}

static void tests(void)
{
    RUN(test_cube);
    RUN(test_own_files);
    RUN(test_round_shapes);
    RUN(test_faces);
    RUN(test_plane);
    RUN(test_sphere);
    RUN(test_box);
    RUN(test_hills);
    RUN(test_no_way);
    RUN(test_bad_files);
    RUN(test_truncated);
    RUN(test_hostile);
}

int main(void)
{
    return in_a_folder(tests);
}
