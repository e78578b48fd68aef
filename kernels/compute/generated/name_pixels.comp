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
uint LIST=8u;const int EVERYWHERE_Q8_=1073741824;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=1)buffer type_10_block_1Compute{uint _group_1_binding_1_cs[];};uint
span_of(uint place){uint low=0u;uint high=0u;uint _e5=_group_0_binding_0_cs.spans;high=_e5;while(true){uint _e7=high;
uint _e8=low;if(((_e7 - _e8)>1u)){}else{break;}{uint _e12=low;uint _e13=high;uint middle=((_e12 + _e13)/2u);uint
_e20=_group_0_binding_0_cs.spans_at;uint _e25=_group_1_binding_1_cs[(_e20 +(SPAN*middle))];if((_e25<=place)){low=middle;
}else{high=middle;}}}uint _e29=_group_0_binding_0_cs.spans_at;uint _e31=low;return(_e29 +(SPAN*_e31));}void main(){
uvec3 group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;uvec2 id=uvec2(4294967295u);uint chunk=0u;uint
pixel=((((group.y*ROW_OF_GROUPS)+ group.x)*THREADS)+ thread);uint _e12=_group_0_binding_0_cs.id;uint at=(_e12
+(2u*pixel));int _e19=_group_0_binding_0_cs.size.x;int _e23=_group_0_binding_0_cs.size.y;if((pixel>=uint((_e19*_e23)))){
return;}uint slot=_group_1_binding_1_cs[at];if((slot!=NOTHING)){uint _e38=_group_0_binding_0_cs.visible;uint
place_1=_group_1_binding_1_cs[(_e38 +(slot/CHUNK))];uint _e44=span_of(place_1);chunk=place_1;uint
_e48=_group_0_binding_0_cs.drawn;if((_e48!=0u)){uint _e54=_group_0_binding_0_cs.drawn;uint
_e61=_group_1_binding_1_cs[((_e54 +(DRAWN*place_1))+ 2u)];chunk=_e61;}uint _e66=_group_1_binding_1_cs[(_e44 + 4u)];uint
_e67=chunk;uint _e72=_group_1_binding_1_cs[(_e44 + 5u)];id=uvec2(_e66,(((_e67 - _e72)*CHUNK)+(slot%CHUNK)));}uint
_e83=id.x;_group_1_binding_1_cs[at]=_e83;uint _e89=id.y;_group_1_binding_1_cs[(at + 1u)]=_e89;return;}
