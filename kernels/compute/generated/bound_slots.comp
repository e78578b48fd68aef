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
int half_width_q8_;uint square_radius;};struct Span{int first;int last;};struct Pixel{int transmittance;ivec3 sum;};
struct Fetched{uint entry;uvec4 a;uvec4 b;};struct Patch{uint x;uint y;uint shift;uvec2 rows;uint list;uint count;};
struct Taken{uint u;uint ux;uint level_q26_;int limit_q11_;ivec3 colour;};struct Share{uint tile;uint number;uvec2 rows;
};struct Place{uint column;uint row;uvec2 at;bvec2 inside;};struct Block{uint list;uint count;uint first;uint done;};
struct Traced{uint limit;int weight;uint largest;uint median;uvec2 sum;};struct Box{uvec2 first;uvec2 end;uvec2 mask;
bool large;};struct Lists{uint halves;uint list;uint room;};struct Turn{Lists lists;uint first;uint end;};const int
FXS_CUT_Q11_=18432;const int FXS_FAINT_Q11_=22697;const int FXS_LEVEL_MAX_Q11_=32767;const int FXS_ALPHA_MAX_Q15_=32440;
const int FXS_CLEAR_Q15_=32767;const int FXS_CLOSED_Q15_=33;const uint CHUNK=256u;const uint THREADS=128u;const uint
ROW_OF_GROUPS=32768u;const uint RECORD=64u;const uint LARGE=8u;const int LARGE_ROWS=8;const uint SPAN=8u;const uint
DRAWN=3u;const uint PAGE=4096u;const uint MERGES=19u;const uint BLOCK=512u;const uint CLASSES=16u;const uint
CUT_OFF=2147483648u;const uint NOTHING=4294967295u;const uint LARGE_BOX=4194303u;const uint MOTION_TURNS=1u;const uint
MOTION_FADES=2u;const int FAR_Q3_=-1048576;const int BOX_COLUMNS=6;const int BOX_ROWS=7;const uint VISIBLE_CHUNKS=0u;
const uint LARGES=1u;const uint PAGES=2u;const uint DAMAGED=3u;const uint VISIBLE=4u;const uint ENTRIES=5u;const uint
SHORT_BLOCKS=7u;const uint LONG_BLOCKS=8u;const uint LONGEST=9u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const
uint LIST=8u;const int EVERYWHERE_Q8_=1073741824;const uint GROUP=16u;const uint SIDE=8u;const uint SOME=32u;const uint
APART=4u;const uint SAMPLES=16u;const uint RANGE=16u;const uint BINS=256u;const uint SPARE=2147483648u;const uint
DONE=1048576u;const int HALF_Q15_=16384;const int REACH=4;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=0)buffer type_14_block_1Compute{uint _group_1_binding_0_cs[];};
layout(std430,binding=1)buffer type_14_block_2Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)readonly
buffer type_18_block_3Compute{uvec4 _group_1_binding_2_cs[];};layout(std430,binding=3)buffer type_14_block_4Compute{
uint _group_1_binding_3_cs[];};shared uint bound[4];uvec2 shift_right(uvec2 a_15,uint n_1){if((n_1==0u)){return a_15;}
if((n_1>=32u)){return uvec2((a_15.y>>(n_1 - 32u)),0u);}return uvec2(((a_15.x>>n_1)|(a_15.y<<(32u - n_1))),
(a_15.y>>n_1));}int zeros_of(uint x_2){return int(uint(31 - findMSB(x_2)));}int zeros_of_wide(uvec2 x_3){int
_e2=zeros_of(x_3.x);int _e6=zeros_of(x_3.y);return((x_3.y!=0u)?_e6:(32 + _e2));}ivec2 centre_q3_(uvec2 box){uint
y_2=((box.x>>21u)|(box.y<<11u));return(ivec2((uvec2(box.x,y_2)<<uvec2(11u)))>>uvec2(11u));}uvec2 columns_of(uint slot_1,
ivec2 centre){uvec4 a_23=_group_1_binding_2_cs[(2u*slot_1)];uint _e14=_group_1_binding_2_cs[((2u*slot_1)+ 1u)].x;uint
vy=max(_e14,1u);uint ratio_q6_=(((uint(abs(int(a_23.w)))<<6u)/vy)+ 65u);uint pixels=((67108864u/max(a_23.z,1u))+ 1u);
int half_1=(int(min(((pixels*min(ratio_q6_,((67108864u/pixels)+ 1u)))>>6u),1048575u))+ 1);int
_e58=_group_0_binding_0_cs.size.x;ivec2 range_1=min(max((ivec2((centre.x>>3u))+ ivec2(-(half_1),half_1)),ivec2(0)),
ivec2((_e58 - 1)));uint _e66=_group_0_binding_0_cs.tile_bits;return((uvec2(range_1)>>uvec2(_e66))+ uvec2(0u,1u));}Box
large_box(uint slot_2,uvec2 word_3){uvec2 columns=uvec2(0u);int _e4=_group_0_binding_0_cs.cutoff;if((_e4==1)){uint
_e10=_group_0_binding_0_cs.squares;uint _e15=_group_1_binding_3_cs[(_e10 +(2u*slot_2))];uint
_e19=_group_0_binding_0_cs.squares;uint _e26=_group_1_binding_3_cs[((_e19 +(2u*slot_2))+ 1u)];uvec2 range_2=uvec2(_e15,
_e26);return Box((range_2&uvec2(65535u)),(range_2>>uvec2(16u)),word_3,true);}ivec2 _e36=centre_q3_(word_3);int
_e41=_group_0_binding_0_cs.tiles.x;columns=uvec2(0u,uint(_e41));if((_e36.x!=FAR_Q3_)){uvec2 _e48=columns_of(slot_2,
_e36);columns=_e48;}uint rows_2=_group_1_binding_2_cs[((2u*slot_2)+ 1u)].w;uint _e58=columns.x;uint
_e63=_group_0_binding_0_cs.tile_bits;uint _e67=columns.y;uint _e71=_group_0_binding_0_cs.tile_bits;return
Box(uvec2(_e58,((rows_2&65535u)>>_e63)),uvec2(_e67,((rows_2>>(16u + _e71))+ 1u)),word_3,true);}Box box_of(uint slot_3){
uint columns_1=0u;uint row_3=0u;uint _e4=_group_0_binding_0_cs.boxes;uint _e9=_group_1_binding_3_cs[(_e4 +(2u*slot_3))];
uint _e13=_group_0_binding_0_cs.boxes;uint _e20=_group_1_binding_3_cs[((_e13 +(2u*slot_3))+ 1u)];uvec2 word_4=uvec2(_e9,
_e20);uvec2 mask=uvec2(word_4.x,(word_4.y&1023u));uint tile_7=(word_4.y>>10u);int _e33=_group_0_binding_0_cs.tiles.x;
uint across_1=uint(_e33);if((tile_7==LARGE_BOX)){Box _e37=large_box(slot_3,mask);return _e37;}if(((mask.x|mask.y)==0u)){
return Box(uvec2(0u),uvec2(0u),mask,false);}for(;(row_3<7u);row_3=(row_3 + 1u)){{uint _e56=columns_1;uint _e58=row_3;
uvec2 _e60=shift_right(mask,(6u*_e58));columns_1=(_e56|(_e60.x&63u));}}uvec2 first_7=uvec2((tile_7%across_1),
(tile_7/across_1));int _e71=zeros_of_wide(mask);uint rows_3=((uint((63 - _e71))/6u)+ 1u);uint _e80=columns_1;return
Box(first_7,(first_7 + uvec2((32u - uint(31 - findMSB(_e80))),rows_3)),mask,false);}void main(){uvec3
group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;bool local=false;uint half_2=((group.y*ROW_OF_GROUPS)+
group.x);if((thread<4u)){bound[thread]=0u;}memoryBarrierShared();barrier();uint _e15=_group_1_binding_0_cs[0];
if((half_2<(2u*_e15))){Box _e21=box_of(((half_2*THREADS)+ thread));if(all(lessThan(_e21.first,_e21.end))){uint
_e31=atomicMax(bound[0],~(_e21.first.x));uint _e37=atomicMax(bound[1],~(_e21.first.y));uint _e42=atomicMax(bound[2],
_e21.end.x);uint _e47=atomicMax(bound[3],_e21.end.y);}}memoryBarrierShared();barrier();if((thread<2u)){uint
_e55=_group_1_binding_0_cs[0];local=(half_2<(2u*_e55));}else{local=false;}bool _e59=local;if(_e59){uint
_e62=bound[thread];uint first_8=(~(_e62)&65535u);uint _e75=bound[(2u + thread)];_group_1_binding_1_cs[((2u*half_2)+
thread)]=(first_8|(_e75<<16u));return;}else{return;}}
