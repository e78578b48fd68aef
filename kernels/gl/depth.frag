// The distance of a depth in a depth buffer, as in the occluder of fxs_targets; `inverse`: 1 / the distance that 0 and 1
// stand for. What is at the farther one hides nothing.
uint distance_of(float depth, vec2 inverse, int bits)
{
    float of_depth = mix(inverse.x, inverse.y, depth), z = float(1 << bits) / of_depth;
    return of_depth <= min(inverse.x, inverse.y) || z >= 4294967040.0 ? 0xffffffffu : uint(z);
}
