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
struct Block {
    uint list;
    uint count;
    uint first;
};
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
const uint SAMPLES = 32u;
const uint RANGE = 8u;
const uint BINS = 256u;
layout(std430, binding = 0) readonly buffer type_11_block_0Compute { uint _group_1_binding_0_cs[]; };
layout(std140, binding = 0) uniform Frame_block_1Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 1) buffer type_13_block_2Compute { uvec2 _group_1_binding_1_cs[]; };
bool fits() {
    bool local = false;
    bool local_1 = false;
    uint _e2 = _group_1_binding_0_cs[2];
    uint _e5 = _group_0_binding_0_cs.page_room;
    if ((_e2 <= _e5)) {
        uint _e11 = _group_1_binding_0_cs[1];
        uint _e14 = _group_0_binding_0_cs.large_room;
        local = (_e11 <= _e14);
    } else {
        local = false;
    }
    bool _e17 = local;
    if (_e17) {
        uint _e22 = _group_1_binding_0_cs[0];
        uint _e25 = _group_0_binding_0_cs.chunk_room;
        local_1 = (_e22 <= _e25);
    } else {
        local_1 = false;
    }
    bool _e28 = local_1;
    return _e28;
}
bool is_below(uvec2 a, uvec2 b) {
    return ((a.y == b.y) ? (a.x < b.x) : (a.y < b.y));
}
Block block_of(uint number_2) {
    bool local_2 = false;
    uint long_ = _group_1_binding_0_cs[8];
    uint _e6 = _group_1_binding_0_cs[7];
    if (!((number_2 >= (long_ + _e6)))) {
        bool _e12 = fits();
        local_2 = !(_e12);
    } else {
        local_2 = true;
    }
    bool _e15 = local_2;
    if (_e15) {
        return Block(0u, 0u, 0u);
    }
    uint _e22 = _group_0_binding_0_cs.blocks;
    uint _e27 = _group_0_binding_0_cs.block_room;
    uint at_3 = (_e22 + (2u * ((number_2 < long_) ? ((_e27 - 1u) - number_2) : (number_2 - long_))));
    uint tile = _group_1_binding_0_cs[at_3];
    uint count_1 = _group_1_binding_0_cs[(TILES + tile)];
    uint _e46 = _group_0_binding_0_cs.next;
    uint _e49 = _group_1_binding_0_cs[(_e46 + tile)];
    uint _e56 = _group_1_binding_0_cs[(at_3 + 1u)];
    return Block((_e49 - count_1), count_1, (BLOCK * _e56));
}
uint count_below(uvec4 first_1, uvec4 length_, uint run, uvec2 key) {
    uvec4 count = uvec4(0u);
    uint step_1 = 0u;
    step_1 = (1u << run);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e49 = step_1;
            step_1 = (_e49 >> 1u);
        }
        loop_init = false;
        uint _e10 = step_1;
        if ((_e10 != 0u)) {
        } else {
            break;
        }
        {
            uvec4 _e13 = count;
            uint _e14 = step_1;
            uvec4 next = (_e13 + uvec4(_e14));
            bvec4 inside = lessThanEqual(next, length_);
            uvec4 at_4 = (first_1 + mix(uvec4(0u), (next - uvec4(1u)), inside));
            uvec2 _e28 = _group_1_binding_1_cs[at_4.x];
            bool _e29 = is_below(_e28, key);
            uvec2 _e33 = _group_1_binding_1_cs[at_4.y];
            bool _e34 = is_below(_e33, key);
            uvec2 _e38 = _group_1_binding_1_cs[at_4.z];
            bool _e39 = is_below(_e38, key);
            uvec2 _e43 = _group_1_binding_1_cs[at_4.w];
            bool _e44 = is_below(_e43, key);
            bvec4 below = bvec4(_e29, _e34, _e39, _e44);
            uvec4 _e46 = count;
            count = mix(_e46, next, bvec4(inside.x && below.x, inside.y && below.y, inside.z && below.z, inside.w && below.w));
        }
    }
    uint _e53 = count.x;
    uint _e55 = count.y;
    uint _e58 = count.z;
    uint _e61 = count.w;
    return (((_e53 + _e55) + _e58) + _e61);
}
void merge(uvec3 group_6, uint thread_9, uint run_1, bool from_spare) {
    bool local_5 = false;
    uint place_2 = 0u;
    uint four = 0u;
    uint number_3 = ((group_6.y * ROW_OF_GROUPS) + group_6.x);
    Block _e11 = block_of((number_3 / 4u));
    uint i_9 = ((_e11.first + ((number_3 % 4u) * THREADS)) + thread_9);
    if (!((_e11.count <= (1u << run_1)))) {
        local_5 = (i_9 >= _e11.count);
    } else {
        local_5 = true;
    }
    bool _e29 = local_5;
    if (_e29) {
        return;
    }
    uint _e34 = _group_0_binding_0_cs.spare;
    uint source = (_e11.list + (from_spare ? _e34 : 0u));
    uint _e40 = _group_0_binding_0_cs.spare;
    uint target_list = (_e11.list + (from_spare ? 0u : _e40));
    uvec2 key_1 = _group_1_binding_1_cs[(source + i_9)];
    uint start_3 = ((i_9 >> (run_1 + 4u)) << (run_1 + 4u));
    place_2 = start_3;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e95 = four;
            four = (_e95 + 1u);
        }
        loop_init_1 = false;
        uint _e57 = four;
        if ((_e57 < 4u)) {
        } else {
            break;
        }
        {
            uint _e67 = four;
            uvec4 first_2 = (uvec4(start_3) + ((uvec4(0u, 1u, 2u, 3u) + uvec4((4u * _e67))) << uvec4(run_1)));
            uvec4 length_1 = min((max(uvec4(_e11.count), first_2) - first_2), uvec4((1u << run_1)));
            if ((length_1.x != 0u)) {
                uint _e85 = place_2;
                uint _e93 = count_below((uvec4(source) + min(first_2, uvec4((_e11.count - 1u)))), length_1, run_1, key_1);
                place_2 = (_e85 + _e93);
            }
        }
    }
    uint _e99 = place_2;
    _group_1_binding_1_cs[(target_list + _e99)] = key_1;
    return;
}
void main() {
    uvec3 group_3 = gl_WorkGroupID;
    uint thread_3 = gl_LocalInvocationIndex;
    merge(group_3, thread_3, 17u, false);
    return;
}
