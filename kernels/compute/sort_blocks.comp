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
shared uvec2 keys[1024];
shared uint places[1024];
shared uint bins[512];
shared uint sums[128];
shared uint bounds[2];
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
void place_bins(uint thread_6) {
    uint own = 0u;
    uint i_5 = 0u;
    uint d = 1u;
    uint below = 0u;
    uint start_3 = 0u;
    uint i_6 = 0u;
    i_5 = (4u * thread_6);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e18 = i_5;
            i_5 = (_e18 + 1u);
        }
        loop_init = false;
        uint _e6 = i_5;
        if ((_e6 < ((4u * thread_6) + 4u))) {
        } else {
            break;
        }
        {
            uint _e12 = own;
            uint _e14 = i_5;
            uint _e16 = bins[_e14];
            own = (_e12 + _e16);
        }
    }
    uint _e23 = own;
    sums[thread_6] = _e23;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e43 = d;
            d = (_e43 * 2u);
        }
        loop_init_1 = false;
        uint _e26 = d;
        if ((_e26 < THREADS)) {
        } else {
            break;
        }
        {
            memoryBarrierShared();
            barrier();
            below = 0u;
            uint _e31 = d;
            if ((thread_6 >= _e31)) {
                uint _e34 = d;
                uint _e37 = sums[(thread_6 - _e34)];
                below = _e37;
            }
            memoryBarrierShared();
            barrier();
            uint _e40 = sums[thread_6];
            uint _e41 = below;
            sums[thread_6] = (_e40 + _e41);
        }
    }
    uint _e48 = sums[thread_6];
    uint _e49 = own;
    start_3 = (_e48 - _e49);
    i_6 = (4u * thread_6);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e71 = i_6;
            i_6 = (_e71 + 1u);
        }
        loop_init_2 = false;
        uint _e55 = i_6;
        if ((_e55 < ((4u * thread_6) + 4u))) {
        } else {
            break;
        }
        {
            uint _e62 = i_6;
            uint size = bins[_e62];
            uint _e66 = i_6;
            uint _e68 = start_3;
            bins[_e66] = _e68;
            uint _e69 = start_3;
            start_3 = (_e69 + size);
        }
    }
    memoryBarrierShared();
    barrier();
    return;
}
void fetch(uint thread_7, uint at, uint some) {
    uint least = NOTHING;
    uint most = 0u;
    uint i_7 = 0u;
    i_7 = thread_7;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e24 = i_7;
            i_7 = (_e24 + THREADS);
        }
        loop_init_3 = false;
        uint _e8 = i_7;
        if ((_e8 < some)) {
        } else {
            break;
        }
        {
            uint _e11 = i_7;
            uvec2 key_1 = _group_1_binding_1_cs[(at + _e11)];
            uint _e16 = i_7;
            keys[_e16] = key_1;
            uint _e18 = least;
            least = min(_e18, key_1.y);
            uint _e21 = most;
            most = max(_e21, key_1.y);
        }
    }
    uint _e29 = least;
    uint _e30 = atomicMin(bounds[0], _e29);
    uint _e33 = most;
    uint _e34 = atomicMax(bounds[1], _e33);
    memoryBarrierShared();
    barrier();
    return;
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    uint i = 0u;
    uint i_1 = 0u;
    uint i_2 = 0u;
    uint i_3 = 0u;
    uint start = 0u;
    uint place = 0u;
    uint k = 0u;
    Block _e2 = block_of(group);
    if ((_e2.count == 0u)) {
        return;
    }
    uint some_1 = min((_e2.count - _e2.first), BLOCK);
    uint at_2 = (_e2.list + _e2.first);
    i = thread;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e22 = i;
            i = (_e22 + THREADS);
        }
        loop_init_6 = false;
        uint _e15 = i;
        if ((_e15 < BINS)) {
        } else {
            break;
        }
        {
            uint _e19 = i;
            bins[_e19] = 0u;
        }
    }
    if ((thread == 0u)) {
        bounds[0] = NOTHING;
        bounds[1] = 0u;
    }
    memoryBarrierShared();
    barrier();
    fetch(thread, at_2, some_1);
    uint low_1 = bounds[0];
    uint _e39 = bounds[1];
    uint bits = (32u - uint(31 - findMSB((_e39 - low_1))));
    uint shift = (max(bits, 9u) - 9u);
    i_1 = thread;
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e61 = i_1;
            i_1 = (_e61 + THREADS);
        }
        loop_init_7 = false;
        uint _e48 = i_1;
        if ((_e48 < some_1)) {
        } else {
            break;
        }
        {
            uint _e52 = i_1;
            uint _e55 = keys[_e52].y;
            uint _e60 = atomicAdd(bins[((_e55 - low_1) >> shift)], 1u);
        }
    }
    memoryBarrierShared();
    barrier();
    place_bins(thread);
    i_2 = thread;
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e81 = i_2;
            i_2 = (_e81 + THREADS);
        }
        loop_init_8 = false;
        uint _e65 = i_2;
        if ((_e65 < some_1)) {
        } else {
            break;
        }
        {
            uint _e70 = i_2;
            uint _e73 = keys[_e70].y;
            uint _e78 = atomicAdd(bins[((_e73 - low_1) >> shift)], 1u);
            uint _e80 = i_2;
            places[_e78] = _e80;
        }
    }
    memoryBarrierShared();
    barrier();
    i_3 = thread;
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e132 = i_3;
            i_3 = (_e132 + THREADS);
        }
        loop_init_9 = false;
        uint _e85 = i_3;
        if ((_e85 < some_1)) {
        } else {
            break;
        }
        {
            uint _e88 = i_3;
            uvec2 key_3 = keys[_e88];
            uint bin = ((key_3.y - low_1) >> shift);
            start = 0u;
            if ((bin > 0u)) {
                uint _e102 = bins[(bin - 1u)];
                start = _e102;
            }
            uint end_1 = bins[bin];
            uint _e106 = start;
            place = _e106;
            uint _e108 = start;
            k = _e108;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e125 = k;
                    k = (_e125 + 1u);
                }
                loop_init_10 = false;
                uint _e110 = k;
                if ((_e110 < end_1)) {
                } else {
                    break;
                }
                {
                    uint _e112 = place;
                    uint _e117 = k;
                    uint _e119 = places[_e117];
                    uvec2 _e121 = keys[_e119];
                    bool _e122 = is_below(_e121, key_3);
                    place = (_e112 + (_e122 ? 1u : 0u));
                }
            }
            uint _e129 = place;
            _group_1_binding_1_cs[(at_2 + _e129)] = key_3;
        }
    }
    return;
}
