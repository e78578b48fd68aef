// Displaces the Gaussians randomly.
#define LOADED(at) masters[at]
layout(local_size_x = 128) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (status.is_full == 0u && i < order.count)
        add_noise(order.noise, i, order.stride, i);
}
