// Bytes of the photograph and of its mask, four in a word.
uint byte_at(uint first_word, uint i) { return photograph[first_word + i / 4u] >> 8u * (i % 4u) & 255u; }
float level_of(uint at, uint channel) { return divide(float(byte_at(order.photographs[view].at, 3u * at + channel)), 255.0); }
bool counts(uint at) { return order.photographs[view].at_mask == 0xffffffffu || byte_at(order.photographs[view].at_mask, at) != 0u; }

// If exposures are fitted, white in a photograph counts as saturated.
bool is_clipped(float a, float level) { return order.has_exposure != 0 && is_beyond_white(a, level) != 0; }
float seen_as(float a, float level) { return order.has_exposure != 0 ? recorded(a, level) : a; }
