// Weighted sums over windows of 11x11 pixels, for a square of 16x16 pixels: first along rows, then along columns.
const int REACH = FXS_FIT_WINDOW / 2, PATCH = FXS_FIT_TILE + 2 * REACH;
shared float patches[PATCHES][PATCH * PATCH];
shared float rows[ROWS][PATCH * FXS_FIT_TILE];

int width() { return order.cameras[view].width; }
int height() { return order.cameras[view].height; }
uint size() { return uint(width() * height()); }
ivec2 corner() { return ivec2(gl_WorkGroupID.xy) * FXS_FIT_TILE; }
ivec2 place() { return ivec2(gl_LocalInvocationIndex % 16u, gl_LocalInvocationIndex / 16u); }
bool is_within(ivec2 at) { return at.x >= 0 && at.x < width() && at.y >= 0 && at.y < height(); }
uint index_of(ivec2 at) { return uint(at.y * width() + at.x); }

float column_sum(int of)
{
    const ivec2 p = place();
    float sum = rows[of][p.y * FXS_FIT_TILE + p.x] * window_weight(0);
    for (int i = 1; i < FXS_FIT_WINDOW; i++)
        sum += rows[of][(p.y + i) * FXS_FIT_TILE + p.x] * window_weight(i);
    return sum;
}
