#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;uint places;uint spans;uint chunk_room;uint large_room;uint page_room;uint drawn;uint seen;uint ranks;
uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint unused;uint classes;uint blocks;uint
block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4 background_q13_;int
depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint backdrop;};struct
Object{uvec4 position_q32_[3];uvec4 eye_q32_[3];ivec4 rotation_q30_[3];ivec4 row_q15_[2];ivec4 forward_q15_[2];ivec4
tint_q13_;uvec2 near_q32_;uvec2 dilation_q30_;ivec2 f_q12_;ivec2 c_q12_;ivec2 slope_low_q23_;ivec2 slope_high_q23_;
ivec2 edge_low_q23_;ivec2 edge_high_q23_;uint focal_q32_;int focal_exponent;int veil_exponent;int jacobian_exponent;int
offset_q11_;int degree;int antialiased;int orthographic;int plane_exponent;uint profile;int scene_degree;uint
chunk_words;uint palette_entries;int palette_step_q19_;uint scale_mantissa;int scale_exponent;int plain;uint crop_count;
uint keep_count;uint first_chunk;uint first_place;uint end_place;uint span;uint part_chunk;uint rows_at;uvec4 crops[32];
};struct Splat{uint u0_q24_;uint v0_q24_;int ux_q24_;int uy_q24_;int vy_q24_;int offset_q11_;ivec2 rows;};struct Bounds{
ivec2 c_q14_;uint breadth_q8_;int shear_q8_;int half_width_q8_;uint square_radius;};struct Span{int first;int last;};
struct Block{uint list;uint count;uint first;uint done;};const uint CHUNK=256u;const uint THREADS=128u;const uint
ROW_OF_GROUPS=32768u;const uint RECORD=64u;const uint LARGE=8u;const int LARGE_ROWS=8;const uint SPAN=8u;const uint
PAGE=4096u;const uint MERGES=19u;const uint BLOCK=512u;const uint CLASSES=16u;const uint CUT_OFF=2147483648u;const uint
NOTHING=4294967295u;const int BOX_COLUMNS=6;const int BOX_ROWS=7;const uint VISIBLE_CHUNKS=0u;const uint LARGES=1u;
const uint PAGES=2u;const uint DAMAGED=3u;const uint VISIBLE=4u;const uint ENTRIES=5u;const uint SHORT_BLOCKS=7u;const
uint LONG_BLOCKS=8u;const uint LONGEST=9u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const uint LIST=8u;const int
EVERYWHERE_Q8_=1073741824;const uint GROUP=16u;const uint SAMPLES=16u;const uint RANGE=16u;const uint BINS=256u;const
uint DONE=1048576u;layout(std430,binding=0)buffer type_14_block_0Compute{uint _group_1_binding_0_cs[];};layout(std140,
binding=0)uniform Frame_block_1Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=1)buffer
type_14_block_2Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)buffer type_14_block_3Compute{uint
_group_1_binding_2_cs[];};shared uvec2 keys[512];shared Block own_block;shared uint below_split[2];shared uint
splits[2];uint list_of(uint tile){return(TILES +(LIST*tile));}bool fits(){bool local_1=false;bool local_2=false;uint
_e2=_group_1_binding_0_cs[2];uint _e5=_group_0_binding_0_cs.page_room;if((_e2<=_e5)){uint _e11=_group_1_binding_0_cs[1];
uint _e14=_group_0_binding_0_cs.large_room;local_1=(_e11<=_e14);}else{local_1=false;}bool _e17=local_1;if(_e17){uint
_e22=_group_1_binding_0_cs[0];uint _e25=_group_0_binding_0_cs.chunk_room;local_2=(_e22<=_e25);}else{local_2=false;}bool
_e28=local_2;return _e28;}uvec2 key_of(uint entry){uint _e4=_group_0_binding_0_cs.depths;uint
_e9=_group_1_binding_2_cs[(_e4 +(entry&2147483647u))];return uvec2(entry,_e9);}uvec2 key_at(bool in_spare,uint at){
if(in_spare){uint _e5=_group_0_binding_0_cs.spare;uint _e8=_group_1_binding_2_cs[(_e5 + at)];uvec2 _e9=key_of(_e8);
return _e9;}uint _e12=_group_1_binding_1_cs[at];uvec2 _e13=key_of(_e12);return _e13;}void put_entry(bool in_spare_1,
uint at_1,uint entry_1){if(in_spare_1){uint _e6=_group_0_binding_0_cs.spare;_group_1_binding_2_cs[(_e6 + at_1)]=entry_1;
return;}else{_group_1_binding_1_cs[at_1]=entry_1;return;}}bool is_below(uvec2 a_1,uvec2 b_1){
return((a_1.y==b_1.y)?(a_1.x<b_1.x):(a_1.y<b_1.y));}uint merges_of(uint count){return(max((32u - uint(31 -
findMSB((count - 1u)))),9u)- 9u);}Block take_block(uvec3 group_2,uint thread_3){bool local_3=false;uint
number_2=((group_2.y*ROW_OF_GROUPS)+ group_2.x);if((thread_3==0u)){uint long_=_group_1_binding_0_cs[8];uint
_e14=_group_0_binding_0_cs.blocks;uint _e19=_group_0_binding_0_cs.block_room;uint at_4=(_e14
+(2u*((number_2<long_)?((_e19 - 1u)- number_2):(number_2 - long_))));own_block.count=0u;uint
_e32=_group_1_binding_0_cs[7];if((number_2<(long_ + _e32))){bool _e37=fits();local_3=_e37;}else{local_3=false;}bool
_e39=local_3;if(_e39){uint tile_1=_group_1_binding_0_cs[at_4];uint _e44=list_of(tile_1);uint
count_2=_group_1_binding_0_cs[_e44];uint _e49=list_of(tile_1);uint _e53=_group_1_binding_0_cs[(_e49 + 1u)];uint
_e60=_group_1_binding_0_cs[(at_4 + 1u)];uint _e68=_group_1_binding_0_cs[(at_4 + 1u)];own_block=Block((_e53 - count_2),
count_2,(BLOCK*(_e60%DONE)),(_e68/DONE));uint _e76=_group_1_binding_0_cs[(at_4 + 1u)];_group_1_binding_0_cs[(at_4 +
1u)]=(_e76 + DONE);}}memoryBarrierShared();barrier();Block _e80=own_block;memoryBarrierShared();barrier();return _e80;}
uint split(uint thread_6,bool in_spare_2,uint first_1,uint a_2,uint second,uint b_2,uint d,uint run){uint low=0u;uint
high=0u;uint i_10=0u;bool local_6=false;uint side=(thread_6/64u);low=(d - min(d,b_2));high=min(d,a_2);for(;
(i_10<=(run/6u));i_10=(i_10 + 1u)){{uint _e21=high;uint _e22=low;uint step_2=(((_e21 - _e22)+ 63u)/64u);uint _e28=low;
uint place_1=(_e28 +((thread_6%64u)*step_2));below_split[side]=0u;memoryBarrierShared();barrier();uint _e36=high;
if((place_1<_e36)){uvec2 _e41=key_at(in_spare_2,(first_1 + place_1));uvec2 _e46=key_at(in_spare_2,(((second + d)- 1u)-
place_1));bool _e47=is_below(_e41,_e46);local_6=_e47;}else{local_6=false;}bool _e49=local_6;if(_e49){uint
_e53=atomicAdd(below_split[side],1u);}memoryBarrierShared();barrier();uint below_3=below_split[side];
memoryBarrierShared();barrier();uint _e57=high;uint _e58=low;high=min(_e57,(_e58 +(below_3*step_2)));uint _e62=low;
low=(_e62 +((below_3!=0u)?(((below_3 - 1u)*step_2)+ 1u):0u));}}uint _e76=low;return _e76;}uint count_below(uint first_2,
uint count_1,uvec2 key){uint below_2=0u;uint step_1=256u;bool local_7=false;for(;(step_1!=0u);step_1=(step_1>>1u)){{
uint _e10=below_2;uint _e11=step_1;uint next=(_e10 + _e11);if((next<=count_1)){uvec2 _e21=keys[((first_2 + next)- 1u)];
bool _e22=is_below(_e21,key);local_7=_e22;}else{local_7=false;}bool _e24=local_7;if(_e24){below_2=next;}}}uint
_e28=below_2;return _e28;}void main(){uvec3 group_1=gl_WorkGroupID;uint thread_1=gl_LocalInvocationIndex;uint i_2=0u;
uint i_3=0u;Block _e2=take_block(group_1,thread_1);uint run_1=(8u + _e2.done);if((_e2.count<=(1u<<run_1))){return;}uint
_e11=merges_of(_e2.count);bool from_spare=((((_e11 + 1u)- _e2.done)%2u)==1u);uint start_2=((_e2.first>>(run_1 +
1u))<<(run_1 + 1u));uint both=min((_e2.count - start_2),(2u<<run_1));uint a_3=min(both,(1u<<run_1));uint d_1=(_e2.first
- start_2);uint some_2=min((both - d_1),BLOCK);uint first_3=(_e2.list + start_2);uint second_1=(first_3 + a_3);uint
_e52=split(thread_1,from_spare,first_3,a_3,second_1,(both - a_3),(d_1 +((thread_1/64u)*some_2)),run_1);
splits[(thread_1/64u)]=_e52;memoryBarrierShared();barrier();uint _e55=splits[1];uint _e58=splits[0];uint of_first=(_e55
- _e58);i_2=thread_1;for(;(i_2<some_2);i_2=(i_2 + THREADS)){{uint _e66=splits[0];uint _e68=i_2;uint _e73=splits[0];uint
_e75=i_2;uint _e77=i_2;uint at_5=((_e77<of_first)?((first_3 + _e73)+ _e75):((((second_1 + d_1)- _e66)+ _e68)-
of_first));uint _e81=i_2;uvec2 _e83=key_at(from_spare,at_5);keys[_e81]=_e83;}}memoryBarrierShared();barrier();
i_3=thread_1;for(;(i_3<some_2);i_3=(i_3 + THREADS)){{uint _e91=i_3;uvec2 key_1=keys[_e91];uint _e94=i_3;bool
is_first=(_e94<of_first);uint _e100=count_below((is_first?of_first:0u),(is_first?(some_2 - of_first):of_first),key_1);
uint _e105=i_3;uint _e107=i_3;put_entry(!(from_spare),(((_e2.list + _e2.first)+(is_first?_e107:(_e105 - of_first)))+
_e100),key_1.x);}}return;}
