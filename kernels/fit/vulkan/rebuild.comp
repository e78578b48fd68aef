// Copies planes of Gaussians: number i of a plane of `parameters` comes from number sources[i] of it, and goes to
// `masters`. The buffer `gaussians` holds the sources; bit 31 marks a new Gaussian, whose moments are 0.
layout(local_size_x = 256) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (i >= rebuilt.count)
        return;
    const uint source = gaussians[i];
    const bool is_dropped = rebuilt.has_moments != 0u && source >= 0x80000000u;
    const uint from = (rebuilt.from_plane + gl_WorkGroupID.y) * rebuilt.from_stride + (source & 0x7fffffffu);
    const uint to = (rebuilt.to_plane + gl_WorkGroupID.y) * rebuilt.to_stride + i;
    masters[to] = is_dropped ? 0.0 : parameters[from];
}
