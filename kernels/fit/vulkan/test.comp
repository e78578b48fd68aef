// Results that a device may round otherwise (vf_device.c compares them with the processor's), and the threads of a
// subgroup, if all subgroups are full.
layout(local_size_x = 64) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    const float a = parameters[2u * i], b = parameters[2u * i + 1u];
    masters[8u * i] = divide(a, b);
    masters[8u * i + 1u] = sqrtf(absolute(a));
    masters[8u * i + 2u] = a * b + 1.0;
    masters[8u * i + 3u] = a - b * 0.3;
    masters[8u * i + 4u] = exp_e(least(most(a, -80.0), 80.0));
    masters[8u * i + 5u] = ln(absolute(a));
    masters[8u * i + 6u] = fma(a, b, -(a * b));
    masters[8u * i + 7u] = gl_NumSubgroups * gl_SubgroupSize == 64u ? float(gl_SubgroupSize) : 0.0;
}
