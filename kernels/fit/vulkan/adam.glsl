// Makes a step of Adam for parameter k of Gaussian i.
void move_one(uint k, float gradient, uint i)
{
    const uint at = k * order.stride + i, squares = uint(FXS_FIT_PARAMETERS) * order.stride;
    float number = masters[at], mean = moments[at], square = moments[squares + at];
    adam_step(order.adam, order.adam.rate[k], gradient, number, mean, square);
    const bool has_limits = (k >= FXS_FIT_SCALE && k < FXS_FIT_ROTATION) || k == FXS_FIT_OPACITY;
    moments[at] = mean;
    moments[squares + at] = square;
    masters[at] = has_limits ? least(most(number, -FXS_FIT_FARTHEST), FXS_FIT_FARTHEST) : number;
}
