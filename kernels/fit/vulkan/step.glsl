// The buffers of a fitting step. A splat is a projected Gaussian; a slot is a pair of a splat and a tile that it touches.
layout(std430, set = 0, binding = 0) buffer order_buffer { fit_status status; fit_order order; };
layout(std430, set = 0, binding = 1) buffer parameters_buffer { float parameters[]; };
layout(std430, set = 0, binding = 2) buffer moments_buffer { float moments[]; };   // means, then squares
layout(std430, set = 0, binding = 3) buffer masters_buffer { float masters[]; };   // the parameters, if not quantised
layout(std430, set = 0, binding = 4) buffer gaussians_buffer { uint gaussians[]; };
layout(std430, set = 0, binding = 5) QUALIFIER buffer slots_buffer { uint slots[]; };
layout(std430, set = 0, binding = 6) buffer pixels_buffer { uint pixels[]; };
layout(std430, set = 0, binding = 7) buffer photograph_buffer { uint photograph[]; };
layout(push_constant) uniform push_constants { uint view, is_surface; fit_rebuilt rebuilt; };

float load(uint at) { return LOADED(at); }
void store(uint at, float x) { STORED(at) = x; }
int bits_of(float x) { return floatBitsToInt(x); }
float real_of(int x) { return intBitsToFloat(x); }
float numbers_from(int first) { return float(first); }

uint tile_count() { return uint(order.cameras[view].tiles_x * order.cameras[view].tiles_y); }
