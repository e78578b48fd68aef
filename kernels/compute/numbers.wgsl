// 64-bit integers as two 32-bit words, low word first, and the functions of src/include/fixsplat/internal/fixed.h.

alias wide = vec2<u32>;

fn wide_of(x: i32) -> wide
{
    return wide(bitcast<u32>(x), bitcast<u32>(x >> 31u));
}

fn add_wide(a: wide, b: wide) -> wide
{
    let low = a.x + b.x;
    return wide(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn sub_wide(a: wide, b: wide) -> wide
{
    return wide(a.x - b.x, a.y - b.y - select(0u, 1u, a.x < b.x));
}

fn is_negative(a: wide) -> bool
{
    return bitcast<i32>(a.y) < 0;
}

// Returns -a. The difference 0 - a is avoided, because NVIDIA's GLSL compiler (driver 580) loses the sign of its result
// in a following shift.
fn negate(a: wide) -> wide
{
    return add_wide(~a, wide(1u, 0u));
}

fn magnitude(a: wide) -> wide
{
    if (is_negative(a)) {
        return negate(a);
    }
    return a;
}

// Returns true if a < b, for signed 64-bit numbers a and b.
fn less(a: wide, b: wide) -> bool
{
    return select(bitcast<i32>(a.y) < bitcast<i32>(b.y), a.x < b.x, a.y == b.y);
}

fn mul_wide(a: u32, b: u32) -> wide
{
    let al = a & 0xffffu;
    let ah = a >> 16u;
    let bl = b & 0xffffu;
    let bh = b >> 16u;
    let low = al * bl;
    let middle = ah * bl + (low >> 16u);
    let other = al * bh + (middle & 0xffffu);
    return wide((other << 16u) | (low & 0xffffu), ah * bh + (middle >> 16u) + (other >> 16u));
}

fn mul_high(a: u32, b: u32) -> u32
{
    return mul_wide(a, b).y;
}

fn mul_mixed(a: i32, b: u32) -> wide
{
    let product = mul_wide(bitcast<u32>(a), b);
    return wide(product.x, product.y - select(0u, b, a < 0));
}

fn mul_signed(a: i32, b: i32) -> wide
{
    let product = mul_mixed(a, bitcast<u32>(b));
    return wide(product.x, product.y - select(0u, bitcast<u32>(a), b < 0));
}

fn mul_word(a: wide, b: u32) -> wide
{
    let product = mul_wide(a.x, b);
    return wide(product.x, product.y + a.y * b);
}

// Shifts a 64-bit number left by n bits, 0 to 63.
fn shift_left(a: wide, n: u32) -> wide
{
    if (n == 0u) {
        return a;
    }
    if (n >= 32u) {
        return wide(0u, a.x << (n - 32u));
    }
    return wide(a.x << n, (a.y << n) | (a.x >> (32u - n)));
}

fn shift_right(a: wide, n: u32) -> wide
{
    if (n == 0u) {
        return a;
    }
    if (n >= 32u) {
        return wide(a.y >> (n - 32u), 0u);
    }
    return wide((a.x >> n) | (a.y << (32u - n)), a.y >> n);
}

// Shifts a signed 64-bit number right by n bits, and rounds towards minus infinity.
fn shift_signed(a: wide, n: u32) -> wide
{
    let high = bitcast<i32>(a.y);
    if (n == 0u) {
        return a;
    }
    if (n >= 32u) {
        return wide(bitcast<u32>(high >> (n - 32u)), bitcast<u32>(high >> 31u));
    }
    return wide((a.x >> n) | (a.y << (32u - n)), bitcast<u32>(high >> n));
}

// Shifts a signed 64-bit number right by n bits, n > 0, and rounds towards plus infinity.
fn shift_up(a: wide, n: u32) -> wide
{
    let most = shift_right(wide(0xffffffffu, 0xffffffffu), 64u - n);
    return shift_signed(add_wide(a, most), n);
}

// Returns x 2^-n, rounded to nearest, halves up; n is 1 to 62.
fn round_shift(x: wide, n: i32) -> wide
{
    return shift_signed(add_wide(shift_signed(x, u32(n - 1)), wide(1u, 0u)), 1u);
}

fn low_of(a: wide) -> i32
{
    return bitcast<i32>(a.x);
}

fn zeros_of(x: u32) -> i32
{
    return i32(countLeadingZeros(x));
}

fn zeros_of_wide(x: wide) -> i32
{
    return select(32 + zeros_of(x.x), zeros_of(x.y), x.y != 0u);
}

// Returns x / 2^n, rounded towards 0.
fn divide_by(x: i32, n: u32) -> i32
{
    return select(x >> n, -(-x >> n), x < 0);
}

// Returns 2^62 / m, for m in [2^31, 2^32).
fn reciprocal(m: u32) -> u32
{
    var y_q30 = 3031741620u - mul_high(m, 2021161081u);
    y_q30 = mul_high(2u * y_q30, 2u * (0x80000000u - mul_high(m, y_q30)));
    y_q30 = mul_high(2u * y_q30, 2u * (0x80000000u - mul_high(m, y_q30)));
    return mul_high(2u * y_q30, 2u * (0x80000000u - mul_high(m, y_q30)));
}

fn rsqrt_step(m: u32, y_q30: u32) -> u32
{
    return mul_high(2u * y_q30, 2u * (0x60000000u - mul_high(m, mul_high(2u * y_q30, y_q30))));
}

// Returns 1 / sqrt(m 2^-32) in Q30, for m in [2^30, 2^32).
fn rsqrt(m: u32) -> u32
{
    return rsqrt_step(m, rsqrt_step(m, rsqrt_step(m, 2369829601u - mul_high(m, 1431655765u))));
}

fn sqrt_of(x: u32) -> u32
{
    if (x == 0u) {
        return 0u;
    }
    let shift = u32(zeros_of(x)) & ~1u;
    let m = x << shift;
    return mul_high(m, rsqrt(m)) >> (14u + shift / 2u);
}

// Returns 2^-f in Q15. The argument f_q15 is 0 to 32767.
fn exp2_q15(f_q15: i32) -> i32
{
    var p = (256 * f_q15 + 16384) >> 15u;
    p = ((p - 1820) * f_q15 + 16384) >> 15u;
    p = ((p + 7904) * f_q15 + 16384) >> 15u;
    p = ((p - 22724) * f_q15 + 16384) >> 15u;
    return 32768 + p;
}

// Returns log2(x) in Q16, for x > 0.
fn log2_q16(x: wide) -> i32
{
    let n = zeros_of_wide(x);
    let t_q15 = i32(shift_left(shift_left(x, u32(n)), 1u).y >> 17u);
    var q = (-2776 * t_q15 + 16384) >> 15u;
    q = ((q + 6897) * t_q15 + 16384) >> 15u;
    q = ((q - 9697) * t_q15 + 16384) >> 15u;
    q = ((q + 14605) * (32768 - t_q15) + 16384) >> 15u;
    return (63 - n) * 65536 + 2 * (((32768 + q) * (t_q15 >> 1u) + 8192) >> 14u);
}
