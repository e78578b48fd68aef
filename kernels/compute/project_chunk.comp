#version 310 es
precision highp float;
precision highp int;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;
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
struct Projected {
    ivec3 camera;
    int zeros;
    uint inverse_q30_;
    ivec2 slope_q23_;
    ivec2 position_q14_;
    bool out_of_range;
};
struct Covariance {
    uint a_q30_;
    uint c_q30_;
    int b_q30_;
    uvec2 det_q60_;
    uvec2 det_undilated_q60_;
    int exponent;
};
struct Root {
    uint m;
    uint inverse_q30_;
    int half_;
};
struct Placed {
    Splat splat;
    Bounds bounds;
};
struct Codes {
    uvec3 position;
    uint rotation;
    uint scale;
    uint colour;
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
const uint CLASS_COUNTS = 16u;
const uint TILES = 64u;
const int EVERYWHERE_Q8_ = 1073741824;
const int CENTRE_LIMIT_Q14_ = 1073741824;
const int SIDE_Q23_ = 536870912;
const uint COMPACT = 1u;
const uint SMALL = 2u;
layout(std140, binding = 1) uniform Object_block_0Compute { Object _group_0_binding_1_cs; };
layout(std430, binding = 1) buffer type_14_block_1Compute { uint _group_1_binding_1_cs[]; };
layout(std140, binding = 0) uniform Frame_block_2Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 0) readonly buffer type_14_block_3Compute { uint _group_1_binding_0_cs[]; };
layout(std430, binding = 2) buffer type_27_block_4Compute { uint _group_1_binding_2_cs[]; };
layout(std430, binding = 3) buffer type_14_block_5Compute { uint _group_1_binding_3_cs[]; };
shared uint visible_here;
int fxs_mul_q15_(int a, int b) {
    return (((a * b) + 16384) >> 15u);
}
int fxs_min(int a_1, int b_1) {
    return ((a_1 < b_1) ? a_1 : b_1);
}
int fxs_limit_q11_(int offset_q11_1, int cut_q11_) {
    int _e4 = fxs_min((offset_q11_1 + cut_q11_), FXS_FAINT_Q11_);
    return _e4;
}
uvec2 wide_of(int x) {
    return uvec2(uint(x), uint((x >> 31u)));
}
uvec2 add_wide(uvec2 a_2, uvec2 b_2) {
    uint low_3 = (a_2.x + b_2.x);
    return uvec2(low_3, ((a_2.y + b_2.y) + ((low_3 < a_2.x) ? 1u : 0u)));
}
uvec2 sub_wide(uvec2 a_3, uvec2 b_3) {
    return uvec2((a_3.x - b_3.x), ((a_3.y - b_3.y) - ((a_3.x < b_3.x) ? 1u : 0u)));
}
bool is_negative(uvec2 a_4) {
    return (int(a_4.y) < 0);
}
uvec2 negate(uvec2 a_5) {
    uvec2 _e5 = add_wide(~(a_5), uvec2(1u, 0u));
    return _e5;
}
uvec2 magnitude(uvec2 a_6) {
    bool _e1 = is_negative(a_6);
    if (_e1) {
        uvec2 _e2 = negate(a_6);
        return _e2;
    }
    return a_6;
}
bool less(uvec2 a_7, uvec2 b_4) {
    return ((a_7.y == b_4.y) ? (a_7.x < b_4.x) : (int(a_7.y) < int(b_4.y)));
}
uvec2 mul_wide(uint a_8, uint b_5) {
    uint high;
    uint low;
    umulExtended(a_8, b_5, high, low);
    return uvec2(low, high);
}
uint mul_high(uint a_9, uint b_6) {
    uvec2 _e2 = mul_wide(a_9, b_6);
    return _e2.y;
}
uvec2 mul_mixed(int a_10, uint b_7) {
    uvec2 _e3 = mul_wide(uint(a_10), b_7);
    return uvec2(_e3.x, (_e3.y - ((a_10 < 0) ? b_7 : 0u)));
}
uvec2 mul_signed(int a_11, int b_8) {
    uvec2 _e3 = mul_mixed(a_11, uint(b_8));
    return uvec2(_e3.x, (_e3.y - ((b_8 < 0) ? uint(a_11) : 0u)));
}
uvec2 mul_word(uvec2 a_12, uint b_9) {
    uvec2 _e3 = mul_wide(a_12.x, b_9);
    return uvec2(_e3.x, (_e3.y + (a_12.y * b_9)));
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
uvec2 shift_signed(uvec2 a_15, uint n_2) {
    int high_3 = int(a_15.y);
    if ((n_2 == 0u)) {
        return a_15;
    }
    if ((n_2 >= 32u)) {
        return uvec2(uint((high_3 >> (n_2 - 32u))), uint((high_3 >> 31u)));
    }
    return uvec2(((a_15.x >> n_2) | (a_15.y << (32u - n_2))), uint((high_3 >> n_2)));
}
uvec2 shift_up(uvec2 a_16, uint n_3) {
    uvec2 _e7 = shift_right(uvec2(4294967295u, 4294967295u), (64u - n_3));
    uvec2 _e8 = add_wide(a_16, _e7);
    uvec2 _e9 = shift_signed(_e8, n_3);
    return _e9;
}
uvec2 round_shift(uvec2 x_1, int n_4) {
    uvec2 _e5 = shift_signed(x_1, uint((n_4 - 1)));
    uvec2 _e9 = add_wide(_e5, uvec2(1u, 0u));
    uvec2 _e11 = shift_signed(_e9, 1u);
    return _e11;
}
int low_of(uvec2 a_17) {
    return int(a_17.x);
}
int zeros_of(uint x_2) {
    return int(uint(31 - findMSB(x_2)));
}
int zeros_of_wide(uvec2 x_3) {
    int _e2 = zeros_of(x_3.x);
    int _e6 = zeros_of(x_3.y);
    return ((x_3.y != 0u) ? _e6 : (32 + _e2));
}
int divide_by(int x_4, uint n_5) {
    return ((x_4 < 0) ? -((-(x_4) >> n_5)) : (x_4 >> n_5));
}
uint reciprocal(uint m) {
    uint y_q30_ = 0u;
    uint _e3 = mul_high(m, 2021161081u);
    y_q30_ = (3031741620u - _e3);
    uint _e7 = y_q30_;
    uint _e11 = y_q30_;
    uint _e12 = mul_high(m, _e11);
    uint _e15 = mul_high((2u * _e7), (2u * (2147483648u - _e12)));
    y_q30_ = _e15;
    uint _e17 = y_q30_;
    uint _e21 = y_q30_;
    uint _e22 = mul_high(m, _e21);
    uint _e25 = mul_high((2u * _e17), (2u * (2147483648u - _e22)));
    y_q30_ = _e25;
    uint _e27 = y_q30_;
    uint _e31 = y_q30_;
    uint _e32 = mul_high(m, _e31);
    uint _e35 = mul_high((2u * _e27), (2u * (2147483648u - _e32)));
    return _e35;
}
uint rsqrt_step(uint m_1, uint y_q30_1) {
    uint _e8 = mul_high((2u * y_q30_1), y_q30_1);
    uint _e9 = mul_high(m_1, _e8);
    uint _e12 = mul_high((2u * y_q30_1), (2u * (1610612736u - _e9)));
    return _e12;
}
uint rsqrt(uint m_2) {
    uint _e3 = mul_high(m_2, 1431655765u);
    uint _e5 = rsqrt_step(m_2, (2369829601u - _e3));
    uint _e6 = rsqrt_step(m_2, _e5);
    uint _e7 = rsqrt_step(m_2, _e6);
    return _e7;
}
uint sqrt_of(uint x_5) {
    if ((x_5 == 0u)) {
        return 0u;
    }
    int _e4 = zeros_of(x_5);
    uint shift_2 = (uint(_e4) & 4294967294u);
    uint m_3 = (x_5 << shift_2);
    uint _e9 = rsqrt(m_3);
    uint _e10 = mul_high(m_3, _e9);
    return (_e10 >> (14u + (shift_2 / 2u)));
}
int exp2_q15_(int f_q15_) {
    int p_1 = 0;
    p_1 = (((256 * f_q15_) + 16384) >> 15u);
    int _e8 = p_1;
    p_1 = ((((_e8 - 1820) * f_q15_) + 16384) >> 15u);
    int _e16 = p_1;
    p_1 = ((((_e16 + 7904) * f_q15_) + 16384) >> 15u);
    int _e24 = p_1;
    p_1 = ((((_e24 - 22724) * f_q15_) + 16384) >> 15u);
    int _e32 = p_1;
    return (32768 + _e32);
}
int log2_q16_(uvec2 x_6) {
    int q = 0;
    int _e1 = zeros_of_wide(x_6);
    uvec2 _e3 = shift_left(x_6, uint(_e1));
    uvec2 _e5 = shift_left(_e3, 1u);
    int t_q15_ = int((_e5.y >> 17u));
    q = (((-2776 * t_q15_) + 16384) >> 15u);
    int _e17 = q;
    q = ((((_e17 + 6897) * t_q15_) + 16384) >> 15u);
    int _e25 = q;
    q = ((((_e25 - 9697) * t_q15_) + 16384) >> 15u);
    int _e33 = q;
    q = ((((_e33 + 14605) * (32768 - t_q15_)) + 16384) >> 15u);
    int _e47 = q;
    return (((63 - _e1) * 65536) + (2 * ((((32768 + _e47) * (t_q15_ >> 1u)) + 8192) >> 14u)));
}
uint half_of(uint word, uint i) {
    return ((word >> (16u * (i % 2u))) & 65535u);
}
uvec2 crop_bound(uint crop, uint i_1, bool high) {
    uint word_4 = ((2u * i_1) + (high ? 6u : 0u));
    uvec4 four = _group_0_binding_1_cs.crops[((4u * crop) + (word_4 / 4u))];
    return (((word_4 % 4u) == 2u) ? four.zw : four.xy);
}
bool lies_in(inout uvec2 low[3], inout uvec2 high_1[3], uint crop_1, bool any_) {
    bool inside = true;
    uint i_2 = 0u;
    bool local = false;
    bool local_1 = false;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e44 = i_2;
            i_2 = (_e44 + 1u);
        }
        loop_init = false;
        uint _e8 = i_2;
        if ((_e8 < 3u)) {
        } else {
            break;
        }
        {
            uint _e11 = i_2;
            uvec2 _e13 = low[_e11];
            uint _e14 = i_2;
            uvec2 _e16 = high_1[_e14];
            uvec2 first = (any_ ? _e16 : _e13);
            uint _e18 = i_2;
            uvec2 _e20 = high_1[_e18];
            uint _e21 = i_2;
            uvec2 _e23 = low[_e21];
            uvec2 last = (any_ ? _e23 : _e20);
            bool _e25 = inside;
            if (_e25) {
                uint _e28 = i_2;
                uvec2 _e30 = crop_bound(crop_1, _e28, false);
                bool _e31 = less(first, _e30);
                local = !(_e31);
            } else {
                local = false;
            }
            bool _e34 = local;
            if (_e34) {
                uint _e37 = i_2;
                uvec2 _e39 = crop_bound(crop_1, _e37, true);
                bool _e40 = less(_e39, last);
                local_1 = !(_e40);
            } else {
                local_1 = false;
            }
            bool _e43 = local_1;
            inside = _e43;
        }
    }
    bool _e47 = inside;
    return _e47;
}
bool is_within_crops(inout uvec2 low_1[3], inout uvec2 high_2[3]) {
    bool kept = false;
    uint crop_2 = 0u;
    bool local_2 = false;
    bool local_3 = false;
    bool local_4 = false;
    uint _e4 = _group_0_binding_1_cs.keep_count;
    kept = (_e4 == 0u);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e49 = crop_2;
            crop_2 = (_e49 + 1u);
        }
        loop_init_1 = false;
        uint _e10 = crop_2;
        uint _e13 = _group_0_binding_1_cs.crop_count;
        if ((_e10 < _e13)) {
        } else {
            break;
        }
        {
            uint _e18 = crop_2;
            uint _e24 = _group_0_binding_1_cs.crops[((4u * _e18) + 3u)].x;
            bool outside = (_e24 != 0u);
            if (outside) {
                uint _e29 = crop_2;
                bool _e31 = lies_in(low_1, high_2, _e29, false);
                local_2 = _e31;
            } else {
                local_2 = false;
            }
            bool _e33 = local_2;
            if (_e33) {
                return false;
            }
            bool _e35 = kept;
            if (!(_e35)) {
                if (!(outside)) {
                    uint _e42 = crop_2;
                    bool _e44 = lies_in(low_1, high_2, _e42, true);
                    local_4 = _e44;
                } else {
                    local_4 = false;
                }
                bool _e46 = local_4;
                local_3 = _e46;
            } else {
                local_3 = true;
            }
            bool _e48 = local_3;
            kept = _e48;
        }
    }
    bool _e52 = kept;
    return _e52;
}
int number_at(uint at) {
    uint _e3 = _group_1_binding_1_cs[at];
    return int(_e3);
}
uvec2 wide_at(uint at_1) {
    uint _e3 = _group_1_binding_1_cs[at_1];
    uint _e8 = _group_1_binding_1_cs[(at_1 + 1u)];
    return uvec2(_e3, _e8);
}
int camera_of(uint record, uint i_3, uvec3 code) {
    uint low_2 = 0u;
    uint sum = 0u;
    uint j = 0u;
    uvec2 _e6 = wide_at((record + (2u * i_3)));
    low_2 = (_e6.x & 65535u);
    sum = ((_e6.y << 16u) | (_e6.x >> 16u));
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e56 = j;
            j = (_e56 + 1u);
        }
        loop_init_2 = false;
        uint _e21 = j;
        if ((_e21 < 3u)) {
        } else {
            break;
        }
        {
            uint _e30 = j;
            uint m_q16_ = _group_1_binding_1_cs[(((record + 6u) + (3u * i_3)) + _e30)];
            uint _e36 = j;
            uint below = ((m_q16_ & 65535u) * code[_e36]);
            uint _e39 = sum;
            uint _e43 = j;
            sum = (_e39 + (uint(((int(m_q16_) >> 16u) * int(code[_e43]))) + (below >> 16u)));
            uint _e52 = low_2;
            low_2 = (_e52 + (below & 65535u));
        }
    }
    uint _e59 = sum;
    uint _e60 = low_2;
    return int((_e59 + (_e60 >> 16u)));
}
bool project_centre(inout Projected centre, uint record_1, uvec3 code_1) {
    uint inverse_q30_ = 1073741824u;
    int side = 0;
    uint i_4 = 0u;
    bool local_5 = false;
    int slope = 0;
    bool local_6 = false;
    int _e4 = camera_of(record_1, 2u, code_1);
    int _e7 = number_at((record_1 + 21u));
    if ((_e4 <= _e7)) {
        return false;
    }
    int _e12 = _group_0_binding_1_cs.orthographic;
    bool parallel = (_e12 != 0);
    int _e16 = zeros_of(uint(_e4));
    int _e19 = number_at((record_1 + 19u));
    int zeros = (parallel ? _e19 : _e16);
    int _e25 = number_at((record_1 + 20u));
    side = _e25;
    if (!(parallel)) {
        uint _e31 = reciprocal((uint(_e4) << uint(zeros)));
        inverse_q30_ = _e31;
        side = (64 * min(_e4, 33554431));
    }
    int _e38 = camera_of(record_1, 0u, code_1);
    int _e40 = camera_of(record_1, 1u, code_1);
    centre.camera = ivec3(_e38, _e40, _e4);
    centre.zeros = zeros;
    uint _e44 = inverse_q30_;
    centre.inverse_q30_ = _e44;
    centre.out_of_range = false;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e121 = i_4;
            i_4 = (_e121 + 1u);
        }
        loop_init_3 = false;
        uint _e49 = i_4;
        if ((_e49 < 2u)) {
        } else {
            break;
        }
        {
            uint _e53 = i_4;
            int x_14 = centre.camera[_e53];
            int _e56 = side;
            if (!((x_14 >= _e56))) {
                int _e62 = side;
                local_5 = (-(x_14) >= _e62);
            } else {
                local_5 = true;
            }
            bool off_axis = local_5;
            uint _e66 = inverse_q30_;
            uvec2 _e67 = mul_mixed(x_14, _e66);
            uvec2 _e70 = round_shift(_e67, (39 - zeros));
            int _e71 = low_of(_e70);
            slope = _e71;
            if (off_axis) {
                slope = ((x_14 < 0) ? -536870912 : SIDE_Q23_);
            }
            uint _e80 = i_4;
            int _e82 = _group_0_binding_1_cs.c_q12_[_e80];
            uvec2 _e83 = wide_of(_e82);
            uvec2 _e85 = shift_left(_e83, 2u);
            uvec2 _e89 = sub_wide(_e85, uvec2(8192u, 0u));
            uint _e92 = i_4;
            int _e94 = _group_0_binding_1_cs.f_q12_[_e92];
            int _e95 = slope;
            uvec2 _e96 = mul_signed(_e94, _e95);
            uvec2 _e98 = round_shift(_e96, 21);
            uvec2 _e99 = add_wide(_e98, _e89);
            if (!(off_axis)) {
                uvec2 _e103 = magnitude(_e99);
                bool _e107 = less(_e103, uvec2(1073741824u, 0u));
                local_6 = !(_e107);
            } else {
                local_6 = true;
            }
            bool _e110 = local_6;
            if (_e110) {
                centre.out_of_range = true;
            }
            uint _e114 = i_4;
            int _e116 = slope;
            centre.slope_q23_[_e114] = _e116;
            uint _e118 = i_4;
            int _e120 = low_of(_e99);
            centre.position_q14_[_e118] = _e120;
        }
    }
    return true;
}
ivec3 jacobian_row(uint i_5, int slope_q23_) {
    int _e5 = _group_0_binding_1_cs.slope_low_q23_[i_5];
    int _e9 = _group_0_binding_1_cs.slope_high_q23_[i_5];
    int slope_1 = min(max(slope_q23_, _e5), _e9);
    int _e13 = _group_0_binding_1_cs.jacobian_exponent;
    int slope_q15_ = (((slope_1 >> uint((7 + _e13))) + 1) >> 1u);
    ivec4 _e25 = _group_0_binding_1_cs.forward_q15_[i_5];
    ivec3 forward = _e25.xyz;
    ivec4 _e30 = _group_0_binding_1_cs.row_q15_[i_5];
    return (_e30.xyz - (((slope_q15_ * forward) + ivec3(16384)) >> uvec3(15u)));
}
int rotation_code_q15_(uint word_1, uint i_6) {
    int code_5 = int(((word_1 >> (20u - (10u * i_6))) & 1023u));
    return (((((2 * code_5) - 1023) * 23194) + 512) >> 10u);
}
bool quaternion(inout ivec4 q_1, uint word_2) {
    uint largest = (word_2 >> 30u);
    int _e5 = rotation_code_q15_(word_2, 0u);
    int _e7 = rotation_code_q15_(word_2, 1u);
    int _e9 = rotation_code_q15_(word_2, 2u);
    int square_q30_ = (((_e5 * _e5) + (_e7 * _e7)) + (_e9 * _e9));
    if ((square_q30_ > 1073741824)) {
        return false;
    }
    uint _e21 = sqrt_of((1073741824u - uint(square_q30_)));
    int most_1 = int(_e21);
    q_1 = ivec4(((largest == 0u) ? most_1 : _e5), ((largest == 1u) ? most_1 : ((largest > 1u) ? _e7 : _e5)), ((largest == 2u) ? most_1 : ((largest > 2u) ? _e9 : _e7)), ((largest == 3u) ? most_1 : _e9));
    return true;
}
ivec3 rotation_column(ivec4 q_2, uint i_7) {
    int w = q_2.x;
    int x_15 = q_2.y;
    int y_1 = q_2.z;
    int z_2 = q_2.w;
    if ((i_7 == 0u)) {
        return ivec3((32768 - ((((y_1 * y_1) + (z_2 * z_2)) + 8192) >> 14u)), ((((x_15 * y_1) + (w * z_2)) + 8192) >> 14u), ((((x_15 * z_2) - (w * y_1)) + 8192) >> 14u));
    }
    if ((i_7 == 1u)) {
        return ivec3(((((x_15 * y_1) - (w * z_2)) + 8192) >> 14u), (32768 - ((((x_15 * x_15) + (z_2 * z_2)) + 8192) >> 14u)), ((((y_1 * z_2) + (w * x_15)) + 8192) >> 14u));
    }
    return ivec3(((((x_15 * z_2) + (w * y_1)) + 8192) >> 14u), ((((y_1 * z_2) - (w * x_15)) + 8192) >> 14u), (32768 - ((((x_15 * x_15) + (y_1 * y_1)) + 8192) >> 14u)));
}
uint screen_size(uint record_2, inout Projected centre_1, int size_q16_, inout int exponent) {
    int whole = -((-(size_q16_) >> 16u));
    int _e13 = exp2_q15_(((-(size_q16_) & 65535) >> 1u));
    uint size_q15_ = uint(_e13);
    uint _e16 = centre_1.inverse_q30_;
    uvec2 _e17 = mul_wide(size_q15_, _e16);
    uvec2 _e19 = shift_right(_e17, 15u);
    uint over_z_q30_ = _e19.x;
    uint _e23 = _group_0_binding_1_cs.focal_q32_;
    uint _e24 = mul_high(over_z_q30_, _e23);
    int _e25 = zeros_of(_e24);
    int _e28 = number_at((record_2 + 18u));
    int _e31 = centre_1.zeros;
    int _e35 = _group_0_binding_1_cs.focal_exponent;
    int _e39 = _group_0_binding_1_cs.jacobian_exponent;
    exponent = ((((((whole - _e28) + _e31) + _e35) + _e39) + 2) - _e25);
    return (_e24 << uint(_e25));
}
bool off_picture(inout Projected centre_2, int exponent_1) {
    bool local_7 = false;
    uint radius_q14_ = (57344u * ((1u << uint(max(exponent_1, 0))) + 1u));
    ivec2 position_2 = centre_2.position_q14_;
    ivec2 _e15 = _group_0_binding_0_cs.tiles;
    uvec2 end = (uvec2(_e15) << uvec2(18u));
    if (!(any(greaterThan(uvec2(max(-(position_2), ivec2(0))), uvec2(radius_q14_))))) {
        local_7 = any(greaterThan(uvec2(max(position_2, ivec2(0))), (end + uvec2(radius_q14_))));
    } else {
        local_7 = true;
    }
    bool _e40 = local_7;
    return _e40;
}
int dot_i(ivec3 a_18, ivec3 b_10) {
    return (((a_18.x * b_10.x) + (a_18.y * b_10.y)) + (a_18.z * b_10.z));
}
uvec2 square_wide(int x_7) {
    uint size = uint(abs(x_7));
    uvec2 _e3 = mul_wide(size, size);
    return _e3;
}
Covariance covariance_of(ivec3 p_2, ivec3 q_3, int exponent_2, uint least_dilation_q30_) {
    Covariance out_ = Covariance(0u, 0u, 0, uvec2(0u), uvec2(0u), 0);
    uint dilation = 0u;
    int _e5 = dot_i(p_2, p_2);
    uint a_20 = uint(_e5);
    int _e7 = dot_i(q_3, q_3);
    uint c_8 = uint(_e7);
    uvec2 _e16 = square_wide(((p_2.y * q_3.z) - (p_2.z * q_3.y)));
    uvec2 _e24 = square_wide(((p_2.z * q_3.x) - (p_2.x * q_3.z)));
    uvec2 _e25 = add_wide(_e16, _e24);
    uvec2 _e33 = square_wide(((p_2.x * q_3.y) - (p_2.y * q_3.x)));
    uvec2 _e34 = add_wide(_e25, _e33);
    dilation = least_dilation_q30_;
    if ((exponent_2 < 15)) {
        uint _e38 = dilation;
        dilation = max(_e38, (322122547u >> uint((2 * exponent_2))));
    }
    uvec2 _e49 = add_wide(uvec2(a_20, 0u), uvec2(c_8, 0u));
    uint _e50 = dilation;
    uvec2 _e53 = add_wide(_e49, uvec2(_e50, 0u));
    int _e55 = dot_i(p_2, q_3);
    out_.b_q30_ = _e55;
    out_.det_undilated_q60_ = _e34;
    uint _e58 = dilation;
    uvec2 _e59 = mul_word(_e53, _e58);
    uvec2 _e60 = add_wide(_e34, _e59);
    out_.det_q60_ = _e60;
    uint _e62 = dilation;
    out_.a_q30_ = (a_20 + _e62);
    uint _e65 = dilation;
    out_.c_q30_ = (c_8 + _e65);
    out_.exponent = exponent_2;
    Covariance _e68 = out_;
    return _e68;
}
Root root_of_q60_(uvec2 x_8) {
    int _e1 = zeros_of_wide(x_8);
    int zeros_1 = (_e1 & -2);
    uvec2 _e5 = shift_left(x_8, uint(zeros_1));
    uint m_4 = _e5.y;
    uint _e7 = rsqrt(m_4);
    return Root(m_4, _e7, (2 - (zeros_1 / 2)));
}
Root root_of_q30_(uint x_9) {
    int _e1 = zeros_of(x_9);
    int zeros_2 = (_e1 & -2);
    uint m_5 = (x_9 << uint(zeros_2));
    uint _e6 = rsqrt(m_5);
    return Root(m_5, _e6, (1 - (zeros_2 / 2)));
}
uint scale_down(uint x_10, int shift) {
    if ((shift > 32)) {
        return 0u;
    }
    return (((x_10 >> uint((shift - 1))) + 1u) >> 1u);
}
uint sqrt_q8_(Root r, int exponent_3) {
    uint _e4 = mul_high(r.m, r.inverse_q30_);
    uint _e9 = scale_down(_e4, ((22 - r.half_) - exponent_3));
    return _e9;
}
uint product_shifted(uint a_19, uint b_11, uint n_6) {
    uvec2 _e3 = mul_wide(a_19, b_11);
    uvec2 _e4 = shift_right(_e3, n_6);
    return _e4.x;
}
void whiten(inout Placed out_1, inout Covariance s, Root c_1, inout Projected centre_3, uint r_q12_) {
    int e = s.exponent;
    int b_q30_ = s.b_q30_;
    uvec2 _e10 = s.det_q60_;
    Root _e11 = root_of_q60_(_e10);
    uint _e13 = s.a_q30_;
    Root _e14 = root_of_q30_(_e13);
    uint _e17 = mul_high(c_1.m, c_1.inverse_q30_);
    uint _e20 = mul_high(_e11.m, _e11.inverse_q30_);
    uint _e24 = product_shifted(c_1.inverse_q30_, _e11.inverse_q30_, 31u);
    uint _e30 = scale_down(c_1.inverse_q30_, ((6 + c_1.half_) + e));
    int vy = int(_e30);
    uint _e34 = product_shifted(_e17, _e11.inverse_q30_, 30u);
    uint _e41 = scale_down(_e34, (((6 - c_1.half_) + _e11.half_) + e));
    int ux = int(_e41);
    uvec2 _e43 = mul_mixed(b_q30_, _e24);
    uvec2 _e50 = round_shift(_e43, (((35 + c_1.half_) + _e11.half_) + e));
    int _e51 = low_of(_e50);
    int uy = -(_e51);
    uint _e53 = sqrt_q8_(_e14, e);
    uint _e55 = product_shifted(_e53, r_q12_, 12u);
    ivec2 position_3 = centre_3.position_q14_;
    uint _e61 = product_shifted(_e20, c_1.inverse_q30_, 30u);
    uint _e68 = scale_down(_e61, (((22 - _e11.half_) + c_1.half_) - e));
    uvec2 _e70 = mul_mixed(b_q30_, c_1.inverse_q30_);
    uvec2 _e75 = round_shift(_e70, ((52 + c_1.half_) - e));
    int _e76 = low_of(_e75);
    out_1.bounds = Bounds(position_3, _e68, _e76, int(((_e55 + (_e55 >> 8u)) + 32u)), 0u);
    uvec2 _e86 = mul_signed(position_3.x, ux);
    uvec2 _e88 = mul_signed(position_3.y, uy);
    uvec2 _e89 = add_wide(_e86, _e88);
    uvec2 _e91 = mul_signed(position_3.y, vy);
    uvec2 _e96 = shift_up(_e89, 14u);
    out_1.splat.u0_q24_ = (1024u - _e96.x);
    uvec2 _e103 = shift_up(_e91, 14u);
    out_1.splat.v0_q24_ = (1024u - _e103.x);
    out_1.splat.ux_q24_ = ux;
    out_1.splat.uy_q24_ = uy;
    out_1.splat.vy_q24_ = vy;
    return;
}
bool clip(inout Placed out_2, uint sigma_q8_, uint r_q12_1) {
    int half_height = 0;
    bool local_8 = false;
    bool local_9 = false;
    bool local_10 = false;
    bool local_11 = false;
    bool local_12 = false;
    bool local_13 = false;
    bool local_14 = false;
    uint _e4 = product_shifted(sigma_q8_, r_q12_1, 12u);
    half_height = int(_e4);
    int _e7 = half_height;
    int _e8 = half_height;
    half_height = (_e7 + ((_e8 >> 8u) + 32));
    int half_width = out_2.bounds.half_width_q8_;
    ivec2 _e19 = out_2.bounds.c_q14_;
    ivec2 c_q8_ = (_e19 >> uvec2(6u));
    int _e24 = half_height;
    int first_1 = (((c_q8_.y - _e24) + 255) >> 8u);
    int _e31 = half_height;
    int last_1 = ((c_q8_.y + _e31) >> 8u);
    ivec2 size_1 = _group_0_binding_0_cs.size;
    if (!(((c_q8_.x + half_width) < 0))) {
        local_8 = ((c_q8_.x - half_width) > ((size_1.x - 1) << 8u));
    } else {
        local_8 = true;
    }
    bool _e54 = local_8;
    if (!(_e54)) {
        local_9 = (last_1 < 0);
    } else {
        local_9 = true;
    }
    bool _e61 = local_9;
    if (!(_e61)) {
        local_10 = (first_1 >= size_1.y);
    } else {
        local_10 = true;
    }
    bool _e68 = local_10;
    if (!(_e68)) {
        local_11 = (first_1 > last_1);
    } else {
        local_11 = true;
    }
    bool _e74 = local_11;
    if (_e74) {
        return false;
    }
    int _e81 = _group_0_binding_1_cs.hidden.x;
    if (((c_q8_.x - half_width) >= (_e81 * 256))) {
        int _e90 = _group_0_binding_1_cs.hidden.y;
        local_12 = (first_1 >= _e90);
    } else {
        local_12 = false;
    }
    bool _e93 = local_12;
    if (_e93) {
        int _e101 = _group_0_binding_1_cs.hidden_end.x;
        local_13 = ((c_q8_.x + half_width) <= ((_e101 - 1) * 256));
    } else {
        local_13 = false;
    }
    bool _e108 = local_13;
    if (_e108) {
        int _e114 = _group_0_binding_1_cs.hidden_end.y;
        local_14 = (last_1 < _e114);
    } else {
        local_14 = false;
    }
    bool _e117 = local_14;
    if (_e117) {
        return false;
    }
    out_2.splat.rows = ivec2(max(first_1, 0), min(last_1, (size_1.y - 1)));
    return true;
}
bool square(inout Placed out_3, inout Covariance s_1) {
    uvec2 least_q60_ = uvec2(1u, 0u);
    uvec2 more = uvec2(0u);
    bool local_15 = false;
    int e_1 = s_1.exponent;
    uint _e5 = s_1.a_q30_;
    uint _e9 = s_1.c_q30_;
    uvec2 _e12 = add_wide(uvec2(_e5, 0u), uvec2(_e9, 0u));
    uvec2 _e14 = shift_right(_e12, 1u);
    uint mid_q30_ = _e14.x;
    if ((e_1 < 15)) {
        uvec2 _e28 = shift_right(uvec2(2576980377u, 26843545u), uint((4 * e_1)));
        least_q60_ = _e28;
    }
    uvec2 _e29 = mul_wide(mid_q30_, mid_q30_);
    uvec2 _e31 = s_1.det_q60_;
    uvec2 _e32 = sub_wide(_e29, _e31);
    more = _e32;
    uvec2 _e34 = least_q60_;
    bool _e35 = less(_e32, _e34);
    if (_e35) {
        uvec2 _e36 = least_q60_;
        more = _e36;
    }
    uvec2 _e37 = more;
    Root _e38 = root_of_q60_(_e37);
    uint _e41 = mul_high(_e38.m, _e38.inverse_q30_);
    uvec2 _e45 = shift_left(uvec2(_e41, 0u), 1u);
    uvec2 _e52 = shift_right(_e45, uint((1 - _e38.half_)));
    uvec2 _e53 = add_wide(uvec2(mid_q30_, 0u), _e52);
    uvec2 _e55 = shift_left(_e53, 30u);
    Root _e56 = root_of_q60_(_e55);
    uint _e57 = sqrt_q8_(_e56, e_1);
    int radius_1 = int((((3u * _e57) + 255u) >> 8u));
    out_3.bounds.square_radius = uint(radius_1);
    int _e73 = _group_0_binding_0_cs.size.y;
    out_3.splat.rows = ivec2(0, (_e73 - 1));
    ivec2 _e80 = out_3.bounds.c_q14_;
    ivec2 pixel = (_e80 >> uvec2(14u));
    if (all(greaterThanEqual(((pixel + ivec2(radius_1)) + ivec2(15)), ivec2(16)))) {
        ivec2 _e97 = _group_0_binding_0_cs.tiles;
        local_15 = all(lessThan(pixel, (ivec2(radius_1) + (16 * _e97))));
    } else {
        local_15 = false;
    }
    bool _e105 = local_15;
    return _e105;
}
uint veil_dilation_q30_(int exponent_4) {
    if ((exponent_4 > 31)) {
        return 64u;
    }
    uvec2 _e6 = _group_0_binding_1_cs.dilation_q30_;
    uvec2 _e10 = shift_right(_e6, uint((2 * exponent_4)));
    uvec2 _e14 = add_wide(_e10, uvec2(1u, 0u));
    return ((_e14.y != 0u) ? 4294967295u : max(_e14.x, 64u));
}
int cut_to_16_q26_(uvec2 x_11) {
    uvec2 most_2 = uvec2(1073741824u, 0u);
    uvec2 _e4 = magnitude(x_11);
    bool _e5 = less(most_2, _e4);
    if (_e5) {
        bool _e6 = is_negative(x_11);
        return (_e6 ? -1073741824 : 1073741824);
    }
    int _e10 = low_of(x_11);
    return _e10;
}
int shift_and_cut(uvec2 x_12, int shift_1) {
    if ((shift_1 < 0)) {
        int _e4 = cut_to_16_q26_(x_12);
        uvec2 _e5 = wide_of(_e4);
        uvec2 _e8 = shift_left(_e5, uint(-(shift_1)));
        int _e9 = cut_to_16_q26_(_e8);
        return _e9;
    }
    uvec2 _e13 = shift_signed(x_12, uint(min(shift_1, 62)));
    int _e14 = cut_to_16_q26_(_e13);
    return _e14;
}
int from_middle_q26_(inout Projected centre_4, uint i_8, int exponent_5) {
    int _e5 = centre_4.camera[i_8];
    uint _e7 = centre_4.inverse_q30_;
    uvec2 _e8 = mul_mixed(_e5, _e7);
    uvec2 _e10 = shift_signed(_e8, 34u);
    int _e11 = low_of(_e10);
    int _e15 = _group_0_binding_1_cs.c_q12_[i_8];
    uvec2 _e16 = wide_of(_e15);
    int _e20 = _group_0_binding_0_cs.tiles[i_8];
    uvec2 _e25 = wide_of(((_e20 << 15u) + 2048));
    uvec2 _e26 = sub_wide(_e16, _e25);
    int _e30 = _group_0_binding_1_cs.f_q12_[i_8];
    uvec2 _e31 = mul_signed(_e30, _e11);
    int _e35 = centre_4.zeros;
    int _e37 = shift_and_cut(_e31, ((14 + exponent_5) - _e35));
    uvec2 _e38 = wide_of(_e37);
    uvec2 _e40 = shift_left(_e26, 14u);
    int _e41 = shift_and_cut(_e40, exponent_5);
    uvec2 _e42 = wide_of(_e41);
    uvec2 _e43 = add_wide(_e38, _e42);
    int _e44 = cut_to_16_q26_(_e43);
    return _e44;
}
bool veil(inout Placed out_4, inout Covariance s_2, inout Projected centre_5, uint r_q12_2) {
    bool local_16 = false;
    int e_2 = s_2.exponent;
    int shift_3 = (min(e_2, 60) - 6);
    ivec2 _e12 = _group_0_binding_0_cs.tiles;
    ivec2 middle_1 = (_e12 * 8);
    uint _e16 = s_2.c_q30_;
    Root _e17 = root_of_q30_(_e16);
    uvec2 _e19 = s_2.det_q60_;
    Root _e20 = root_of_q60_(_e19);
    uint _e24 = product_shifted(_e17.inverse_q30_, _e20.inverse_q30_, 31u);
    uint _e27 = mul_high(_e17.m, _e17.inverse_q30_);
    uvec2 _e29 = mul_wide(_e27, _e20.inverse_q30_);
    uvec2 _e31 = shift_right(_e29, 30u);
    uvec2 _e33 = shift_left(_e31, 2u);
    uvec2 _e39 = round_shift(_e33, ((14 - _e17.half_) + _e20.half_));
    int _e40 = low_of(_e39);
    int _e42 = s_2.b_q30_;
    uvec2 _e43 = mul_mixed(_e42, _e24);
    uvec2 _e49 = round_shift(_e43, ((41 + _e17.half_) + _e20.half_));
    int _e50 = low_of(_e49);
    int uy_q18_ = -(_e50);
    uvec2 _e58 = round_shift(uvec2(_e17.inverse_q30_, 0u), (12 + _e17.half_));
    int _e59 = low_of(_e58);
    int _e61 = from_middle_q26_(centre_5, 0u, e_2);
    int _e63 = from_middle_q26_(centre_5, 1u, e_2);
    uvec2 _e64 = mul_signed(_e61, _e40);
    uvec2 _e65 = mul_signed(_e63, uy_q18_);
    uvec2 _e66 = add_wide(_e64, _e65);
    uvec2 _e68 = shift_up(_e66, 20u);
    uvec2 _e69 = mul_signed(_e63, _e59);
    uvec2 _e71 = shift_up(_e69, 20u);
    uvec2 _e72 = wide_of(_e40);
    uvec2 _e73 = round_shift(_e72, shift_3);
    int _e74 = low_of(_e73);
    uvec2 _e75 = wide_of(uy_q18_);
    uvec2 _e76 = round_shift(_e75, shift_3);
    int _e77 = low_of(_e76);
    uvec2 _e78 = wide_of(_e59);
    uvec2 _e79 = round_shift(_e78, shift_3);
    int _e80 = low_of(_e79);
    out_4.splat.u0_q24_ = (((1024u - _e68.x) - uint((middle_1.x * _e74))) - uint((middle_1.y * _e77)));
    out_4.splat.v0_q24_ = ((1024u - _e71.x) - uint((middle_1.y * _e80)));
    out_4.splat.ux_q24_ = _e74;
    out_4.splat.uy_q24_ = _e77;
    out_4.splat.vy_q24_ = _e80;
    int _e114 = _group_0_binding_0_cs.size.y;
    out_4.splat.rows = ivec2(0, (_e114 - 1));
    int _e128 = _group_0_binding_0_cs.cutoff;
    out_4.bounds = Bounds(ivec2(0), 0u, 0, EVERYWHERE_Q8_, ((_e128 == 1) ? 131072u : 0u));
    uvec2 r_q24_ = uvec2(((r_q12_2 + 1u) * 4096u), 0u);
    uvec2 _e141 = mul_signed(middle_1.x, _e74);
    uvec2 _e144 = mul_signed(middle_1.y, abs(_e77));
    uvec2 _e145 = add_wide(_e141, _e144);
    uvec2 _e146 = add_wide(r_q24_, _e145);
    uvec2 _e147 = magnitude(_e68);
    bool _e148 = less(_e146, _e147);
    if (!(_e148)) {
        uvec2 _e153 = mul_signed(middle_1.y, _e80);
        uvec2 _e154 = add_wide(r_q24_, _e153);
        uvec2 _e155 = magnitude(_e71);
        bool _e156 = less(_e154, _e155);
        local_16 = !(_e156);
    } else {
        local_16 = false;
    }
    bool _e159 = local_16;
    return _e159;
}
bool project_shape(inout Placed out_5, uint record_3, inout Projected centre_6, uint scale_word, uint rotation_word) {
    ivec3 sizes_q16_ = ivec3(0);
    uint i_9 = 0u;
    int size_exponent = 0;
    bool local_17 = false;
    ivec4 q_4 = ivec4(0);
    ivec3 t_x = ivec3(0);
    ivec3 t_y = ivec3(0);
    uint i_10 = 0u;
    uint least = 64u;
    Covariance s_3 = Covariance(0u, 0u, 0, uvec2(0u), uvec2(0u), 0);
    int offset_q11_2 = 0;
    uint r2_q11_ = 0u;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e35 = i_9;
            i_9 = (_e35 + 1u);
        }
        loop_init_4 = false;
        uint _e8 = i_9;
        if ((_e8 < 3u)) {
        } else {
            break;
        }
        {
            uint _e12 = i_9;
            uint code_6 = ((scale_word >> (10u * _e12)) & 1023u);
            uint _e17 = i_9;
            int _e21 = number_at((record_3 + 15u));
            uint _e27 = _group_1_binding_1_cs[(record_3 + 16u)];
            sizes_q16_[_e17] = (_e21 - int(((((code_6 * code_6) * _e27) + 128u) >> 8u)));
        }
    }
    int _e39 = sizes_q16_.x;
    int _e41 = sizes_q16_.y;
    int _e44 = sizes_q16_.z;
    int most_3 = max(max(_e39, _e41), _e44);
    uint _e47 = screen_size(record_3, centre_6, most_3, size_exponent);
    int _e48 = size_exponent;
    if (!((_e48 > 16))) {
        bool _e55 = centre_6.out_of_range;
        local_17 = _e55;
    } else {
        local_17 = true;
    }
    bool is_veil = local_17;
    if (is_veil) {
        int _e58 = size_exponent;
        int _e61 = _group_0_binding_1_cs.veil_exponent;
        if ((_e58 < _e61)) {
            return false;
        }
    } else {
        int _e64 = size_exponent;
        bool _e65 = off_picture(centre_6, _e64);
        if (_e65) {
            return false;
        }
    }
    int _e67 = size_exponent;
    int exponent_6 = max(_e67, 0);
    bool _e71 = quaternion(q_4, rotation_word);
    if (!(_e71)) {
        return false;
    }
    int _e77 = centre_6.slope_q23_.x;
    ivec3 _e78 = jacobian_row(0u, _e77);
    int _e82 = centre_6.slope_q23_.y;
    ivec3 _e83 = jacobian_row(1u, _e82);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e131 = i_10;
            i_10 = (_e131 + 1u);
        }
        loop_init_5 = false;
        uint _e88 = i_10;
        if ((_e88 < 3u)) {
        } else {
            break;
        }
        {
            ivec4 _e91 = q_4;
            uint _e92 = i_10;
            ivec3 _e93 = rotation_column(_e91, _e92);
            uint _e94 = i_10;
            int _e96 = sizes_q16_[_e94];
            int below_q16_ = (most_3 - _e96);
            int _e102 = exp2_q15_(((below_q16_ & 65535) >> 1u));
            uint ratio_q15_ = uint(_e102);
            uint _e105 = product_shifted(ratio_q15_, _e47, 31u);
            int _e108 = size_exponent;
            uint _e113 = scale_down(_e105, (((1 + exponent_6) - _e108) + (below_q16_ >> 16u)));
            int k_q15_ = int(_e113);
            uint _e115 = i_10;
            int _e117 = dot_i(_e78, _e93);
            int _e122 = fxs_mul_q15_(((_e117 + 16384) >> 15u), k_q15_);
            t_x[_e115] = _e122;
            uint _e123 = i_10;
            int _e125 = dot_i(_e83, _e93);
            int _e130 = fxs_mul_q15_(((_e125 + 16384) >> 15u), k_q15_);
            t_y[_e123] = _e130;
        }
    }
    if (is_veil) {
        uint _e136 = veil_dilation_q30_(exponent_6);
        least = _e136;
    }
    ivec3 _e137 = t_x;
    ivec3 _e138 = t_y;
    uint _e139 = least;
    Covariance _e140 = covariance_of(_e137, _e138, exponent_6, _e139);
    s_3 = _e140;
    int _e144 = out_5.splat.offset_q11_;
    offset_q11_2 = _e144;
    int _e148 = _group_0_binding_1_cs.antialiased;
    if ((_e148 != 0)) {
        uint _e153 = s_3.det_undilated_q60_.x;
        uint _e156 = s_3.det_undilated_q60_.y;
        if (((_e153 | _e156) == 0u)) {
            return false;
        }
        uvec2 _e162 = s_3.det_q60_;
        int _e163 = log2_q16_(_e162);
        uvec2 _e165 = s_3.det_undilated_q60_;
        int _e166 = log2_q16_(_e165);
        int log2_ = (_e163 - _e166);
        int _e168 = offset_q11_2;
        uvec2 _e170 = mul_signed(log2_, 45426);
        uvec2 _e174 = add_wide(_e170, uvec2(1048576u, 0u));
        uvec2 _e176 = shift_signed(_e174, 21u);
        int _e177 = low_of(_e176);
        offset_q11_2 = (_e168 + _e177);
    }
    int _e179 = offset_q11_2;
    if ((_e179 > FXS_FAINT_Q11_)) {
        return false;
    }
    int _e185 = offset_q11_2;
    out_5.splat.offset_q11_ = _e185;
    int _e186 = offset_q11_2;
    int _e188 = fxs_limit_q11_(_e186, FXS_CUT_Q11_);
    int _e189 = offset_q11_2;
    r2_q11_ = uint((_e188 - _e189));
    int _e195 = _group_0_binding_0_cs.cutoff;
    if ((_e195 == 1)) {
        int _e199 = offset_q11_2;
        r2_q11_ = uint((FXS_FAINT_Q11_ - _e199));
    }
    uint _e202 = r2_q11_;
    uint _e207 = sqrt_of(((_e202 + 1u) << 13u));
    uint r_q12_5 = (_e207 + 1u);
    if (is_veil) {
        bool _e210 = veil(out_5, s_3, centre_6, r_q12_5);
        return _e210;
    }
    uint _e212 = s_3.c_q30_;
    Root _e213 = root_of_q30_(_e212);
    whiten(out_5, s_3, _e213, centre_6, r_q12_5);
    int _e216 = _group_0_binding_0_cs.cutoff;
    if ((_e216 == 1)) {
        bool _e219 = square(out_5, s_3);
        return _e219;
    }
    uint _e220 = sqrt_q8_(_e213, exponent_6);
    bool _e221 = clip(out_5, _e220, r_q12_5);
    return _e221;
}
uint depth_key(uint record_4, int z) {
    int _e3 = zeros_of(uint(z));
    int _e6 = number_at((record_4 + 18u));
    return ((uint((((_e6 - _e3) - 1) + 32)) << 26u) | (((uint(z) << uint(_e3)) >> 5u) & 67108863u));
}
uint falling_q30_(uint l_q16_) {
    uint whole_1 = (l_q16_ >> 16u);
    if ((whole_1 > 30u)) {
        return 0u;
    }
    int _e11 = exp2_q15_((int((l_q16_ & 65535u)) >> 1u));
    return ((uint(_e11) << 15u) >> whole_1);
}
uint octaves_below_q16_(uint x_q30_) {
    int _e3 = log2_q16_(uvec2(x_q30_, 0u));
    return uint(max((1966080 - _e3), 0));
}
uint share_of_q11_(uint offset_q11_3, uint share_q8_) {
    if ((offset_q11_3 > 22697u)) {
        return (22697u + 1u);
    }
    uint _e12 = falling_q30_((((offset_q11_3 * 94548u) + 2048u) >> 12u));
    uint clear_q30_ = (1073741824u - min(_e12, 1063004406u));
    uint _e18 = octaves_below_q16_(clear_q30_);
    uint _e22 = falling_q30_(((_e18 * share_q8_) >> 8u));
    uint share_q30_ = (1073741824u - _e22);
    if ((share_q30_ == 0u)) {
        return (22697u + 1u);
    }
    uint _e28 = octaves_below_q16_(share_q30_);
    uvec2 _e30 = mul_wide(_e28, 90852u);
    uvec2 _e34 = add_wide(_e30, uvec2(1048576u, 0u));
    uvec2 _e36 = shift_right(_e34, 21u);
    uint offset = _e36.x;
    return min(offset, (22697u + 1u));
}
uint byte_at(uint byte) {
    uint _e5 = _group_1_binding_0_cs[(byte / 4u)];
    return ((_e5 >> (8u * (byte % 4u))) & 255u);
}
int signed_byte_of(uint word_3, uint i_11) {
    return (int((word_3 << (24u - (8u * i_11)))) >> 24u);
}
uint spread_11_(uint code_2) {
    return ((code_2 << 5u) | (code_2 >> 6u));
}
uint spread_scale(uint x_13, uint y, uint z_1, uint bits) {
    return ((((x_13 << 3u) | (x_13 >> 4u)) | (((y << 3u) | (y >> 4u)) << 10u)) | (((z_1 << (10u - bits)) | (z_1 >> ((2u * bits) - 10u))) << 20u));
}
Codes small_codes(uint rows, uint g) {
    uint a_21 = _group_1_binding_0_cs[(rows + g)];
    uint b_27 = _group_1_binding_0_cs[((rows + CHUNK) + g)];
    uint c_9 = _group_1_binding_0_cs[((rows + 512u) + g)];
    uint _e23 = byte_at((((4u * rows) + 3072u) + g));
    uint q1_ = (((c_9 >> 27u) | ((b_27 >> 31u) << 5u)) | ((_e23 >> 7u) << 6u));
    uint red = ((b_27 >> 11u) & 127u);
    uint green = ((b_27 >> 18u) & 127u);
    uint blue = ((b_27 >> 25u) & 63u);
    uint _e50 = spread_11_((a_21 & 2047u));
    uint _e55 = spread_11_(((a_21 >> 11u) & 2047u));
    uint _e58 = spread_11_((b_27 & 2047u));
    uint _e67 = spread_scale((_e23 & 127u), q1_, ((c_9 >> 20u) & 127u), 7u);
    uint _e86 = spread_scale((c_9 & 127u), ((c_9 >> 7u) & 127u), ((c_9 >> 14u) & 63u), 6u);
    return Codes(uvec3(_e50, _e55, _e58), (_e67 | (((a_21 >> 22u) & 3u) << 30u)), _e86, (((((red << 1u) | (red >> 6u)) | (((green << 1u) | (green >> 6u)) << 8u)) | (((blue << 2u) | (blue >> 4u)) << 16u)) | (a_21 & 4278190080u)));
}
Codes codes_of(uint rows_1, uint g_1) {
    uint _e4 = _group_0_binding_1_cs.profile;
    if ((_e4 == SMALL)) {
        Codes _e7 = small_codes(rows_1, g_1);
        return _e7;
    }
    uint half_ = (rows_1 + (g_1 / 2u));
    uint _e13 = _group_1_binding_0_cs[half_];
    uint _e14 = half_of(_e13, g_1);
    uint _e19 = _group_1_binding_0_cs[(half_ + 128u)];
    uint _e20 = half_of(_e19, g_1);
    uint _e25 = _group_1_binding_0_cs[(half_ + 256u)];
    uint _e26 = half_of(_e25, g_1);
    uint _e33 = _group_1_binding_0_cs[((rows_1 + 384u) + g_1)];
    uint _e39 = _group_1_binding_0_cs[((rows_1 + 640u) + g_1)];
    uint _e45 = _group_1_binding_0_cs[((rows_1 + 896u) + g_1)];
    return Codes(uvec3(_e14, _e20, _e26), _e33, _e39, _e45);
}
ivec3 q15_direction(uint record_5, uvec3 position) {
    uvec2 offset_q32_[3] = uvec2[3](uvec2(0u), uvec2(0u), uvec2(0u));
    uvec2 most = uvec2(1u, 0u);
    uint i_12 = 0u;
    ivec3 d = ivec3(0);
    uint i_13 = 0u;
    ivec3 out_6 = ivec3(0);
    uint i_14 = 0u;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e44 = i_12;
            i_12 = (_e44 + 1u);
        }
        loop_init_6 = false;
        uint _e9 = i_12;
        if ((_e9 < 3u)) {
        } else {
            break;
        }
        {
            uint _e15 = i_12;
            uint _e18 = _group_1_binding_1_cs[((record_5 + 34u) + _e15)];
            uint _e19 = i_12;
            uvec2 _e21 = mul_wide(_e18, position[_e19]);
            uint _e26 = _group_1_binding_1_cs[(record_5 + 37u)];
            uvec2 _e27 = shift_left(_e21, _e26);
            uint _e28 = i_12;
            uint _e33 = i_12;
            uvec2 _e36 = wide_at(((record_5 + 22u) + (2u * _e33)));
            uvec2 _e37 = add_wide(_e36, _e27);
            offset_q32_[_e28] = _e37;
            uvec2 _e38 = most;
            uint _e39 = i_12;
            uvec2 _e41 = offset_q32_[_e39];
            uvec2 _e42 = magnitude(_e41);
            most = (_e38 | _e42);
        }
    }
    uvec2 _e47 = most;
    int _e48 = zeros_of_wide(_e47);
    uint shift_4 = uint(max((49 - _e48), 0));
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e67 = i_13;
            i_13 = (_e67 + 1u);
        }
        loop_init_7 = false;
        uint _e57 = i_13;
        if ((_e57 < 3u)) {
        } else {
            break;
        }
        {
            uint _e60 = i_13;
            uint _e62 = i_13;
            uvec2 _e64 = offset_q32_[_e62];
            uvec2 _e65 = shift_signed(_e64, shift_4);
            int _e66 = low_of(_e65);
            d[_e60] = _e66;
        }
    }
    int _e71 = d.x;
    int _e73 = d.x;
    int _e77 = d.y;
    int _e79 = d.y;
    int _e84 = d.z;
    int _e86 = d.z;
    uint square_1 = max(((uint((_e71 * _e73)) + uint((_e77 * _e79))) + uint((_e84 * _e86))), 1u);
    int _e92 = zeros_of(square_1);
    uint zeros_3 = (uint(_e92) & 4294967294u);
    uint _e97 = rsqrt((square_1 << zeros_3));
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e121 = i_14;
            i_14 = (_e121 + 1u);
        }
        loop_init_8 = false;
        uint _e101 = i_14;
        if ((_e101 < 3u)) {
        } else {
            break;
        }
        {
            uint _e104 = i_14;
            int _e106 = d[_e104];
            uvec2 _e112 = mul_mixed((_e106 * (1 << (zeros_3 / 2u))), _e97);
            uvec2 _e114 = round_shift(_e112, 31);
            uint _e115 = i_14;
            int _e117 = low_of(_e114);
            out_6[_e115] = min(max(_e117, -32767), 32767);
        }
    }
    ivec3 _e124 = out_6;
    return _e124;
}
void basis(inout int b_12[15], ivec3 d_1, int degree) {
    int x_16 = d_1.x;
    int y_2 = d_1.y;
    int z_3 = d_1.z;
    int _e8 = fxs_mul_q15_(-16011, y_2);
    b_12[0] = _e8;
    int _e11 = fxs_mul_q15_(16011, z_3);
    b_12[1] = _e11;
    int _e14 = fxs_mul_q15_(-16011, x_16);
    b_12[2] = _e14;
    if ((degree < 2)) {
        return;
    }
    int _e17 = fxs_mul_q15_(x_16, x_16);
    int _e18 = fxs_mul_q15_(y_2, y_2);
    int _e19 = fxs_mul_q15_(z_3, z_3);
    int _e20 = fxs_mul_q15_(x_16, y_2);
    int _e21 = fxs_mul_q15_(y_2, z_3);
    int _e22 = fxs_mul_q15_(x_16, z_3);
    int _e25 = fxs_mul_q15_(17900, _e20);
    b_12[3] = (2 * _e25);
    int _e30 = fxs_mul_q15_(17900, _e21);
    b_12[4] = (-2 * _e30);
    int _e39 = fxs_mul_q15_(10335, (((2 * _e19) - _e17) - _e18));
    b_12[5] = _e39;
    int _e42 = fxs_mul_q15_(17900, _e22);
    b_12[6] = (-2 * _e42);
    int _e48 = fxs_mul_q15_(17900, (_e17 - _e18));
    b_12[7] = _e48;
    if ((degree < 3)) {
        return;
    }
    int _e53 = fxs_mul_q15_(19335, y_2);
    int _e58 = divide_by(((3 * _e17) - _e18), 1u);
    int _e59 = fxs_mul_q15_(_e53, _e58);
    b_12[8] = (-2 * _e59);
    int _e64 = fxs_mul_q15_(23680, _e20);
    int _e65 = fxs_mul_q15_(_e64, z_3);
    b_12[9] = (4 * _e65);
    int _e70 = fxs_mul_q15_(14976, y_2);
    int _e76 = divide_by((((4 * _e19) - _e17) - _e18), 2u);
    int _e77 = fxs_mul_q15_(_e70, _e76);
    b_12[10] = (-4 * _e77);
    int _e82 = fxs_mul_q15_(12228, z_3);
    int _e92 = divide_by((((2 * _e19) - (3 * _e17)) - (3 * _e18)), 2u);
    int _e93 = fxs_mul_q15_(_e82, _e92);
    b_12[11] = (4 * _e93);
    int _e98 = fxs_mul_q15_(14976, x_16);
    int _e104 = divide_by((((4 * _e19) - _e17) - _e18), 2u);
    int _e105 = fxs_mul_q15_(_e98, _e104);
    b_12[12] = (-4 * _e105);
    int _e110 = fxs_mul_q15_(23680, z_3);
    int _e112 = fxs_mul_q15_(_e110, (_e17 - _e18));
    b_12[13] = (2 * _e112);
    int _e117 = fxs_mul_q15_(19335, x_16);
    int _e122 = divide_by((_e17 - (3 * _e18)), 1u);
    int _e123 = fxs_mul_q15_(_e117, _e122);
    b_12[14] = (-2 * _e123);
    return;
}
uint sh_count(int degree_1) {
    return uint((((degree_1 + 1) * (degree_1 + 1)) - 1));
}
void add_bands(inout ivec3 sum_q16_, inout int b_13[15], uint record_6, uint rows_2, uint g_2) {
    int d_2 = 1;
    ivec3 band_q15_ = ivec3(0);
    uint k = 0u;
    uint c_2 = 0u;
    uint at_3 = (((4u * rows_2) + 4608u) + g_2);
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            int _e86 = d_2;
            d_2 = (_e86 + 1);
        }
        loop_init_9 = false;
        int _e12 = d_2;
        int _e15 = _group_0_binding_1_cs.degree;
        if ((_e12 <= _e15)) {
        } else {
            break;
        }
        {
            band_q15_ = ivec3(0);
            int _e20 = d_2;
            uint _e23 = sh_count((_e20 - 1));
            k = _e23;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e61 = k;
                    k = (_e61 + 1u);
                }
                loop_init_10 = false;
                uint _e25 = k;
                int _e26 = d_2;
                uint _e27 = sh_count(_e26);
                if ((_e25 < _e27)) {
                } else {
                    break;
                }
                {
                    c_2 = 0u;
                    bool loop_init_11 = true;
                    while(true) {
                        if (!loop_init_11) {
                            uint _e58 = c_2;
                            c_2 = (_e58 + 1u);
                        }
                        loop_init_11 = false;
                        uint _e31 = c_2;
                        if ((_e31 < 3u)) {
                        } else {
                            break;
                        }
                        {
                            uint _e35 = k;
                            uint _e37 = c_2;
                            uint byte_2 = (at_3 + (((3u * _e35) + _e37) * CHUNK));
                            uint _e42 = c_2;
                            int _e44 = band_q15_[_e42];
                            uint _e45 = k;
                            int _e47 = b_13[_e45];
                            uint _e52 = _group_1_binding_0_cs[(byte_2 / 4u)];
                            int _e55 = signed_byte_of(_e52, (byte_2 % 4u));
                            band_q15_[_e42] = (_e44 + (_e47 * _e55));
                        }
                    }
                }
            }
            int _e66 = d_2;
            int _e69 = number_at(((record_6 + 43u) + uint(_e66)));
            ivec3 _e70 = sum_q16_;
            ivec3 _e71 = band_q15_;
            sum_q16_ = (_e70 + (((((_e71 + ivec3(512)) >> uvec3(10u)) * _e69) + ivec3(128)) >> uvec3(8u)));
        }
    }
    return;
}
int dot_16_(inout int b_14[15], uvec4 words) {
    int sum_1 = 0;
    uint k_1 = 0u;
    bool loop_init_12 = true;
    while(true) {
        if (!loop_init_12) {
            uint _e23 = k_1;
            k_1 = (_e23 + 1u);
        }
        loop_init_12 = false;
        uint _e6 = k_1;
        if ((_e6 < 15u)) {
        } else {
            break;
        }
        {
            int _e9 = sum_1;
            uint _e10 = k_1;
            int _e12 = b_14[_e10];
            uint _e13 = k_1;
            uint _e17 = k_1;
            int _e20 = signed_byte_of(words[(_e13 / 4u)], (_e17 % 4u));
            sum_1 = (_e9 + (_e12 * _e20));
        }
    }
    int _e26 = sum_1;
    return _e26;
}
void add_mean(inout ivec3 sum_2, inout int b_15[15], uint record_7) {
    uint c_3 = 0u;
    bool loop_init_13 = true;
    while(true) {
        if (!loop_init_13) {
            uint _e38 = c_3;
            c_3 = (_e38 + 1u);
        }
        loop_init_13 = false;
        uint _e5 = c_3;
        if ((_e5 < 3u)) {
        } else {
            break;
        }
        {
            uint _e11 = c_3;
            uint at_4 = ((record_7 + 48u) + (4u * _e11));
            uint _e14 = c_3;
            int _e16 = sum_2[_e14];
            uint _e19 = _group_1_binding_1_cs[at_4];
            uint _e24 = _group_1_binding_1_cs[(at_4 + 1u)];
            uint _e29 = _group_1_binding_1_cs[(at_4 + 2u)];
            uint _e34 = _group_1_binding_1_cs[(at_4 + 3u)];
            int _e36 = dot_16_(b_15, uvec4(_e19, _e24, _e29, _e34));
            sum_2[_e14] = (_e16 + _e36);
        }
    }
    return;
}
void add_entry(inout ivec3 sum_3, inout int b_16[15], uint stage, uint code_3) {
    uint c_4 = 0u;
    uint _e8 = _group_0_binding_1_cs.palette_entries;
    uint index = min((code_3 & 127u), (_e8 - 1u));
    int sign_ = (((code_3 & 128u) != 0u) ? -1 : 1);
    bool loop_init_14 = true;
    while(true) {
        if (!loop_init_14) {
            uint _e60 = c_4;
            c_4 = (_e60 + 1u);
        }
        loop_init_14 = false;
        uint _e21 = c_4;
        if ((_e21 < 3u)) {
        } else {
            break;
        }
        {
            uint _e27 = _group_0_binding_1_cs.palette_entries;
            uint _e32 = c_4;
            uint at_5 = ((12u * ((stage * _e27) + index)) + (4u * _e32));
            uint _e35 = c_4;
            int _e37 = sum_3[_e35];
            uint _e40 = _group_1_binding_0_cs[at_5];
            uint _e45 = _group_1_binding_0_cs[(at_5 + 1u)];
            uint _e50 = _group_1_binding_0_cs[(at_5 + 2u)];
            uint _e55 = _group_1_binding_0_cs[(at_5 + 3u)];
            int _e57 = dot_16_(b_16, uvec4(_e40, _e45, _e50, _e55));
            sum_3[_e35] = (_e37 + (sign_ * _e57));
        }
    }
    return;
}
int code_at(uint byte_1, uint bit) {
    uint code_4 = 0u;
    uint at_6 = (byte_1 + (bit / 8u));
    uint shift_5 = ((8u * (at_6 % 4u)) + (bit % 8u));
    uint _e16 = _group_1_binding_0_cs[(at_6 / 4u)];
    code_4 = (_e16 >> shift_5);
    if ((shift_5 > 29u)) {
        uint _e21 = code_4;
        uint _e28 = _group_1_binding_0_cs[((at_6 / 4u) + 1u)];
        code_4 = (_e21 | (_e28 << (32u - shift_5)));
    }
    uint _e33 = code_4;
    return int(((_e33 & 7u) ^ 4u));
}
ivec3 palette_sum_q16_(inout int b_17[15], uint record_8, uint rows_3, uint g_3) {
    uint stages = 0u;
    uint bytes = 0u;
    uint at_2 = 0u;
    ivec3 sum_4 = ivec3(0);
    uint stage_1 = 0u;
    ivec3 out_7 = ivec3(0);
    uint c_5 = 0u;
    uint c_6 = 0u;
    int odd = 0;
    uint k_2 = 0u;
    int degree_2 = _group_0_binding_1_cs.scene_degree;
    uint _e9 = _group_0_binding_1_cs.profile;
    bool compact = (_e9 == COMPACT);
    stages = ((degree_2 == 1) ? 4u : 6u);
    uint _e18 = stages;
    bytes = _e18;
    at_2 = ((4u * rows_3) + 3328u);
    if (compact) {
        stages = 3u;
        bytes = ((degree_2 == 1) ? 8u : ((degree_2 == 2) ? 13u : 21u));
        at_2 = ((4u * rows_3) + 4608u);
    }
    uint _e39 = at_2;
    uint _e40 = bytes;
    at_2 = (_e39 + (g_3 * _e40));
    add_mean(sum_4, b_17, record_8);
    bool loop_init_15 = true;
    while(true) {
        if (!loop_init_15) {
            uint _e56 = stage_1;
            stage_1 = (_e56 + 1u);
        }
        loop_init_15 = false;
        uint _e48 = stage_1;
        uint _e49 = stages;
        if ((_e48 < _e49)) {
        } else {
            break;
        }
        {
            uint _e51 = stage_1;
            uint _e52 = at_2;
            uint _e53 = stage_1;
            uint _e55 = byte_at((_e52 + _e53));
            add_entry(sum_4, b_17, _e51, _e55);
        }
    }
    bool loop_init_16 = true;
    while(true) {
        if (!loop_init_16) {
            uint _e77 = c_5;
            c_5 = (_e77 + 1u);
        }
        loop_init_16 = false;
        uint _e62 = c_5;
        if ((_e62 < 3u)) {
        } else {
            break;
        }
        {
            uint _e65 = c_5;
            uint _e67 = c_5;
            int _e69 = sum_4[_e67];
            int _e72 = _group_0_binding_1_cs.palette_step_q19_;
            uvec2 _e73 = mul_signed(_e69, _e72);
            uvec2 _e75 = shift_signed(_e73, 18u);
            int _e76 = low_of(_e75);
            out_7[_e65] = _e76;
        }
    }
    if (compact) {
        uint _e80 = at_2;
        uint _e83 = byte_at((_e80 + 3u));
        bool loop_init_17 = true;
        while(true) {
            if (!loop_init_17) {
                uint _e136 = c_6;
                c_6 = (_e136 + 1u);
            }
            loop_init_17 = false;
            uint _e86 = c_6;
            if ((_e86 < 3u)) {
            } else {
                break;
            }
            {
                odd = 0;
                k_2 = 0u;
                bool loop_init_18 = true;
                while(true) {
                    if (!loop_init_18) {
                        uint _e117 = k_2;
                        k_2 = (_e117 + 1u);
                    }
                    loop_init_18 = false;
                    uint _e93 = k_2;
                    uint _e94 = sh_count(degree_2);
                    if ((_e93 < _e94)) {
                    } else {
                        break;
                    }
                    {
                        int _e96 = odd;
                        uint _e97 = k_2;
                        int _e99 = b_17[_e97];
                        uint _e100 = at_2;
                        uint _e103 = c_6;
                        uint _e104 = sh_count(degree_2);
                        uint _e106 = k_2;
                        int _e110 = code_at(_e100, (32u + (3u * ((_e103 * _e104) + _e106))));
                        odd = (_e96 + (_e99 * ((2 * _e110) - 7)));
                    }
                }
                uint shift_6 = (31u - (_e83 >> 3u));
                uint _e124 = c_6;
                int _e126 = out_7[_e124];
                int _e127 = odd;
                out_7[_e124] = (_e126 + ((_e127 * int((8u + (_e83 & 7u)))) >> shift_6));
            }
        }
    }
    ivec3 _e139 = out_7;
    return _e139;
}
ivec3 shade(uint record_9, uint rows_4, uint g_4, Codes codes) {
    ivec3 sum_q16_1 = ivec3(0);
    uint c_7 = 0u;
    int b_18[15] = int[15](0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    bool loop_init_19 = true;
    while(true) {
        if (!loop_init_19) {
            uint _e38 = c_7;
            c_7 = (_e38 + 1u);
        }
        loop_init_19 = false;
        uint _e7 = c_7;
        if ((_e7 < 3u)) {
        } else {
            break;
        }
        {
            uint _e13 = c_7;
            uint _e16 = _group_1_binding_1_cs[((record_9 + 41u) + _e13)];
            uint _e19 = c_7;
            uint step_ = (_e16 * ((codes.colour >> (8u * _e19)) & 255u));
            uint _e25 = c_7;
            uint _e29 = c_7;
            int _e31 = number_at(((record_9 + 38u) + _e29));
            sum_q16_1[_e25] = (_e31 + int(((step_ + 8u) >> 4u)));
        }
    }
    int _e43 = _group_0_binding_1_cs.degree;
    if ((_e43 > 0)) {
        ivec3 _e48 = q15_direction(record_9, codes.position);
        int _e51 = _group_0_binding_1_cs.degree;
        basis(b_18, _e48, _e51);
        uint _e54 = _group_0_binding_1_cs.palette_entries;
        if ((_e54 != 0u)) {
            ivec3 _e57 = sum_q16_1;
            ivec3 _e58 = palette_sum_q16_(b_18, record_9, rows_4, g_4);
            sum_q16_1 = (_e57 + _e58);
        } else {
            add_bands(sum_q16_1, b_18, record_9, rows_4, g_4);
        }
    }
    ivec3 _e60 = sum_q16_1;
    return min(max(((_e60 + ivec3(4)) >> uvec3(3u)), ivec3(0)), ivec3(32767));
}
Span columns_between(int left_q8_, int right_q8_) {
    bool local_18 = false;
    bool local_19 = false;
    int first_2 = ((left_q8_ + 255) >> 8u);
    int last_2 = (right_q8_ >> 8u);
    if (!((last_2 < 0))) {
        int _e16 = _group_0_binding_0_cs.size.x;
        local_18 = (first_2 >= _e16);
    } else {
        local_18 = true;
    }
    bool _e19 = local_18;
    if (!(_e19)) {
        local_19 = (first_2 > last_2);
    } else {
        local_19 = true;
    }
    bool _e25 = local_19;
    if (_e25) {
        return Span(0, -1);
    }
    int _e38 = _group_0_binding_0_cs.tiles.x;
    int _e44 = _group_0_binding_0_cs.size.x;
    return Span((max(first_2, 0) >> 4u), ((last_2 >= _e44) ? (_e38 - 1) : (last_2 >> 4u)));
}
Span columns_of(inout Bounds b_19) {
    int _e3 = b_19.c_q14_.x;
    int c_q8_1 = (_e3 >> 6u);
    int _e7 = b_19.half_width_q8_;
    int _e10 = b_19.half_width_q8_;
    Span _e12 = columns_between((c_q8_1 - _e7), (c_q8_1 + _e10));
    return _e12;
}
int radius_q12_(int offset_q11_4) {
    int _e3 = _group_0_binding_0_cs.cut_q11_;
    int _e4 = fxs_limit_q11_(offset_q11_4, _e3);
    uint _e11 = sqrt_of((uint(((_e4 - offset_q11_4) + 1)) << 13u));
    return (int(_e11) + 1);
}
int v_at_row(inout Splat s_4, inout Bounds b_20, int row) {
    int _e7 = b_20.c_q14_.y;
    int _e10 = s_4.vy_q24_;
    uvec2 _e11 = mul_signed(((row << 14u) - _e7), _e10);
    uvec2 _e13 = shift_signed(_e11, 26u);
    int _e14 = low_of(_e13);
    return _e14;
}
int half_at(inout Bounds b_21, int r_q12_3, int v_q12_) {
    uint _e7 = sqrt_of(uint(((r_q12_3 * r_q12_3) - (v_q12_ * v_q12_))));
    uint root = (_e7 + 1u);
    uint _e11 = b_21.breadth_q8_;
    uvec2 _e12 = mul_wide(_e11, root);
    uvec2 _e14 = shift_right(_e12, 12u);
    return int(_e14.x);
}
Span ellipse_span(inout Splat s_5, inout Bounds b_22, int r_1, int row_1) {
    bool local_20 = false;
    bool local_21 = false;
    int left = 0;
    int right = 0;
    uvec2 tangent = uvec2(0u);
    bool local_22 = false;
    bool local_23 = false;
    int _e6 = v_at_row(s_5, b_22, (row_1 * 16));
    int _e11 = v_at_row(s_5, b_22, ((row_1 * 16) + 15));
    int reach = b_22.half_width_q8_;
    if (!((_e6 > (r_1 + 2)))) {
        local_20 = (_e11 < (-(r_1) - 2));
    } else {
        local_20 = true;
    }
    bool _e25 = local_20;
    if (_e25) {
        local_21 = (reach != EVERYWHERE_Q8_);
    } else {
        local_21 = false;
    }
    bool _e31 = local_21;
    if (_e31) {
        return Span(0, -1);
    }
    int top = min(max(_e6, -(r_1)), r_1);
    int bottom = min(max((_e11 + 1), -(r_1)), r_1);
    int _e42 = b_22.shear_q8_;
    uvec2 _e43 = mul_signed(_e42, top);
    uvec2 _e45 = shift_signed(_e43, 12u);
    int _e46 = low_of(_e45);
    int _e48 = b_22.shear_q8_;
    uvec2 _e49 = mul_signed(_e48, bottom);
    uvec2 _e51 = shift_signed(_e49, 12u);
    int _e52 = low_of(_e51);
    int _e53 = half_at(b_22, r_1, top);
    int _e54 = half_at(b_22, r_1, bottom);
    left = -(max((_e53 - _e46), (_e54 - _e52)));
    right = max((_e53 + _e46), (_e54 + _e52));
    int _e65 = b_22.shear_q8_;
    uvec2 _e69 = mul_wide(uint(abs(_e65)), uint(r_1));
    uvec2 _e71 = shift_right(_e69, 12u);
    uvec2 _e74 = mul_wide(_e71.x, uint(r_1));
    tangent = _e74;
    int _e77 = b_22.shear_q8_;
    if ((_e77 < 0)) {
        uvec2 _e80 = tangent;
        uvec2 _e81 = negate(_e80);
        tangent = _e81;
    }
    uvec2 _e82 = tangent;
    uvec2 _e83 = negate(_e82);
    uvec2 _e84 = mul_signed(top, reach);
    uvec2 _e85 = mul_signed(bottom, reach);
    uvec2 _e86 = tangent;
    bool _e87 = less(_e86, _e84);
    if (!(_e87)) {
        uvec2 _e91 = tangent;
        bool _e92 = less(_e85, _e91);
        local_22 = !(_e92);
    } else {
        local_22 = false;
    }
    bool _e95 = local_22;
    if (_e95) {
        right = reach;
    }
    bool _e96 = less(_e83, _e84);
    if (!(_e96)) {
        bool _e100 = less(_e85, _e83);
        local_23 = !(_e100);
    } else {
        local_23 = false;
    }
    bool _e103 = local_23;
    if (_e103) {
        left = -(reach);
    }
    int _e107 = b_22.c_q14_.x;
    int c_q8_2 = (_e107 >> 6u);
    int margin = ((reach >> 8u) + 32);
    int _e114 = left;
    int _e119 = right;
    Span _e125 = columns_between((c_q8_2 + max((_e114 - margin), -(reach))), (c_q8_2 - max((-(_e119) - margin), -(reach))));
    return _e125;
}
Span square_span(int centre_q14_, uint radius, int tiles) {
    int pixel_1 = (centre_q14_ >> 14u);
    int first_3 = ((pixel_1 - int(radius)) >> 4u);
    int last_3 = ((((pixel_1 + int(radius)) + 15) >> 4u) - 1);
    return Span(min(max(first_3, 0), tiles), min(max(last_3, -1), (tiles - 1)));
}
Span rows_of(inout Splat s_6, inout Bounds b_23) {
    int _e4 = _group_0_binding_0_cs.cutoff;
    if ((_e4 == 1)) {
        int _e9 = b_23.c_q14_.y;
        uint _e11 = b_23.square_radius;
        int _e15 = _group_0_binding_0_cs.tiles.y;
        Span _e16 = square_span(_e9, _e11, _e15);
        return _e16;
    }
    int _e19 = s_6.rows.x;
    int _e24 = s_6.rows.y;
    return Span((_e19 >> 4u), (_e24 >> 4u));
}
Span span_of(inout Splat s_7, inout Bounds b_24, int r_q12_4, int row_2) {
    int _e6 = _group_0_binding_0_cs.cutoff;
    if ((_e6 == 1)) {
        int _e11 = b_24.c_q14_.x;
        uint _e13 = b_24.square_radius;
        int _e17 = _group_0_binding_0_cs.tiles.x;
        Span _e18 = square_span(_e11, _e13, _e17);
        return _e18;
    }
    Span _e19 = ellipse_span(s_7, b_24, r_q12_4, row_2);
    return _e19;
}
uint scale_depth(uint key) {
    uint _e9 = _group_0_binding_1_cs.scale_mantissa;
    uint _e10 = mul_high(((67108864u | (key & 67108863u)) << 5u), _e9);
    int _e11 = zeros_of(_e10);
    int _e17 = _group_0_binding_1_cs.scale_exponent;
    int exponent_7 = (((int((key >> 26u)) + _e17) + 1) - _e11);
    if ((exponent_7 < 0)) {
        return 0u;
    }
    if ((exponent_7 > 63)) {
        return 4294967295u;
    }
    return ((uint(exponent_7) << 26u) | (((_e10 << uint(_e11)) >> 5u) & 67108863u));
}
bool is_kept(uint record_10, uvec3 position_1) {
    uvec2 centre_7[3] = uvec2[3](uvec2(0u), uvec2(0u), uvec2(0u));
    uint i_15 = 0u;
    bool loop_init_20 = true;
    while(true) {
        if (!loop_init_20) {
            uint _e34 = i_15;
            i_15 = (_e34 + 1u);
        }
        loop_init_20 = false;
        uint _e5 = i_15;
        if ((_e5 < 3u)) {
        } else {
            break;
        }
        {
            uint _e11 = i_15;
            uint _e14 = _group_1_binding_1_cs[((record_10 + 34u) + _e11)];
            uint _e15 = i_15;
            uvec2 _e17 = mul_wide(_e14, position_1[_e15]);
            uint _e22 = _group_1_binding_1_cs[(record_10 + 37u)];
            uvec2 _e23 = shift_left(_e17, _e22);
            uint _e24 = i_15;
            uint _e29 = i_15;
            uvec2 _e32 = wide_at(((record_10 + 28u) + (2u * _e29)));
            uvec2 _e33 = add_wide(_e32, _e23);
            centre_7[_e24] = _e33;
        }
    }
    bool _e37 = is_within_crops(centre_7, centre_7);
    return _e37;
}
int offset_of(uint record_11, uint opacity, uint share_q8_1) {
    uint offset_q11_5 = 0u;
    uint _e8 = _group_1_binding_1_cs[(record_11 + 17u)];
    uint code_7 = ((CHUNK * _e8) + opacity);
    uint _e15 = _group_1_binding_1_cs[(code_7 / 2u)];
    uint _e16 = half_of(_e15, code_7);
    offset_q11_5 = _e16;
    if ((share_q8_1 != 256u)) {
        uint _e20 = offset_q11_5;
        uint _e21 = share_of_q11_(_e20, share_q8_1);
        offset_q11_5 = _e21;
    }
    uint _e22 = offset_q11_5;
    int _e26 = _group_0_binding_1_cs.offset_q11_;
    return (int(_e22) + _e26);
}
void count_tiles(int row_3, Span s_8) {
    if ((s_8.first > s_8.last)) {
        return;
    }
    int _e9 = _group_0_binding_0_cs.tiles.x;
    uint tile = (TILES + uint((row_3 * _e9)));
    uint _e19 = atomicAdd(_group_1_binding_2_cs[(tile + uint(s_8.first))], 1u);
    int _e24 = _group_0_binding_0_cs.tiles.x;
    if ((s_8.last < (_e24 - 1))) {
        uint _e36 = atomicAdd(_group_1_binding_2_cs[((tile + uint(s_8.last)) + 1u)], 4294967295u);
        return;
    } else {
        return;
    }
}
void put_large(uint slot, inout Bounds b_25) {
    uint _e5 = atomicAdd(_group_1_binding_2_cs[1], 1u);
    uint _e8 = _group_0_binding_0_cs.large_room;
    if ((_e5 < _e8)) {
        uint _e12 = _group_0_binding_0_cs.larges;
        uint at_7 = (_e12 + (LARGE * _e5));
        _group_1_binding_1_cs[at_7] = slot;
        int _e24 = b_25.c_q14_.x;
        _group_1_binding_1_cs[(at_7 + 1u)] = uint(_e24);
        int _e32 = b_25.c_q14_.y;
        _group_1_binding_1_cs[(at_7 + 2u)] = uint(_e32);
        uint _e39 = b_25.breadth_q8_;
        _group_1_binding_1_cs[(at_7 + 3u)] = _e39;
        int _e45 = b_25.shear_q8_;
        _group_1_binding_1_cs[(at_7 + 4u)] = uint(_e45);
        int _e52 = b_25.half_width_q8_;
        _group_1_binding_1_cs[(at_7 + 5u)] = uint(_e52);
        uint _e59 = b_25.square_radius;
        _group_1_binding_1_cs[(at_7 + 6u)] = _e59;
        return;
    } else {
        return;
    }
}
uvec2 list_splat(uint slot_1, inout Placed out_8) {
    Splat s_9 = Splat(0u, 0u, 0, 0, 0, 0, ivec2(0));
    Bounds b_26 = Bounds(ivec2(0), 0u, 0, 0, 0u);
    bool local_24 = false;
    bool local_25 = false;
    bool local_26 = false;
    bool local_27 = false;
    bool local_28 = false;
    bool local_29 = false;
    bool local_30 = false;
    uvec2 box = uvec2(0u, 0u);
    int row_4 = 0;
    bool local_31 = false;
    bool local_32 = false;
    Splat _e3 = out_8.splat;
    s_9 = _e3;
    Bounds _e6 = out_8.bounds;
    b_26 = _e6;
    Span _e8 = rows_of(s_9, b_26);
    Span _e9 = columns_of(b_26);
    int _e12 = _group_0_binding_0_cs.cutoff;
    bool is_square = (_e12 == 1);
    if (!(is_square)) {
        local_24 = (_e9.first > _e9.last);
    } else {
        local_24 = false;
    }
    bool _e22 = local_24;
    if (_e22) {
        return uvec2(0u, 0u);
    }
    int _e30 = _group_0_binding_0_cs.tiles.x;
    uint first_tile = uint(((_e8.first * _e30) + _e9.first));
    if (!(is_square)) {
        local_25 = (_e8.first == _e8.last);
    } else {
        local_25 = false;
    }
    bool _e42 = local_25;
    if (_e42) {
        int _e47 = s_9.rows.x;
        local_26 = (_e47 > 0);
    } else {
        local_26 = false;
    }
    bool _e51 = local_26;
    if (_e51) {
        int _e56 = s_9.rows.y;
        int _e60 = _group_0_binding_0_cs.size.y;
        local_27 = (_e56 < (_e60 - 1));
    } else {
        local_27 = false;
    }
    bool _e65 = local_27;
    if (_e65) {
        local_28 = ((_e9.last - _e9.first) < 4);
    } else {
        local_28 = false;
    }
    bool _e74 = local_28;
    if (_e74) {
        count_tiles(_e8.first, _e9);
        return uvec2(((2u << uint((_e9.last - _e9.first))) - 1u), (first_tile << 10u));
    }
    if (!(is_square)) {
        local_29 = ((_e9.last - _e9.first) >= BOX_COLUMNS);
    } else {
        local_29 = true;
    }
    bool _e96 = local_29;
    if (!(_e96)) {
        local_30 = ((_e8.last - _e8.first) >= BOX_ROWS);
    } else {
        local_30 = true;
    }
    bool large = local_30;
    int _e108 = s_9.offset_q11_;
    int _e109 = radius_q12_(_e108);
    row_4 = _e8.first;
    bool loop_init_21 = true;
    while(true) {
        if (!loop_init_21) {
            int _e154 = row_4;
            row_4 = (_e154 + 1);
        }
        loop_init_21 = false;
        int _e116 = row_4;
        if ((_e116 <= _e8.last)) {
        } else {
            break;
        }
        {
            int _e119 = row_4;
            Span _e120 = span_of(s_9, b_26, _e109, _e119);
            int _e121 = row_4;
            count_tiles(_e121, _e120);
            if (!(large)) {
                local_31 = (_e120.first <= _e120.last);
            } else {
                local_31 = false;
            }
            bool _e129 = local_31;
            if (_e129) {
                uint bits_1 = ((2u << uint((_e120.last - _e9.first))) - (1u << uint((_e120.first - _e9.first))));
                uvec2 _e143 = box;
                int _e147 = row_4;
                uvec2 _e152 = shift_left(uvec2(bits_1, 0u), uint((BOX_COLUMNS * (_e147 - _e8.first))));
                box = (_e143 | _e152);
            }
        }
    }
    if (large) {
        local_32 = (_e8.first <= _e8.last);
    } else {
        local_32 = false;
    }
    bool _e163 = local_32;
    if (_e163) {
        put_large(slot_1, b_26);
    }
    uint _e165 = box.x;
    uint _e167 = box.y;
    if (((_e165 | _e167) == 0u)) {
        uvec2 _e171 = box;
        return _e171;
    }
    uint _e173 = box.x;
    uint _e175 = box.y;
    return uvec2(_e173, (_e175 | (first_tile << 10u)));
}
void put_splat(uint slot_2, inout Splat s_10, ivec3 colour_q13_1) {
    uint at_8 = (8u * slot_2);
    uint _e8 = s_10.u0_q24_;
    _group_1_binding_3_cs[at_8] = _e8;
    uint _e14 = s_10.v0_q24_;
    _group_1_binding_3_cs[(at_8 + 1u)] = _e14;
    int _e20 = s_10.ux_q24_;
    _group_1_binding_3_cs[(at_8 + 2u)] = uint(_e20);
    int _e27 = s_10.uy_q24_;
    _group_1_binding_3_cs[(at_8 + 3u)] = uint(_e27);
    int _e34 = s_10.vy_q24_;
    _group_1_binding_3_cs[(at_8 + 4u)] = uint(_e34);
    int _e41 = s_10.offset_q11_;
    _group_1_binding_3_cs[(at_8 + 5u)] = (uint(_e41) | (uint(colour_q13_1.x) << 16u));
    _group_1_binding_3_cs[(at_8 + 6u)] = (uint(colour_q13_1.y) | (uint(colour_q13_1.z) << 16u));
    int _e65 = s_10.rows.x;
    int _e69 = s_10.rows.y;
    _group_1_binding_3_cs[(at_8 + 7u)] = (uint(_e65) | (uint(_e69) << 16u));
    return;
}
void project_gaussian(uint place, uint slot_3) {
    uint chunk = 0u;
    Projected centre_8 = Projected(ivec3(0), 0, 0u, ivec2(0), ivec2(0), false);
    Placed out_9 = Placed(Splat(0u, 0u, 0, 0, 0, 0, ivec2(0)), Bounds(ivec2(0), 0u, 0, 0, 0u));
    uvec2 box_1 = uvec2(0u, 0u);
    bool local_33 = false;
    bool local_34 = false;
    uint key_1 = 0u;
    uint _e4 = _group_0_binding_0_cs.records;
    uint record_12 = (_e4 + (RECORD * place));
    chunk = place;
    uint _e11 = _group_0_binding_0_cs.drawn;
    if ((_e11 != 0u)) {
        uint _e17 = _group_0_binding_0_cs.drawn;
        uint _e22 = _group_1_binding_1_cs[(_e17 + (2u * place))];
        chunk = _e22;
    }
    uint g_5 = (slot_3 % CHUNK);
    uint _e27 = _group_0_binding_1_cs.rows_at;
    uint _e28 = chunk;
    uint _e31 = _group_0_binding_1_cs.first_chunk;
    uint _e35 = _group_0_binding_1_cs.part_chunk;
    uint _e39 = _group_0_binding_1_cs.chunk_words;
    uint rows_5 = (_e27 + (((_e28 - _e31) - _e35) * _e39));
    Codes _e42 = codes_of(rows_5, g_5);
    uint opacity_1 = (_e42.colour >> 24u);
    if ((opacity_1 != 0u)) {
        bool _e55 = project_centre(centre_8, record_12, _e42.position);
        if (_e55) {
            uint _e62 = _group_1_binding_1_cs[(record_12 + 47u)];
            int _e63 = offset_of(record_12, opacity_1, _e62);
            out_9.splat.offset_q11_ = _e63;
            bool _e66 = project_shape(out_9, record_12, centre_8, _e42.scale, _e42.rotation);
            if (_e66) {
                uint _e71 = _group_0_binding_1_cs.crop_count;
                if (!((_e71 == 0u))) {
                    bool _e78 = is_kept(record_12, _e42.position);
                    local_34 = _e78;
                } else {
                    local_34 = true;
                }
                bool _e80 = local_34;
                local_33 = _e80;
            } else {
                local_33 = false;
            }
            bool _e82 = local_33;
            if (_e82) {
                int _e85 = centre_8.camera.z;
                uint _e86 = depth_key(record_12, _e85);
                key_1 = _e86;
                int _e90 = _group_0_binding_1_cs.plain;
                if ((_e90 == 0)) {
                    uint _e93 = key_1;
                    uint _e94 = scale_depth(_e93);
                    key_1 = _e94;
                }
                ivec3 _e95 = shade(record_12, rows_5, g_5, _e42);
                ivec4 _e98 = _group_0_binding_1_cs.tint_q13_;
                ivec3 colour = min((((_e95 * _e98.xyz) + ivec3(4096)) >> uvec3(13u)), ivec3(32767));
                put_splat(slot_3, out_9.splat, colour);
                uint _e114 = _group_0_binding_0_cs.depths;
                uint _e117 = key_1;
                _group_1_binding_1_cs[(_e114 + slot_3)] = _e117;
                uvec2 _e118 = list_splat(slot_3, out_9);
                box_1 = _e118;
                uint _e121 = atomicAdd(visible_here, 1u);
            }
        }
    }
    uint _e125 = _group_0_binding_0_cs.boxes;
    uint _e131 = box_1.x;
    _group_1_binding_1_cs[(_e125 + (2u * slot_3))] = _e131;
    uint _e135 = _group_0_binding_0_cs.boxes;
    uint _e143 = box_1.y;
    _group_1_binding_1_cs[((_e135 + (2u * slot_3)) + 1u)] = _e143;
    return;
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    if ((thread == 0u)) {
        visible_here = 0u;
    }
    memoryBarrierShared();
    barrier();
    uint _e8 = _group_0_binding_0_cs.spans_at;
    uint _e12 = _group_0_binding_1_cs.span;
    uint span = (_e8 + (SPAN * _e12));
    uint half_1 = ((group.y * ROW_OF_GROUPS) + group.x);
    uint _e24 = _group_1_binding_1_cs[(span + 2u)];
    uint ordinal = (_e24 + (half_1 / 2u));
    uint _e32 = _group_1_binding_1_cs[(span + 3u)];
    if ((ordinal < _e32)) {
        uint _e37 = _group_0_binding_0_cs.visible;
        uint _e40 = _group_1_binding_1_cs[(_e37 + ordinal)];
        project_gaussian(_e40, (((ordinal * CHUNK) + ((half_1 % 2u) * THREADS)) + thread));
    }
    memoryBarrierShared();
    barrier();
    if ((thread == 0u)) {
        uint _e54 = visible_here;
        uint _e55 = atomicAdd(_group_1_binding_2_cs[4], _e54);
        return;
    } else {
        return;
    }
}
