/* Loads libheif (a decoder of HEIF photographs) with dlopen at the first use. */
#ifdef FXS_WITH_HEIF

#include "src/image/heif_library.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stddef.h>
#include <string.h>

static fxs_heif_library lib;
static int is_here;

static void load(void)
{
    static const struct {
        const char *name;
        size_t at;
    } functions[] = {
#define FUNCTION(name) {#name, offsetof(fxs_heif_library, name)},
        FXS_HEIF_FUNCTIONS(FUNCTION)
    };
    void *library = dlopen("libheif.so.1", RTLD_NOW | RTLD_LOCAL);
    is_here = library != NULL;
    for (size_t i = 0; is_here && i < sizeof functions / sizeof *functions; i++) {
        void *address = dlsym(library, functions[i].name);
        memcpy((char *)&lib + functions[i].at, &address, sizeof address);
        is_here = address != NULL;
    }
    is_here = is_here && lib.heif_init(NULL).code == heif_error_Ok;
}

const fxs_heif_library *fxs_heif_library_open(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, load);
    return is_here ? &lib : NULL;
}

#else
typedef int fxs_heif_is_not_linked;
#endif
