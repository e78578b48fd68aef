// Quantises the spherical harmonics of one degree.
#define LOADED(at) masters[at]
#define STORED(at) parameters[at]
#include "quantise.glsl"
layout(local_size_x = 128) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    const int degree = int(gl_WorkGroupID.y) + 1, first = FXS_FIT_SH + 3 * (degree * degree - 1);
    int code;
    if (i >= order.count)
        return;
    const fxs_fit_chunk chunk = chunk_of(i);
    for (int k = first; k < first + 6 * degree + 3; k++) {
        const uint at = uint(k) * order.stride + i;
        store(at, quantise_band(chunk, degree, load(at), code));
    }
}
