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
    uint unused;
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
struct Quarter {
    uint tile;
    uint x;
    uint y;
    uint list;
    uint count;
};
struct Place {
    uint column;
    uint row;
    uint at;
    bool inside;
};
struct Traced {
    uint limit;
    int weight;
    uint largest;
    uint median;
    uvec2 sum;
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
const uint SPAN = 8u;
const uint PAGE = 4096u;
const uint MERGES = 5u;
const uint BLOCK = 1024u;
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
const uint BLOCKS = 7u;
const uint LONGEST = 8u;
const uint CLASS_COUNTS = 16u;
const uint TILES = 64u;
const int EVERYWHERE_Q8_ = 1073741824;
const uint SIDE = 8u;
const uint SOME = 64u;
const int HALF_Q15_ = 16384;
layout(std430, binding = 0) readonly buffer type_12_block_0Compute { uint _group_1_binding_0_cs[]; };
layout(std140, binding = 0) uniform Frame_block_1Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 1) readonly buffer type_13_block_2Compute { uvec2 _group_1_binding_1_cs[]; };
layout(std430, binding = 2) readonly buffer type_14_block_3Compute { uvec4 _group_1_binding_2_cs[]; };
layout(std430, binding = 3) buffer type_12_block_4Compute { uint _group_1_binding_3_cs[]; };
shared ivec2 rows[512];
shared ivec4 others[64];
shared uint touching[8];
shared uint open_round;
shared uint open_pixels[2];
shared uvec2 own[64];
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
uvec2 add_wide(uvec2 a_2, uvec2 b_2) {
    uint low = (a_2.x + b_2.x);
    return uvec2(low, ((a_2.y + b_2.y) + ((low < a_2.x) ? 1u : 0u)));
}
uvec2 shift_left(uvec2 a_13, uint n) {
    if ((n == 0u)) {
        return a_13;
    }
    if ((n >= 32u)) {
        return uvec2(0u, (a_13.x << (n - 32u)));
    }
    return uvec2((a_13.x << n), ((a_13.y << n) | (a_13.x >> (32u - n))));
}
uvec2 shift_right(uvec2 a_14, uint n_1) {
    if ((n_1 == 0u)) {
        return a_14;
    }
    if ((n_1 >= 32u)) {
        return uvec2((a_14.y >> (n_1 - 32u)), 0u);
    }
    return uvec2(((a_14.x >> n_1) | (a_14.y << (32u - n_1))), (a_14.y >> n_1));
}
int zeros_of(uint x_2) {
    return int(uint(31 - findMSB(x_2)));
}
uint classes_before(uint number, uvec4 sizes, inout uint start, inout uint all_) {
    uint _e4 = all_;
    uint w = (_e4 + sizes.w);
    uint z = (w + sizes.z);
    uint y = (z + sizes.y);
    uint x_7 = (y + sizes.x);
    uvec4 ends = uvec4(x_7, y, z, w);
    uvec4 before_1 = mix(uvec4(0u), uvec4(1u), greaterThanEqual(uvec4(number), ends));
    uvec4 last = (before_1 * ends);
    all_ = x_7;
    uint _e22 = start;
    start = max(_e22, max(max(last.x, last.y), max(last.z, last.w)));
    return (((before_1.x + before_1.y) + before_1.z) + before_1.w);
}
uvec4 class_sizes(uint first_1) {
    uint at_3 = (CLASS_COUNTS + first_1);
    uint _e5 = _group_1_binding_0_cs[at_3];
    uint _e10 = _group_1_binding_0_cs[(at_3 + 1u)];
    uint _e15 = _group_1_binding_0_cs[(at_3 + 2u)];
    uint _e20 = _group_1_binding_0_cs[(at_3 + 3u)];
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
    uint before_2 = (((_e13 + _e14) + _e16) + _e18);
    if ((before_2 == CLASSES)) {
        return NOTHING;
    }
    uint _e26 = _group_0_binding_0_cs.classes;
    int _e32 = _group_0_binding_0_cs.tiles.x;
    int _e36 = _group_0_binding_0_cs.tiles.y;
    uint _e42 = start_1;
    uint _e45 = _group_1_binding_0_cs[(((_e26 + ((15u - before_2) * uint((_e32 * _e36)))) + number_1) - _e42)];
    return _e45;
}
bool fits() {
    bool local_3 = false;
    bool local_4 = false;
    uint _e2 = _group_1_binding_0_cs[2];
    uint _e5 = _group_0_binding_0_cs.page_room;
    if ((_e2 <= _e5)) {
        uint _e11 = _group_1_binding_0_cs[1];
        uint _e14 = _group_0_binding_0_cs.large_room;
        local_3 = (_e11 <= _e14);
    } else {
        local_3 = false;
    }
    bool _e17 = local_3;
    if (_e17) {
        uint _e22 = _group_1_binding_0_cs[0];
        uint _e25 = _group_0_binding_0_cs.chunk_room;
        local_4 = (_e22 <= _e25);
    } else {
        local_4 = false;
    }
    bool _e28 = local_4;
    return _e28;
}
uvec2 fetch_entry(Quarter q_1, uint i_1) {
    if ((i_1 < q_1.count)) {
        uvec2 _e8 = _group_1_binding_1_cs[(q_1.list + i_1)];
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
bvec2 place_splat(uint i_2, Fetched f_1, Quarter q_2) {
    uint u = 0u;
    uint v = 0u;
    bool touches = false;
    bool upper = false;
    uint open_1 = 0u;
    uint row = 0u;
    bool local_5 = false;
    int offset_q11_2 = int((f_1.b.y & 65535u));
    int _e10 = _group_0_binding_0_cs.cut_q11_;
    int _e11 = fxs_limit_q11_(offset_q11_2, _e10);
    uint ux = f_1.a.z;
    u = ((f_1.a.x + (q_2.x * ux)) + (q_2.y * f_1.a.w));
    v = (f_1.a.y + (q_2.y * f_1.b.x));
    uint _e39 = open_pixels[0];
    open_1 = _e39;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e108 = row;
            row = (_e108 + 1u);
        }
        loop_init = false;
        uint _e43 = row;
        if ((_e43 < SIDE)) {
        } else {
            break;
        }
        {
            uint _e46 = row;
            if ((_e46 == 4u)) {
                uint _e51 = open_pixels[1];
                open_1 = _e51;
                bool _e52 = touches;
                upper = _e52;
                touches = false;
            }
            uint _e54 = open_1;
            uint of_row = (_e54 & 255u);
            if ((of_row != 0u)) {
                uint _e59 = u;
                int left = int((_e59 + (min(uint(findLSB(of_row)), 32u) * ux)));
                uint _e64 = u;
                int right = int((_e64 + ((31u - uint(31 - findMSB(of_row))) * ux)));
                uint _e71 = v;
                int _e73 = fxs_coordinate_q13_(int(_e71));
                int _e74 = fxs_row_level_q11_(_e73, offset_q11_2);
                int least = max(max(left, -(right)), 0);
                uint _e82 = row;
                uint _e85 = u;
                rows[((SIDE * i_2) + _e82)] = ivec2(int(_e85), _e74);
                bool _e88 = touches;
                if (!(_e88)) {
                    int _e92 = fxs_coordinate_q13_(least);
                    int _e93 = fxs_level_q11_(_e92, _e74);
                    local_5 = (_e93 <= _e11);
                } else {
                    local_5 = true;
                }
                bool _e96 = local_5;
                touches = _e96;
            }
            uint _e97 = open_1;
            open_1 = (_e97 >> 8u);
            uint _e100 = u;
            u = (_e100 + f_1.a.w);
            uint _e104 = v;
            v = (_e104 + f_1.b.x);
        }
    }
    others[i_2] = ivec4(int(ux), _e11, int(((f_1.b.y >> 16u) | (f_1.b.z << 16u))), int((f_1.b.z >> 16u)));
    bool _e130 = upper;
    bool _e131 = touches;
    return bvec2(_e130, _e131);
}
int blend_splat(inout Pixel p_3, uint i_3, uint column, uint row_1) {
    bool local_6 = false;
    ivec2 at_row = rows[((SIDE * i_3) + row_1)];
    ivec4 other_1 = others[i_3];
    int u_1 = (at_row.x + (int(column) * other_1.x));
    int _e18 = fxs_coordinate_q13_(u_1);
    int _e20 = fxs_level_q11_(_e18, at_row.y);
    if (!((_e20 > other_1.y))) {
        int _e27 = p_3.transmittance;
        local_6 = (_e27 < FXS_CLOSED_Q15_);
    } else {
        local_6 = true;
    }
    bool _e31 = local_6;
    if (_e31) {
        return 0;
    }
    int _e33 = fxs_alpha_q15_(_e20);
    int _e35 = p_3.transmittance;
    int _e36 = fxs_weight_q15_(_e33, _e35);
    int _e38 = p_3.transmittance;
    p_3.transmittance = (_e38 - _e36);
    ivec3 _e41 = p_3.sum;
    int _e45 = fxs_mul_q15_(_e36, (other_1.z & 65535));
    int _e49 = fxs_mul_q15_(_e36, (other_1.z >> 16u));
    int _e51 = fxs_mul_q15_(_e36, other_1.w);
    p_3.sum = (_e41 + ivec3(_e45, _e49, _e51));
    return _e36;
}
ivec3 background_of(uint word_2) {
    uvec3 rgb = uvec3((word_2 & 255u), ((word_2 >> 8u) & 255u), ((word_2 >> 16u) & 255u));
    return ivec3((((rgb * 8192u) + uvec3(127u)) / uvec3(255u)));
}
void put_colour(inout Pixel p_4, uint at) {
    ivec3 background_q13_1 = ivec3(0);
    uint word_3 = 0u;
    ivec3 _e3 = p_4.sum;
    ivec3 sum_1 = min(_e3, ivec3(32767));
    int transmittance_2 = p_4.transmittance;
    uint _e11 = _group_0_binding_0_cs.format;
    if ((_e11 == 3u)) {
        uvec3 rgb_1 = uvec3(min((((sum_1 * 65535) + ivec3(4096)) >> uvec3(13u)), ivec3(65535)));
        uint alpha = uint(((((FXS_CLEAR_Q15_ - transmittance_2) * 65535) + 16384) >> 15u));
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
    int _e83 = fxs_resolve_8bit(sum_1.x, transmittance_2, _e82);
    uint r = uint(_e83);
    int _e87 = background_q13_1.y;
    int _e88 = fxs_resolve_8bit(sum_1.y, transmittance_2, _e87);
    uint g = uint(_e88);
    int _e92 = background_q13_1.z;
    int _e93 = fxs_resolve_8bit(sum_1.z, transmittance_2, _e92);
    uint b_10 = uint(_e93);
    word_3 = (((r | (g << 8u)) | (b_10 << 16u)) | 4278190080u);
    uint _e106 = _group_0_binding_0_cs.format;
    if ((_e106 == 1u)) {
        uint _e109 = word_3;
        int _e112 = fxs_coverage_8bit(transmittance_2);
        word_3 = ((_e109 & 16777215u) | (uint(_e112) << 24u));
    }
    uint _e119 = _group_0_binding_0_cs.format;
    if ((_e119 == 2u)) {
        word_3 = ((((((r * 31u) + 127u) / 255u) << 11u) | ((((g * 63u) + 127u) / 255u) << 5u)) | (((b_10 * 31u) + 127u) / 255u));
    }
    uint _e149 = _group_0_binding_0_cs.colour;
    uint _e152 = word_3;
    _group_1_binding_3_cs[(_e149 + at)] = _e152;
    return;
}
uint list_of(uint tile, uint count) {
    uint merges = ((max((32u - uint(31 - findMSB((max(count, 1u) - 1u)))), 10u) - 7u) / 4u);
    uint _e18 = _group_0_binding_0_cs.next;
    uint _e21 = _group_1_binding_0_cs[(_e18 + tile)];
    uint _e26 = _group_0_binding_0_cs.spare;
    return ((_e21 - count) + (((merges % 2u) == 1u) ? _e26 : 0u));
}
Quarter quarter_of(uvec3 group_1) {
    bool local_7 = false;
    uint number_2 = ((group_1.y * ROW_OF_GROUPS) + group_1.x);
    int _e9 = _group_0_binding_0_cs.tiles.x;
    uint across = uint(_e9);
    uint _e13 = tile_at((number_2 / 4u));
    if (!((_e13 == NOTHING))) {
        bool _e19 = fits();
        local_7 = !(_e19);
    } else {
        local_7 = true;
    }
    bool _e22 = local_7;
    if (_e22) {
        return Quarter(4294967295u, 0u, 0u, 0u, 0u);
    }
    uint count_1 = _group_1_binding_0_cs[(TILES + _e13)];
    uint _e52 = list_of(_e13, count_1);
    return Quarter(_e13, (((_e13 % across) * 16u) + ((number_2 % 2u) * SIDE)), (((_e13 / across) * 16u) + (((number_2 / 2u) % 2u) * SIDE)), _e52, count_1);
}
Place place_of(Quarter q_3, uint thread_1) {
    bool local_8 = false;
    uint column_1 = (thread_1 % SIDE);
    uint row_2 = (thread_1 / SIDE);
    int _e11 = _group_0_binding_0_cs.size.x;
    int _e22 = _group_0_binding_0_cs.size.x;
    if (((q_3.x + column_1) < uint(_e22))) {
        int _e32 = _group_0_binding_0_cs.size.y;
        local_8 = ((q_3.y + row_2) < uint(_e32));
    } else {
        local_8 = false;
    }
    bool _e36 = local_8;
    return Place(column_1, row_2, ((((q_3.y + row_2) * uint(_e11)) + q_3.x) + column_1), _e36);
}
void clear_rounds(uint thread_2, bool inside) {
    if ((thread_2 < 2u)) {
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
    if (inside) {
        uint _e24 = atomicOr(open_pixels[(thread_2 / 32u)], (1u << (thread_2 % 32u)));
    }
    memoryBarrierShared();
    barrier();
    return;
}
void close_pixel(uint thread_3) {
    uint _e10 = atomicAnd(open_pixels[(thread_3 / 32u)], ~((1u << (thread_3 % 32u))));
    return;
}
void place_fetched(Quarter q_4, uint thread_4, Fetched f_2, uint words) {
    if (((f_2.entry.x & CUT_OFF) == 0u)) {
        bvec2 _e10 = place_splat(thread_4, f_2, q_4);
        if (_e10.x) {
            uint _e21 = atomicOr(touching[(words + (thread_4 / 32u))], (1u << (thread_4 % 32u)));
        }
        if (_e10.y) {
            uint _e34 = atomicOr(touching[((words + 2u) + (thread_4 / 32u))], (1u << (thread_4 % 32u)));
            return;
        } else {
            return;
        }
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
uint key_of(uint depth) {
    bool local_9 = false;
    int _e3 = zeros_of((depth | 1u));
    if (!((depth == NOTHING))) {
        local_9 = (depth == 0u);
    } else {
        local_9 = true;
    }
    bool _e12 = local_9;
    if (_e12) {
        return depth;
    }
    int _e17 = _group_0_binding_0_cs.depth_bits;
    return ((uint(((63 - _e3) - _e17)) << 26u) | (((depth << uint(_e3)) >> 5u) & 67108863u));
}
uint depth_of_key(uint key) {
    int _e8 = _group_0_binding_0_cs.depth_bits;
    int shift_1 = (((int((key >> 26u)) - 32) + _e8) - 26);
    uint mantissa = (67108864u | (key & 67108863u));
    if ((shift_1 > 5)) {
        return 4294967294u;
    }
    if ((shift_1 >= 0)) {
        return (mantissa << uint(shift_1));
    }
    if ((shift_1 > -32)) {
        return (mantissa >> uint(-(shift_1)));
    }
    return 0u;
}
uvec2 depth_sum(int weight, uint key_1) {
    int code_q15_ = min(int((((key_1 & 67108863u) + 1024u) >> 11u)), 32767);
    int _e18 = _group_0_binding_0_cs.depth_bits;
    int shift_2 = (min(((int((key_1 >> 26u)) - 32) + _e18), 32) + 8);
    if ((shift_2 < 0)) {
        return uvec2(0u, 0u);
    }
    int _e29 = fxs_mul_q15_(weight, code_q15_);
    uvec2 _e35 = shift_left(uvec2(uint((weight + _e29)), 0u), uint(shift_2));
    return _e35;
}
uint mean_depth(uvec2 sum, int transmittance) {
    uint weight_2 = uint((FXS_CLEAR_Q15_ - transmittance));
    if ((weight_2 == 0u)) {
        return NOTHING;
    }
    uvec2 _e12 = add_wide(sum, uvec2((weight_2 << 7u), 0u));
    uvec2 _e14 = shift_right(_e12, 8u);
    uint a_18 = ((_e14.y >> 16u) % weight_2);
    uint b_11 = ((a_18 << 16u) | (_e14.y & 65535u));
    uint c_1 = (((b_11 % weight_2) << 16u) | (_e14.x >> 16u));
    uint d = (((c_1 % weight_2) << 16u) | (_e14.x & 65535u));
    if ((_e14.y >= weight_2)) {
        return 4294967294u;
    }
    return min((((c_1 / weight_2) << 16u) | (d / weight_2)), 4294967294u);
}
void note(inout Traced t_1, int before, int weight_1, uint key_2, uint slot) {
    uvec2 _e7 = t_1.sum;
    uvec2 _e8 = depth_sum(weight_1, key_2);
    uvec2 _e9 = add_wide(_e7, _e8);
    t_1.sum = _e9;
    if ((before >= HALF_Q15_)) {
        t_1.median = key_2;
    }
    int _e14 = t_1.weight;
    if ((weight_1 > _e14)) {
        t_1.weight = weight_1;
        t_1.largest = slot;
        return;
    } else {
        return;
    }
}
void put_traces(inout Traced t_2, int transmittance_1, uint at_2) {
    uint _e5 = _group_0_binding_0_cs.mean_depth;
    if ((_e5 != NOTHING)) {
        uint _e11 = _group_0_binding_0_cs.mean_depth;
        uvec2 _e15 = t_2.sum;
        uint _e16 = mean_depth(_e15, transmittance_1);
        _group_1_binding_3_cs[(_e11 + at_2)] = _e16;
    }
    uint _e19 = _group_0_binding_0_cs.median_depth;
    if ((_e19 != NOTHING)) {
        uint _e25 = _group_0_binding_0_cs.median_depth;
        uint _e29 = t_2.median;
        uint _e30 = depth_of_key(_e29);
        _group_1_binding_3_cs[(_e25 + at_2)] = ((transmittance_1 >= HALF_Q15_) ? NOTHING : _e30);
    }
    uint _e37 = _group_0_binding_0_cs.id;
    if ((_e37 != NOTHING)) {
        uint _e43 = _group_0_binding_0_cs.id;
        uint _e49 = t_2.largest;
        _group_1_binding_3_cs[(_e43 + (2u * at_2))] = _e49;
        return;
    } else {
        return;
    }
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    Pixel p = Pixel(0, ivec3(0));
    Traced t = Traced(4294967295u, 0, 4294967295u, 4294967295u, uvec2(0u, 0u));
    bool local = false;
    bool open = false;
    Fetched fetched = Fetched(uvec2(0u), uvec4(0u), uvec4(0u));
    uvec2 entry = uvec2(0u);
    uint first = 0u;
    uint word = 0u;
    uint bits = 0u;
    bool local_1 = false;
    bool local_2 = false;
    Quarter _e2 = quarter_of(group);
    if ((_e2.tile == NOTHING)) {
        return;
    }
    Place _e6 = place_of(_e2, thread);
    p = Pixel((_e6.inside ? FXS_CLEAR_Q15_ : 0), ivec3(0));
    if (_e6.inside) {
        uint _e29 = _group_0_binding_0_cs.occluder;
        local = (_e29 != NOTHING);
    } else {
        local = false;
    }
    bool _e33 = local;
    if (_e33) {
        uint _e38 = _group_0_binding_0_cs.occluder;
        uint _e42 = _group_1_binding_3_cs[(_e38 + _e6.at)];
        uint _e43 = key_of(_e42);
        t.limit = _e43;
    }
    open = _e6.inside;
    uvec2 _e46 = fetch_entry(_e2, thread);
    Fetched _e47 = fetch_splat(_e46);
    fetched = _e47;
    uvec2 _e51 = fetch_entry(_e2, (SOME + thread));
    entry = _e51;
    bool _e53 = open;
    clear_rounds(thread, _e53);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e170 = first;
            first = (_e170 + SOME);
        }
        loop_init_1 = false;
        uint _e56 = first;
        if ((_e56 < _e2.count)) {
        } else {
            break;
        }
        {
            uint _e59 = first;
            uint round_ = ((_e59 / SOME) + 1u);
            uint words_1 = (4u * (round_ % 2u));
            bool _e68 = open;
            if (_e68) {
                open_round = round_;
            }
            Fetched _e70 = fetched;
            place_fetched(_e2, thread, _e70, words_1);
            uvec2 _e74 = fetched.entry;
            own[thread] = _e74;
            uvec2 _e75 = entry;
            Fetched _e76 = fetch_splat(_e75);
            fetched = _e76;
            uint _e77 = first;
            uvec2 _e81 = fetch_entry(_e2, ((_e77 + 128u) + thread));
            entry = _e81;
            memoryBarrierShared();
            barrier();
            uint _e83 = open_round;
            memoryBarrierShared();
            barrier();
            if ((_e83 != round_)) {
                break;
            }
            if ((thread < 4u)) {
                touching[((4u - words_1) + thread)] = 0u;
            }
            word = 0u;
            bool loop_init_2 = true;
            while(true) {
                if (!loop_init_2) {
                    uint _e145 = word;
                    word = (_e145 + 1u);
                }
                loop_init_2 = false;
                uint _e95 = word;
                if ((_e95 < 2u)) {
                } else {
                    break;
                }
                {
                    uint _e104 = word;
                    uint _e107 = touching[((words_1 + ((thread / 32u) * 2u)) + _e104)];
                    bits = _e107;
                    bool loop_init_3 = true;
                    while(true) {
                        if (!loop_init_3) {
                            uint _e140 = bits;
                            uint _e141 = bits;
                            bits = (_e140 & (_e141 - 1u));
                        }
                        loop_init_3 = false;
                        uint _e109 = bits;
                        if ((_e109 != 0u)) {
                        } else {
                            break;
                        }
                        {
                            uint _e113 = word;
                            uint _e115 = bits;
                            uint i_4 = ((32u * _e113) + min(uint(findLSB(_e115)), 32u));
                            uint _e121 = own[i_4].y;
                            uint _e123 = t.limit;
                            if ((_e121 <= _e123)) {
                                int before_3 = p.transmittance;
                                int _e129 = blend_splat(p, i_4, _e6.column, _e6.row);
                                if ((_e129 > 0)) {
                                    uint _e135 = own[i_4].y;
                                    uint _e139 = own[i_4].x;
                                    note(t, before_3, _e129, _e135, _e139);
                                }
                            }
                        }
                    }
                }
            }
            bool _e148 = open;
            if (_e148) {
                int _e152 = p.transmittance;
                if (!((_e152 < FXS_CLOSED_Q15_))) {
                    uint _e161 = own[0].y;
                    uint _e163 = t.limit;
                    local_2 = (_e161 > _e163);
                } else {
                    local_2 = true;
                }
                bool _e166 = local_2;
                local_1 = _e166;
            } else {
                local_1 = false;
            }
            bool _e168 = local_1;
            if (_e168) {
                open = false;
                close_pixel(thread);
            }
            memoryBarrierShared();
            barrier();
        }
    }
    if (_e6.inside) {
        put_pixel(p, _e6.at);
        int _e176 = p.transmittance;
        put_traces(t, _e176, _e6.at);
        return;
    } else {
        return;
    }
}
