#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Block{uint list;uint count;uint first;uint done;};
const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;const uint BLOCK=512u;const uint TILES=64u;const uint LIST=8u;
const uint GROUP=16u;const uint SAMPLES=16u;const uint RANGE=16u;const uint BINS=256u;const uint SPARE=2147483648u;
const uint DONE=1048576u;layout(std140,binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};shared uint
sums[128];shared uint group_sums[8];layout(std430,binding=0)buffer type_14_block_1Compute{uint _group_1_binding_0_cs[];}
;layout(std430,binding=1)buffer type_14_block_2Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)buffer
type_14_block_3Compute{uint _group_1_binding_2_cs[];};shared uvec2 keys[512];shared uint bins[257];shared uint
samples[16];shared uint ranks[16];shared uvec2 bounds[16];shared Block own_block;uint list_of(uint tile){return(TILES
+(LIST*tile));}uint plus(uint a,uint b,bool cut){bool local=false;if(cut){local=((a + b)<a);}else{local=false;}bool
_e10=local;return(_e10?4294967295u:(a + b));}uint sum_before(uint thread_2,uint own,bool cut_1){uint sum=0u;uint i_1=0u;
uint sum_1=0u;uint i_2=0u;uint i_3=0u;sums[thread_2]=own;memoryBarrierShared();barrier();if((thread_2<8u)){for(;
(i_1<GROUP);i_1=(i_1 + 1u)){{uint _e14=sum;uint _e18=i_1;uint _e21=sums[((GROUP*thread_2)+ _e18)];uint _e22=plus(_e14,
_e21,cut_1);sum=_e22;}}uint _e28=sum;group_sums[thread_2]=_e28;}memoryBarrierShared();barrier();for(;
(i_2<(thread_2/GROUP));i_2=(i_2 + 1u)){{uint _e37=sum_1;uint _e39=i_2;uint _e41=group_sums[_e39];uint _e42=plus(_e37,
_e41,cut_1);sum_1=_e42;}}i_3=((thread_2/GROUP)*GROUP);for(;(i_3<thread_2);i_3=(i_3 + 1u)){{uint _e53=sum_1;uint
_e55=i_3;uint _e57=sums[_e55];uint _e58=plus(_e53,_e57,cut_1);sum_1=_e58;}}uint _e62=sum_1;return _e62;}uvec2
keyed(uint entry){uint _e4=_group_0_binding_0_cs.depths;uint _e9=_group_1_binding_2_cs[(_e4 +(entry&2147483647u))];
return uvec2(entry,_e9);}uvec2 key_at(uint at){if(((at&SPARE)!=0u)){uint _e8=_group_0_binding_0_cs.spare;uint
_e13=_group_1_binding_2_cs[(_e8 +(at&2147483647u))];uvec2 _e14=keyed(_e13);return _e14;}uint
_e17=_group_1_binding_1_cs[at];uvec2 _e18=keyed(_e17);return _e18;}void put_entry(uint at_1,uint entry_1){
if(((at_1&SPARE)!=0u)){uint _e9=_group_0_binding_0_cs.spare;_group_1_binding_2_cs[(_e9 +(at_1&2147483647u))]=entry_1;
return;}else{_group_1_binding_1_cs[at_1]=entry_1;return;}}bool is_below(uvec2 a_1,uvec2 b_1){
return((a_1.y==b_1.y)?(a_1.x<b_1.x):(a_1.y<b_1.y));}uint merges_of(uint count){return(max((32u - uint(31 -
findMSB((count - 1u)))),9u)- 9u);}Block take_block(uvec3 group_2,uint thread_3){uint
number_2=((group_2.y*ROW_OF_GROUPS)+ group_2.x);if((thread_3==0u)){uint long_=_group_1_binding_0_cs[8];uint
_e14=_group_0_binding_0_cs.blocks;uint _e19=_group_0_binding_0_cs.block_room;uint at_5=(_e14
+(2u*((number_2<long_)?((_e19 - 1u)- number_2):(number_2 - long_))));own_block.count=0u;uint
_e32=_group_1_binding_0_cs[7];if((number_2<(long_ + _e32))){uint tile_1=_group_1_binding_0_cs[at_5];uint
_e39=list_of(tile_1);uint count_3=_group_1_binding_0_cs[_e39];uint _e44=list_of(tile_1);uint
_e48=_group_1_binding_0_cs[(_e44 + 1u)];uint _e55=_group_1_binding_0_cs[(at_5 + 1u)];uint
_e63=_group_1_binding_0_cs[(at_5 + 1u)];own_block=Block((_e48 - count_3),count_3,(BLOCK*(_e55%DONE)),(_e63/DONE));uint
_e71=_group_1_binding_0_cs[(at_5 + 1u)];_group_1_binding_0_cs[(at_5 + 1u)]=(_e71 + DONE);}}memoryBarrierShared();
barrier();Block _e75=own_block;memoryBarrierShared();barrier();return _e75;}void place_bins(uint thread_4,uint some){
uint bin=(2u*thread_4);uint size=bins[bin];uint _e11=bins[(bin + 1u)];uint _e14=sum_before(thread_4,(size + _e11),
false);bins[bin]=_e14;bins[(bin + 1u)]=(_e14 + size);if((thread_4==0u)){bins[256]=some;}memoryBarrierShared();barrier();
return;}void bound_ranges(uint thread_5,uint at_2,uint some_1){uint below=0u;uint i_5=0u;bool local_1=false;bool
local_2=false;uint sample_=(thread_5%SAMPLES);if((thread_5<SAMPLES)){uvec2 _e16=key_at((at_2 +(((thread_5*max(some_1,
SAMPLES))/SAMPLES)%some_1)));samples[thread_5]=_e16.y;ranks[thread_5]=0u;}memoryBarrierShared();barrier();uint
own_2=samples[sample_];for(;(i_5<2u);i_5=(i_5 + 1u)){{uint _e35=i_5;uint other=(((thread_5/SAMPLES)*2u)+ _e35);uint
_e37=below;uint _e42=samples[other];if(!((_e42<own_2))){uint _e49=samples[other];if((_e49==own_2)){
local_2=(other<sample_);}else{local_2=false;}bool _e55=local_2;local_1=_e55;}else{local_1=true;}bool _e57=local_1;
below=(_e37 +(_e57?1u:0u));}}uint _e65=below;uint _e66=atomicAdd(ranks[sample_],_e65);memoryBarrierShared();barrier();
if((thread_5<SAMPLES)){uint _e72=ranks[thread_5];bounds[_e72].x=own_2;}memoryBarrierShared();barrier();
if((thread_5<SAMPLES)){uint _e84=bounds[min((thread_5 + 1u),15u)].x;uint _e88=bounds[thread_5].x;uint width=(_e84 -
_e88);bounds[thread_5].y=(max((32u - uint(31 - findMSB(width))),4u)- 4u);}memoryBarrierShared();barrier();return;}uint
bin_of(uint depth){uint range=0u;uint step_=8u;for(;(step_!=0u);step_=(step_>>1u)){{uint _e8=range;uint _e10=step_;uint
_e12=range;uint _e13=step_;uint _e17=bounds[(_e12 + _e13)].x;range=(_e8 +((_e17<=depth)?_e10:0u));}}uint _e25=range;
uvec2 bound=bounds[_e25];uint _e29=range;return((RANGE*_e29)+ min(((max(depth,bound.x)- bound.x)>>bound.y),15u));}void
sort_block(uint thread_6,uint at_3,uint some_2,uint to){uvec2 own_1[4]=uvec2[4](uvec2(0u),uvec2(0u),uvec2(0u),
uvec2(0u));uint bin_of_own[4]=uint[4](0u,0u,0u,0u);uint place[4]=uint[4](0u,0u,0u,0u);uint i_6=0u;uint k=0u;uint k_1=0u;
uint k_2=0u;uint k_3=0u;uint below_1=0u;uint i_7=0u;i_6=thread_6;for(;(i_6<BINS);i_6=(i_6 + THREADS)){{uint _e12=i_6;
bins[_e12]=0u;}}for(;(k<4u);k=(k + 1u)){{uint _e23=k;if(((thread_6 +(_e23*THREADS))<some_2)){uint _e28=k;uint _e31=k;
uvec2 _e35=key_at(((at_3 + thread_6)+(_e31*THREADS)));own_1[_e28]=_e35;}}}bound_ranges(thread_6,at_3,some_2);for(;
(k_1<4u);k_1=(k_1 + 1u)){{uint _e44=k_1;if(((thread_6 +(_e44*THREADS))<some_2)){uint _e49=k_1;uint _e51=k_1;uint
_e54=own_1[_e51].y;uint _e55=bin_of(_e54);bin_of_own[_e49]=_e55;uint _e56=k_1;uint _e59=k_1;uint _e61=bin_of_own[_e59];
uint _e64=atomicAdd(bins[_e61],1u);place[_e56]=_e64;}}}memoryBarrierShared();barrier();place_bins(thread_6,some_2);for(;
(k_2<4u);k_2=(k_2 + 1u)){{uint _e73=k_2;if(((thread_6 +(_e73*THREADS))<some_2)){uint _e80=k_2;uint
_e82=bin_of_own[_e80];uint _e84=bins[_e82];uint _e85=k_2;uint _e87=place[_e85];uint _e90=k_2;uvec2 _e92=own_1[_e90];
keys[(_e84 + _e87)]=_e92;}}}memoryBarrierShared();barrier();for(;(k_3<4u);k_3=(k_3 + 1u)){{uint _e101=k_3;if(((thread_6
+(_e101*THREADS))<some_2)){uint _e107=k_3;uint _e109=bin_of_own[_e107];uint first_3=bins[_e109];uint _e113=k_3;uint
_e115=bin_of_own[_e113];uint end=bins[(_e115 + 1u)];below_1=first_3;i_7=first_3;for(;(i_7<end);i_7=(i_7 + 1u)){{uint
_e124=below_1;uint _e128=i_7;uvec2 _e130=keys[_e128];uint _e131=k_3;uvec2 _e133=own_1[_e131];bool _e134=is_below(_e130,
_e133);below_1=(_e124 +(_e134?1u:0u));}}uint _e140=below_1;uint _e142=k_3;uint _e145=own_1[_e142].x;put_entry((to +
_e140),_e145);}}}return;}void main(){uvec3 group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;Block
_e2=take_block(group,thread);if((_e2.count==0u)){return;}uint at_6=(_e2.list + _e2.first);uint
_e12=merges_of(_e2.count);uint to_2=(at_6|(((_e12%2u)==1u)?SPARE:0u));sort_block(thread,at_6,min((_e2.count -
_e2.first),BLOCK),to_2);return;}
