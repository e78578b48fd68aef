#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Box{uvec2 first;uvec2 end;uvec2 mask;bool large;};
const int FXS_CLEAR_Q15_=32767;const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;const uint NOTHING=4294967295u;
const uint LARGE_BOX=4194303u;const int FAR_Q3_=-1048576;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=0)buffer type_14_block_1Compute{uint _group_1_binding_0_cs[];};
layout(std430,binding=1)buffer type_14_block_2Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)readonly
buffer type_18_block_3Compute{uvec4 _group_1_binding_2_cs[];};layout(std430,binding=3)buffer type_14_block_4Compute{
uint _group_1_binding_3_cs[];};shared uint bound[4];uvec2 add_wide(uvec2 a_3,uvec2 b_3){uint low_1=(a_3.x + b_3.x);
return uvec2(low_1,((a_3.y + b_3.y)+((low_1<a_3.x)?1u:0u)));}uvec2 shift_right(uvec2 a_15,uint n_1){if((n_1==0u)){
return a_15;}if((n_1>=32u)){return uvec2((a_15.y>>(n_1 - 32u)),0u);}return uvec2(((a_15.x>>n_1)|(a_15.y<<(32u - n_1))),
(a_15.y>>n_1));}int zeros_of(uint x_2){return int(uint(31 - findMSB(x_2)));}int zeros_of_wide(uvec2 x_3){int
_e2=zeros_of(x_3.x);int _e6=zeros_of(x_3.y);return((x_3.y!=0u)?_e6:(32 + _e2));}uint mean_depth(uvec2 sum_3,int
transmittance){uint weight_3=uint((FXS_CLEAR_Q15_ - transmittance));if((weight_3==0u)){return NOTHING;}uvec2
_e12=add_wide(sum_3,uvec2((weight_3<<7u),0u));uvec2 _e14=shift_right(_e12,8u);uint a_22=((_e14.y>>16u)%weight_3);uint
b_14=((a_22<<16u)|(_e14.y&65535u));uint c_2=(((b_14%weight_3)<<16u)|(_e14.x>>16u));uint
d_2=(((c_2%weight_3)<<16u)|(_e14.x&65535u));if((_e14.y>=weight_3)){return 4294967294u;}return
min((((c_2/weight_3)<<16u)|(d_2/weight_3)),4294967294u);}ivec2 centre_q3_(uvec2 box){uint
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
