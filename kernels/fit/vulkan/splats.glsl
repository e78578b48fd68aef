// The words of a splat, in the order of fxs_fit_splat.
const uint SPLAT_WORDS = 16u, SPLAT_DEPTH = 10u;

uint splat_at(uint gaussian) { return order.at_splats + SPLAT_WORDS * gaussian; }
float splat_number(uint gaussian, uint k) { return uintBitsToFloat(gaussians[splat_at(gaussian) + k]); }
uint tiles_of(uint gaussian) { return gaussians[order.at_bases + gaussian + 1u] - gaussians[order.at_bases + gaussian]; }
