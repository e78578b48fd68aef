/* Draws frames of a path as small pictures of median depths. Back ends without depths are left out. */
#include "walls.h"

#include <string.h>

#include <fixsplat/internal/view_more.h>
#include "command.h"
#include "views.h"

enum { CHECKS = 200, WIDTH = 64 };

static int is_covered(renderer *small, const world *w, const frame_options *o, const fxs_view *frame, picture *p)
{
    const double limit = 5 * fxs_near_of_box(w->inner_low, w->inner_high);
    const int height = WIDTH * frame->height / frame->width;
    fxs_view view = *frame;
    int near = 0;
    fxs_view_resize(&view, WIDTH, height > 0 ? height : 1);
    if (renderer_render(small, w, &view, &o->render, p, 0))
        return 0;
    for (int i = 0; i < p->width * p->height; i++)
        near += p->depths[i] < ldexp(limit, p->depth_bits);
    return 2 * near > p->width * p->height;
}

void say_walls(const renderer *r, const world *w, const frame_options *o, const fxs_view *frames, long count)
{
    const long step = count / CHECKS + 1;
    renderer small = *r;
    picture p = {.pixels = 0};
    long first = -1, last = -1, places = 0;
    if (!(r->backend->can & FXS_CAN_TRACE) || is_quiet())
        return;
    small.draws = DRAW_MEDIAN_DEPTH;
    small.stereo = 0;
    small.has_scissor = 0;
    memset(small.scissor, 0, sizeof small.scissor);
    for (long i = 0, was = 0; i < count; i += step) {
        const int is = is_covered(&small, w, o, &frames[i * views_per_frame(o)], &p);
        places += is && !was;
        first = is && first < 0 ? i : first;
        last = is && places == 1 ? i : last;
        was = is;
    }
    picture_free(&p);
    if (!places)
        return;
    char more[48] = "";
    if (places > 1)
        snprintf(more, sizeof more, ", and %ld more places", places - 1);
    note("%s: frames %ld to %ld%s: more than half of the picture is nearer than %.3g units: does the path go through a "
         "wall?", o->path, first, last, more, 5 * fxs_near_of_box(w->inner_low, w->inner_high));
}
