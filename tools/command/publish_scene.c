/* Loads the scene of `fixsplat publish`. It is packed again if its compression profile or levels of detail differ from
   the options. */
#include "publish_scene.h"

#include <stdio.h>
#include <stdlib.h>

#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include "src/base/os_calls.h"
#include "command.h"

#define WORTH_SAYING 1.5           /* least reduction factor of the file size that is reported */

static int load_anew(loaded_scene *scene, const char *path, const load_options *options)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    return open_scene(path, options, &file, &info) || load_stream(scene, path, options, file, &info);
}

int publish_load(loaded_scene *scene, const char *path, const load_options *options, int profile)
{
    load_options how = *options;
    if (load_scene(scene, path, options))
        return EXIT_FAILED;
    const int was_packed = is_packed(scene);
    const fxs_scene *own = scene->opened->scene;
    const int is_other = profile && own->profile != options->profile, lacks_tree = options->tree && !own->nodes;
    const int anew = was_packed && (is_other || (lacks_tree && own->chunk_count > 1));
    how.profile = profile ? options->profile : own->profile;
    how.tree |= own->nodes != 0;
    if (anew) {
        free_scene(scene);
        if (load_anew(scene, path, &how))
            return EXIT_FAILED;
    }
    if (anew || !was_packed)
        fxs_file_seal((void *)(uintptr_t)scene->opened->data, scene->opened->bytes);
    return 0;
}

void publish_say_gain(const loaded_scene *scene, char *const *words)
{
    const fxs_scene *own = scene->opened->scene;
    const size_t small = fxs_pack_bytes(scene->opened->info, FXS_PROFILE_SMALL) * (own->nodes ? 2 : 1);
    const double times = small ? (double)scene->opened->bytes / (double)small : 0;
    fxs_printed command;
    if (times < WORTH_SAYING || fxs_print_begin(&command))
        return;
    fputs("fixsplat", command.file);
    for (; *words; words++)
        write_shell_word(command.file, *words);
    if (!fxs_print_end(&command))
        note("%s: taken as it is, %.1f MB in profile %s; %.1f times smaller, with less detail, by: %s --profile small",
             scene->path, (double)scene->opened->bytes * 1e-6, profile_names[own->profile], times, command.text);
    free(command.text);
}
