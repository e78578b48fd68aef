// The buffers of a fitting step. A splat is a projected Gaussian; a slot is a pair of a splat and a tile that it touches.
// `parameters` and `masters` may be one buffer, so they are not `restrict`.
layout(std430, set = 0, binding = 0) restrict buffer status_buffer { fit_status status; };
layout(std430, set = 0, binding = 1) buffer parameters_buffer { float parameters[]; };
layout(std430, set = 0, binding = 2) restrict buffer moments_buffer { float moments[]; };  // means, then squares
layout(std430, set = 0, binding = 3) buffer masters_buffer { float masters[]; };   // the parameters, if not quantised
layout(std430, set = 0, binding = 4) restrict buffer gaussians_buffer { uint gaussians[]; };
layout(std430, set = 0, binding = 5) restrict QUALIFIER buffer slots_buffer { uint slots[]; };
layout(std430, set = 0, binding = 6) restrict buffer pixels_buffer { uint pixels[]; };
layout(std430, set = 0, binding = 7) restrict buffer photograph_buffer { uint photograph[]; };
layout(std430, set = 0, binding = 8) restrict readonly buffer order_buffer { fit_order order; };
layout(push_constant) uniform push_constants { uint view, is_surface; fit_rebuilt rebuilt; };

float load(uint at) { return LOADED(at); }
void store(uint at, float x) { STORED(at) = x; }
int bits_of(float x) { return floatBitsToInt(x); }
float real_of(int x) { return intBitsToFloat(x); }
float numbers_from(int first) { return float(first); }

uint tile_count() { return uint(order.cameras[view].tiles_x * order.cameras[view].tiles_y); }
