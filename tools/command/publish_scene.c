/* Loads the scene of `fixsplat publish`. It is packed again if its compression profile or levels of detail differ from
   the options. */
#include "publish_scene.h"

#include <stdio.h>
#include <stdlib.h>

#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/view_more.h>
#include "src/base/os_calls.h"
#include "src/open/opened_camera.h"
#include "command.h"
#include "tools/serve/scene_picture.h"

#define WORTH_SAYING 1.5           /* least reduction factor of the file size that is reported */

static int load_anew(loaded_scene *scene, const char *path, const load_options *options)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    return open_scene(path, options, &file, &info) || load_stream(scene, path, options, file, &info);
}

/* Stores the first view of a scene without a start view as its start view, so that the poster and the page's first
   picture are the same. */
static int store_first_view(const fxs_opened *opened)
{
    const fxs_picture picture = {50, PICTURE_WIDTH, PICTURE_HEIGHT};
    fxs_view view;
    fxs_message why;
    if (fxs_view_of_start(&view, opened->data, picture.width, picture.height))
        return 0;
    const int error = fxs_opened_first_view(opened, &picture, &view, &why) ||
                      fxs_view_to_start((void *)(uintptr_t)opened->data, &view, &why);
    return error ? fail_for(&why) : 0;
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
    if (!anew && was_packed)
        return 0;
    if (store_first_view(scene->opened)) {
        free_scene(scene);
        return EXIT_FAILED;
    }
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

/* tan a: vertical tangent of the start view, tan p: of the poster, reach: the horizontal tangent of the scene. The
   numbers are tan p / tan a and tan p / reach. */
void publish_frame(char text[POSTER_FRAME], const fxs_opened *opened, int width, int height)
{
    fxs_view wide, poster;
    text[0] = 0;
    if (!fxs_view_of_start(&wide, opened->data, 16, 9) || !fxs_view_of_start(&poster, opened->data, width, height))
        return;
    const double tangent = height / 2.0 / poster.fy, reach = fxs_start_reach(&wide, opened->data);
    snprintf(text, POSTER_FRAME, " poster-frame=\"%.4f %.4f\"", tangent * wide.fy / 4.5,
             reach > 0.001 ? tangent / reach : 1000);
}
