#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;
const uint SPAN=8u;const uint GROUP=16u;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};shared uint sums[128];shared uint group_sums[8];layout(std430,binding=0)buffer
type_13_block_1Compute{uint _group_1_binding_0_cs[];};layout(std430,binding=1)buffer type_13_block_2Compute{uint
_group_1_binding_1_cs[];};layout(std430,binding=2)buffer type_15_block_3Compute{uint _group_1_binding_2_cs[];};uint
plus(uint a_16,uint b_8,bool cut){bool local=false;if(cut){local=((a_16 + b_8)<a_16);}else{local=false;}bool _e10=local;
return(_e10?4294967295u:(a_16 + b_8));}uint sum_before(uint thread_1,uint own_1,bool cut_1){uint sum=0u;uint i_4=0u;
uint sum_1=0u;uint i_5=0u;uint i_6=0u;sums[thread_1]=own_1;memoryBarrierShared();barrier();if((thread_1<8u)){for(;
(i_4<GROUP);i_4=(i_4 + 1u)){{uint _e14=sum;uint _e18=i_4;uint _e21=sums[((GROUP*thread_1)+ _e18)];uint _e22=plus(_e14,
_e21,cut_1);sum=_e22;}}uint _e28=sum;group_sums[thread_1]=_e28;}memoryBarrierShared();barrier();for(;
(i_5<(thread_1/GROUP));i_5=(i_5 + 1u)){{uint _e37=sum_1;uint _e39=i_5;uint _e41=group_sums[_e39];uint _e42=plus(_e37,
_e41,cut_1);sum_1=_e42;}}i_6=((thread_1/GROUP)*GROUP);for(;(i_6<thread_1);i_6=(i_6 + 1u)){{uint _e53=sum_1;uint
_e55=i_6;uint _e57=sums[_e55];uint _e58=plus(_e53,_e57,cut_1);sum_1=_e58;}}uint _e62=sum_1;return _e62;}void
put_arguments(uint at_2,uint groups){_group_1_binding_0_cs[(4u*at_2)]=min(groups,ROW_OF_GROUPS);
_group_1_binding_0_cs[((4u*at_2)+ 1u)]=(((groups + ROW_OF_GROUPS)- 1u)/ROW_OF_GROUPS);_group_1_binding_0_cs[((4u*at_2)+
2u)]=1u;return;}uint rank_of(uint place){uint _e4=_group_0_binding_0_cs.seen;uint _e9=_group_1_binding_2_cs[(_e4
+(place/32u))];uint below=(_e9&((1u<<(place%32u))- 1u));uint _e20=_group_0_binding_0_cs.ranks;uint
_e25=_group_1_binding_1_cs[(_e20 +(place/32u))];return(_e25 + uint(bitCount(below)));}void main(){uint
thread=gl_LocalInvocationIndex;uint own=0u;uint i=0u;uint at=0u;uint i_1=0u;uint bits=0u;uint i_2=0u;uint
_e3=_group_0_binding_0_cs.places;uint words=((_e3/32u)+ 1u);uint each=(((words + THREADS)- 1u)/THREADS);uint
first=min((thread*each),words);uint end=min((first + each),words);i=first;for(;(i<end);i=(i + 1u)){{uint _e23=own;uint
_e27=_group_0_binding_0_cs.seen;uint _e28=i;uint _e31=_group_1_binding_2_cs[(_e27 + _e28)];own=(_e23 +
uint(bitCount(_e31)));}}uint _e37=own;uint _e39=sum_before(thread,_e37,false);at=_e39;i_1=first;for(;(i_1<end);i_1=(i_1
+ 1u)){{uint _e47=_group_0_binding_0_cs.ranks;uint _e48=i_1;uint _e51=at;_group_1_binding_1_cs[(_e47 + _e48)]=_e51;uint
_e55=_group_0_binding_0_cs.seen;uint _e56=i_1;uint _e59=_group_1_binding_2_cs[(_e55 + _e56)];bits=_e59;for(;(bits!=0u);
bits=(bits&(bits - 1u))){{uint _e67=_group_0_binding_0_cs.visible;uint _e68=at;uint _e72=i_1;uint _e74=bits;
_group_1_binding_1_cs[(_e67 + _e68)]=((32u*_e72)+ min(uint(findLSB(_e74)),32u));uint _e77=at;at=(_e77 + 1u);}}}}
memoryBarrierBuffer();barrier();memoryBarrierShared();barrier();i_2=thread;for(;(i_2<=_group_0_binding_0_cs.spans);
i_2=(i_2 + THREADS)){{uint _e96=_group_0_binding_0_cs.spans_at;uint _e98=i_2;uint span=(_e96 +(SPAN*_e98));uint
_e103=_group_1_binding_1_cs[span];uint _e104=rank_of(_e103);uint _e109=_group_1_binding_1_cs[(span + 1u)];uint
_e110=rank_of(_e109);_group_1_binding_1_cs[(span + 2u)]=_e104;_group_1_binding_1_cs[(span + 3u)]=_e110;uint _e119=i_2;
uint _e125=i_2;uint _e128=_group_0_binding_0_cs.spans;put_arguments(_e119,max((2u*(_e110 - _e104)),
((_e125==_e128)?1u:0u)));}}if((thread==127u)){uint _e139=at;_group_1_binding_2_cs[0]=_e139;return;}else{return;}}
