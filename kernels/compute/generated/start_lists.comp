#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;
const uint PAGE=4096u;const uint BLOCK=512u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const uint LIST=8u;const
uint GROUP=16u;layout(std140,binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};shared uint sums[128];
shared uint group_sums[8];layout(std430,binding=0)buffer type_13_block_1Compute{uint _group_1_binding_0_cs[];};
layout(std430,binding=2)buffer type_15_block_2Compute{uint _group_1_binding_2_cs[];};shared uint first_page;uint
list_of(uint tile){return(TILES +(LIST*tile));}uint plus(uint a_16,uint b_8,bool cut){bool local=false;if(cut){
local=((a_16 + b_8)<a_16);}else{local=false;}bool _e10=local;return(_e10?4294967295u:(a_16 + b_8));}uint
sum_before(uint thread_1,uint own_1,bool cut_1){uint sum=0u;uint i_1=0u;uint sum_1=0u;uint i_2=0u;uint i_3=0u;
sums[thread_1]=own_1;memoryBarrierShared();barrier();if((thread_1<8u)){for(;(i_1<GROUP);i_1=(i_1 + 1u)){{uint _e14=sum;
uint _e18=i_1;uint _e21=sums[((GROUP*thread_1)+ _e18)];uint _e22=plus(_e14,_e21,cut_1);sum=_e22;}}uint _e28=sum;
group_sums[thread_1]=_e28;}memoryBarrierShared();barrier();for(;(i_2<(thread_1/GROUP));i_2=(i_2 + 1u)){{uint _e37=sum_1;
uint _e39=i_2;uint _e41=group_sums[_e39];uint _e42=plus(_e37,_e41,cut_1);sum_1=_e42;}}i_3=((thread_1/GROUP)*GROUP);for(;
(i_3<thread_1);i_3=(i_3 + 1u)){{uint _e53=sum_1;uint _e55=i_3;uint _e57=sums[_e55];uint _e58=plus(_e53,_e57,cut_1);
sum_1=_e58;}}uint _e62=sum_1;return _e62;}uint sum_of_all(bool cut_2){uint sum_2=0u;uint i_4=0u;for(;(i_4<8u);i_4=(i_4
+ 1u)){{uint _e8=sum_2;uint _e10=i_4;uint _e12=group_sums[_e10];uint _e13=plus(_e8,_e12,cut_2);sum_2=_e13;}}uint
_e17=sum_2;return _e17;}uint class_of(uint length_1){return((length_1==0u)?0u:min((34u - uint(31 - findMSB(length_1))),
15u));}void put_blocks(uint tile_1,uint length_2){uint at=0u;uint i_5=0u;bool local_1=false;uint
blocks=((length_2>1u)?(((length_2 - 1u)/BLOCK)+ 1u):0u);if((blocks==0u)){return;}if((blocks>1u)){uint
_e20=atomicMax(_group_1_binding_2_cs[9],length_2);uint _e23=_group_0_binding_0_cs.block_room;uint
_e26=atomicAdd(_group_1_binding_2_cs[8],blocks);at=((_e23 - _e26)- blocks);}else{uint
_e32=atomicAdd(_group_1_binding_2_cs[7],1u);at=_e32;}for(;;i_5=(i_5 + 1u)){uint _e35=i_5;if((_e35<blocks)){uint _e39=at;
uint _e40=i_5;uint _e44=_group_0_binding_0_cs.block_room;local_1=((_e39 + _e40)<_e44);}else{local_1=false;}bool
_e47=local_1;if(_e47){}else{break;}{uint _e51=_group_0_binding_0_cs.blocks;uint _e53=at;uint _e54=i_5;
_group_1_binding_2_cs[(_e51 +(2u*(_e53 + _e54)))]=tile_1;uint _e62=_group_0_binding_0_cs.blocks;uint _e64=at;uint
_e65=i_5;uint _e72=i_5;_group_1_binding_2_cs[((_e62 +(2u*(_e64 + _e65)))+ 1u)]=_e72;}}return;}void main(){uvec3
group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;uint tiles_before=0u;uint entries_before=0u;uint first=0u;uint
own=0u;uint length_=0u;uint column=0u;int _e5=_group_0_binding_0_cs.tiles.x;uint across=uint(_e5);uint
row=(group.x*across);for(;(first<across);first=(first + THREADS)){{uint _e17=first;uint column_1=(_e17 + thread);uint
_e20=list_of((row + column_1));own=0u;if((column_1<across)){uint _e26=_group_1_binding_2_cs[_e20];own=_e26;}
memoryBarrierShared();barrier();uint _e27=tiles_before;uint _e28=own;uint _e30=sum_before(thread,_e28,false);uint
_e32=own;length_=((_e27 + _e30)+ _e32);uint _e35=tiles_before;uint _e37=sum_of_all(false);tiles_before=(_e35 + _e37);
if((column_1>=across)){length_=0u;}memoryBarrierShared();barrier();uint _e41=entries_before;uint _e42=length_;uint
_e44=sum_before(thread,_e42,true);uint _e46=plus(_e41,_e44,true);uint _e47=length_;uint _e49=plus(_e46,_e47,true);uint
_e50=entries_before;uint _e52=sum_of_all(true);uint _e54=plus(_e50,_e52,true);entries_before=_e54;if((column_1<across)){
uint _e58=length_;_group_1_binding_2_cs[_e20]=_e58;uint _e63=length_;_group_1_binding_2_cs[(_e20 + 1u)]=(_e49 - _e63);}}
}if((thread==0u)){uint _e72=entries_before;uint _e73=atomicAdd(_group_1_binding_2_cs[5],_e72);uint _e74=entries_before;
uint _e76=entries_before;if(((_e73 + _e74)<_e76)){uint _e81=atomicAdd(_group_1_binding_2_cs[6],1u);}uint
_e85=entries_before;uint _e90=atomicAdd(_group_1_binding_2_cs[2],((_e85/PAGE)+ 1u));first_page=_e90;if((group.x==0u)){
uint _e96=_group_1_binding_2_cs[1];uint _e99=_group_0_binding_0_cs.large_room;uint larges_1=min(_e96,_e99);uint
_e104=_group_0_binding_0_cs.spans;uint at_1=(4u*(_e104 + 1u));_group_1_binding_0_cs[at_1]=min(larges_1,ROW_OF_GROUPS);
_group_1_binding_0_cs[(at_1 + 1u)]=(((larges_1 + ROW_OF_GROUPS)- 1u)/ROW_OF_GROUPS);_group_1_binding_0_cs[(at_1 +
2u)]=1u;}}memoryBarrierShared();barrier();column=thread;for(;(column<across);column=(column + THREADS)){{uint
_e130=column;uint tile_2=(row + _e130);uint _e133=list_of(tile_2);uint length_3=_group_1_binding_2_cs[_e133];uint
_e136=class_of(length_3);put_blocks(tile_2,length_3);uint _e142=atomicAdd(_group_1_binding_2_cs[(CLASS_COUNTS + _e136)],
1u);uint _e146=_group_0_binding_0_cs.classes;int _e151=_group_0_binding_0_cs.tiles.y;_group_1_binding_2_cs[((_e146
+((_e136*across)*uint(_e151)))+ _e142)]=tile_2;uint _e158=list_of(tile_2);uint _e163=first_page;uint
_e166=atomicAdd(_group_1_binding_2_cs[(_e158 + 1u)],(_e163*PAGE));}}return;}
