/* Writes the faces between solid and free voxels as a .glb: one mesh without normals, whose triangles face the free
 * side. Faces of a plane that form rectangles are merged. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/packed.h>
#include "src/base/glb.h"
#include "src/base/number.h"
#include "src/base/os_calls.h"
#include "src/base/output_internal.h"
#include "src/base/try_internal.h"
#include "voxels.h"

/* A rectangle of faces in the plane at `level` of axis `axis`, voxels. It faces along the axis, or against it. */
typedef struct rectangle {
    int32_t axis, against, level;
    int32_t low[2], high[2];       /* on the axes (axis + 1) % 3 and (axis + 2) % 3 */
} rectangle;

typedef struct faces {
    const fxs_voxels *voxels;
    rectangle *at;
    size_t count, room;
    int32_t size[2];               /* voxels of a plane */
    unsigned char *solid[2];       /* voxels below and above the plane */
    unsigned char *mask;           /* faces of the plane that are not merged yet */
    fxs_message *message;
} faces;

/* ---- Rectangles -------------------------------------------------------------------------------------------------- */

static int add(faces *f, const rectangle *r)
{
    if (f->count == f->room) {
        const size_t room = f->room ? 2 * f->room : 1024;
        rectangle *larger = fxs_enlarge(NULL, f->at, f->count, room, sizeof *f->at);
        if (!larger)
            return fxs_fail_memory(f->message, NULL, 0);
        f->at = larger;
        f->room = room;
    }
    f->at[f->count++] = *r;
    return 0;
}

static int is_full(const unsigned char *row, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        if (!row[i])
            return 0;
    return 1;
}

/* Takes the largest rectangle of rows from (u, v) on out of the mask. */
static int take_rectangle(faces *f, rectangle r, int32_t u, int32_t v)
{
    const int32_t wide = f->size[0];
    int32_t end = u, top = v + 1;
    while (end < wide && f->mask[v * wide + end])
        end++;
    while (top < f->size[1] && is_full(f->mask + top * wide + u, end - u))
        top++;
    for (int32_t row = v; row < top; row++)
        memset(f->mask + row * wide + u, 0, (size_t)(end - u));
    const int first = (r.axis + 1) % 3, second = (r.axis + 2) % 3;
    r.low[0] = f->voxels->info.low[first] + u;
    r.high[0] = f->voxels->info.low[first] + end;
    r.low[1] = f->voxels->info.low[second] + v;
    r.high[1] = f->voxels->info.low[second] + top;
    return add(f, &r);
}

/* Merges the faces of a plane that look one way. */
static int merge(faces *f, const rectangle *r)
{
    const int32_t count = f->size[0] * f->size[1];
    for (int32_t i = 0; i < count; i++)
        f->mask[i] = f->solid[r->against][i] && !f->solid[!r->against][i];
    for (int32_t i = 0; i < count; i++)
        if (f->mask[i])
            FXS_TRY(take_rectangle(f, *r, i % f->size[0], i / f->size[0]));
    return 0;
}

static void look(faces *f, unsigned char *solid, int axis, int32_t level)
{
    const fxs_voxels_info *info = &f->voxels->info;
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    int32_t at[3];
    at[axis] = level;
    for (at[second] = info->low[second]; at[second] < info->high[second]; at[second]++)
        for (at[first] = info->low[first]; at[first] < info->high[first]; at[first]++)
            *solid++ = (unsigned char)fxs_voxels_solid(f->voxels, at[0], at[1], at[2]);
}

/* The outermost voxels of the box are solid, so it has no faces on its sides. */
static int find_faces(faces *f, int axis)
{
    const fxs_voxels_info *info = &f->voxels->info;
    f->size[0] = info->high[(axis + 1) % 3] - info->low[(axis + 1) % 3];
    f->size[1] = info->high[(axis + 2) % 3] - info->low[(axis + 2) % 3];
    const size_t plane = (size_t)f->size[0] * (size_t)f->size[1];
    unsigned char *bytes = fxs_allocate(NULL, plane, 3);
    int error = bytes ? 0 : fxs_fail_memory(f->message, NULL, 0);
    f->solid[0] = bytes;
    f->solid[1] = bytes ? bytes + plane : NULL;
    f->mask = bytes ? bytes + 2 * plane : NULL;
    if (!error)
        look(f, f->solid[0], axis, info->low[axis]);
    for (int32_t level = info->low[axis] + 1; level < info->high[axis] && !error; level++) {
        look(f, f->solid[1], axis, level);
        for (int against = 0; against < 2 && !error; against++)
            error = merge(f, &(rectangle){.axis = axis, .against = against, .level = level});
        unsigned char *below = f->solid[0];
        f->solid[0] = f->solid[1];
        f->solid[1] = below;
    }
    fxs_release(NULL, bytes);
    return error;
}

