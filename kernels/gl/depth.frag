// Converts a value of a GL depth buffer to a distance in units of 2^-bits. `inverse` holds 1 / distance at the values 0
// and 1. The far plane gives 0xffffffff.
uint distance_of(float depth, vec2 inverse, int bits)
{
    float of_depth = mix(inverse.x, inverse.y, depth), z = float(1 << bits) / of_depth;
    return of_depth <= min(inverse.x, inverse.y) || z >= 4294967040.0 ? 0xffffffffu : uint(z);
}
