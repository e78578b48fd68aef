// Quantises all parameters except the spherical harmonics above degree 0.
#define LOADED(at) masters[at]
#define STORED(at) parameters[at]
#include "quantise.glsl"
layout(local_size_x = 64) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    int codes[FXS_FIT_SH];
    if (i < order.count)
        quantise_shape(grid_of(), chunk_of(i), i, i, int(order.stride), codes);
}