/* ---- File -------------------------------------------------------------------------------------------------------- */

static void corners_of(const rectangle *r, float size, float corners[4][3])
{
    for (int i = 0; i < 4; i++) {
        const int right = i == 1 || i == 2, up = i > 1;
        corners[i][r->axis] = (float)r->level * size;
        corners[i][(r->axis + 1) % 3] = (float)(right ? r->high[0] : r->low[0]) * size;
        corners[i][(r->axis + 2) % 3] = (float)(up ? r->high[1] : r->low[1]) * size;
    }
}

static int write_positions(const faces *f, fxs_output *output)
{
    for (size_t i = 0; i < f->count; i++) {
        float corners[4][3];
        uint32_t bits[12];
        corners_of(&f->at[i], (float)f->voxels->info.voxel, corners);
        memcpy(bits, corners, sizeof bits);
        for (int k = 0; k < 12; k++)
            bits[k] = fxs_little_32(bits[k]);
        FXS_TRY(fxs_output_write(output, bits, sizeof bits, f->message));
    }
    return 0;
}

static int write_triangles(const faces *f, fxs_output *output)
{
    static const uint32_t turns[2][6] = {{0, 1, 2, 0, 2, 3}, {0, 2, 1, 0, 3, 2}};
    for (size_t i = 0; i < f->count; i++) {
        uint32_t triangles[6];
        for (int k = 0; k < 6; k++)
            triangles[k] = fxs_little_32((uint32_t)(4 * i) + turns[f->at[i].against][k]);
        FXS_TRY(fxs_output_write(output, triangles, sizeof triangles, f->message));
    }
    return 0;
}

static void print_corner(FILE *file, const faces *f, const char *name, int is_high)
{
    double values[3];
    for (int axis = 0; axis < 3; axis++) {
        float most = 0;
        for (size_t i = 0; i < f->count; i++) {
            float corners[4][3];
            corners_of(&f->at[i], (float)f->voxels->info.voxel, corners);
            for (int k = 0; k < 4; k++)
                if ((!i && !k) || (is_high ? corners[k][axis] > most : corners[k][axis] < most))
                    most = corners[k][axis];
        }
        values[axis] = (double)most;
    }
    fprintf(file, ",\"%s\":", name);
    fxs_print_list(file, 9, ",", values, 3);
}

static void print_json(FILE *file, const faces *f)
{
    const unsigned long positions = (unsigned long)f->count * 48, triangles = (unsigned long)f->count * 24;
    fprintf(file, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"fixsplat " FXS_VERSION "\"},\"scene\":0,"
            "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
            "{\"POSITION\":0},\"indices\":1}]}],\"buffers\":[{\"byteLength\":%lu}],\"bufferViews\":[{\"buffer\":0,"
            "\"byteLength\":%lu,\"target\":34962},{\"buffer\":0,\"byteOffset\":%lu,\"byteLength\":%lu,"
            "\"target\":34963}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%lu,"
            "\"type\":\"VEC3\"",
            positions + triangles, positions, positions, triangles, positions / 12);
    print_corner(file, f, "min", 0);
    print_corner(file, f, "max", 1);
    fprintf(file, "},{\"bufferView\":1,\"componentType\":5125,\"count\":%lu,\"type\":\"SCALAR\"}]}", triangles / 4);
    fxs_glb_pad(file);
}

static int write_chunks(const faces *f, const fxs_printed *json, fxs_output *output)
{
    fxs_glb_begin(output->file, json->text, json->size, (uint32_t)f->count * 72);
    FXS_TRY(write_positions(f, output));
    return write_triangles(f, output);
}

static int write_file(const faces *f, const char *path)
{
    fxs_printed json;
    fxs_output output;
    fxs_message closing;
    if (f->count > (UINT32_MAX >> 7))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, f->message, "%s: more than 4 GiB: make voxels larger", path);
    if (fxs_print_begin(&json))
        return fxs_fail_memory(f->message, path, 0);
    print_json(json.file, f);
    if (fxs_print_end(&json))
        return fxs_fail_memory(f->message, path, 0);
    int error = fxs_output_open(&output, path, 0, f->message);
    if (!error) {
        error = write_chunks(f, &json, &output);
        const int closed = fxs_output_close(&output, error ? &closing : f->message);
        error = error ? error : closed;
    }
    free(json.text);
    return error;
}

int fxs_voxels_write_glb(const fxs_voxels *voxels, const char *path, fxs_message *message)
{
    faces f = {.voxels = voxels, .message = message};
    int error = 0;
    for (int axis = 0; axis < 3 && !error; axis++)
        error = find_faces(&f, axis);
    error = error ? error : write_file(&f, path);
    fxs_release(NULL, f.at);
    return error;
}
