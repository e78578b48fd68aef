// Results that a device may round otherwise (vf_device.c compares them with the processor's).
layout(local_size_x = 64) in;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    const float a = parameters[2u * i], b = parameters[2u * i + 1u];
    masters[7u * i] = divide(a, b);
    masters[7u * i + 1u] = sqrtf(absolute(a));
    masters[7u * i + 2u] = a * b + 1.0;
    masters[7u * i + 3u] = a - b * 0.3;
    masters[7u * i + 4u] = exp_e(least(most(a, -80.0), 80.0));
    masters[7u * i + 5u] = ln(absolute(a));
    masters[7u * i + 6u] = fma(a, b, -(a * b));
}
