#include <fixsplat/backend.h>
#include <fixsplat/internal/backends.h>

#include <string.h>

const fxs_backend *fxs_backend_at(int index)
{
    static const fxs_backend *const all[] = {&fxs_backend_cpu,          &fxs_backend_gles,   &fxs_backend_gles_fetch,
                                             &fxs_backend_gles_compute, &fxs_backend_osmesa, &fxs_backend_vulkan,
                                             &fxs_backend_cuda};
    return index >= 0 && index < (int)(sizeof all / sizeof *all) ? all[index] : 0;
}

const fxs_backend *fxs_backend_find(const char *name)
{
    const fxs_backend *backend = 0;
    if (!strcmp(name, "auto"))
        name = "cpu";
    for (int i = 0; (backend = fxs_backend_at(i)) != 0 && strcmp(backend->name, name); i++)
        ;
    return backend;
}
