#version 310 es
precision highp float;
precision highp int;
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;
struct Frame {
    ivec2 size;
    ivec2 tiles;
    uint places;
    uint spans;
    uint chunk_room;
    uint large_room;
    uint page_room;
    uint drawn;
    uint seen;
    uint ranks;
    uint visible;
    uint records;
    uint boxes;
    uint depths;
    uint larges;
    uint spans_at;
    uint next;
    uint classes;
    uint blocks;
    uint block_room;
    uint spare;
    uint tile_bits;
    uint cleared;
    int cutoff;
    int cut_q11_;
    uint format;
    ivec4 background_q13_;
    int depth_bits;
    uint colour;
    uint coverage;
    uint mean_depth;
    uint median_depth;
    uint id;
    uint occluder;
    uint backdrop;
};
struct Object {
    uvec4 position_q32_[3];
    uvec4 eye_q32_[3];
    ivec4 rotation_q30_[3];
    ivec4 row_q15_[2];
    ivec4 forward_q15_[2];
    ivec4 tint_q13_;
    uvec2 near_q32_;
    uvec2 dilation_q30_;
    ivec2 f_q12_;
    ivec2 c_q12_;
    ivec2 slope_low_q23_;
    ivec2 slope_high_q23_;
    ivec2 edge_low_q23_;
    ivec2 edge_high_q23_;
    ivec2 hidden_low_q23_;
    ivec2 hidden_high_q23_;
    ivec2 hidden;
    ivec2 hidden_end;
    uint focal_q32_;
    int focal_exponent;
    int veil_exponent;
    int jacobian_exponent;
    int offset_q11_;
    int degree;
    int antialiased;
    int orthographic;
    int plane_exponent;
    uint profile;
    int scene_degree;
    uint chunk_words;
    uint palette_entries;
    int palette_step_q19_;
    uint scale_mantissa;
    int scale_exponent;
    int plain;
    uint crop_count;
    uint keep_count;
    uint first_chunk;
    uint first_place;
    uint end_place;
    uint span;
    uint part_chunk;
    uint rows_at;
    uvec4 crops[32];
};
struct Splat {
    uint u0_q24_;
    uint v0_q24_;
    int ux_q24_;
    int uy_q24_;
    int vy_q24_;
    int offset_q11_;
    ivec2 rows;
};
struct Bounds {
    ivec2 c_q14_;
    uint breadth_q8_;
    int shear_q8_;
    int half_width_q8_;
    uint square_radius;
};
struct Span {
    int first;
    int last;
};
struct Pixel {
    int transmittance;
    ivec3 sum;
};
struct Fetched {
    uvec2 entry;
    uvec4 a;
    uvec4 b;
};
struct Half {
    uint tile;
    uint x;
    uint y;
    uint list;
    uint count;
};
struct Taken {
    uint u;
    uint ux;
    int level;
    int limit;
    ivec3 colour;
};
struct Place {
    uint column;
    uint row;
    uint at;
    uint words;
    bvec2 inside;
};
const int FXS_CUT_Q11_ = 18432;
const int FXS_FAINT_Q11_ = 22697;
const int FXS_LEVEL_MAX_Q11_ = 32767;
const int FXS_ALPHA_MAX_Q15_ = 32440;
const int FXS_CLEAR_Q15_ = 32767;
const int FXS_CLOSED_Q15_ = 33;
const uint CHUNK = 256u;
const uint THREADS = 128u;
const uint ROW_OF_GROUPS = 32768u;
const uint RECORD = 64u;
const uint LARGE = 8u;
const int LARGE_ROWS = 8;
const uint SPAN = 8u;
const uint PAGE = 4096u;
const uint MERGES = 5u;
const uint BLOCK = 512u;
const uint CLASSES = 16u;
const uint CUT_OFF = 2147483648u;
const uint NOTHING = 4294967295u;
const int BOX_COLUMNS = 6;
const int BOX_ROWS = 7;
const uint VISIBLE_CHUNKS = 0u;
const uint LARGES = 1u;
const uint PAGES = 2u;
const uint DAMAGED = 3u;
const uint VISIBLE = 4u;
const uint ENTRIES = 5u;
const uint SHORT_BLOCKS = 7u;
const uint LONG_BLOCKS = 8u;
const uint LONGEST = 9u;
const uint CLASS_COUNTS = 16u;
const uint TILES = 64u;
const int EVERYWHERE_Q8_ = 1073741824;
const uint SIDE = 8u;
const uint SOME = 64u;
const uint APART = 4u;
const uint CROWD = 2048u;
layout(std430, binding = 0) readonly buffer type_11_block_0Compute { uint _group_1_binding_0_cs[]; };
layout(std140, binding = 0) uniform Frame_block_1Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 1) readonly buffer type_13_block_2Compute { uvec2 _group_1_binding_1_cs[]; };
layout(std430, binding = 2) readonly buffer type_14_block_3Compute { uvec4 _group_1_binding_2_cs[]; };
layout(std430, binding = 3) buffer type_11_block_4Compute { uint _group_1_binding_3_cs[]; };
shared uvec4 shapes[64];
shared uvec4 shades[64];
shared uint touching[8];
shared uint open_round;
shared uint open_pixels[4];
shared uint masks[128];
int fxs_mul_q15_(int a, int b) {
    return (((a * b) + 16384) >> 15u);
}
int fxs_min(int a_1, int b_1) {
    return ((a_1 < b_1) ? a_1 : b_1);
}
int fxs_coordinate_q13_(int coordinate_q24_) {
    int c = 0;
    c = (coordinate_q24_ >> 11u);
    int _e4 = c;
    int _e6 = fxs_min(_e4, 32767);
    int _e7 = c;
    return ((_e7 < -32767) ? -32767 : _e6);
}
int fxs_row_level_q11_(int v_q13_, int offset_q11_) {
    int _e2 = fxs_mul_q15_(v_q13_, v_q13_);
    int _e5 = fxs_min((_e2 + offset_q11_), FXS_LEVEL_MAX_Q11_);
    return _e5;
}
int fxs_level_q11_(int u_q13_, int row_level_q11_) {
    int _e2 = fxs_mul_q15_(u_q13_, u_q13_);
    int _e5 = fxs_min((_e2 + row_level_q11_), FXS_LEVEL_MAX_Q11_);
    return _e5;
}
int fxs_limit_q11_(int offset_q11_1, int cut_q11_) {
    int _e4 = fxs_min((offset_q11_1 + cut_q11_), FXS_FAINT_Q11_);
    return _e4;
}
int fxs_alpha_q15_(int level_q11_) {
    int p_2 = 0;
    int _e2 = fxs_mul_q15_(-4236, level_q11_);
    p_2 = (_e2 + 16016);
    int _e6 = p_2;
    int _e7 = fxs_mul_q15_(_e6, level_q11_);
    p_2 = (_e7 - 32730);
    int _e10 = p_2;
    int _e11 = fxs_mul_q15_(_e10, level_q11_);
    p_2 = (_e11 + 32767);
    int _e14 = p_2;
    int _e15 = p_2;
    int _e16 = fxs_mul_q15_(_e14, _e15);
    p_2 = _e16;
    int _e17 = p_2;
    int _e18 = p_2;
    int _e19 = fxs_mul_q15_(_e17, _e18);
    p_2 = _e19;
    int _e20 = p_2;
    int _e21 = p_2;
    int _e22 = fxs_mul_q15_(_e20, _e21);
    p_2 = _e22;
    int _e23 = p_2;
    int _e25 = fxs_min(_e23, FXS_ALPHA_MAX_Q15_);
    return _e25;
}
int fxs_weight_q15_(int alpha_q15_, int transmittance_q15_) {
    int _e2 = fxs_mul_q15_(alpha_q15_, transmittance_q15_);
    return _e2;
}
int fxs_accumulate_q13_(int sum_q13_, int weight_q15_, int colour_q13_) {
    int _e3 = fxs_mul_q15_(weight_q15_, colour_q13_);
    int _e6 = fxs_min((sum_q13_ + _e3), 32767);
    return _e6;
}
int fxs_resolve_8bit(int sum_q13_1, int transmittance_q15_1, int background_q13_) {
    int _e3 = fxs_accumulate_q13_(sum_q13_1, transmittance_q15_1, background_q13_);
    int _e11 = fxs_min((((_e3 * 255) + 4096) >> 13u), 255);
    return _e11;
}
int fxs_coverage_8bit(int transmittance_q15_2) {
    return ((((FXS_CLEAR_Q15_ - transmittance_q15_2) * 255) + 16384) >> 15u);
}
uint classes_before(uint number, uvec4 sizes, inout uint start, inout uint all_) {
    uint _e4 = all_;
    uint w = (_e4 + sizes.w);
    uint z = (w + sizes.z);
    uint y = (z + sizes.y);
    uint x = (y + sizes.x);
    uvec4 ends = uvec4(x, y, z, w);
    uvec4 before = mix(uvec4(0u), uvec4(1u), greaterThanEqual(uvec4(number), ends));
    uvec4 last = (before * ends);
    all_ = x;
    uint _e22 = start;
    start = max(_e22, max(max(last.x, last.y), max(last.z, last.w)));
    return (((before.x + before.y) + before.z) + before.w);
}
uvec4 class_sizes(uint first_1) {
    uint at_2 = (CLASS_COUNTS + first_1);
    uint _e5 = _group_1_binding_0_cs[at_2];
    uint _e10 = _group_1_binding_0_cs[(at_2 + 1u)];
    uint _e15 = _group_1_binding_0_cs[(at_2 + 2u)];
    uint _e20 = _group_1_binding_0_cs[(at_2 + 3u)];
    return uvec4(_e5, _e10, _e15, _e20);
}
uint tile_at(uint number_1) {
    uint start_1 = 0u;
    uint all_1 = 0u;
    uvec4 _e2 = class_sizes(12u);
    uvec4 _e4 = class_sizes(8u);
    uvec4 _e6 = class_sizes(4u);
    uvec4 _e8 = class_sizes(0u);
    uint _e13 = classes_before(number_1, _e2, start_1, all_1);
    uint _e14 = classes_before(number_1, _e4, start_1, all_1);
    uint _e16 = classes_before(number_1, _e6, start_1, all_1);
    uint _e18 = classes_before(number_1, _e8, start_1, all_1);
    uint before_1 = (((_e13 + _e14) + _e16) + _e18);
    if ((before_1 == CLASSES)) {
        return NOTHING;
    }
    uint _e26 = _group_0_binding_0_cs.classes;
    int _e32 = _group_0_binding_0_cs.tiles.x;
    int _e36 = _group_0_binding_0_cs.tiles.y;
    uint _e42 = start_1;
    uint _e45 = _group_1_binding_0_cs[(((_e26 + ((15u - before_1) * uint((_e32 * _e36)))) + number_1) - _e42)];
    return _e45;
}
bool fits() {
    bool local_5 = false;
    bool local_6 = false;
    uint _e2 = _group_1_binding_0_cs[2];
    uint _e5 = _group_0_binding_0_cs.page_room;
    if ((_e2 <= _e5)) {
        uint _e11 = _group_1_binding_0_cs[1];
        uint _e14 = _group_0_binding_0_cs.large_room;
        local_5 = (_e11 <= _e14);
    } else {
        local_5 = false;
    }
    bool _e17 = local_5;
    if (_e17) {
        uint _e22 = _group_1_binding_0_cs[0];
        uint _e25 = _group_0_binding_0_cs.chunk_room;
        local_6 = (_e22 <= _e25);
    } else {
        local_6 = false;
    }
    bool _e28 = local_6;
    return _e28;
}
uvec2 fetch_entry(Half h, uint i_1) {
    if ((i_1 < h.count)) {
        uvec2 _e8 = _group_1_binding_1_cs[(h.list + i_1)];
        return _e8;
    }
    return uvec2(4294967295u, 4294967295u);
}
Fetched fetch_splat(uvec2 entry_1) {
    Fetched f = Fetched(uvec2(0u), uvec4(0u), uvec4(0u));
    f.entry = entry_1;
    if (((entry_1.x & CUT_OFF) == 0u)) {
        uvec4 _e14 = _group_1_binding_2_cs[(2u * entry_1.x)];
        f.a = _e14;
        uvec4 _e23 = _group_1_binding_2_cs[((2u * entry_1.x) + 1u)];
        f.b = _e23;
    }
    Fetched _e24 = f;
    return _e24;
}
bool reaches(uint u, uint ux, uint open_1, int level, int limit) {
    bool local_7 = false;
    int left = int((u + (min(uint(findLSB(open_1)), 32u) * ux)));
    int right = int((u + ((31u - uint(31 - findMSB(open_1))) * ux)));
    if ((open_1 != 0u)) {
        int _e23 = fxs_coordinate_q13_(max(max(left, -(right)), 0));
        int _e24 = fxs_level_q11_(_e23, level);
        local_7 = (_e24 <= limit);
    } else {
        local_7 = false;
    }
    bool _e27 = local_7;
    return _e27;
}
bvec2 touch(Fetched f_1, Half h_1) {
    uint u_1 = 0u;
    uint v = 0u;
    bvec2 touches = bvec2(false);
    uint row = 0u;
    int offset_q11_2 = int((f_1.b.y & 65535u));
    int _e9 = _group_0_binding_0_cs.cut_q11_;
    int _e10 = fxs_limit_q11_(offset_q11_2, _e9);
    uint ux_1 = f_1.a.z;
    uint first_2 = (max((f_1.b.w & 65535u), h_1.y) - h_1.y);
    uint last_1 = min((max((f_1.b.w >> 16u), h_1.y) - h_1.y), 7u);
    u_1 = ((f_1.a.x + (h_1.x * ux_1)) + ((h_1.y + first_2) * f_1.a.w));
    v = (f_1.a.y + ((h_1.y + first_2) * f_1.b.x));
    row = first_2;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e93 = row;
            row = (_e93 + 1u);
        }
        loop_init = false;
        uint _e56 = row;
        if ((_e56 <= last_1)) {
        } else {
            break;
        }
        {
            uint _e59 = row;
            uint _e63 = open_pixels[(_e59 / 2u)];
            uint _e65 = row;
            uint open_3 = (_e63 >> (16u * (_e65 % 2u)));
            uint _e70 = v;
            int _e72 = fxs_coordinate_q13_(int(_e70));
            int _e73 = fxs_row_level_q11_(_e72, offset_q11_2);
            bvec2 _e74 = touches;
            uint _e75 = u_1;
            bool _e78 = reaches(_e75, ux_1, (open_3 & 255u), _e73, _e10);
            uint _e79 = u_1;
            bool _e82 = reaches(_e79, ux_1, (open_3 & 65280u), _e73, _e10);
            touches = bvec2(_e74.x || bvec2(_e78, _e82).x, _e74.y || bvec2(_e78, _e82).y);
            uint _e85 = u_1;
            u_1 = (_e85 + f_1.a.w);
            uint _e89 = v;
            v = (_e89 + f_1.b.x);
        }
    }
    bvec2 _e96 = touches;
    return _e96;
}
Taken take(uint i_2, uint row_1) {
    uvec4 shape = shapes[i_2];
    uvec4 shade = shades[i_2];
    int v_1 = int((shape.y + (row_1 * shade.x)));
    int _e18 = fxs_coordinate_q13_(v_1);
    int _e23 = fxs_row_level_q11_(_e18, int((shade.y & 65535u)));
    return Taken((shape.x + (row_1 * shape.w)), shape.z, _e23, int(shade.w), ivec3(uvec3((shade.y >> 16u), (shade.z & 65535u), (shade.z >> 16u))));
}
int blend_splat(inout Pixel p_3, Taken t, uint column) {
    bool local_8 = false;
    int _e8 = fxs_coordinate_q13_(int((t.u + (column * t.ux))));
    int _e9 = fxs_mul_q15_(_e8, _e8);
    int level_1 = (_e9 + t.level);
    if ((level_1 <= t.limit)) {
        int _e17 = p_3.transmittance;
        local_8 = (_e17 >= FXS_CLOSED_Q15_);
    } else {
        local_8 = false;
    }
    bool counts_1 = local_8;
    int _e22 = fxs_alpha_q15_(level_1);
    int _e24 = p_3.transmittance;
    int _e25 = fxs_weight_q15_(_e22, _e24);
    int weight = (counts_1 ? _e25 : 0);
    int _e29 = p_3.transmittance;
    p_3.transmittance = (_e29 - weight);
    ivec3 _e32 = p_3.sum;
    int _e35 = fxs_mul_q15_(weight, t.colour.x);
    int _e38 = fxs_mul_q15_(weight, t.colour.y);
    int _e41 = fxs_mul_q15_(weight, t.colour.z);
    p_3.sum = (_e32 + ivec3(_e35, _e38, _e41));
    return weight;
}
ivec3 background_of(uint word_1) {
    uvec3 rgb = uvec3((word_1 & 255u), ((word_1 >> 8u) & 255u), ((word_1 >> 16u) & 255u));
    return ivec3((((rgb * 8192u) + uvec3(127u)) / uvec3(255u)));
}
void put_colour(inout Pixel p_4, uint at) {
    ivec3 background_q13_1 = ivec3(0);
    uint word_2 = 0u;
    ivec3 _e3 = p_4.sum;
    ivec3 sum = min(_e3, ivec3(32767));
    int transmittance = p_4.transmittance;
    uint _e11 = _group_0_binding_0_cs.format;
    if ((_e11 == 3u)) {
        uvec3 rgb_1 = uvec3(min((((sum * 65535) + ivec3(4096)) >> uvec3(13u)), ivec3(65535)));
        uint alpha = uint(((((FXS_CLEAR_Q15_ - transmittance) * 65535) + 16384) >> 15u));
        uint _e38 = _group_0_binding_0_cs.colour;
        _group_1_binding_3_cs[(_e38 + (2u * at))] = (rgb_1.x | (rgb_1.y << 16u));
        uint _e51 = _group_0_binding_0_cs.colour;
        _group_1_binding_3_cs[((_e51 + (2u * at)) + 1u)] = (rgb_1.z | (alpha << 16u));
        return;
    }
    ivec4 _e64 = _group_0_binding_0_cs.background_q13_;
    background_q13_1 = _e64.xyz;
    uint _e69 = _group_0_binding_0_cs.backdrop;
    if ((_e69 != NOTHING)) {
        uint _e75 = _group_0_binding_0_cs.backdrop;
        uint _e78 = _group_1_binding_3_cs[(_e75 + at)];
        ivec3 _e79 = background_of(_e78);
        background_q13_1 = _e79;
    }
    int _e82 = background_q13_1.x;
    int _e83 = fxs_resolve_8bit(sum.x, transmittance, _e82);
    uint r = uint(_e83);
    int _e87 = background_q13_1.y;
    int _e88 = fxs_resolve_8bit(sum.y, transmittance, _e87);
    uint g = uint(_e88);
    int _e92 = background_q13_1.z;
    int _e93 = fxs_resolve_8bit(sum.z, transmittance, _e92);
    uint b_2 = uint(_e93);
    word_2 = (((r | (g << 8u)) | (b_2 << 16u)) | 4278190080u);
    uint _e106 = _group_0_binding_0_cs.format;
    if ((_e106 == 1u)) {
        uint _e109 = word_2;
        int _e112 = fxs_coverage_8bit(transmittance);
        word_2 = ((_e109 & 16777215u) | (uint(_e112) << 24u));
    }
    uint _e119 = _group_0_binding_0_cs.format;
    if ((_e119 == 2u)) {
        word_2 = ((((((r * 31u) + 127u) / 255u) << 11u) | ((((g * 63u) + 127u) / 255u) << 5u)) | (((b_2 * 31u) + 127u) / 255u));
    }
    uint _e149 = _group_0_binding_0_cs.colour;
    uint _e152 = word_2;
    _group_1_binding_3_cs[(_e149 + at)] = _e152;
    return;
}
uint list_of(uint tile, uint count) {
    uint merges = ((max((32u - uint(31 - findMSB((max(count, 1u) - 1u)))), 9u) - 6u) / 4u);
    uint _e18 = _group_0_binding_0_cs.next;
    uint _e21 = _group_1_binding_0_cs[(_e18 + tile)];
    uint _e26 = _group_0_binding_0_cs.spare;
    return ((_e21 - count) + (((merges % 2u) == 1u) ? _e26 : 0u));
}
Half half_tile_of(uvec3 group_2) {
    bool local_9 = false;
    uint number_2 = ((group_2.y * ROW_OF_GROUPS) + group_2.x);
    int _e9 = _group_0_binding_0_cs.tiles.x;
    uint across = uint(_e9);
    uint _e13 = _group_0_binding_0_cs.tile_bits;
    uint of_tile = (_e13 - 3u);
    uint _e17 = tile_at((number_2 >> of_tile));
    if (!((_e17 == NOTHING))) {
        bool _e23 = fits();
        local_9 = !(_e23);
    } else {
        local_9 = true;
    }
    bool _e26 = local_9;
    if (_e26) {
        return Half(4294967295u, 0u, 0u, 0u, 0u);
    }
    uint count_1 = _group_1_binding_0_cs[(TILES + _e17)];
    uint _e41 = _group_0_binding_0_cs.tile_bits;
    uint _e46 = _group_0_binding_0_cs.tile_bits;
    uint _e52 = list_of(_e17, count_1);
    return Half(_e17, ((_e17 % across) << _e41), (((_e17 / across) << _e46) + ((number_2 & of_tile) * SIDE)), _e52, count_1);
}
Place place_of(Half h_2, uint thread_2) {
    uint _e4 = _group_0_binding_0_cs.tile_bits;
    bool pairs = (_e4 > 3u);
    uint column_1 = (pairs ? (((thread_2 / 32u) * SIDE) + (thread_2 % APART)) : (thread_2 % SIDE));
    uint row_3 = (pairs ? ((thread_2 % 32u) / APART) : (thread_2 / SIDE));
    uvec2 x_1 = (uvec2(h_2.x) + uvec2(column_1, (column_1 + APART)));
    int _e35 = _group_0_binding_0_cs.size.x;
    int _e48 = _group_0_binding_0_cs.size.x;
    int _e57 = _group_0_binding_0_cs.size.y;
    return Place(column_1, row_3, ((((h_2.y + row_3) * uint(_e35)) + h_2.x) + column_1), ((column_1 / SIDE) * 2u), bvec2(bvec2(lessThan(x_1, uvec2(uint(_e48))).x && bvec2(((h_2.y + row_3) < uint(_e57))).x, lessThan(x_1, uvec2(uint(_e48))).y && bvec2(((h_2.y + row_3) < uint(_e57))).y).x && bvec2(true, pairs).x, bvec2(lessThan(x_1, uvec2(uint(_e48))).x && bvec2(((h_2.y + row_3) < uint(_e57))).x, lessThan(x_1, uvec2(uint(_e48))).y && bvec2(((h_2.y + row_3) < uint(_e57))).y).y && bvec2(true, pairs).y));
}
uint bit_of(Place place, bool second) {
    return (1u << ((((place.row % 2u) * 16u) + place.column) + (second ? APART : 0u)));
}
void clear_rounds(uint thread_3, Place place_1) {
    if ((thread_3 < 4u)) {
        open_pixels[thread_3] = 0u;
    }
    if ((thread_3 < 8u)) {
        touching[thread_3] = 0u;
    }
    if ((thread_3 == 0u)) {
        open_round = 0u;
    }
    memoryBarrierShared();
    barrier();
    uint _e23 = bit_of(place_1, false);
    uint _e29 = bit_of(place_1, true);
    uint _e34 = atomicOr(open_pixels[(place_1.row / 2u)], ((place_1.inside.x ? _e23 : 0u) | (place_1.inside.y ? _e29 : 0u)));
    memoryBarrierShared();
    barrier();
    return;
}
void close_pixel(Place place_2, bool second_1) {
    uint _e7 = bit_of(place_2, second_1);
    uint _e9 = atomicAnd(open_pixels[(place_2.row / 2u)], ~(_e7));
    return;
}
void put_splat(Half h_3, uint thread_4, Fetched f_2) {
    int _e10 = _group_0_binding_0_cs.cut_q11_;
    int _e11 = fxs_limit_q11_(int((f_2.b.y & 65535u)), _e10);
    shapes[thread_4] = uvec4(((f_2.a.x + (h_3.x * f_2.a.z)) + (h_3.y * f_2.a.w)), (f_2.a.y + (h_3.y * f_2.b.x)), f_2.a.zw);
    shades[thread_4] = uvec4(f_2.b.xyz, uint(_e11));
    return;
}
void place_splat(Half h_4, uint thread_5, Fetched f_3, uint words) {
    if (((f_3.entry.x & CUT_OFF) != 0u)) {
        return;
    }
    put_splat(h_4, thread_5, f_3);
    bvec2 _e10 = touch(f_3, h_4);
    if (_e10.x) {
        uint _e21 = atomicOr(touching[(words + (thread_5 / 32u))], (1u << (thread_5 % 32u)));
    }
    if (_e10.y) {
        uint _e34 = atomicOr(touching[((words + 2u) + (thread_5 / 32u))], (1u << (thread_5 % 32u)));
        return;
    } else {
        return;
    }
}
void put_pixel(inout Pixel p_5, uint at_1) {
    uint _e4 = _group_0_binding_0_cs.colour;
    if ((_e4 != NOTHING)) {
        put_colour(p_5, at_1);
    }
    uint _e9 = _group_0_binding_0_cs.coverage;
    if ((_e9 != NOTHING)) {
        uint _e15 = _group_0_binding_0_cs.coverage;
        int _e19 = p_5.transmittance;
        int _e20 = fxs_coverage_8bit(_e19);
        _group_1_binding_3_cs[(_e15 + at_1)] = uint(_e20);
        return;
    } else {
        return;
    }
}
void blend_round(inout Pixel p_6, inout Pixel q_1, Place place_3, uint words_1) {
    uint word_3 = 0u;
    uint bits = 0u;
    Taken next = Taken(0u, 0u, 0, 0, ivec3(0));
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e58 = word_3;
            word_3 = (_e58 + 1u);
        }
        loop_init_1 = false;
        uint _e6 = word_3;
        if ((_e6 < 2u)) {
        } else {
            break;
        }
        {
            uint _e12 = word_3;
            uint _e15 = touching[((words_1 + place_3.words) + _e12)];
            bits = _e15;
            uint _e18 = word_3;
            uint _e20 = bits;
            Taken _e26 = take(((32u * _e18) + (min(uint(findLSB(_e20)), 32u) % 32u)), place_3.row);
            next = _e26;
            while(true) {
                uint _e28 = bits;
                if ((_e28 != 0u)) {
                } else {
                    break;
                }
                {
                    Taken taken = next;
                    uint _e32 = bits;
                    uint _e33 = bits;
                    bits = (_e32 & (_e33 - 1u));
                    uint _e38 = word_3;
                    uint _e40 = bits;
                    Taken _e46 = take(((32u * _e38) + (min(uint(findLSB(_e40)), 32u) % 32u)), place_3.row);
                    next = _e46;
                    int _e48 = blend_splat(p_6, taken, place_3.column);
                    uint _e51 = _group_0_binding_0_cs.tile_bits;
                    if ((_e51 > 3u)) {
                        int _e57 = blend_splat(q_1, taken, (place_3.column + APART));
                    }
                }
            }
        }
    }
    return;
}
void mark_pixels(Half h_5, uint thread_6, Fetched f_4) {
    uint row_2 = 0u;
    uint open_2 = 0u;
    bool local_10 = false;
    if (((f_4.entry.x & CUT_OFF) != 0u)) {
        return;
    }
    put_splat(h_5, thread_6, f_4);
    uint _e12 = shades[thread_6].w;
    int limit_1 = int(_e12);
    uint first_3 = (max((f_4.b.w & 65535u), h_5.y) - h_5.y);
    uint last_2 = min((max((f_4.b.w >> 16u), h_5.y) - h_5.y), 7u);
    row_2 = first_3;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e93 = row_2;
            row_2 = (_e93 + 1u);
        }
        loop_init_2 = false;
        uint _e33 = row_2;
        if ((_e33 <= last_2)) {
        } else {
            break;
        }
        {
            uint _e35 = row_2;
            Taken _e36 = take(thread_6, _e35);
            uint _e38 = row_2;
            uint _e42 = open_pixels[(_e38 / 2u)];
            uint _e44 = row_2;
            open_2 = ((_e42 >> (16u * (_e44 % 2u))) & 255u);
            bool loop_init_3 = true;
            while(true) {
                if (!loop_init_3) {
                    uint _e88 = open_2;
                    uint _e89 = open_2;
                    open_2 = (_e88 & (_e89 - 1u));
                }
                loop_init_3 = false;
                uint _e52 = open_2;
                if ((_e52 != 0u)) {
                    local_10 = (_e36.level <= limit_1);
                } else {
                    local_10 = false;
                }
                bool _e60 = local_10;
                if (_e60) {
                } else {
                    break;
                }
                {
                    uint _e61 = open_2;
                    uint column_2 = min(uint(findLSB(_e61)), 32u);
                    int _e68 = fxs_coordinate_q13_(int((_e36.u + (column_2 * _e36.ux))));
                    int _e70 = fxs_level_q11_(_e68, _e36.level);
                    if ((_e70 <= limit_1)) {
                        uint _e75 = row_2;
                        uint _e87 = atomicOr(masks[((2u * ((SIDE * _e75) + column_2)) + (thread_6 / 32u))], (1u << (thread_6 % 32u)));
                    }
                }
            }
        }
    }
    return;
}
void blend_crowd(inout Pixel p_7, Place place_4) {
    uint word_4 = 0u;
    uint bits_1 = 0u;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e39 = word_4;
            word_4 = (_e39 + 1u);
        }
        loop_init_4 = false;
        uint _e4 = word_4;
        if ((_e4 < 2u)) {
        } else {
            break;
        }
        {
            uint _e15 = word_4;
            uint _e19 = atomicExchange(masks[((2u * ((SIDE * place_4.row) + place_4.column)) + _e15)], 0u);
            bits_1 = _e19;
            bool loop_init_5 = true;
            while(true) {
                if (!loop_init_5) {
                    uint _e34 = bits_1;
                    uint _e35 = bits_1;
                    bits_1 = (_e34 & (_e35 - 1u));
                }
                loop_init_5 = false;
                uint _e21 = bits_1;
                if ((_e21 != 0u)) {
                } else {
                    break;
                }
                {
                    uint _e25 = word_4;
                    uint _e27 = bits_1;
                    Taken _e31 = take(((32u * _e25) + min(uint(findLSB(_e27)), 32u)), place_4.row);
                    int _e33 = blend_splat(p_7, _e31, place_4.column);
                }
            }
        }
    }
    return;
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    bool local = false;
    Pixel p = Pixel(0, ivec3(0));
    Pixel q = Pixel(0, ivec3(0));
    bvec2 open = bvec2(false);
    Fetched fetched = Fetched(uvec2(0u), uvec4(0u), uvec4(0u));
    uvec2 entry = uvec2(0u);
    uint first = 0u;
    bool local_1 = false;
    bool local_2 = false;
    Half _e2 = half_tile_of(group);
    if ((_e2.tile == NOTHING)) {
        return;
    }
    Place _e6 = place_of(_e2, thread);
    uint _e9 = _group_0_binding_0_cs.tile_bits;
    if ((_e9 == 3u)) {
        local = (_e2.count >= CROWD);
    } else {
        local = false;
    }
    bool crowded = local;
    p = Pixel((_e6.inside.x ? FXS_CLEAR_Q15_ : 0), ivec3(0));
    q = Pixel((_e6.inside.y ? FXS_CLEAR_Q15_ : 0), ivec3(0));
    open = _e6.inside;
    uvec2 _e39 = fetch_entry(_e2, thread);
    Fetched _e40 = fetch_splat(_e39);
    fetched = _e40;
    uvec2 _e44 = fetch_entry(_e2, (SOME + thread));
    entry = _e44;
    masks[thread] = 0u;
    masks[(64u + thread)] = 0u;
    clear_rounds(thread, _e6);
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e117 = first;
            first = (_e117 + SOME);
        }
        loop_init_6 = false;
        uint _e56 = first;
        if ((_e56 < _e2.count)) {
        } else {
            break;
        }
        {
            uint _e59 = first;
            uint round_ = ((_e59 / SOME) + 1u);
            uint words_2 = (4u * (round_ % 2u));
            bvec2 _e68 = open;
            if (any(_e68)) {
                open_round = round_;
            }
            if (crowded) {
                Fetched _e71 = fetched;
                mark_pixels(_e2, thread, _e71);
            } else {
                Fetched _e72 = fetched;
                place_splat(_e2, thread, _e72, words_2);
            }
            uvec2 _e73 = entry;
            Fetched _e74 = fetch_splat(_e73);
            fetched = _e74;
            uint _e75 = first;
            uvec2 _e79 = fetch_entry(_e2, ((_e75 + 128u) + thread));
            entry = _e79;
            memoryBarrierShared();
            barrier();
            uint _e81 = open_round;
            memoryBarrierShared();
            barrier();
            if ((_e81 != round_)) {
                break;
            }
            if ((thread < 4u)) {
                touching[((4u - words_2) + thread)] = 0u;
            }
            if (crowded) {
                blend_crowd(p, _e6);
            } else {
                blend_round(p, q, _e6, words_2);
            }
            bool _e92 = open.x;
            if (_e92) {
                int _e96 = p.transmittance;
                local_1 = (_e96 < FXS_CLOSED_Q15_);
            } else {
                local_1 = false;
            }
            bool _e100 = local_1;
            if (_e100) {
                open.x = false;
                close_pixel(_e6, false);
            }
            bool _e105 = open.y;
            if (_e105) {
                int _e109 = q.transmittance;
                local_2 = (_e109 < FXS_CLOSED_Q15_);
            } else {
                local_2 = false;
            }
            bool _e113 = local_2;
            if (_e113) {
                open.y = false;
                close_pixel(_e6, true);
            }
            memoryBarrierShared();
            barrier();
        }
    }
    if (_e6.inside.x) {
        put_pixel(p, _e6.at);
    }
    if (_e6.inside.y) {
        put_pixel(q, (_e6.at + APART));
        return;
    } else {
        return;
    }
}
