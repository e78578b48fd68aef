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
uint DONE=1048576u;shared uint sums[128];shared uint group_sums[8];layout(std430,binding=0)buffer
type_14_block_0Compute{uint _group_1_binding_0_cs[];};layout(std140,binding=0)uniform Frame_block_1Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=1)buffer type_14_block_2Compute{uint _group_1_binding_1_cs[];};
layout(std430,binding=2)buffer type_14_block_3Compute{uint _group_1_binding_2_cs[];};shared uvec2 keys[512];shared uint
bins[257];shared uint samples[16];shared uint ranks[16];shared uvec2 bounds[16];shared Block own_block;uint
list_of(uint tile){return(TILES +(LIST*tile));}uint plus(uint a,uint b,bool cut){bool local=false;if(cut){local=((a +
b)<a);}else{local=false;}bool _e10=local;return(_e10?4294967295u:(a + b));}uint sum_before(uint thread_2,uint own_1,
bool cut_1){uint sum=0u;uint i_5=0u;uint sum_1=0u;uint i_6=0u;uint i_7=0u;sums[thread_2]=own_1;memoryBarrierShared();
barrier();if((thread_2<8u)){for(;(i_5<GROUP);i_5=(i_5 + 1u)){{uint _e14=sum;uint _e18=i_5;uint
_e21=sums[((GROUP*thread_2)+ _e18)];uint _e22=plus(_e14,_e21,cut_1);sum=_e22;}}uint _e28=sum;group_sums[thread_2]=_e28;}
memoryBarrierShared();barrier();for(;(i_6<(thread_2/GROUP));i_6=(i_6 + 1u)){{uint _e37=sum_1;uint _e39=i_6;uint
_e41=group_sums[_e39];uint _e42=plus(_e37,_e41,cut_1);sum_1=_e42;}}i_7=((thread_2/GROUP)*GROUP);for(;(i_7<thread_2);
i_7=(i_7 + 1u)){{uint _e53=sum_1;uint _e55=i_7;uint _e57=sums[_e55];uint _e58=plus(_e53,_e57,cut_1);sum_1=_e58;}}uint
_e62=sum_1;return _e62;}bool fits(){bool local_1=false;bool local_2=false;uint _e2=_group_1_binding_0_cs[2];uint
_e5=_group_0_binding_0_cs.page_room;if((_e2<=_e5)){uint _e11=_group_1_binding_0_cs[1];uint
_e14=_group_0_binding_0_cs.large_room;local_1=(_e11<=_e14);}else{local_1=false;}bool _e17=local_1;if(_e17){uint
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
void place_bins(uint thread_4,uint some){uint bin=(2u*thread_4);uint size=bins[bin];uint _e11=bins[(bin + 1u)];uint
_e14=sum_before(thread_4,(size + _e11),false);bins[bin]=_e14;bins[(bin + 1u)]=(_e14 + size);if((thread_4==0u)){
bins[256]=some;}memoryBarrierShared();barrier();return;}void bound_ranges(uint thread_5,uint at_2,uint some_1){uint
below_1=0u;uint i_9=0u;bool local_4=false;bool local_5=false;uint sample_=(thread_5%SAMPLES);if((thread_5<SAMPLES)){
uvec2 _e17=key_at(false,(at_2 +(((thread_5*max(some_1,SAMPLES))/SAMPLES)%some_1)));samples[thread_5]=_e17.y;
ranks[thread_5]=0u;}memoryBarrierShared();barrier();uint own_2=samples[sample_];for(;(i_9<2u);i_9=(i_9 + 1u)){{uint
_e36=i_9;uint other=(((thread_5/SAMPLES)*2u)+ _e36);uint _e38=below_1;uint _e43=samples[other];if(!((_e43<own_2))){uint
_e50=samples[other];if((_e50==own_2)){local_5=(other<sample_);}else{local_5=false;}bool _e56=local_5;local_4=_e56;}else{
local_4=true;}bool _e58=local_4;below_1=(_e38 +(_e58?1u:0u));}}uint _e66=below_1;uint _e67=atomicAdd(ranks[sample_],
_e66);memoryBarrierShared();barrier();if((thread_5<SAMPLES)){uint _e73=ranks[thread_5];bounds[_e73].x=own_2;}
memoryBarrierShared();barrier();if((thread_5<SAMPLES)){uint _e85=bounds[min((thread_5 + 1u),15u)].x;uint
_e89=bounds[thread_5].x;uint width=(_e85 - _e89);bounds[thread_5].y=(max((32u - uint(31 - findMSB(width))),4u)- 4u);}
memoryBarrierShared();barrier();return;}uint bin_of(uint depth){uint range=0u;uint step_=8u;for(;(step_!=0u);
step_=(step_>>1u)){{uint _e8=range;uint _e10=step_;uint _e12=range;uint _e13=step_;uint _e17=bounds[(_e12 + _e13)].x;
range=(_e8 +((_e17<=depth)?_e10:0u));}}uint _e25=range;uvec2 bound=bounds[_e25];uint _e29=range;return((RANGE*_e29)+
min(((max(depth,bound.x)- bound.x)>>bound.y),15u));}void main(){uvec3 group=gl_WorkGroupID;uint
thread=gl_LocalInvocationIndex;uvec2 own[4]=uvec2[4](uvec2(0u),uvec2(0u),uvec2(0u),uvec2(0u));uint
bin_of_own[4]=uint[4](0u,0u,0u,0u);uint place[4]=uint[4](0u,0u,0u,0u);uint i=0u;uint k=0u;uint k_1=0u;uint k_2=0u;uint
k_3=0u;uint below=0u;uint i_1=0u;Block _e2=take_block(group,thread);if((_e2.count==0u)){return;}uint
some_2=min((_e2.count - _e2.first),BLOCK);uint at_5=(_e2.list + _e2.first);uint _e15=merges_of(_e2.count);bool
to_spare=((_e15%2u)==1u);i=thread;for(;(i<BINS);i=(i + THREADS)){{uint _e28=i;bins[_e28]=0u;}}for(;(k<4u);k=(k + 1u)){{
uint _e39=k;if(((thread +(_e39*THREADS))<some_2)){uint _e44=k;uint _e48=k;uvec2 _e52=key_at(false,((at_5 +
thread)+(_e48*THREADS)));own[_e44]=_e52;}}}bound_ranges(thread,at_5,some_2);for(;(k_1<4u);k_1=(k_1 + 1u)){{uint
_e61=k_1;if(((thread +(_e61*THREADS))<some_2)){uint _e66=k_1;uint _e68=k_1;uint _e71=own[_e68].y;uint _e72=bin_of(_e71);
bin_of_own[_e66]=_e72;uint _e73=k_1;uint _e76=k_1;uint _e78=bin_of_own[_e76];uint _e81=atomicAdd(bins[_e78],1u);
place[_e73]=_e81;}}}memoryBarrierShared();barrier();place_bins(thread,some_2);for(;(k_2<4u);k_2=(k_2 + 1u)){{uint
_e90=k_2;if(((thread +(_e90*THREADS))<some_2)){uint _e97=k_2;uint _e99=bin_of_own[_e97];uint _e101=bins[_e99];uint
_e102=k_2;uint _e104=place[_e102];uint _e107=k_2;uvec2 _e109=own[_e107];keys[(_e101 + _e104)]=_e109;}}}
memoryBarrierShared();barrier();for(;(k_3<4u);k_3=(k_3 + 1u)){{uint _e118=k_3;if(((thread +(_e118*THREADS))<some_2)){
uint _e124=k_3;uint _e126=bin_of_own[_e124];uint first_3=bins[_e126];uint _e130=k_3;uint _e132=bin_of_own[_e130];uint
end=bins[(_e132 + 1u)];below=first_3;i_1=first_3;for(;(i_1<end);i_1=(i_1 + 1u)){{uint _e141=below;uint _e145=i_1;uvec2
_e147=keys[_e145];uint _e148=k_3;uvec2 _e150=own[_e148];bool _e151=is_below(_e147,_e150);below=(_e141 +(_e151?1u:0u));}}
uint _e157=below;uint _e159=k_3;uint _e162=own[_e159].x;put_entry(to_spare,(at_5 + _e157),_e162);}}}return;}
