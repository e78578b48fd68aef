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
shared uvec2 keys[512];
shared uint bins[256];
shared uint sums[16];
shared uint samples[32];
shared uvec2 bounds[32];
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
void place_bins(uint thread_6) {
    uint size = 0u;
    uint i_2 = 0u;
    uint start_2 = 0u;
    uint i_3 = 0u;
    uint i_4 = 0u;
    if ((thread_6 < 16u)) {
        bool loop_init = true;
        while(true) {
            if (!loop_init) {
                uint _e18 = i_2;
                i_2 = (_e18 + 1u);
            }
            loop_init = false;
            uint _e8 = i_2;
            if ((_e8 < 16u)) {
            } else {
                break;
            }
            {
                uint _e10 = size;
                uint _e13 = i_2;
                uint _e16 = bins[((16u * thread_6) + _e13)];
                size = (_e10 + _e16);
            }
        }
        uint _e23 = size;
        sums[thread_6] = _e23;
    }
    memoryBarrierShared();
    barrier();
    uint bin = (2u * thread_6);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e39 = i_3;
            i_3 = (_e39 + 1u);
        }
        loop_init_1 = false;
        uint _e30 = i_3;
        if ((_e30 < (bin / 16u))) {
        } else {
            break;
        }
        {
            uint _e33 = start_2;
            uint _e35 = i_3;
            uint _e37 = sums[_e35];
            start_2 = (_e33 + _e37);
        }
    }
    i_4 = ((bin / 16u) * 16u);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e53 = i_4;
            i_4 = (_e53 + 1u);
        }
        loop_init_2 = false;
        uint _e45 = i_4;
        if ((_e45 < bin)) {
        } else {
            break;
        }
        {
            uint _e47 = start_2;
            uint _e49 = i_4;
            uint _e51 = bins[_e49];
            start_2 = (_e47 + _e51);
        }
    }
    uint _e56 = start_2;
    uint _e59 = bins[bin];
    uint next = (_e56 + _e59);
    memoryBarrierShared();
    barrier();
    uint _e63 = start_2;
    bins[bin] = _e63;
    bins[(bin + 1u)] = next;
    memoryBarrierShared();
    barrier();
    return;
}
void bound_ranges(uint thread_7, uint at, uint some) {
    uint own = 0u;
    uint place_1 = 0u;
    uint i_5 = 0u;
    bool local_3 = false;
    bool local_4 = false;
    if ((thread_7 < SAMPLES)) {
        uint _e17 = _group_1_binding_1_cs[(at + (((thread_7 * max(some, SAMPLES)) / SAMPLES) % some))].y;
        own = _e17;
        uint _e20 = own;
        samples[thread_7] = _e20;
    }
    memoryBarrierShared();
    barrier();
    if ((thread_7 < SAMPLES)) {
        bool loop_init_3 = true;
        while(true) {
            if (!loop_init_3) {
                uint _e58 = i_5;
                i_5 = (_e58 + 1u);
            }
            loop_init_3 = false;
            uint _e27 = i_5;
            if ((_e27 < SAMPLES)) {
            } else {
                break;
            }
            {
                uint _e30 = place_1;
                uint _e34 = i_5;
                uint _e36 = samples[_e34];
                uint _e37 = own;
                if (!((_e36 < _e37))) {
                    uint _e43 = i_5;
                    uint _e45 = samples[_e43];
                    uint _e46 = own;
                    if ((_e45 == _e46)) {
                        uint _e50 = i_5;
                        local_4 = (_e50 < thread_7);
                    } else {
                        local_4 = false;
                    }
                    bool _e53 = local_4;
                    local_3 = _e53;
                } else {
                    local_3 = true;
                }
                bool _e55 = local_3;
                place_1 = (_e30 + (_e55 ? 1u : 0u));
            }
        }
        uint _e62 = place_1;
        uint _e65 = own;
        bounds[_e62].x = _e65;
    }
    memoryBarrierShared();
    barrier();
    if ((thread_7 < SAMPLES)) {
        uint _e75 = bounds[min((thread_7 + 1u), 31u)].x;
        uint _e79 = bounds[thread_7].x;
        uint width = (_e75 - _e79);
        bounds[thread_7].y = (max((32u - uint(31 - findMSB(width))), 3u) - 3u);
    }
    memoryBarrierShared();
    barrier();
    return;
}
uint bin_of(uint depth) {
    uint range = 0u;
    uint step_ = 16u;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e21 = step_;
            step_ = (_e21 >> 1u);
        }
        loop_init_4 = false;
        uint _e5 = step_;
        if ((_e5 != 0u)) {
        } else {
            break;
        }
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
void fill_bins(uint thread_8, uint at_1, uint some_1) {
    uint i_6 = 0u;
    uint i_7 = 0u;
    uint i_8 = 0u;
    i_6 = thread_8;
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e11 = i_6;
            i_6 = (_e11 + THREADS);
        }
        loop_init_5 = false;
        uint _e4 = i_6;
        if ((_e4 < BINS)) {
        } else {
            break;
        }
        {
            uint _e8 = i_6;
            bins[_e8] = 0u;
        }
    }
    memoryBarrierShared();
    barrier();
    i_7 = thread_8;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e28 = i_7;
            i_7 = (_e28 + THREADS);
        }
        loop_init_6 = false;
        uint _e15 = i_7;
        if ((_e15 < some_1)) {
        } else {
            break;
        }
        {
            uint _e19 = i_7;
            uint _e23 = _group_1_binding_1_cs[(at_1 + _e19)].y;
            uint _e24 = bin_of(_e23);
            uint _e27 = atomicAdd(bins[_e24], 1u);
        }
    }
    memoryBarrierShared();
    barrier();
    place_bins(thread_8);
    i_8 = thread_8;
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e47 = i_8;
            i_8 = (_e47 + THREADS);
        }
        loop_init_7 = false;
        uint _e32 = i_8;
        if ((_e32 < some_1)) {
        } else {
            break;
        }
        {
            uint _e35 = i_8;
            uvec2 key_1 = _group_1_binding_1_cs[(at_1 + _e35)];
            uint _e42 = bin_of(key_1.y);
            uint _e45 = atomicAdd(bins[_e42], 1u);
            keys[_e45] = key_1;
        }
    }
    memoryBarrierShared();
    barrier();
    return;
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    uint i = 0u;
    uint place = 0u;
    uint k = 0u;
    Block _e7 = block_of(((group.y * ROW_OF_GROUPS) + group.x));
    if ((_e7.count == 0u)) {
        return;
    }
    uint some_2 = min((_e7.count - _e7.first), BLOCK);
    uint at_5 = (_e7.list + _e7.first);
    bound_ranges(thread, at_5, some_2);
    fill_bins(thread, at_5, some_2);
    i = thread;
    bool loop_init_10 = true;
    while(true) {
        if (!loop_init_10) {
            uint _e61 = i;
            i = (_e61 + THREADS);
        }
        loop_init_10 = false;
        uint _e20 = i;
        if ((_e20 < some_2)) {
        } else {
            break;
        }
        {
            uint _e23 = i;
            uvec2 key_3 = keys[_e23];
            uint _e27 = bin_of(key_3.y);
            place = 0u;
            if ((_e27 > 0u)) {
                uint _e36 = bins[(_e27 - 1u)];
                place = _e36;
            }
            uint end = bins[_e27];
            uint _e40 = place;
            k = _e40;
            bool loop_init_11 = true;
            while(true) {
                if (!loop_init_11) {
                    uint _e54 = k;
                    k = (_e54 + 1u);
                }
                loop_init_11 = false;
                uint _e42 = k;
                if ((_e42 < end)) {
                } else {
                    break;
                }
                {
                    uint _e44 = place;
                    uint _e48 = k;
                    uvec2 _e50 = keys[_e48];
                    bool _e51 = is_below(_e50, key_3);
                    place = (_e44 + (_e51 ? 1u : 0u));
                }
            }
            uint _e58 = place;
            _group_1_binding_1_cs[(at_5 + _e58)] = key_3;
        }
    }
    return;
}
