// Finds the tiles that a splat touches, with the arithmetic of src/core/bin.c.

fn columns_between(left_q8: i32, right_q8: i32) -> Span
{
    let first = (left_q8 + 255) >> 8u;
    let last = right_q8 >> 8u;
    if (last < 0 || first >= frame.size.x || first > last) {
        return Span(0, -1);
    }
    return Span(max(first, 0) >> frame.tile_bits,
                select(last >> frame.tile_bits, frame.tiles.x - 1, last >= frame.size.x));
}

fn columns_of(b: ptr<function, Bounds>) -> Span
{
    let c_q8 = (*b).c_q14.x >> 6u;
    return columns_between(c_q8 - (*b).half_width_q8, c_q8 + (*b).half_width_q8);
}

fn radius_q12(offset_q11: i32) -> i32
{
    return i32(sqrt_of(u32(fxs_limit_q11(offset_q11, frame.cut_q11) - offset_q11 + 1) << 13u)) + 1;
}

// Returns a splat's coordinate v, which is linear in the pixel position, on a row of pixels. The result is below 2^30.
fn v_at_row(s: ptr<function, Splat>, b: ptr<function, Bounds>, row: i32) -> i32
{
    return low_of(shift_signed(mul_signed((row << 14u) - (*b).c_q14.y, (*s).vy_q24), 26u));
}

fn half_at(b: ptr<function, Bounds>, r_q12: i32, v_q12: i32) -> i32
{
    let root = sqrt_of(u32(r_q12 * r_q12 - v_q12 * v_q12)) + 1u;
    return i32(shift_right(mul_wide((*b).breadth_q8, root), 12u).x);
}

fn ellipse_span(s: ptr<function, Splat>, b: ptr<function, Bounds>, r: i32, row: i32) -> Span
{
    let top_q12 = v_at_row(s, b, row << frame.tile_bits);
    let bottom_q12 = v_at_row(s, b, ((row + 1) << frame.tile_bits) - 1);
    let reach = (*b).half_width_q8;
    if ((top_q12 > r + 2 || bottom_q12 < -r - 2) && reach != EVERYWHERE_Q8) {
        return Span(0, -1);
    }
    let top = clamp(top_q12, -r, r);
    let bottom = clamp(bottom_q12 + 1, -r, r);
    let x_top = low_of(shift_signed(mul_signed((*b).shear_q8, top), 12u));
    let x_bottom = low_of(shift_signed(mul_signed((*b).shear_q8, bottom), 12u));
    let half_top = half_at(b, r, top);
    let half_bottom = half_at(b, r, bottom);
    var left = -max(half_top - x_top, half_bottom - x_bottom);
    var right = max(half_top + x_top, half_bottom + x_bottom);
    var tangent = mul_wide(shift_right(mul_wide(u32(abs((*b).shear_q8)), u32(r)), 12u).x, u32(r));
    if ((*b).shear_q8 < 0) {
        tangent = negate(tangent);
    }
    let opposite = negate(tangent);
    let low = mul_signed(top, reach);
    let high = mul_signed(bottom, reach);
    if (!less(tangent, low) && !less(high, tangent)) {
        right = reach;
    }
    if (!less(opposite, low) && !less(high, opposite)) {
        left = -reach;
    }
    let c_q8 = (*b).c_q14.x >> 6u;
    let margin = (reach >> 8u) + 32;
    return columns_between(c_q8 + max(left - margin, -reach), c_q8 - max(-right - margin, -reach));
}

// Returns the range of tiles that a splat's square covers along one axis. With square splats, tiles always have 16
// pixels.
fn square_span(centre_q14: i32, radius: u32, tiles: i32) -> Span
{
    let pixel = centre_q14 >> 14u;
    let first = (pixel - i32(radius)) >> 4u;
    let last = ((pixel + i32(radius) + 15) >> 4u) - 1;
    return Span(clamp(first, 0, tiles), clamp(last, -1, tiles - 1));
}

fn rows_of(s: ptr<function, Splat>, b: ptr<function, Bounds>) -> Span
{
    if (frame.cutoff == 1) {
        return square_span((*b).c_q14.y, (*b).square_radius, frame.tiles.y);
    }
    return Span((*s).rows.x >> frame.tile_bits, (*s).rows.y >> frame.tile_bits);
}

fn span_of(s: ptr<function, Splat>, b: ptr<function, Bounds>, r_q12: i32, row: i32) -> Span
{
    if (frame.cutoff == 1) {
        return square_span((*b).c_q14.x, (*b).square_radius, frame.tiles.x);
    }
    return ellipse_span(s, b, r_q12, row);
}
