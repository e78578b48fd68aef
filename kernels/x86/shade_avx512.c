#include "lanes_avx512.h"
#include "shade_body.h"
#include "x86.h"

FXS_X86_SHADE(avx512)
{
    return shade(view, scene, chunk, indices, count, splats);
}
