// Arithmetic that Vulkan does not promise: division and square root of floats, rounded to nearest as in IEEE 754. A
// first guess by the device's operation is corrected: with fused multiply-adds where the device has them (Markstein
// 1990), else in integers. Results below 2^-126 become 0, as any device may do.
layout(constant_id = 0) const bool HAS_FMA = false;

// True for a number of 2^-60..2^60, whose products and remainders neither overflow nor lose bits.
bool is_ordinary(float x) { return (floatBitsToUint(x) >> 23 & 255u) - 67u < 121u; }

bool truth(bool x) { return x; }
bool truth(int x) { return x != 0; }
bool truth(uint x) { return x != 0u; }

int divide(int a, int b) { return a / b; }
uint divide(uint a, uint b) { return a / b; }

// Makes a float of a sign bit, a mantissa in 2^23..2^24 (its value of 2^24 included) and the power of two of its lowest
// bit plus 150.
float made(uint sign, uint mantissa, int exponent)
{
    exponent += mantissa >> 24 == 1u ? 1 : 0;
    return exponent <= 0 ? uintBitsToFloat(sign)
           : exponent >= 255 ? uintBitsToFloat(sign | 0x7f800000u)
                             : uintBitsToFloat(sign | uint(exponent) << 23 | (mantissa & 0x7fffffu));
}

// a / b. The quotient q of the mantissas has 24 bits; its remainder a 2^k - q b fits in 32 bits, because the guess is
// off by a few units. There are no ties: no quotient lies halfway between two floats.
float divide(float a, float b)
{
    if (HAS_FMA && is_ordinary(a) && is_ordinary(b)) {
        float inverse = 1.0 / b;
        inverse = fma(fma(-b, inverse, 1.0), inverse, inverse);
        float quotient = a * inverse;
        quotient = fma(fma(-b, quotient, a), inverse, quotient);
        return fma(fma(-b, quotient, a), inverse, quotient);
    }
    const uint x = floatBitsToUint(a), y = floatBitsToUint(b), sign = (x ^ y) & 0x80000000u;
    const int of_x = int(x >> 23 & 255u), of_y = int(y >> 23 & 255u);
    if (of_x == 0 || of_y == 0 || of_x == 255 || of_y == 255) {
        const bool is_nan = isnan(a) || isnan(b) || (of_x == 0 && of_y == 0) || (of_x == 255 && of_y == 255);
        return uintBitsToFloat(is_nan ? 0x7fc00000u : of_x == 255 || of_y == 0 ? sign | 0x7f800000u : sign);
    }
    const uint p = x & 0x7fffffu | 0x800000u, q = y & 0x7fffffu | 0x800000u, more = p < q ? 1u : 0u;
    uint guess = uint(float(p) / float(q) * (more == 1u ? 16777216.0 : 8388608.0));
    int rest = int((p << (23u + more)) - guess * q);
    const int steps = int(floor(float(rest) / float(q)));
    guess += uint(steps);
    rest -= steps * int(q);
    if (rest < 0) {
        guess--;
        rest += int(q);
    } else if (rest >= int(q)) {
        guess++;
        rest -= int(q);
    }
    return made(sign, guess + (2 * rest > int(q) ? 1u : 0u), of_x - of_y + 127 - int(more));
}

// The square root of x: the root r of a mantissa of 47 or 48 bits has 24 bits, and the remainder is that minus r^2.
float sqrtf(float x)
{
    if (HAS_FMA && x > 0.0 && is_ordinary(x)) {
        const float inverse = inversesqrt(x);
        float found = x * inverse, half_inverse = 0.5 * inverse;
        const float left = fma(-half_inverse, found, 0.5);
        found = fma(found, left, found);
        half_inverse = fma(half_inverse, left, half_inverse);
        return fma(fma(-found, found, x), half_inverse, found);
    }
    const uint bits = floatBitsToUint(x);
    const int of_x = int(bits >> 23 & 255u);
    if (of_x == 0)
        return uintBitsToFloat(bits & 0x80000000u);
    if (bits >= 0x7f800000u)
        return uintBitsToFloat(bits == 0x7f800000u ? bits : 0x7fc00000u);
    const uint odd = uint(of_x & 1) ^ 1u, mantissa = bits & 0x7fffffu | 0x800000u;
    uint guess = uint(sqrt(float(mantissa << odd)) * 2896.309326171875);   // sqrt(2^23)
    int rest = int((mantissa << (23u + odd)) - guess * guess);
    const int steps = int(floor(float(rest) / (2.0 * float(guess))));
    rest -= int(2u * guess) * steps + steps * steps;
    guess += uint(steps);
    if (rest < 0) {
        guess--;
        rest += int(2u * guess + 1u);
    } else if (rest > int(2u * guess)) {
        rest -= int(2u * guess + 1u);
        guess++;
    }
    return made(0u, guess + (rest > int(guess) ? 1u : 0u), (of_x + 127 - int(odd)) / 2);
}
