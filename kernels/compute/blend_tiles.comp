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
    int p_1 = 0;
    int _e2 = fxs_mul_q15_(-4236, level_q11_);
    p_1 = (_e2 + 16016);
    int _e6 = p_1;
    int _e7 = fxs_mul_q15_(_e6, level_q11_);
    p_1 = (_e7 - 32730);
    int _e10 = p_1;
    int _e11 = fxs_mul_q15_(_e10, level_q11_);
    p_1 = (_e11 + 32767);
    int _e14 = p_1;
    int _e15 = p_1;
    int _e16 = fxs_mul_q15_(_e14, _e15);
    p_1 = _e16;
    int _e17 = p_1;
    int _e18 = p_1;
    int _e19 = fxs_mul_q15_(_e17, _e18);
    p_1 = _e19;
    int _e20 = p_1;
    int _e21 = p_1;
    int _e22 = fxs_mul_q15_(_e20, _e21);
    p_1 = _e22;
    int _e23 = p_1;
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
    bool local_2 = false;
    bool local_3 = false;
    uint _e2 = _group_1_binding_0_cs[2];
    uint _e5 = _group_0_binding_0_cs.page_room;
    if ((_e2 <= _e5)) {
        uint _e11 = _group_1_binding_0_cs[1];
        uint _e14 = _group_0_binding_0_cs.large_room;
        local_2 = (_e11 <= _e14);
    } else {
        local_2 = false;
    }
    bool _e17 = local_2;
    if (_e17) {
        uint _e22 = _group_1_binding_0_cs[0];
        uint _e25 = _group_0_binding_0_cs.chunk_room;
        local_3 = (_e22 <= _e25);
    } else {
        local_3 = false;
    }
    bool _e28 = local_3;
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
    bool local_4 = false;
    int left = int((u + (min(uint(findLSB(open_1)), 32u) * ux)));
    int right = int((u + ((31u - uint(31 - findMSB(open_1))) * ux)));
    if ((open_1 != 0u)) {
        int _e23 = fxs_coordinate_q13_(max(max(left, -(right)), 0));
        int _e24 = fxs_level_q11_(_e23, level);
        local_4 = (_e24 <= limit);
    } else {
        local_4 = false;
    }
    bool _e27 = local_4;
    return _e27;
}
bvec2 place_splat(uint i_2, Fetched f_1, Half h_1) {
    uint u_1 = 0u;
    uint v = 0u;
    bvec2 touches = bvec2(false);
    uint row = 0u;
    int offset_q11_2 = int((f_1.b.y & 65535u));
    int _e10 = _group_0_binding_0_cs.cut_q11_;
    int _e11 = fxs_limit_q11_(offset_q11_2, _e10);
    uint ux_1 = f_1.a.z;
    uvec2 at_3 = uvec2(((f_1.a.x + (h_1.x * ux_1)) + (h_1.y * f_1.a.w)), (f_1.a.y + (h_1.y * f_1.b.x)));
    uint first_2 = (max((f_1.b.w & 65535u), h_1.y) - h_1.y);
    uint last_1 = min((max((f_1.b.w >> 16u), h_1.y) - h_1.y), 7u);
    u_1 = (at_3.x + (first_2 * f_1.a.w));
    v = (at_3.y + (first_2 * f_1.b.x));
    shapes[i_2] = uvec4(at_3, ux_1, f_1.a.w);
    shades[i_2] = uvec4(f_1.b.xyz, uint(_e11));
    row = first_2;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e114 = row;
            row = (_e114 + 1u);
        }
        loop_init = false;
        uint _e77 = row;
        if ((_e77 <= last_1)) {
        } else {
            break;
        }
        {
            uint _e80 = row;
            uint _e84 = open_pixels[(_e80 / 2u)];
            uint _e86 = row;
            uint open_2 = (_e84 >> (16u * (_e86 % 2u)));
            uint _e91 = v;
            int _e93 = fxs_coordinate_q13_(int(_e91));
            int _e94 = fxs_row_level_q11_(_e93, offset_q11_2);
            bvec2 _e95 = touches;
            uint _e96 = u_1;
            bool _e99 = reaches(_e96, ux_1, (open_2 & 255u), _e94, _e11);
            uint _e100 = u_1;
            bool _e103 = reaches(_e100, ux_1, (open_2 & 65280u), _e94, _e11);
            touches = bvec2(_e95.x || bvec2(_e99, _e103).x, _e95.y || bvec2(_e99, _e103).y);
            uint _e106 = u_1;
            u_1 = (_e106 + f_1.a.w);
            uint _e110 = v;
            v = (_e110 + f_1.b.x);
        }
    }
    bvec2 _e117 = touches;
    return _e117;
}
Taken take(uint i_3, uint row_1) {
    uvec4 shape = shapes[i_3];
    uvec4 shade = shades[i_3];
    int v_1 = int((shape.y + (row_1 * shade.x)));
    int _e18 = fxs_coordinate_q13_(v_1);
    int _e23 = fxs_row_level_q11_(_e18, int((shade.y & 65535u)));
    return Taken((shape.x + (row_1 * shape.w)), shape.z, _e23, int(shade.w), ivec3(uvec3((shade.y >> 16u), (shade.z & 65535u), (shade.z >> 16u))));
}
int blend_splat(inout Pixel p_2, Taken t, uint column) {
    bool local_5 = false;
    int _e8 = fxs_coordinate_q13_(int((t.u + (column * t.ux))));
    int _e10 = fxs_level_q11_(_e8, t.level);
    if ((_e10 <= t.limit)) {
        int _e16 = p_2.transmittance;
        local_5 = (_e16 >= FXS_CLOSED_Q15_);
    } else {
        local_5 = false;
    }
    bool counts_1 = local_5;
    int _e21 = fxs_alpha_q15_(_e10);
    int _e23 = p_2.transmittance;
    int _e24 = fxs_weight_q15_(_e21, _e23);
    int weight = (counts_1 ? _e24 : 0);
    int _e28 = p_2.transmittance;
    p_2.transmittance = (_e28 - weight);
    ivec3 _e31 = p_2.sum;
    int _e34 = fxs_mul_q15_(weight, t.colour.x);
    int _e37 = fxs_mul_q15_(weight, t.colour.y);
    int _e40 = fxs_mul_q15_(weight, t.colour.z);
    p_2.sum = (_e31 + ivec3(_e34, _e37, _e40));
    return weight;
}
ivec3 background_of(uint word_2) {
    uvec3 rgb = uvec3((word_2 & 255u), ((word_2 >> 8u) & 255u), ((word_2 >> 16u) & 255u));
    return ivec3((((rgb * 8192u) + uvec3(127u)) / uvec3(255u)));
}
void put_colour(inout Pixel p_3, uint at) {
    ivec3 background_q13_1 = ivec3(0);
    uint word_3 = 0u;
    ivec3 _e3 = p_3.sum;
    ivec3 sum = min(_e3, ivec3(32767));
    int transmittance = p_3.transmittance;
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
    word_3 = (((r | (g << 8u)) | (b_2 << 16u)) | 4278190080u);
    uint _e106 = _group_0_binding_0_cs.format;
    if ((_e106 == 1u)) {
        uint _e109 = word_3;
        int _e112 = fxs_coverage_8bit(transmittance);
        word_3 = ((_e109 & 16777215u) | (uint(_e112) << 24u));
    }
    uint _e119 = _group_0_binding_0_cs.format;
    if ((_e119 == 2u)) {
        word_3 = ((((((r * 31u) + 127u) / 255u) << 11u) | ((((g * 63u) + 127u) / 255u) << 5u)) | (((b_2 * 31u) + 127u) / 255u));
    }
    uint _e149 = _group_0_binding_0_cs.colour;
    uint _e152 = word_3;
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
Half half_tile_of(uvec3 group_1) {
    bool local_6 = false;
    uint number_2 = ((group_1.y * ROW_OF_GROUPS) + group_1.x);
    int _e9 = _group_0_binding_0_cs.tiles.x;
    uint across = uint(_e9);
    uint _e13 = _group_0_binding_0_cs.tile_bits;
    uint of_tile = (_e13 - 3u);
    uint _e17 = tile_at((number_2 >> of_tile));
    if (!((_e17 == NOTHING))) {
        bool _e23 = fits();
        local_6 = !(_e23);
    } else {
        local_6 = true;
    }
    bool _e26 = local_6;
    if (_e26) {
        return Half(4294967295u, 0u, 0u, 0u, 0u);
    }
    uint count_1 = _group_1_binding_0_cs[(TILES + _e17)];
    uint _e41 = _group_0_binding_0_cs.tile_bits;
    uint _e46 = _group_0_binding_0_cs.tile_bits;
    uint _e52 = list_of(_e17, count_1);
    return Half(_e17, ((_e17 % across) << _e41), (((_e17 / across) << _e46) + ((number_2 & of_tile) * SIDE)), _e52, count_1);
}
Place place_of(Half h_2, uint thread_1) {
    uint column_1 = (((thread_1 / 32u) * SIDE) + (thread_1 % APART));
    uint row_2 = ((thread_1 % 32u) / APART);
    uvec2 x_1 = (uvec2(h_2.x) + uvec2(column_1, (column_1 + APART)));
    int _e24 = _group_0_binding_0_cs.size.x;
    int _e33 = _group_0_binding_0_cs.size.x;
    uint _e39 = _group_0_binding_0_cs.tile_bits;
    int _e50 = _group_0_binding_0_cs.size.y;
    return Place(column_1, row_2, ((((h_2.y + row_2) * uint(_e24)) + h_2.x) + column_1), bvec2(lessThan(x_1, uvec2(min(uint(_e33), (h_2.x + (1u << _e39))))).x && bvec2(((h_2.y + row_2) < uint(_e50))).x, lessThan(x_1, uvec2(min(uint(_e33), (h_2.x + (1u << _e39))))).y && bvec2(((h_2.y + row_2) < uint(_e50))).y));
}
uint bit_of(Place place, bool second) {
    return (1u << ((((place.row % 2u) * 16u) + place.column) + (second ? APART : 0u)));
}
void clear_rounds(uint thread_2, Place place_1) {
    if ((thread_2 < 4u)) {
        open_pixels[thread_2] = 0u;
    }
    if ((thread_2 < 8u)) {
        touching[thread_2] = 0u;
    }
    if ((thread_2 == 0u)) {
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
void place_fetched(Half h_3, uint thread_3, Fetched f_2, uint words) {
    if (((f_2.entry.x & CUT_OFF) == 0u)) {
        bvec2 _e10 = place_splat(thread_3, f_2, h_3);
        if (_e10.x) {
            uint _e21 = atomicOr(touching[(words + (thread_3 / 32u))], (1u << (thread_3 % 32u)));
        }
        if (_e10.y) {
            uint _e34 = atomicOr(touching[((words + 2u) + (thread_3 / 32u))], (1u << (thread_3 % 32u)));
            return;
        } else {
            return;
        }
    } else {
        return;
    }
}
void put_pixel(inout Pixel p_4, uint at_1) {
    uint _e4 = _group_0_binding_0_cs.colour;
    if ((_e4 != NOTHING)) {
        put_colour(p_4, at_1);
    }
    uint _e9 = _group_0_binding_0_cs.coverage;
    if ((_e9 != NOTHING)) {
        uint _e15 = _group_0_binding_0_cs.coverage;
        int _e19 = p_4.transmittance;
        int _e20 = fxs_coverage_8bit(_e19);
        _group_1_binding_3_cs[(_e15 + at_1)] = uint(_e20);
        return;
    } else {
        return;
    }
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    Pixel p = Pixel(0, ivec3(0));
    Pixel q = Pixel(0, ivec3(0));
    bvec2 open = bvec2(false);
    Fetched fetched = Fetched(uvec2(0u), uvec4(0u), uvec4(0u));
    uvec2 entry = uvec2(0u);
    uint first = 0u;
    uint word = 0u;
    uint bits = 0u;
    Taken next = Taken(0u, 0u, 0, 0, ivec3(0));
    bool local = false;
    bool local_1 = false;
    Half _e2 = half_tile_of(group);
    if ((_e2.tile == NOTHING)) {
        return;
    }
    Place _e6 = place_of(_e2, thread);
    p = Pixel((_e6.inside.x ? FXS_CLEAR_Q15_ : 0), ivec3(0));
    q = Pixel((_e6.inside.y ? FXS_CLEAR_Q15_ : 0), ivec3(0));
    open = _e6.inside;
    uvec2 _e27 = fetch_entry(_e2, thread);
    Fetched _e28 = fetch_splat(_e27);
    fetched = _e28;
    uvec2 _e32 = fetch_entry(_e2, (SOME + thread));
    entry = _e32;
    clear_rounds(thread, _e6);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e151 = first;
            first = (_e151 + SOME);
        }
        loop_init_1 = false;
        uint _e36 = first;
        if ((_e36 < _e2.count)) {
        } else {
            break;
        }
        {
            uint _e39 = first;
            uint round_ = ((_e39 / SOME) + 1u);
            uint words_1 = (4u * (round_ % 2u));
            bvec2 _e48 = open;
            if (any(_e48)) {
                open_round = round_;
            }
            Fetched _e51 = fetched;
            place_fetched(_e2, thread, _e51, words_1);
            uvec2 _e52 = entry;
            Fetched _e53 = fetch_splat(_e52);
            fetched = _e53;
            uint _e54 = first;
            uvec2 _e58 = fetch_entry(_e2, ((_e54 + 128u) + thread));
            entry = _e58;
            memoryBarrierShared();
            barrier();
            uint _e60 = open_round;
            memoryBarrierShared();
            barrier();
            if ((_e60 != round_)) {
                break;
            }
            if ((thread < 4u)) {
                touching[((4u - words_1) + thread)] = 0u;
            }
            word = 0u;
            bool loop_init_2 = true;
            while(true) {
                if (!loop_init_2) {
                    uint _e122 = word;
                    word = (_e122 + 1u);
                }
                loop_init_2 = false;
                uint _e72 = word;
                if ((_e72 < 2u)) {
                } else {
                    break;
                }
                {
                    uint _e81 = word;
                    uint _e84 = touching[((words_1 + ((thread / 32u) * 2u)) + _e81)];
                    bits = _e84;
                    uint _e87 = word;
                    uint _e89 = bits;
                    Taken _e95 = take(((32u * _e87) + (min(uint(findLSB(_e89)), 32u) % 32u)), _e6.row);
                    next = _e95;
                    while(true) {
                        uint _e97 = bits;
                        if ((_e97 != 0u)) {
                        } else {
                            break;
                        }
                        {
                            Taken taken = next;
                            uint _e101 = bits;
                            uint _e102 = bits;
                            bits = (_e101 & (_e102 - 1u));
                            uint _e107 = word;
                            uint _e109 = bits;
                            Taken _e115 = take(((32u * _e107) + (min(uint(findLSB(_e109)), 32u) % 32u)), _e6.row);
                            next = _e115;
                            int _e117 = blend_splat(p, taken, _e6.column);
                            int _e121 = blend_splat(q, taken, (_e6.column + APART));
                        }
                    }
                }
            }
            bool _e126 = open.x;
            if (_e126) {
                int _e130 = p.transmittance;
                local = (_e130 < FXS_CLOSED_Q15_);
            } else {
                local = false;
            }
            bool _e134 = local;
            if (_e134) {
                open.x = false;
                close_pixel(_e6, false);
            }
            bool _e139 = open.y;
            if (_e139) {
                int _e143 = q.transmittance;
                local_1 = (_e143 < FXS_CLOSED_Q15_);
            } else {
                local_1 = false;
            }
            bool _e147 = local_1;
            if (_e147) {
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
