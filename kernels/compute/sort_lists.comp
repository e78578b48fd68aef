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
const uint ROOM = 2048u;
layout(std140, binding = 0) uniform Frame_block_0Compute { Frame _group_0_binding_0_cs; };
layout(std430, binding = 0) readonly buffer type_10_block_1Compute { uint _group_1_binding_0_cs[]; };
layout(std430, binding = 1) buffer type_12_block_2Compute { uvec2 _group_1_binding_1_cs[]; };
shared uvec2 keys[2048];
uint tile_at(uint number) {
    uint rest = 0u;
    uint class_number = CLASSES;
    int _e4 = _group_0_binding_0_cs.tiles.x;
    int _e8 = _group_0_binding_0_cs.tiles.y;
    uint tiles = uint((_e4 * _e8));
    rest = number;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e42 = class_number;
            class_number = (_e42 - 1u);
        }
        loop_init = false;
        uint _e14 = class_number;
        if ((_e14 > 0u)) {
        } else {
            break;
        }
        {
            uint _e19 = class_number;
            uint count_5 = _group_1_binding_0_cs[((CLASS_COUNTS + _e19) - 1u)];
            uint _e25 = rest;
            if ((_e25 < count_5)) {
                uint _e30 = _group_0_binding_0_cs.classes;
                uint _e31 = class_number;
                uint _e36 = rest;
                uint _e39 = _group_1_binding_0_cs[((_e30 + ((_e31 - 1u) * tiles)) + _e36)];
                return _e39;
            }
            uint _e40 = rest;
            rest = (_e40 - count_5);
        }
    }
    return NOTHING;
}
bool fits() {
    bool local_1 = false;
    bool local_2 = false;
    uint _e2 = _group_1_binding_0_cs[2];
    uint _e5 = _group_0_binding_0_cs.page_room;
    if ((_e2 <= _e5)) {
        uint _e11 = _group_1_binding_0_cs[1];
        uint _e14 = _group_0_binding_0_cs.large_room;
        local_1 = (_e11 <= _e14);
    } else {
        local_1 = false;
    }
    bool _e17 = local_1;
    if (_e17) {
        uint _e22 = _group_1_binding_0_cs[0];
        uint _e25 = _group_0_binding_0_cs.chunk_room;
        local_2 = (_e22 <= _e25);
    } else {
        local_2 = false;
    }
    bool _e28 = local_2;
    return _e28;
}
bool is_above(uvec2 a, uvec2 b) {
    return ((a.y == b.y) ? (a.x > b.x) : (a.y > b.y));
}
uvec2 pair_of(uint i_2, uint log_1, bool turned) {
    uint distance_ = (1u << log_1);
    uint within = (i_2 & (distance_ - 1u));
    uint low = (((i_2 >> log_1) << (log_1 + 1u)) + within);
    return uvec2(low, (turned ? (((low + (2u * distance_)) - 1u) - (2u * within)) : (low + distance_)));
}
void order_here(uint i_3, uint log_2, bool turned_1) {
    uvec2 _e3 = pair_of(i_3, log_2, turned_1);
    uvec2 a_1 = keys[_e3.x];
    uvec2 b_1 = keys[_e3.y];
    bool _e12 = is_above(a_1, b_1);
    if (_e12) {
        keys[_e3.x] = b_1;
        keys[_e3.y] = a_1;
        return;
    } else {
        return;
    }
}
void merge_here(uint thread_1, uint first, uint end, uint half_, bool turns) {
    uint size_1 = 0u;
    uint log_3 = 0u;
    uint i_4 = 0u;
    bool local_3 = false;
    size_1 = first;
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e33 = size_1;
            size_1 = (_e33 + 1u);
        }
        loop_init_1 = false;
        uint _e6 = size_1;
        if ((_e6 <= end)) {
        } else {
            break;
        }
        {
            uint _e8 = size_1;
            log_3 = _e8;
            bool loop_init_2 = true;
            while(true) {
                if (!loop_init_2) {
                    uint _e30 = log_3;
                    log_3 = (_e30 - 1u);
                }
                loop_init_2 = false;
                uint _e10 = log_3;
                if ((_e10 > 0u)) {
                } else {
                    break;
                }
                {
                    memoryBarrierShared();
                    barrier();
                    i_4 = thread_1;
                    bool loop_init_3 = true;
                    while(true) {
                        if (!loop_init_3) {
                            uint _e27 = i_4;
                            i_4 = (_e27 + THREADS);
                        }
                        loop_init_3 = false;
                        uint _e14 = i_4;
                        if ((_e14 < half_)) {
                        } else {
                            break;
                        }
                        {
                            uint _e16 = i_4;
                            uint _e17 = log_3;
                            if (turns) {
                                uint _e22 = log_3;
                                uint _e23 = size_1;
                                local_3 = (_e22 == _e23);
                            } else {
                                local_3 = false;
                            }
                            bool _e26 = local_3;
                            order_here(_e16, (_e17 - 1u), _e26);
                        }
                    }
                }
            }
        }
    }
    memoryBarrierShared();
    barrier();
    return;
}
void fetch(uint thread_2, uint at, uint count, uint room) {
    uint i_5 = 0u;
    uvec2 key = uvec2(0u);
    i_5 = thread_2;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e22 = i_5;
            i_5 = (_e22 + THREADS);
        }
        loop_init_4 = false;
        uint _e5 = i_5;
        if ((_e5 < room)) {
        } else {
            break;
        }
        {
            key = uvec2(4294967295u, 4294967295u);
            uint _e11 = i_5;
            if ((_e11 < count)) {
                uint _e14 = i_5;
                uvec2 _e17 = _group_1_binding_1_cs[(at + _e14)];
                key = _e17;
            }
            uint _e19 = i_5;
            uvec2 _e21 = key;
            keys[_e19] = _e21;
        }
    }
    return;
}
void put_back(uint thread_3, uint at_1, uint count_1) {
    uint i_6 = 0u;
    i_6 = thread_3;
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e14 = i_6;
            i_6 = (_e14 + THREADS);
        }
        loop_init_5 = false;
        uint _e4 = i_6;
        if ((_e4 < count_1)) {
        } else {
            break;
        }
        {
            uint _e7 = i_6;
            uint _e11 = i_6;
            uvec2 _e13 = keys[_e11];
            _group_1_binding_1_cs[(at_1 + _e7)] = _e13;
        }
    }
    memoryBarrierShared();
    barrier();
    return;
}
uint bits_of(uint count_2) {
    return (32u - uint(31 - findMSB((count_2 - 1u))));
}
void order_there(uint i_7, uint at_2, uint count_3, uint log_4, bool turned_2) {
    uvec2 _e5 = pair_of(i_7, log_4, turned_2);
    if ((_e5.y < count_3)) {
        uvec2 a_2 = _group_1_binding_1_cs[(at_2 + _e5.x)];
        uvec2 b_2 = _group_1_binding_1_cs[(at_2 + _e5.y)];
        bool _e18 = is_above(a_2, b_2);
        if (_e18) {
            _group_1_binding_1_cs[(at_2 + _e5.x)] = b_2;
            _group_1_binding_1_cs[(at_2 + _e5.y)] = a_2;
            return;
        } else {
            return;
        }
    } else {
        return;
    }
}
void sort_blocks(uint thread_4, uint at_3, uint count_4, uint first_1, bool turns_1) {
    uint block = 0u;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e20 = block;
            block = (_e20 + ROOM);
        }
        loop_init_6 = false;
        uint _e7 = block;
        if ((_e7 < count_4)) {
        } else {
            break;
        }
        {
            uint _e9 = block;
            uint some = min((count_4 - _e9), ROOM);
            uint _e13 = block;
            fetch(thread_4, (at_3 + _e13), some, ROOM);
            merge_here(thread_4, first_1, 11u, 1024u, turns_1);
            uint _e18 = block;
            put_back(thread_4, (at_3 + _e18), some);
        }
    }
    memoryBarrierBuffer();
    barrier();
    return;
}
void main() {
    uvec3 group = gl_WorkGroupID;
    uint thread = gl_LocalInvocationIndex;
    bool local = false;
    uint size = 12u;
    uint log_ = 0u;
    uint i = 0u;
    uint _e7 = tile_at(((group.y * ROW_OF_GROUPS) + group.x));
    if (!((_e7 == NOTHING))) {
        bool _e13 = fits();
        local = !(_e13);
    } else {
        local = true;
    }
    bool _e16 = local;
    if (_e16) {
        return;
    }
    uint count_6 = _group_1_binding_0_cs[(TILES + _e7)];
    uint _e25 = _group_0_binding_0_cs.next;
    uint _e28 = _group_1_binding_0_cs[(_e25 + _e7)];
    uint at_4 = (_e28 - count_6);
    if ((count_6 < 2u)) {
        return;
    }
    uint _e32 = bits_of(count_6);
    if ((count_6 <= ROOM)) {
        fetch(thread, at_4, count_6, (1u << _e32));
        merge_here(thread, 1u, _e32, ((1u << _e32) / 2u), true);
        put_back(thread, at_4, count_6);
        return;
    }
    sort_blocks(thread, at_4, count_6, 1u, true);
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e76 = size;
            size = (_e76 + 1u);
        }
        loop_init_7 = false;
        uint _e47 = size;
        if ((_e47 <= _e32)) {
        } else {
            break;
        }
        {
            uint _e49 = size;
            log_ = _e49;
            bool loop_init_8 = true;
            while(true) {
                if (!loop_init_8) {
                    uint _e71 = log_;
                    log_ = (_e71 - 1u);
                }
                loop_init_8 = false;
                uint _e51 = log_;
                if ((_e51 > 11u)) {
                } else {
                    break;
                }
                {
                    i = thread;
                    bool loop_init_9 = true;
                    while(true) {
                        if (!loop_init_9) {
                            uint _e68 = i;
                            i = (_e68 + THREADS);
                        }
                        loop_init_9 = false;
                        uint _e55 = i;
                        if ((_e55 < ((1u << _e32) / 2u))) {
                        } else {
                            break;
                        }
                        {
                            uint _e61 = i;
                            uint _e62 = log_;
                            uint _e65 = log_;
                            uint _e66 = size;
                            order_there(_e61, at_4, count_6, (_e62 - 1u), (_e65 == _e66));
                        }
                    }
                    memoryBarrierBuffer();
                    barrier();
                }
            }
            sort_blocks(thread, at_4, count_6, 11u, false);
        }
    }
    return;
}
