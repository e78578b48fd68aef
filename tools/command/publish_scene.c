/* Loads the scene of `fixsplat publish`. It is packed again if its compression profile or levels of detail differ from
   the options. */
#include "publish_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "src/base/os_calls.h"
#include "command.h"
#include "tools/serve/scene_picture.h"

#define COPY_MOST ((size_t)1 << 30)  /* largest .fxs that is copied in memory for its first start view */
#define WORTH_SAYING 1.5           /* least reduction factor of the file size that is reported */

static int load_anew(loaded_scene *scene, const char *path, const load_options *options)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    return open_scene(path, options, &file, &info) || load_stream(scene, path, options, file, &info);
}

static int has_up(const publish_start *o)
{
    return o->up[0] != 0 || o->up[1] != 0 || o->up[2] != 0;
}

/* Sets up direction and start view of a packed scene. Its start view is chosen if the scene has none, so that poster
   and first picture of the page are the same. */
static int set_start(void *data, size_t bytes, const publish_start *o)
{
    fxs_start start;
    fxs_message why;
    fxs_start_of(&start, data);
    if (has_up(o)) {
        memcpy(start.up, o->up, sizeof start.up);
        start.tangent = 0;
        fxs_start_to(data, &start);
    }
    const int error = o->view.given ? start_store(&o->view, data, &why)
                    : start.tangent > 0 ? 0 : fxs_start_choose(data, bytes, &why);
    return error ? fail_for(&why) : 0;
}

/* True if an .fxs must be changed: by the options, or for its first start view unless the file is very large. */
static int needs_copy(const loaded_scene *scene, const publish_start *start)
{
    const fxs_opened *o = scene->opened;
    return start->view.given || has_up(start) || (!(o->info->start.tangent > 0) && o->bytes <= COPY_MOST);
}

/* Replaces the mapping of an .fxs by a copy in memory with another start view. */
static int copy_scene(loaded_scene *scene, const publish_start *start)
{
    const size_t bytes = scene->opened->bytes;
    const fxs_open_options options = {.size = sizeof options};
    void *copy = fxs_aligned_allocate(bytes);
    fxs_opened *opened = 0;
    fxs_message why;
    if (!copy)
        return fail(EXIT_FAILED, "%s: out of memory", scene->path);
    memcpy(copy, scene->opened->data, bytes);
    int status = set_start(copy, bytes, start);
    if (!status && (fxs_file_seal(copy, bytes) ||
                    fxs_open_memory(scene->path, copy, bytes, &options, &opened, &why)))
        status = fail(EXIT_FAILED, "%s: changed while it was read", scene->path);
    if (status) {
        fxs_aligned_free(copy);
        return status;
    }
    fxs_close(scene->opened);
    scene->opened = opened;
    scene->copy = copy;
    return 0;
}

int take_sound(const option_row *row, void *field, const char *value)
{
    fxs_sound sound;
    *(const char **)field = value;
    return fxs_sound_kind(&sound, value, 0) ? 0 : wrong_value(row, value);
}

/* Loads the sound of the options in place of the scene's own. */
static int load_sound(loaded_scene *scene, const char *path)
{
    fxs_mapping file;
    fxs_message why;
    if (!scene->opened->scene->motion)
        return fail(EXIT_USAGE, "--sound %s: %s is still, and only moving scenes have sound", path, scene->path);
    if (fxs_map_open(&file, path, &why))
        return fail_for(&why);
    free(scene->sound.data);
    scene->sound = (fxs_sound){.volume = 1, .data = malloc(file.bytes), .bytes = file.bytes};
    fxs_sound_kind(&scene->sound, path, 0);
    if (scene->sound.data)
        memcpy(scene->sound.data, file.data, file.bytes);
    fxs_map_close(&file);
    return scene->sound.data ? 0 : fail(EXIT_FAILED, "%s: out of memory", path);
}

int publish_load(loaded_scene *scene, const char *path, const load_options *options, int profile,
                 const publish_start *start)
{
    load_options how = *options;
    if (load_scene(scene, path, options))
        return EXIT_FAILED;
    const int was_packed = is_packed(scene);
    const fxs_scene *own = scene->opened->scene;
    const int is_other = profile && own->profile != options->profile;
    const int lacks_tree = options->tree && !own->nodes && !own->motion;
    const int anew = was_packed && (is_other || (lacks_tree && own->chunk_count > 1));
    how.profile = profile ? options->profile : own->profile;
    how.tree |= own->nodes != 0;
    if (anew) {
        free_scene(scene);
        if (load_anew(scene, path, &how))
            return EXIT_FAILED;
    }
    void *data = (void *)(uintptr_t)scene->opened->data;
    int status = anew || !was_packed ? set_start(data, scene->opened->bytes, start)
                 : needs_copy(scene, start) ? copy_scene(scene, start) : 0;
    status = status || !start->sound ? status : load_sound(scene, start->sound);
    if (status)
        free_scene(scene);
    else if (anew || !was_packed)
        fxs_file_seal(data, scene->opened->bytes);
    return status;
}

void publish_say_gain(const loaded_scene *scene, char *const *words)
{
    const fxs_scene *own = scene->opened->scene;
    const size_t small = fxs_pack_bytes(scene->opened->info, FXS_PROFILE_SMALL) * (own->nodes ? 2 : 1);
    const double times = small ? (double)scene->opened->bytes / (double)small : 0;
    fxs_printed line;
    if (times < WORTH_SAYING || fxs_print_begin(&line))
        return;
    fputs("fixsplat", line.file);
    for (; *words; words++)
        write_shell_word(line.file, *words);
    if (!fxs_print_end(&line))
        note("%s: taken as it is, %.1f MB in profile %s; %.1f times smaller, with less detail, by: %s --profile small",
             scene->path, (double)scene->opened->bytes * 1e-6, profile_names[own->profile], times, line.text);
    free(line.text);
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
