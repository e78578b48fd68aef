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
struct Block {
    uint list;
    uint count;
    uint first;
    uint done;
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
const uint SAMPLES = 32u;
const uint RANGE = 8u;
const uint BINS = 256u;
const uint DONE = 1048576u;
layout(std430, binding = 0) buffer type_11_block_0Compute { uint _group_1_binding_0_cs[]; };
layout(std140, binding = 0) uniform Frame_block_1Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 1) buffer type_11_block_2Compute { uint _group_1_binding_1_cs[]; };
layout(std430, binding = 2) buffer type_11_block_3Compute { uint _group_1_binding_2_cs[]; };
shared uvec2 keys[512];
shared uint bins[257];
shared uint sums[16];
shared uint samples[32];
shared uvec2 bounds[32];
shared Block own_block;
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
uvec2 key_of(uint entry) {
    uint _e4 = _group_0_binding_0_cs.depths;
    uint _e9 = _group_1_binding_2_cs[(_e4 + (entry & 2147483647u))];
    return uvec2(entry, _e9);
}
uvec2 key_at(bool in_spare, uint at) {
    if (in_spare) {
        uint _e5 = _group_0_binding_0_cs.spare;
        uint _e8 = _group_1_binding_2_cs[(_e5 + at)];
        uvec2 _e9 = key_of(_e8);
        return _e9;
    }
    uint _e12 = _group_1_binding_1_cs[at];
    uvec2 _e13 = key_of(_e12);
    return _e13;
}
void put_entry(bool in_spare_1, uint at_1, uint entry_1) {
    if (in_spare_1) {
        uint _e6 = _group_0_binding_0_cs.spare;
        _group_1_binding_2_cs[(_e6 + at_1)] = entry_1;
        return;
    } else {
        _group_1_binding_1_cs[at_1] = entry_1;
        return;
    }
}
bool is_below(uvec2 a, uvec2 b) {
    return ((a.y == b.y) ? (a.x < b.x) : (a.y < b.y));
}
uint merges_of(uint count) {
    return (max((32u - uint(31 - findMSB((count - 1u)))), 9u) - 9u);
}
Block take_block(uvec3 group_2, uint thread_2) {
    bool local_2 = false;
    uint number_2 = ((group_2.y * ROW_OF_GROUPS) + group_2.x);
    if ((thread_2 == 0u)) {
        uint long_ = _group_1_binding_0_cs[8];
        uint _e14 = _group_0_binding_0_cs.blocks;
        uint _e19 = _group_0_binding_0_cs.block_room;
        uint at_4 = (_e14 + (2u * ((number_2 < long_) ? ((_e19 - 1u) - number_2) : (number_2 - long_))));
        own_block.count = 0u;
        uint _e32 = _group_1_binding_0_cs[7];
        if ((number_2 < (long_ + _e32))) {
            bool _e37 = fits();
            local_2 = _e37;
        } else {
            local_2 = false;
        }
        bool _e39 = local_2;
        if (_e39) {
            uint tile = _group_1_binding_0_cs[at_4];
            uint count_2 = _group_1_binding_0_cs[(TILES + tile)];
            uint _e52 = _group_0_binding_0_cs.next;
            uint _e55 = _group_1_binding_0_cs[(_e52 + tile)];
            uint _e62 = _group_1_binding_0_cs[(at_4 + 1u)];
            uint _e70 = _group_1_binding_0_cs[(at_4 + 1u)];
            own_block = Block((_e55 - count_2), count_2, (BLOCK * (_e62 % DONE)), (_e70 / DONE));
            uint _e78 = _group_1_binding_0_cs[(at_4 + 1u)];
            _group_1_binding_0_cs[(at_4 + 1u)] = (_e78 + DONE);
        }
    }
    memoryBarrierShared();
    barrier();
    Block _e82 = own_block;
    memoryBarrierShared();
    barrier();
    return _e82;
}
void place_bins(uint thread_3, uint some) {
    uint size = 0u;
    uint i_5 = 0u;
    uint start_2 = 0u;
    uint i_6 = 0u;
    uint i_7 = 0u;
    if ((thread_3 < 16u)) {
        for (; (i_5 < 16u); i_5 = (i_5 + 1u)) {
            {
                uint _e11 = size;
                uint _e14 = i_5;
                uint _e17 = bins[((16u * thread_3) + _e14)];
                size = (_e11 + _e17);
            }
        }
        uint _e24 = size;
        sums[thread_3] = _e24;
    }
    memoryBarrierShared();
    barrier();
    uint bin = (2u * thread_3);
    for (; (i_6 < (bin / 16u)); i_6 = (i_6 + 1u)) {
        {
            uint _e34 = start_2;
            uint _e36 = i_6;
            uint _e38 = sums[_e36];
            start_2 = (_e34 + _e38);
        }
    }
    i_7 = ((bin / 16u) * 16u);
    for (; (i_7 < bin); i_7 = (i_7 + 1u)) {
        {
            uint _e48 = start_2;
            uint _e50 = i_7;
            uint _e52 = bins[_e50];
            start_2 = (_e48 + _e52);
        }
    }
    uint _e57 = start_2;
    uint _e60 = bins[bin];
    uint next = (_e57 + _e60);
    memoryBarrierShared();
    barrier();
    uint _e64 = start_2;
    bins[bin] = _e64;
    bins[(bin + 1u)] = next;
    if ((thread_3 == 0u)) {
        bins[256] = some;
    }
    memoryBarrierShared();
    barrier();
    return;
}
void bound_ranges(uint thread_4, uint at_2, uint some_1) {
    uint own_1 = 0u;
    uint place_1 = 0u;
    uint i_8 = 0u;
    bool local_3 = false;
    bool local_4 = false;
    if ((thread_4 < SAMPLES)) {
        uvec2 _e15 = key_at(false, (at_2 + (((thread_4 * max(some_1, SAMPLES)) / SAMPLES) % some_1)));
        own_1 = _e15.y;
        uint _e19 = own_1;
        samples[thread_4] = _e19;
    }
    memoryBarrierShared();
    barrier();
    if ((thread_4 < SAMPLES)) {
        for (; (i_8 < SAMPLES); i_8 = (i_8 + 1u)) {
            {
                uint _e29 = place_1;
                uint _e33 = i_8;
                uint _e35 = samples[_e33];
                uint _e36 = own_1;
                if (!((_e35 < _e36))) {
                    uint _e42 = i_8;
                    uint _e44 = samples[_e42];
                    uint _e45 = own_1;
                    if ((_e44 == _e45)) {
                        uint _e49 = i_8;
                        local_4 = (_e49 < thread_4);
                    } else {
                        local_4 = false;
                    }
                    bool _e52 = local_4;
                    local_3 = _e52;
                } else {
                    local_3 = true;
                }
                bool _e54 = local_3;
                place_1 = (_e29 + (_e54 ? 1u : 0u));
            }
        }
        uint _e61 = place_1;
        uint _e64 = own_1;
        bounds[_e61].x = _e64;
    }
    memoryBarrierShared();
    barrier();
    if ((thread_4 < SAMPLES)) {
        uint _e74 = bounds[min((thread_4 + 1u), 31u)].x;
        uint _e78 = bounds[thread_4].x;
        uint width = (_e74 - _e78);
        bounds[thread_4].y = (max((32u - uint(31 - findMSB(width))), 3u) - 3u);
    }
    memoryBarrierShared();
    barrier();
    return;
}
uint bin_of(uint depth) {
    uint range = 0u;
    uint step_ = 16u;
    for (; (step_ != 0u); step_ = (step_ >> 1u)) {
        {
            uint _e8 = range;
            uint _e10 = step_;
            uint _e12 = range;
            uint _e13 = step_;
            uint _e17 = bounds[(_e12 + _e13)].x;
            range = (_e8 + ((_e17 <= depth) ? _e10 : 0u));
        }
    }
    uint _e25 = range;
    uvec2 bound = bounds[_e25];
    uint _e29 = range;
    return ((RANGE * _e29) + min(((max(depth, bound.x) - bound.x) >> bound.y), 7u));
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    uvec2 own[4] = uvec2[4](uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u));
    uint bin_of_own[4] = uint[4](0u, 0u, 0u, 0u);
    uint place[4] = uint[4](0u, 0u, 0u, 0u);
    uint i = 0u;
    uint k = 0u;
    uint k_1 = 0u;
    uint k_2 = 0u;
    uint below = 0u;
    uint i_1 = 0u;
    Block _e2 = take_block(group, thread);
    if ((_e2.count == 0u)) {
        return;
    }
    uint some_2 = min((_e2.count - _e2.first), BLOCK);
    uint at_5 = (_e2.list + _e2.first);
    uint _e15 = merges_of(_e2.count);
    bool to_spare = ((_e15 % 2u) == 1u);
    i = thread;
    for (; (i < BINS); i = (i + THREADS)) {
        {
            uint _e28 = i;
            bins[_e28] = 0u;
        }
    }
    bound_ranges(thread, at_5, some_2);
    for (; (k < 4u); k = (k + 1u)) {
        {
            uint _e39 = k;
            if (((thread + (_e39 * THREADS)) < some_2)) {
                uint _e44 = k;
                uint _e48 = k;
                uvec2 _e52 = key_at(false, ((at_5 + thread) + (_e48 * THREADS)));
                own[_e44] = _e52;
                uint _e53 = k;
                uint _e55 = k;
                uint _e58 = own[_e55].y;
                uint _e59 = bin_of(_e58);
                bin_of_own[_e53] = _e59;
                uint _e60 = k;
                uint _e63 = k;
                uint _e65 = bin_of_own[_e63];
                uint _e68 = atomicAdd(bins[_e65], 1u);
                place[_e60] = _e68;
            }
        }
    }
    memoryBarrierShared();
    barrier();
    place_bins(thread, some_2);
    for (; (k_1 < 4u); k_1 = (k_1 + 1u)) {
        {
            uint _e77 = k_1;
            if (((thread + (_e77 * THREADS)) < some_2)) {
                uint _e84 = k_1;
                uint _e86 = bin_of_own[_e84];
                uint _e88 = bins[_e86];
                uint _e89 = k_1;
                uint _e91 = place[_e89];
                uint _e94 = k_1;
                uvec2 _e96 = own[_e94];
                keys[(_e88 + _e91)] = _e96;
            }
        }
    }
    memoryBarrierShared();
    barrier();
    for (; (k_2 < 4u); k_2 = (k_2 + 1u)) {
        {
            uint _e105 = k_2;
            if (((thread + (_e105 * THREADS)) < some_2)) {
                uint _e111 = k_2;
                uint _e113 = bin_of_own[_e111];
                uint first_3 = bins[_e113];
                uint _e117 = k_2;
                uint _e119 = bin_of_own[_e117];
                uint end = bins[(_e119 + 1u)];
                below = first_3;
                i_1 = first_3;
                for (; (i_1 < end); i_1 = (i_1 + 1u)) {
                    {
                        uint _e128 = below;
                        uint _e132 = i_1;
                        uvec2 _e134 = keys[_e132];
                        uint _e135 = k_2;
                        uvec2 _e137 = own[_e135];
                        bool _e138 = is_below(_e134, _e137);
                        below = (_e128 + (_e138 ? 1u : 0u));
                    }
                }
                uint _e144 = below;
                uint _e146 = k_2;
                uint _e149 = own[_e146].x;
                put_entry(to_spare, (at_5 + _e144), _e149);
            }
        }
    }
    return;
}
