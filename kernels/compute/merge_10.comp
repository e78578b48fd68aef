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
const uint BINS = 512u;
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
Block block_of(uvec3 group_6) {
    bool local_2 = false;
    uint number_2 = ((group_6.y * ROW_OF_GROUPS) + group_6.x);
    uint _e8 = _group_1_binding_0_cs[7];
    if (!((number_2 >= _e8))) {
        bool _e13 = fits();
        local_2 = !(_e13);
    } else {
        local_2 = true;
    }
    bool _e16 = local_2;
    if (_e16) {
        return Block(0u, 0u, 0u);
    }
    uint _e24 = _group_0_binding_0_cs.blocks;
    uint tile = _group_1_binding_0_cs[(_e24 + (2u * number_2))];
    uint count = _group_1_binding_0_cs[(TILES + tile)];
    uint _e38 = _group_0_binding_0_cs.next;
    uint _e41 = _group_1_binding_0_cs[(_e38 + tile)];
    uint _e47 = _group_0_binding_0_cs.blocks;
    uint _e54 = _group_1_binding_0_cs[((_e47 + (2u * number_2)) + 1u)];
    return Block((_e41 - count), count, (BLOCK * _e54));
}
uint count_below(uint first_1, uint length_, uvec2 key) {
    uint low = 0u;
    uint high = 0u;
    high = length_;
    while(true) {
        uint _e6 = low;
        uint _e7 = high;
        if ((_e6 < _e7)) {
        } else {
            break;
        }
        {
            uint _e9 = low;
            uint _e10 = high;
            uint middle = ((_e9 + _e10) / 2u);
            uvec2 _e17 = _group_1_binding_1_cs[(first_1 + middle)];
            bool _e18 = is_below(_e17, key);
            if (_e18) {
                low = (middle + 1u);
            } else {
                high = middle;
            }
        }
    }
    uint _e21 = low;
    return _e21;
}
void merge(uint thread_8, Block block, uint run, bool from_spare) {
    uint i_8 = 0u;
    uint place_1 = 0u;
    uint other = 0u;
    bool local_3 = false;
    if ((block.count <= (1u << run))) {
        return;
    }
    uint _e12 = _group_0_binding_0_cs.spare;
    uint source = (block.list + (from_spare ? _e12 : 0u));
    uint _e18 = _group_0_binding_0_cs.spare;
    uint target_list = (block.list + (from_spare ? 0u : _e18));
    uint end = min((block.first + BLOCK), block.count);
    i_8 = (block.first + thread_8);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e81 = i_8;
            i_8 = (_e81 + THREADS);
        }
        loop_init = false;
        uint _e30 = i_8;
        if ((_e30 < end)) {
        } else {
            break;
        }
        {
            uint _e33 = i_8;
            uvec2 key_1 = _group_1_binding_1_cs[(source + _e33)];
            uint _e37 = i_8;
            uint own_1 = (_e37 >> run);
            uint first_run = (own_1 & 4294967280u);
            uint _e42 = i_8;
            place_1 = ((first_run << run) + (_e42 & ((1u << run) - 1u)));
            other = first_run;
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e74 = other;
                    other = (_e74 + 1u);
                }
                loop_init_1 = false;
                uint _e51 = other;
                if ((_e51 < (first_run + 16u))) {
                } else {
                    break;
                }
                {
                    uint _e55 = other;
                    uint first_2 = (_e55 << run);
                    uint _e57 = other;
                    if ((_e57 != own_1)) {
                        local_3 = (first_2 < block.count);
                    } else {
                        local_3 = false;
                    }
                    bool _e64 = local_3;
                    if (_e64) {
                        uint _e65 = place_1;
                        uint _e72 = count_below((source + first_2), min((1u << run), (block.count - first_2)), key_1);
                        place_1 = (_e65 + _e72);
                    }
                }
            }
            uint _e78 = place_1;
            _group_1_binding_1_cs[(target_list + _e78)] = key_1;
        }
    }
    return;
}
void main() {
    uvec3 group_1 = gl_WorkGroupID;
    uint thread_1 = gl_LocalInvocationIndex;
    Block _e2 = block_of(group_1);
    merge(thread_1, _e2, 10u, false);
    return;
}
