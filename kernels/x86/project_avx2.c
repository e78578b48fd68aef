#include "lanes_avx2.h"
#include "project_body.h"
#include "x86.h"

FXS_X86_PROJECT(avx2)
{
    return view->square || view->orthographic
               ? fxs_project_c(view, scene, chunk, splats, bounds, indices, depths)
               : project(view, scene, chunk, splats, bounds, indices, depths);
}
