/* Renders two eyes one after the other in the same memory. With a budget or a detail, both draw the chunks that one cut
   chooses. Otherwise each picture equals that of a mono frame, byte for byte. */
#include "stereo.h"
#include "targets.h"

/* Calls `step` for each eye of a request. Continues after FXS_ERR_MEMORY, so that stats.memory.least is the maximum of
   both eyes. */
static int each_eye(fxs_frame *f, const fxs_request *request, int (*step)(fxs_frame *f))
{
    size_t least = 0;
    int error = 0;
    for (uint32_t eye = 0; eye < 2 && (!error || error == FXS_ERR_MEMORY); eye++) {
        int own = fxs_frame_look(f, request, eye);
        own = own ? own : step(f);
        error = own ? own : error;
        least = f->stats.memory.least > least ? f->stats.memory.least : least;
    }
    f->stats.memory.least = least;
    return error;
}

int fxs_stereo_check(const fxs_request *request)
{
    const fxs_camera *a = &request->cameras[0], *b = &request->cameras[1];
    if (a->width != b->width || a->height != b->height || a->projection != b->projection)
        return FXS_ERR_SIZE;
    return fxs_targets_collide(&request->targets[0], &request->targets[1], a->width, a->height) ? FXS_ERR_TARGET : 0;
}

int fxs_stereo_render(fxs_frame *f, const fxs_request *request)
{
    int error = fxs_stereo_check(request);
    if (error)
        return error;
    const uint64_t start = fxs_now(f);
    error = each_eye(f, request, fxs_frame_check);
    f->stats.visible = 0;
    error = error ? error : each_eye(f, request, fxs_frame_render);
    f->stats.frame_nanoseconds = fxs_now(f) - start;
    return error;
}
