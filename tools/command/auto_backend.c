/* Chooses the back end of --backend auto. The file of the trial begins with a key: version, processor, threads, and a
   hash of what a new card or driver changes. Asking the drivers for their devices takes 0.1 to 0.4 s each. */
#include "auto_backend.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "src/base/os_calls.h"

enum { PATH_MOST = 4096, CARDS = 16, CANDIDATES = 4 };

/* The processor must be first. */
static const char *const candidates[CANDIDATES] = {"cpu", "cuda", "vulkan", "gles-compute"};

/* Files and folders that change with a driver, files that name a card, and variables that choose drivers. */
static const char *const drivers[] = {
    "/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/usr/share/glvnd/egl_vendor.d",
    "/usr/lib/dri", "/usr/lib64/dri", "/usr/lib/x86_64-linux-gnu/dri", "/usr/lib/aarch64-linux-gnu/dri",
};
static const char *const facts[] = {"/proc/driver/nvidia/version", "/sys/module/nvidia/version",
                                    "/sys/module/amdgpu/version"};
static const char *const variables[] = {
    "VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", "VK_LOADER_DRIVERS_SELECT", "CUDA_VISIBLE_DEVICES",
    "LIBGL_ALWAYS_SOFTWARE", "GALLIUM_DRIVER", "MESA_LOADER_DRIVER_OVERRIDE", "__EGL_VENDOR_LIBRARY_FILENAMES",
    "EGL_PLATFORM",
};

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ ((const uint8_t *)bytes)[i]) * 0x100000001b3u;
    return hash;
}

static uint64_t hash_text(uint64_t hash, const char *text)
{
    return hash_bytes(hash, text ? text : "", text ? strlen(text) + 1 : 0);
}

static uint64_t hash_file(uint64_t hash, const char *path)
{
    char bytes[1024];
    FILE *file = fopen(path, "rb");
    if (!file)
        return hash_text(hash, NULL);
    hash = hash_bytes(hash_text(hash, path), bytes, fread(bytes, 1, sizeof bytes, file));
    fclose(file);
    return hash;
}

static uint64_t hash_of_drivers(void)
{
    uint64_t hash = 0xcbf29ce484222325u;
    char path[64];
    for (size_t i = 0; i < sizeof drivers / sizeof *drivers; i++) {
        fxs_file_facts f = {0};
        if (fxs_file_look(drivers[i], &f) != FXS_FILE_NONE)
            hash = hash_bytes(hash_text(hash, drivers[i]), &f.modified, sizeof f.modified);
    }
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++)
        hash = hash_file(hash, facts[i]);
    for (int i = 0; i < CARDS; i++) {
        snprintf(path, sizeof path, "/sys/class/drm/card%d/device/uevent", i);
        hash = hash_file(hash, path);
        snprintf(path, sizeof path, "/dev/nvidia%d", i);
        hash = hash_bytes(hash, (uint8_t[]){(uint8_t)fxs_file_kind(path)}, 1);
    }
    for (size_t i = 0; i < sizeof variables / sizeof *variables; i++)
        hash = hash_text(hash_bytes(hash, &i, 1), getenv(variables[i]));
    return hash;
}

void name_processor(char name[128])
{
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[512];
    strcpy(name, "unknown");
    while (file && fgets(line, sizeof line, file))
        if (!strncmp(line, "model name", 10) && sscanf(line, "%*[^:]: %127[^\n]", name) == 1)
            break;
    if (file)
        fclose(file);
}

static void make_key(char key[TRIAL_KEY])
{
    char name[128];
    name_processor(name);
    snprintf(key, TRIAL_KEY, "fixsplat %s, %s, %u threads, drivers %016" PRIx64, FXS_VERSION, name,
             (unsigned)fxs_processors(), hash_of_drivers());
}

typedef struct keeping {
    const char *path, *key;
    int error;
    fxs_message *why;
} keeping;

static void keep(void *argument, const trial *t)
{
    keeping *k = argument;
    if (!k->error)
        k->error = trial_write(t, k->path, k->key, k->why);
}

int trial_get(trial *t, int is_anew, fxs_message *why)
{
    const fxs_backend *backends[CANDIDATES];
    char path[PATH_MOST], key[TRIAL_KEY];
    keeping k = {.path = path, .key = key, .why = why};
    make_key(key);
    for (int i = 0; i < CANDIDATES; i++)
        backends[i] = fxs_backend_find(candidates[i]);
    if (fxs_cache_path("trial", 0, path, sizeof path))
        k.error = fxs_fail(why, "no folder to keep a trial in");
    else if (!is_anew && !trial_read(t, backends, CANDIDATES, path, key))
        return 0;
    else
        fxs_cache_path("trial", 1, path, sizeof path);
    trial_run(t, backends, CANDIDATES, keep, &k);
    return k.error;
}

void settle_backend(frame_options *options, double pictures)
{
    const double size = options->width ? (double)options->width * options->height : 1280.0 * 720;
    const unsigned can = (options->gazes ? FXS_CAN_RATES : 0u) | (options->load.pool ? FXS_CAN_PART : 0u);
    fxs_message unused;
    trial t;
    if (strcmp(options->backend, "auto"))
        return;
    options->is_auto = 1;
    options->backend = "cpu";
    if (pictures * size <= AUTO_PIXELS || is_given("cpu") || is_given("threads") || is_given("max-memory"))
        return;
    trial_get(&t, 0, &unused);
    options->backend = trial_fastest(&t, can)->backend->name;
}
