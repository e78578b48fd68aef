#include "lanes_avx2.h"
#include "shade_body.h"
#include "x86.h"

FXS_X86_SHADE(avx2)
{
    return shade(view, scene, chunk, indices, count, splats);
}
