#version 310 es
precision highp float;precision highp int;layout(local_size_x=64,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Pixel{int transmittance;ivec3 sum;};const int
FXS_CLEAR_Q15_=32767;const uint ROW_OF_GROUPS=32768u;const uint NOTHING=4294967295u;const uint SIDE=8u;layout(std140,
binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=0)readonly buffer
type_11_block_1Compute{uint _group_1_binding_0_cs[];};layout(std430,binding=3)buffer type_11_block_2Compute{uint
_group_1_binding_3_cs[];};int fxs_mul_q15_(int a,int b){return(((a*b)+ 16384)>>15u);}int fxs_min(int a_1,int b_1){
return((a_1<b_1)?a_1:b_1);}int fxs_accumulate_q13_(int sum_q13_,int weight_q15_,int colour_q13_){int
_e3=fxs_mul_q15_(weight_q15_,colour_q13_);int _e6=fxs_min((sum_q13_ + _e3),32767);return _e6;}int fxs_resolve_8bit(int
sum_q13_1,int transmittance_q15_1,int background_q13_){int _e3=fxs_accumulate_q13_(sum_q13_1,transmittance_q15_1,
background_q13_);int _e11=fxs_min((((_e3*255)+ 4096)>>13u),255);return _e11;}int fxs_coverage_8bit(int
transmittance_q15_2){return((((FXS_CLEAR_Q15_ - transmittance_q15_2)*255)+ 16384)>>15u);}ivec3 background_of(uint
word_1){uvec3 rgb=uvec3((word_1&255u),((word_1>>8u)&255u),((word_1>>16u)&255u));return ivec3((((rgb*8192u)+
uvec3(127u))/uvec3(255u)));}void put_colour(inout Pixel p_3,uint at){ivec3 background_q13_1=ivec3(0);uint word_2=0u;
ivec3 _e3=p_3.sum;ivec3 sum=min(_e3,ivec3(32767));int transmittance=p_3.transmittance;uint
_e11=_group_0_binding_0_cs.format;if((_e11==3u)){uvec3 rgb_1=uvec3(min((((sum*65535)+ ivec3(4096))>>uvec3(13u)),
ivec3(65535)));uint alpha=uint(((((FXS_CLEAR_Q15_ - transmittance)*65535)+ 16384)>>15u));uint
_e38=_group_0_binding_0_cs.colour;_group_1_binding_3_cs[(_e38 +(2u*at))]=(rgb_1.x|(rgb_1.y<<16u));uint
_e51=_group_0_binding_0_cs.colour;_group_1_binding_3_cs[((_e51 +(2u*at))+ 1u)]=(rgb_1.z|(alpha<<16u));return;}ivec4
_e64=_group_0_binding_0_cs.background_q13_;background_q13_1=_e64.xyz;uint _e69=_group_0_binding_0_cs.backdrop;
if((_e69!=NOTHING)){uint _e75=_group_0_binding_0_cs.backdrop;uint _e78=_group_1_binding_3_cs[(_e75 + at)];ivec3
_e79=background_of(_e78);background_q13_1=_e79;}int _e82=background_q13_1.x;int _e83=fxs_resolve_8bit(sum.x,
transmittance,_e82);uint r=uint(_e83);int _e87=background_q13_1.y;int _e88=fxs_resolve_8bit(sum.y,transmittance,_e87);
uint g_1=uint(_e88);int _e92=background_q13_1.z;int _e93=fxs_resolve_8bit(sum.z,transmittance,_e92);uint b_3=uint(_e93);
word_2=(((r|(g_1<<8u))|(b_3<<16u))|4278190080u);uint _e106=_group_0_binding_0_cs.format;if((_e106==1u)){uint
_e109=word_2;int _e112=fxs_coverage_8bit(transmittance);word_2=((_e109&16777215u)|(uint(_e112)<<24u));}uint
_e119=_group_0_binding_0_cs.format;if((_e119==2u)){word_2=((((((r*31u)+ 127u)/255u)<<11u)|((((g_1*63u)+
127u)/255u)<<5u))|(((b_3*31u)+ 127u)/255u));}uint _e149=_group_0_binding_0_cs.colour;uint _e152=word_2;
_group_1_binding_3_cs[(_e149 + at)]=_e152;return;}uvec2 corner_of(uint tile_1,uint number_2){uint
_e4=_group_0_binding_0_cs.tile_bits;uint halves=(_e4 - 3u);int _e10=_group_0_binding_0_cs.tiles.x;uint
across=uint(_e10);uint _e17=_group_0_binding_0_cs.tile_bits;return((uvec2((tile_1%across),
(tile_1/across))<<uvec2(_e17))+(uvec2((number_2&halves),((number_2>>1u)&halves))*SIDE));}void put_pixel(inout Pixel p_4,
uint at_2){uint _e4=_group_0_binding_0_cs.colour;if((_e4!=NOTHING)){put_colour(p_4,at_2);}uint
_e9=_group_0_binding_0_cs.coverage;if((_e9!=NOTHING)){uint _e15=_group_0_binding_0_cs.coverage;int
_e19=p_4.transmittance;int _e20=fxs_coverage_8bit(_e19);_group_1_binding_3_cs[(_e15 + at_2)]=uint(_e20);return;}else{
return;}}void main(){uvec3 group_1=gl_WorkGroupID;uint thread_1=gl_LocalInvocationIndex;Pixel p=Pixel(32767,ivec3(0));
uint number_6=((group_1.y*ROW_OF_GROUPS)+ group_1.x);uint _e10=_group_0_binding_0_cs.tile_bits;uint
of_class=(number_6>>(2u*(_e10 - 3u)));uint _e17=_group_1_binding_0_cs[16];if((of_class>=_e17)){return;}uint
_e22=_group_0_binding_0_cs.classes;uint _e25=_group_1_binding_0_cs[(_e22 + of_class)];uvec2 _e26=corner_of(_e25,
number_6);uvec2 pixel=(_e26 + uvec2((thread_1%SIDE),(thread_1/SIDE)));ivec2 _e35=_group_0_binding_0_cs.size;
if(any(greaterThanEqual(pixel,uvec2(_e35)))){return;}int _e43=_group_0_binding_0_cs.size.x;uint
at_4=((pixel.y*uint(_e43))+ pixel.x);put_pixel(p,at_4);uint _e55=_group_0_binding_0_cs.mean_depth;if((_e55!=NOTHING)){
uint _e61=_group_0_binding_0_cs.mean_depth;_group_1_binding_3_cs[(_e61 + at_4)]=NOTHING;}uint
_e67=_group_0_binding_0_cs.median_depth;if((_e67!=NOTHING)){uint _e73=_group_0_binding_0_cs.median_depth;
_group_1_binding_3_cs[(_e73 + at_4)]=NOTHING;}uint _e79=_group_0_binding_0_cs.id;if((_e79!=NOTHING)){uint
_e85=_group_0_binding_0_cs.id;_group_1_binding_3_cs[(_e85 +(2u*at_4))]=NOTHING;return;}else{return;}}
