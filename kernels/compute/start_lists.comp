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
    uint depths;
    uint boxes;
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
const uint CHUNK = 256u;
const uint THREADS = 128u;
const uint ROW_OF_GROUPS = 32768u;
const uint RECORD = 64u;
const uint LARGE = 8u;
const int LARGE_ROWS = 8;
const uint SPAN = 8u;
const uint PAGE = 4096u;
const uint MERGES = 19u;
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
layout(std140, binding = 0) uniform Frame_block_0Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 0) buffer type_11_block_1Compute { uint _group_1_binding_0_cs[]; };
layout(std430, binding = 2) buffer type_13_block_2Compute { uint _group_1_binding_2_cs[]; };
shared uint sums[128];
shared uint first_page;
uint add_most(uint a_16, uint b_8) {
    return (((a_16 + b_8) < a_16) ? 4294967295u : (a_16 + b_8));
}
uint sum_to(uint thread_1, uint own_1, bool cut) {
    uint d = 1u;
    uint below = 0u;
    memoryBarrierShared();
    barrier();
    sums[thread_1] = own_1;
    for (; (d < THREADS); d = (d * 2u)) {
        {
            memoryBarrierShared();
            barrier();
            below = 0u;
            uint _e12 = d;
            if ((thread_1 >= _e12)) {
                uint _e15 = d;
                uint _e18 = sums[(thread_1 - _e15)];
                below = _e18;
            }
            memoryBarrierShared();
            barrier();
            if (cut) {
                uint _e23 = sums[thread_1];
                uint _e24 = below;
                uint _e25 = add_most(_e23, _e24);
                sums[thread_1] = _e25;
            } else {
                uint _e28 = sums[thread_1];
                uint _e29 = below;
                sums[thread_1] = (_e28 + _e29);
            }
        }
    }
    memoryBarrierShared();
    barrier();
    uint _e36 = sums[thread_1];
    return _e36;
}
uint class_of(uint length_1) {
    return ((length_1 == 0u) ? 0u : min((34u - uint(31 - findMSB(length_1))), 15u));
}
void put_blocks(uint tile, uint length_2) {
    uint at = 0u;
    uint i_1 = 0u;
    bool local = false;
    uint blocks = ((length_2 > 1u) ? (((length_2 - 1u) / BLOCK) + 1u) : 0u);
    if ((blocks == 0u)) {
        return;
    }
    if ((blocks > 1u)) {
        uint _e20 = atomicMax(_group_1_binding_2_cs[9], length_2);
        uint _e23 = _group_0_binding_0_cs.block_room;
        uint _e26 = atomicAdd(_group_1_binding_2_cs[8], blocks);
        at = ((_e23 - _e26) - blocks);
    } else {
        uint _e32 = atomicAdd(_group_1_binding_2_cs[7], 1u);
        at = _e32;
    }
    for (; ; i_1 = (i_1 + 1u)) {
        uint _e35 = i_1;
        if ((_e35 < blocks)) {
            uint _e39 = at;
            uint _e40 = i_1;
            uint _e44 = _group_0_binding_0_cs.block_room;
            local = ((_e39 + _e40) < _e44);
        } else {
            local = false;
        }
        bool _e47 = local;
        if (_e47) {
        } else {
            break;
        }
        {
            uint _e51 = _group_0_binding_0_cs.blocks;
            uint _e53 = at;
            uint _e54 = i_1;
            _group_1_binding_2_cs[(_e51 + (2u * (_e53 + _e54)))] = tile;
            uint _e62 = _group_0_binding_0_cs.blocks;
            uint _e64 = at;
            uint _e65 = i_1;
            uint _e72 = i_1;
            _group_1_binding_2_cs[((_e62 + (2u * (_e64 + _e65))) + 1u)] = _e72;
        }
    }
    return;
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    uint tiles_before = 0u;
    uint entries_before = 0u;
    uint first = 0u;
    uint own = 0u;
    uint length_ = 0u;
    uint column = 0u;
    int _e5 = _group_0_binding_0_cs.tiles.x;
    uint across = uint(_e5);
    uint row = (group.x * across);
    for (; (first < across); first = (first + THREADS)) {
        {
            uint _e17 = first;
            uint column_1 = (_e17 + thread);
            uint at_1 = ((TILES + row) + column_1);
            own = 0u;
            if ((column_1 < across)) {
                uint _e27 = _group_1_binding_2_cs[at_1];
                own = _e27;
            }
            uint _e28 = tiles_before;
            uint _e29 = own;
            uint _e31 = sum_to(thread, _e29, false);
            length_ = (_e28 + _e31);
            uint _e34 = tiles_before;
            uint _e37 = sums[127];
            tiles_before = (_e34 + _e37);
            if ((column_1 >= across)) {
                length_ = 0u;
            }
            uint _e41 = entries_before;
            uint _e42 = length_;
            uint _e44 = sum_to(thread, _e42, true);
            uint _e45 = add_most(_e41, _e44);
            uint _e46 = entries_before;
            uint _e49 = sums[127];
            uint _e50 = add_most(_e46, _e49);
            entries_before = _e50;
            if ((column_1 < across)) {
                uint _e54 = length_;
                _group_1_binding_2_cs[at_1] = _e54;
                uint _e58 = _group_0_binding_0_cs.next;
                uint _e62 = length_;
                _group_1_binding_2_cs[((_e58 + row) + column_1)] = (_e45 - _e62);
            }
        }
    }
    if ((thread == 0u)) {
        uint _e71 = entries_before;
        uint _e72 = atomicAdd(_group_1_binding_2_cs[5], _e71);
        uint _e73 = entries_before;
        uint _e75 = entries_before;
        if (((_e72 + _e73) < _e75)) {
            uint _e80 = atomicAdd(_group_1_binding_2_cs[6], 1u);
        }
        uint _e84 = entries_before;
        uint _e89 = atomicAdd(_group_1_binding_2_cs[2], ((_e84 / PAGE) + 1u));
        first_page = _e89;
        if ((group.x == 0u)) {
            uint _e95 = _group_1_binding_2_cs[1];
            uint _e98 = _group_0_binding_0_cs.large_room;
            uint larges = min(_e95, _e98);
            uint _e103 = _group_0_binding_0_cs.spans;
            uint at_2 = (4u * (_e103 + 1u));
            _group_1_binding_0_cs[at_2] = min(larges, ROW_OF_GROUPS);
            _group_1_binding_0_cs[(at_2 + 1u)] = (((larges + ROW_OF_GROUPS) - 1u) / ROW_OF_GROUPS);
            _group_1_binding_0_cs[(at_2 + 2u)] = 1u;
        }
    }
    memoryBarrierShared();
    barrier();
    column = thread;
    for (; (column < across); column = (column + THREADS)) {
        {
            uint _e129 = column;
            uint tile_1 = (row + _e129);
            uint length_3 = _group_1_binding_2_cs[(TILES + tile_1)];
            uint _e136 = class_of(length_3);
            put_blocks(tile_1, length_3);
            uint _e142 = atomicAdd(_group_1_binding_2_cs[(CLASS_COUNTS + _e136)], 1u);
            uint _e146 = _group_0_binding_0_cs.classes;
            int _e151 = _group_0_binding_0_cs.tiles.y;
            _group_1_binding_2_cs[((_e146 + ((_e136 * across) * uint(_e151))) + _e142)] = tile_1;
            uint _e160 = _group_0_binding_0_cs.next;
            uint _e164 = first_page;
            uint _e167 = atomicAdd(_group_1_binding_2_cs[(_e160 + tile_1)], (_e164 * PAGE));
        }
    }
    return;
}
