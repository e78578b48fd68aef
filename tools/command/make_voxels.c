/* Makes the voxels of a loaded scene, for the commands collide and publish. */
#include "make_voxels.h"

#include <math.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/start.h>
#include "tools/serve/scene_picture.h"

/* Chooses seeds: the given one; or two, the first view's camera or another place, moved into the box, and the middle of
   the scene. */
static int take_seeds(fxs_collide_options *c, const voxel_options *o, const fxs_opened *opened)
{
    const double height = o->height == 0 ? FXS_COLLIDE_HEIGHT : o->height;
    fxs_camera camera;
    fxs_message why;
    memcpy(c->up, opened->info->start.up, sizeof c->up);
    c->seed_count = o->seed.given ? 1 : 2;
    if (!o->seed.given && !o->from && fxs_opened_camera(opened, PICTURE_WIDTH, PICTURE_HEIGHT, &camera, &why))
        return fail_for(&why);
    for (int i = 0; i < 3; i++) {
        const double at = o->seed.given ? o->seed.at[i] : o->from ? o->from[i]
                          : ldexp((double)camera.position_q32[i], -32);
        c->seeds[0][i] = o->seed.given ? at : fmin(fmax(at, c->low[i] - height / 2), c->high[i] + height / 2);
        c->seeds[1][i] = (c->low[i] + c->high[i]) / 2;
    }
    return 0;
}

int make_voxels(fxs_voxels **voxels, const voxel_options *o, const loaded_scene *scene, const frame_options *frame)
{
    char label[] = "voxels";
    fxs_message why;
    const fxs_opened *opened = scene->opened;
    fxs_collide_options c = {.size = sizeof c, .voxel = o->voxel, .opacity = o->opacity, .radius = o->radius,
                             .height = o->height, .max_memory = o->max_memory,
                             .progress = progress_of(&frame->load, label)};
    fxs_inner_box(opened->data, c.low, c.high);
    if (take_seeds(&c, o, opened))
        return EXIT_FAILED;
    fxs_pool *pool = fxs_pool_create(frame->threads);
    c.workers = (fxs_workers){pool ? fxs_pool_run : 0, pool, frame->threads};
    const int error = fxs_collide(opened->scene, &c, voxels, &why);
    progress_end();
    fxs_pool_destroy(pool);
    if (error)
        return fail(EXIT_FAILED, "%s: %s%s", scene->path, why.text,
                    error == FXS_ERR_UNSUPPORTED ? ": give --time SECONDS"
                    : error == FXS_ERR_OBJECT && !o->seed.given ? o->hint : "");
    return 0;
}
