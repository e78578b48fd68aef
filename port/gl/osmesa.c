/* Opens a core context of OpenGL 3.3 in OSMesa, Mesa's software renderer without a window. libOSMesa is loaded at run
 * time. */
#include <fixsplat/gl.h>
#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/internal/message.h>

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

typedef void function(void);

typedef struct fxs_osmesa {
    void *library;
    OSMesaContext context;
    function *(*get_address)(const char *name);
    unsigned char pixel[4];
} fxs_osmesa;

static function *symbol(const fxs_osmesa *o, const char *name)
{
    function *found = 0;
    void *address = dlsym(o->library, name);
    memcpy(&found, &address, sizeof found);
    return found;
}

void (*fxs_osmesa_load(void *argument, const char *name))(void)
{
    const fxs_osmesa *o = argument;
    return o->get_address(name);
}

int fxs_osmesa_use(void *osmesa)
{
    fxs_osmesa *o = osmesa;
    GLboolean (*make_current)(OSMesaContext, void *, GLenum, GLsizei, GLsizei) =
        (GLboolean (*)(OSMesaContext, void *, GLenum, GLsizei, GLsizei))symbol(o, "OSMesaMakeCurrent");
    return make_current && make_current(o->context, o->pixel, GL_UNSIGNED_BYTE, 1, 1) ? 0 : -1;
}

static int make_context(fxs_osmesa *o, fxs_message *m)
{
    static const int attributes[] = {OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0};
    OSMesaContext (*create)(const int *, OSMesaContext) =
        (OSMesaContext (*)(const int *, OSMesaContext))symbol(o, "OSMesaCreateContextAttribs");
    o->get_address = (function *(*)(const char *))symbol(o, "OSMesaGetProcAddress");
    if (!create || !o->get_address)
        return fxs_fail(m, "libOSMesa.so.8 is too old: it makes no core contexts");
    o->context = create(attributes, 0);
    if (!o->context || fxs_osmesa_use(o))
        return fxs_fail(m, "libOSMesa.so.8 makes no context of OpenGL 3.3");
    return 0;
}

int fxs_osmesa_open(void **out, fxs_message *m)
{
    fxs_osmesa *o = *out = calloc(1, sizeof *o);
    if (!o)
        return fxs_fail(m, "out of memory");
    o->library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    int result = o->library ? make_context(o, m) : fxs_fail(m, "no OSMesa: %s", dlerror());
    if (result) {
        fxs_osmesa_close(o);
        *out = 0;
    }
    return result;
}

void fxs_osmesa_close(void *osmesa)
{
    fxs_osmesa *o = osmesa;
    if (o && o->context)
        ((void (*)(OSMesaContext))symbol(o, "OSMesaDestroyContext"))(o->context);
    /* The loaded libOSMesa stays in memory, because unloading it can crash drivers. */
    free(o);
}
