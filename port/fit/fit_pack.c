/* The Gaussians of a fit as the renderer draws them. */
#include <string.h>

#include "fit_internal.h"

int fxs_fit_pack(const fxs_fit *f, fxs_packed_scene *scene, fxs_pack_report *report, fxs_message *message)
{
    fxs_gaussian_source gaussians;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report unwanted;
    const fxs_fit_options *o = &f->options;
    const fxs_pack_options options = {.profile = o->profile, .run = o->run, .pool = o->pool, .threads = o->threads};
    memset(scene, 0, sizeof *scene);
    fxs_fit_gaussians(f, &gaussians);
    int error = fxs_scene_file_open_gaussians("fit", &gaussians, NULL, &file, &info, message);
    if (error)
        return error;
    error = fxs_pack(file, &info, scene, report ? report : &unwanted, &options, message);
    fxs_scene_file_close(file);
    return error;
}
