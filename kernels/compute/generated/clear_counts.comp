#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Object{uvec4 position_q32_[3];uvec4 eye_q32_[3];
ivec4 rotation_q30_[3];ivec4 row_q15_[2];ivec4 forward_q15_[2];ivec4 tint_q13_;uvec2 near_q32_;uvec2 dilation_q30_;
ivec2 f_q12_;ivec2 c_q12_;ivec2 slope_low_q23_;ivec2 slope_high_q23_;ivec2 edge_low_q23_;ivec2 edge_high_q23_;uint
focal_q32_;int focal_exponent;int veil_exponent;int jacobian_exponent;int offset_q11_;int degree;int antialiased;int
orthographic;int plane_exponent;uint profile;int scene_degree;uint chunk_words;uint palette_entries;int
palette_step_q19_;uint scale_mantissa;int scale_exponent;int plain;uint crop_count;uint keep_count;uint first_chunk;
uint first_place;uint end_place;uint span;uint part_chunk;uint rows_at;uint part_chunks;uint motion_at;uint
motion_degree;uint motion_cut_q16_;uint motion_flags;uvec4 crops[32];};struct Splat{uint u0_q24_;uint v0_q24_;int
ux_q24_;int uy_q24_;int vy_q24_;int offset_q11_;ivec2 rows;};struct Bounds{ivec2 c_q14_;uint breadth_q8_;int shear_q8_;
int half_width_q8_;uint square_radius;};struct Span{int first;int last;};const uint CHUNK=256u;const uint THREADS=128u;
const uint ROW_OF_GROUPS=32768u;const uint RECORD=64u;const uint LARGE=8u;const int LARGE_ROWS=8;const uint SPAN=8u;
const uint DRAWN=3u;const uint PAGE=4096u;const uint MERGES=19u;const uint BLOCK=512u;const uint CLASSES=16u;const uint
CUT_OFF=2147483648u;const uint NOTHING=4294967295u;const uint LARGE_BOX=4194303u;const uint MOTION_TURNS=1u;const uint
MOTION_FADES=2u;const int FAR_Q3_=-1048576;const int BOX_COLUMNS=6;const int BOX_ROWS=7;const uint VISIBLE_CHUNKS=0u;
const uint LARGES=1u;const uint PAGES=2u;const uint DAMAGED=3u;const uint VISIBLE=4u;const uint ENTRIES=5u;const uint
SHORT_BLOCKS=7u;const uint LONG_BLOCKS=8u;const uint LONGEST=9u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const
uint LIST=8u;const int EVERYWHERE_Q8_=1073741824;const uint GROUP=16u;layout(std140,binding=0)uniform
Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=2)buffer type_15_block_1Compute{uint
_group_1_binding_2_cs[];};void main(){uvec3 at_1=gl_GlobalInvocationID;uint i_8=(((at_1.y*ROW_OF_GROUPS)*THREADS)+
at_1.x);uint _e10=_group_0_binding_0_cs.cleared;if((i_8<_e10)){_group_1_binding_2_cs[i_8]=0u;return;}else{return;}}
