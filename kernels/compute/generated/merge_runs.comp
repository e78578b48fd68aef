#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Block{uint list;uint count;uint first;uint done;};
const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;const uint BLOCK=512u;const uint TILES=64u;const uint LIST=8u;
const uint SPARE=2147483648u;const uint DONE=1048576u;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=0)buffer type_14_block_1Compute{uint _group_1_binding_0_cs[];};
layout(std430,binding=1)buffer type_14_block_2Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)buffer
type_14_block_3Compute{uint _group_1_binding_2_cs[];};shared uvec2 keys[512];shared Block own_block;shared uint
below_split[2];shared uint splits[2];uint list_of(uint tile){return(TILES +(LIST*tile));}uvec2 keyed(uint entry){uint
_e4=_group_0_binding_0_cs.depths;uint _e9=_group_1_binding_2_cs[(_e4 +(entry&2147483647u))];return uvec2(entry,_e9);}
uvec2 key_at(uint at){if(((at&SPARE)!=0u)){uint _e8=_group_0_binding_0_cs.spare;uint _e13=_group_1_binding_2_cs[(_e8
+(at&2147483647u))];uvec2 _e14=keyed(_e13);return _e14;}uint _e17=_group_1_binding_1_cs[at];uvec2 _e18=keyed(_e17);
return _e18;}void put_entry(uint at_1,uint entry_1){if(((at_1&SPARE)!=0u)){uint _e9=_group_0_binding_0_cs.spare;
_group_1_binding_2_cs[(_e9 +(at_1&2147483647u))]=entry_1;return;}else{_group_1_binding_1_cs[at_1]=entry_1;return;}}bool
is_below(uvec2 a_1,uvec2 b_1){return((a_1.y==b_1.y)?(a_1.x<b_1.x):(a_1.y<b_1.y));}uint merges_of(uint count){
return(max((32u - uint(31 - findMSB((count - 1u)))),9u)- 9u);}Block take_block(uvec3 group_2,uint thread_3){uint
number_2=((group_2.y*ROW_OF_GROUPS)+ group_2.x);if((thread_3==0u)){uint long_=_group_1_binding_0_cs[8];uint
_e14=_group_0_binding_0_cs.blocks;uint _e19=_group_0_binding_0_cs.block_room;uint at_5=(_e14
+(2u*((number_2<long_)?((_e19 - 1u)- number_2):(number_2 - long_))));own_block.count=0u;uint
_e32=_group_1_binding_0_cs[7];if((number_2<(long_ + _e32))){uint tile_1=_group_1_binding_0_cs[at_5];uint
_e39=list_of(tile_1);uint count_3=_group_1_binding_0_cs[_e39];uint _e44=list_of(tile_1);uint
_e48=_group_1_binding_0_cs[(_e44 + 1u)];uint _e55=_group_1_binding_0_cs[(at_5 + 1u)];uint
_e63=_group_1_binding_0_cs[(at_5 + 1u)];own_block=Block((_e48 - count_3),count_3,(BLOCK*(_e55%DONE)),(_e63/DONE));uint
_e71=_group_1_binding_0_cs[(at_5 + 1u)];_group_1_binding_0_cs[(at_5 + 1u)]=(_e71 + DONE);}}memoryBarrierShared();
barrier();Block _e75=own_block;memoryBarrierShared();barrier();return _e75;}uint split(uint thread_7,uint first_1,uint
a_2,uint second,uint b_2,uint d,uint run){uint low=0u;uint high=0u;uint i_8=0u;bool local_3=false;uint
side=(thread_7/64u);low=(d - min(d,b_2));high=min(d,a_2);for(;(i_8<=(run/6u));i_8=(i_8 + 1u)){{uint _e20=high;uint
_e21=low;uint step_2=(((_e20 - _e21)+ 63u)/64u);uint _e27=low;uint place_1=(_e27 +((thread_7%64u)*step_2));
below_split[side]=0u;memoryBarrierShared();barrier();uint _e35=high;if((place_1<_e35)){uvec2 _e40=key_at((first_1 +
place_1));uvec2 _e45=key_at((((second + d)- 1u)- place_1));bool _e46=is_below(_e40,_e45);local_3=_e46;}else{
local_3=false;}bool _e48=local_3;if(_e48){uint _e52=atomicAdd(below_split[side],1u);}memoryBarrierShared();barrier();
uint below_3=below_split[side];memoryBarrierShared();barrier();uint _e56=high;uint _e57=low;high=min(_e56,(_e57
+(below_3*step_2)));uint _e61=low;low=(_e61 +((below_3!=0u)?(((below_3 - 1u)*step_2)+ 1u):0u));}}uint _e75=low;return
_e75;}uint count_below(uint first_2,uint count_1,uvec2 key){uint below_2=0u;uint step_1=256u;bool local_4=false;for(;
(step_1!=0u);step_1=(step_1>>1u)){{uint _e10=below_2;uint _e11=step_1;uint next=(_e10 + _e11);if((next<=count_1)){uvec2
_e21=keys[((first_2 + next)- 1u)];bool _e22=is_below(_e21,key);local_4=_e22;}else{local_4=false;}bool _e24=local_4;
if(_e24){below_2=next;}}}uint _e28=below_2;return _e28;}void merge_block(uint thread_8,uint source,uint to_1,uint
count_2,uint block,uint run_1){uint i_9=0u;uint i_10=0u;uint start_2=((block>>(run_1 + 1u))<<(run_1 + 1u));uint
both=min((count_2 - start_2),(2u<<run_1));uint a_3=min(both,(1u<<run_1));uint d_1=(block - start_2);uint
some_3=min((both - d_1),BLOCK);uint first_3=(source + start_2);uint second_1=(first_3 + a_3);uint _e34=split(thread_8,
first_3,a_3,second_1,(both - a_3),(d_1 +((thread_8/64u)*some_3)),run_1);splits[(thread_8/64u)]=_e34;
memoryBarrierShared();barrier();uint _e37=splits[1];uint _e40=splits[0];uint of_first=(_e37 - _e40);i_9=thread_8;for(;
(i_9<some_3);i_9=(i_9 + THREADS)){{uint _e48=splits[0];uint _e50=i_9;uint _e55=splits[0];uint _e57=i_9;uint _e59=i_9;
uint at_6=((_e59<of_first)?((first_3 + _e55)+ _e57):((((second_1 + d_1)- _e48)+ _e50)- of_first));uint _e63=i_9;uvec2
_e65=key_at(at_6);keys[_e63]=_e65;}}memoryBarrierShared();barrier();i_10=thread_8;for(;(i_10<some_3);i_10=(i_10 +
THREADS)){{uint _e73=i_10;uvec2 key_1=keys[_e73];uint _e76=i_10;bool is_first=(_e76<of_first);uint
_e82=count_below((is_first?of_first:0u),(is_first?(some_3 - of_first):of_first),key_1);uint _e84=i_10;uint _e86=i_10;
put_entry((((to_1 + block)+(is_first?_e86:(_e84 - of_first)))+ _e82),key_1.x);}}return;}void main(){uvec3
group_1=gl_WorkGroupID;uint thread_1=gl_LocalInvocationIndex;Block _e2=take_block(group_1,thread_1);uint run_2=(8u +
_e2.done);if((_e2.count<=(1u<<run_2))){return;}uint _e11=merges_of(_e2.count);bool from_spare=((((_e11 + 1u)-
_e2.done)%2u)==1u);merge_block(thread_1,(_e2.list|(from_spare?SPARE:0u)),(_e2.list|(from_spare?0u:SPARE)),_e2.count,
_e2.first,run_2);return;}
