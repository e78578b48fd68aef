#include "backend.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef FXS_WITH_GLES
#include "../kernels/gles/gles.h"
#else
typedef int fxs_gl_load_fn;
#endif
#ifdef FXS_WITH_EGL
#include "../port/egl/egl.h"
#define EGL fxs_egl_open, fxs_egl_load, fxs_egl_use, fxs_egl_close
#else
#define EGL 0, 0, 0, 0
#endif
#ifdef FXS_WITH_OSMESA
#include "../port/osmesa/osmesa.h"
#define OSMESA fxs_osmesa_open, fxs_osmesa_load, fxs_osmesa_use, fxs_osmesa_close
#else
#define OSMESA 0, 0, 0, 0
#endif

typedef struct kind {
    const char *name, *does, *packages;
    int quads;
    int (*open)(void **port, fxs_message *message);
    fxs_gl_load_fn *load;
    int (*use)(void *port);
    void (*close)(void *port);
} kind;

static const kind kinds[] = {
    {"gles", "OpenGL ES 3.0 by EGL, the same bytes", "libegl-dev, libgles-dev", 0, EGL},
    {"gles-quads", "the same device, quads blended by the hardware: inexact", "libegl-dev, libgles-dev", 1, EGL},
    {"osmesa", "OpenGL by OSMesa, the same bytes", "libosmesa6-dev, libgles-dev", 0, OSMESA},
};

enum { KINDS = sizeof kinds / sizeof *kinds };

struct backend {
    const kind *kind;
    void *port;
    struct fxs_gles *gles;
};

static int is_cpu(const char *name)
{
    return !strcmp(name, "cpu") || !strcmp(name, "auto");
}

static const kind *find(const char *name)
{
    for (int i = 0; i < KINDS; i++)
        if (!strcmp(name, kinds[i].name))
            return &kinds[i];
    return 0;
}

int backend_known(const char *name)
{
    return is_cpu(name) || find(name);
}

#ifdef FXS_WITH_GLES
static int open_gles(backend *b, fxs_message *m)
{
    char text[FXS_GLES_MESSAGE];
    fxs_gles *gles = malloc(fxs_gles_bytes());
    if (!gles)
        return fxs_fail(m, "out of memory");
    if (fxs_gles_init(gles, b->kind->load, b->kind->use, b->port, text)) {
        free(gles);
        return fxs_fail(m, "%s", text);
    }
    b->gles = gles;
    return 0;
}

int backend_open(backend **out, const char *name, fxs_config *config, fxs_message *m)
{
    const kind *k = find(name);
    *out = 0;
    if (is_cpu(name))
        return 0;
    if (!k || !k->open)
        return fxs_fail(m, "built without the headers in %s", k ? k->packages : name);
    backend *b = calloc(1, sizeof *b);
    if (!b)
        return fxs_fail(m, "out of memory");
    b->kind = k;
    if (k->open(&b->port, m) || open_gles(b, m)) {
        backend_close(b);
        return -1;
    }
    config->draw = k->quads ? fxs_gles_draw_quads : fxs_gles_draw;
    config->draw_argument = b->gles;
    config->draw_unlisted = k->quads;
    *out = b;
    return 0;
}

uint64_t backend_nanoseconds(const backend *b)
{
    return b ? fxs_gles_nanoseconds(b->gles) : 0;
}

void backend_close(backend *b)
{
    if (!b)
        return;
    if (b->gles)
        fxs_gles_free(b->gles);
    free(b->gles);
    b->kind->close(b->port);
    free(b);
}

static const char *device(const backend *b)
{
    return fxs_gles_renderer(b->gles);
}
#else
int backend_open(backend **out, const char *name, fxs_config *config, fxs_message *m)
{
    const kind *k = find(name);
    (void)config;
    *out = 0;
    return is_cpu(name) ? 0 : fxs_fail(m, "built without the headers in %s", k ? k->packages : name);
}

uint64_t backend_nanoseconds(const backend *b)
{
    (void)b;
    return 0;
}

void backend_close(backend *b)
{
    (void)b;
}

static const char *device(const backend *b)
{
    (void)b;
    return "";
}
#endif

void backend_list(void)
{
    printf("%-11s here: the processor, what auto takes\n", "cpu");
    for (int i = 0; i < KINDS; i++) {
        fxs_config config;
        fxs_message m;
        backend *b;
        if (backend_open(&b, kinds[i].name, &config, &m))
            printf("%-11s not here: %s (%s)\n", kinds[i].name, m.text, kinds[i].does);
        else
            printf("%-11s here: %s (%s)\n", kinds[i].name, device(b), kinds[i].does);
        backend_close(b);
    }
}
