/* Fuzzes the reader of meshes, their measures, and ways along them. Byte 0 of an input picks the format. The other
   bytes are the file; the container of a .glb is always valid. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/surface.h>
#include "glb_bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char path[] = "/tmp/fixsplat-fuzz-XXXXXX";

static void remove_file(void)
{
    remove(path);
}

static void put_mesh(const uint8_t *data, size_t size)
{
    static uint8_t glb[1 << 16];
    const int is_glb = data[0] % 2;
    if (strstr(path, "-XXXXXX")) {
        const int descriptor = mkstemp(path);
        if (descriptor < 0 || close(descriptor))
            abort();
        atexit(remove_file);
    }
    FILE *file = fopen(path, "wb");
    const size_t count = is_glb ? make_glb(data + 1, size - 1, glb) : size - 1;
    if (!file || fwrite(is_glb ? glb : data + 1, 1, count, file) != count || fclose(file))
        abort();
}

/* The measures are finite, and a way is not shorter than the straight line. */
static void check(const fxs_mesh *mesh)
{
    fxs_mesh_measures m;
    fxs_mesh_route route;
    fxs_message message;
    if (fxs_mesh_measure(&m, mesh, &message) || !isfinite(m.volume) || !(m.area >= 0) || !m.parts)
        abort();
    if (fxs_mesh_find_route(&route, mesh, m.low, m.high, &message) == 0) {
        if (!(route.along >= route.straight * 0.999999) || route.count < 2)
            abort();
        fxs_mesh_route_free(&route);
    } else if (!strstr(message.text, "not joined"))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fxs_mesh *mesh;
    fxs_message message;
    if (size < 2 || size > 1 << 15)
        return 0;
    put_mesh(data, size);
    const int is_mesh = fxs_mesh_is_file(path);
    if (fxs_mesh_open(&mesh, path, 0, &message)) {
        if (mesh || strchr(message.text, '\n') || strncmp(message.text, path, strlen(path)) != 0)
            abort();
        return 0;
    }
    if (!is_mesh)
        abort();
    check(mesh);
    fxs_mesh_free(mesh);
    return 0;
}
