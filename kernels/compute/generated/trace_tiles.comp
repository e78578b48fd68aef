#version 310 es
precision highp float;precision highp int;layout(local_size_x=32,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Pixel{int transmittance;ivec3 sum;};struct Fetched{
uint entry;uvec4 a;uvec4 b;};struct Patch{uint x;uint y;uint shift;uvec2 rows;uint list;uint count;};struct Taken{uint
u;uint ux;uint level_q26_;int limit_q11_;ivec3 colour;};struct Share{uint tile;uint number;uvec2 rows;};struct Place{
uint column;uint row;uvec2 at;bvec2 inside;};struct Traced{uint limit;int weight;uint largest;uint median;uvec2 sum;};
const int FXS_FAINT_Q11_=22697;const int FXS_ALPHA_MAX_Q15_=32440;const int FXS_CLEAR_Q15_=32767;const int
FXS_CLOSED_Q15_=33;const uint ROW_OF_GROUPS=32768u;const uint CLASSES=16u;const uint CUT_OFF=2147483648u;const uint
NOTHING=4294967295u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const uint LIST=8u;const uint SIDE=8u;const uint
SOME=32u;const uint APART=4u;const int HALF_Q15_=16384;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=0)readonly buffer type_12_block_1Compute{uint _group_1_binding_0_cs[];};
shared uvec4 shapes[32];shared uvec4 shades[32];shared uint touching[2];shared uint open_round;shared uint
open_pixels[2];shared uint shared_number;layout(std430,binding=1)readonly buffer type_12_block_2Compute{uint
_group_1_binding_1_cs[];};layout(std430,binding=2)readonly buffer type_16_block_3Compute{uvec4 _group_1_binding_2_cs[];}
;layout(std430,binding=3)buffer type_12_block_4Compute{uint _group_1_binding_3_cs[];};shared uvec2 own[32];int
fxs_mul_q15_(int a,int b){return(((a*b)+ 16384)>>15u);}int fxs_min(int a_1,int b_1){return((a_1<b_1)?a_1:b_1);}int
fxs_coordinate_q13_(int coordinate_q24_){int c=0;c=(coordinate_q24_>>11u);int _e4=c;int _e6=fxs_min(_e4,32767);int
_e7=c;return((_e7<-32767)?-32767:_e6);}int fxs_limit_q11_(int offset_q11_1,int cut_q11_){int _e4=fxs_min((offset_q11_1
+ cut_q11_),FXS_FAINT_Q11_);return _e4;}int fxs_mul_add_q15_(int a_2,int b_2,int c_1){return(((a_2*b_2)+((c_1*32768)+
16384))>>15u);}int fxs_alpha_q15_(int level_q11_){int p=0;int _e3=fxs_mul_add_q15_(-4236,level_q11_,16016);p=_e3;int
_e5=p;int _e7=fxs_mul_add_q15_(_e5,level_q11_,-32730);p=_e7;int _e8=p;int _e10=fxs_mul_add_q15_(_e8,level_q11_,32767);
p=_e10;int _e11=p;int _e12=p;int _e13=fxs_mul_q15_(_e11,_e12);p=_e13;int _e14=p;int _e15=p;int _e16=fxs_mul_q15_(_e14,
_e15);p=_e16;int _e17=p;int _e18=p;int _e19=fxs_mul_q15_(_e17,_e18);p=_e19;int _e20=p;int _e22=fxs_min(_e20,
FXS_ALPHA_MAX_Q15_);return _e22;}int fxs_weight_q15_(int alpha_q15_,int transmittance_q15_){int
_e2=fxs_mul_q15_(alpha_q15_,transmittance_q15_);return _e2;}int fxs_accumulate_q13_(int sum_q13_,int weight_q15_,int
colour_q13_){int _e3=fxs_mul_q15_(weight_q15_,colour_q13_);int _e6=fxs_min((sum_q13_ + _e3),32767);return _e6;}int
fxs_resolve_8bit(int sum_q13_1,int transmittance_q15_1,int background_q13_){int _e3=fxs_accumulate_q13_(sum_q13_1,
transmittance_q15_1,background_q13_);int _e11=fxs_min((((_e3*255)+ 4096)>>13u),255);return _e11;}int
fxs_coverage_8bit(int transmittance_q15_2){return((((FXS_CLEAR_Q15_ - transmittance_q15_2)*255)+ 16384)>>15u);}uvec2
add_wide(uvec2 a_3,uvec2 b_3){uint low=(a_3.x + b_3.x);return uvec2(low,((a_3.y + b_3.y)+((low<a_3.x)?1u:0u)));}uvec2
shift_left(uvec2 a_14,uint n){if((n==0u)){return a_14;}if((n>=32u)){return uvec2(0u,(a_14.x<<(n - 32u)));}return
uvec2((a_14.x<<n),((a_14.y<<n)|(a_14.x>>(32u - n))));}uvec2 shift_right(uvec2 a_15,uint n_1){if((n_1==0u)){return a_15;}
if((n_1>=32u)){return uvec2((a_15.y>>(n_1 - 32u)),0u);}return uvec2(((a_15.x>>n_1)|(a_15.y<<(32u - n_1))),
(a_15.y>>n_1));}int zeros_of(uint x_2){return int(uint(31 - findMSB(x_2)));}uint list_of(uint tile){return(TILES
+(LIST*tile));}uint classes_before(uint number,uvec4 sizes,inout uint start,inout uint all_){uint _e4=all_;uint w=(_e4
+ sizes.w);uint z=(w + sizes.z);uint y=(z + sizes.y);uint x_7=(y + sizes.x);uvec4 ends=uvec4(x_7,y,z,w);uvec4
before_1=mix(uvec4(0u),uvec4(1u),greaterThanEqual(uvec4(number),ends));uvec4 last=(before_1*ends);all_=x_7;uint
_e22=start;start=max(_e22,max(max(last.x,last.y),max(last.z,last.w)));return(((before_1.x + before_1.y)+ before_1.z)+
before_1.w);}uvec4 class_sizes(uint first){uint at_6=(CLASS_COUNTS + first);uint _e5=_group_1_binding_0_cs[at_6];uint
_e10=_group_1_binding_0_cs[(at_6 + 1u)];uint _e15=_group_1_binding_0_cs[(at_6 + 2u)];uint
_e20=_group_1_binding_0_cs[(at_6 + 3u)];return uvec4(_e5,_e10,_e15,_e20);}uint tile_at(uint number_1){uint start_1=0u;
uint all_1=0u;uvec4 _e2=class_sizes(12u);uvec4 _e4=class_sizes(8u);uvec4 _e6=class_sizes(4u);uvec4 _e8=class_sizes(0u);
uint _e13=classes_before(number_1,_e2,start_1,all_1);uint _e14=classes_before(number_1,_e4,start_1,all_1);uint
_e16=classes_before(number_1,_e6,start_1,all_1);uint _e18=classes_before(number_1,_e8,start_1,all_1);uint
before_2=(((_e13 + _e14)+ _e16)+ _e18);if((before_2==CLASSES)){return NOTHING;}uint _e26=_group_0_binding_0_cs.classes;
int _e32=_group_0_binding_0_cs.tiles.x;int _e36=_group_0_binding_0_cs.tiles.y;uint _e42=start_1;uint
_e45=_group_1_binding_0_cs[(((_e26 +((15u - before_2)*uint((_e32*_e36))))+ number_1)- _e42)];return _e45;}uint
lane_of(uint thread_1){return((thread_1<SOME)?thread_1:1073741824u);}uint fetch_entry(Patch here,uint i_1){
if((i_1<here.count)){uint _e8=_group_1_binding_1_cs[(here.list + i_1)];return _e8;}return NOTHING;}Fetched
fetch_splat(uint entry){Fetched f=Fetched(0u,uvec4(0u),uvec4(0u));f.entry=entry;if(((entry&CUT_OFF)==0u)){uvec4
_e12=_group_1_binding_2_cs[(2u*entry)];f.a=_e12;uvec4 _e20=_group_1_binding_2_cs[((2u*entry)+ 1u)];f.b=_e20;}Fetched
_e21=f;return _e21;}Fetched relative(Fetched f_1,Patch here_1){Fetched g=Fetched(0u,uvec4(0u),uvec4(0u));g=f_1;uint
first_2=((max((f_1.b.w&65535u),here_1.y)- here_1.y)>>here_1.shift);uint last_1=((max((f_1.b.w>>16u),here_1.y)-
here_1.y)>>here_1.shift);g.a=uvec4(((f_1.a.x +(here_1.x*f_1.a.z))+(here_1.y*f_1.a.w)),(f_1.a.y +(here_1.y*f_1.b.x)),
(f_1.a.zw<<uvec2(here_1.shift)));g.b.x=(f_1.b.x<<here_1.shift);g.b.w=(first_2|(last_1<<16u));Fetched _e60=g;return _e60;
}uint open_of(uint row){uint _e5=open_pixels[(row/4u)];return((_e5>>(8u*(row%4u)))&255u);}bool touch(Fetched f_2,Patch
here_2){uint u=0u;uint v=0u;bool touches=false;uint row_1=0u;bool local=false;int offset_q11_2=int((f_2.b.y&65535u));
int _e9=_group_0_binding_0_cs.cut_q11_;int _e10=fxs_limit_q11_(offset_q11_2,_e9);uint ux=f_2.a.z;uint
first_3=max((f_2.b.w&65535u),here_2.rows.x);uint last_2=min((f_2.b.w>>16u),here_2.rows.y);u=(f_2.a.x
+(first_3*f_2.a.w));v=(f_2.a.y +(first_3*f_2.b.x));row_1=first_3;for(;(row_1<=last_2);row_1=(row_1 + 1u)){{uint
_e46=row_1;uint _e47=open_of(_e46);uint _e48=u;int left=int((_e48 +(uint(findLSB(_e47))*ux)));uint _e53=u;int
right=int((_e53 +(uint(findMSB(_e47))*ux)));int u_q13_1=min((max(max(left,-(right)),0)>>11u),32767);uint _e66=v;int
_e68=fxs_coordinate_q13_(int(_e66));int _e69=fxs_mul_q15_(_e68,_e68);int most_q26_=(((((_e10 - _e69)- offset_q11_2)+
1)*32768)- 16384);bool _e78=touches;if((_e47!=0u)){local=((u_q13_1*u_q13_1)<most_q26_);}else{local=false;}bool
_e86=local;touches=(_e78||_e86);uint _e88=u;u=(_e88 + f_2.a.w);uint _e92=v;v=(_e92 + f_2.b.x);}}bool _e99=touches;
return _e99;}Taken take(uint i_2,uint row_2){uvec4 shape=shapes[i_2];uvec4 shade=shades[i_2];int v_1=int((shape.y
+(row_2*shade.x)));int _e13=fxs_coordinate_q13_(v_1);int _e14=fxs_mul_q15_(_e13,_e13);int level_q11_1=(_e14 +
int((shade.y&65535u)));return Taken((shape.x +(row_2*shape.w)),shape.z,((uint(level_q11_1)<<15u)+ 16384u),int(shade.w),
ivec3(uvec3((shade.y>>16u),(shade.z&65535u),(shade.z>>16u))));}int blend_splat(inout Pixel p_2,Taken t,uint column){
bool local_1=false;int _e8=fxs_coordinate_q13_(int((t.u +(column*t.ux))));int level=int(((uint((_e8*_e8))+
t.level_q26_)>>15u));if((level<=t.limit_q11_)){int _e21=p_2.transmittance;local_1=(_e21>=FXS_CLOSED_Q15_);}else{
local_1=false;}bool counts_1=local_1;int _e26=fxs_alpha_q15_(level);int _e28=p_2.transmittance;int
_e29=fxs_weight_q15_(_e26,_e28);int weight_2=(counts_1?_e29:0);int _e33=p_2.transmittance;p_2.transmittance=(_e33 -
weight_2);ivec3 _e36=p_2.sum;int _e39=fxs_mul_q15_(weight_2,t.colour.x);int _e42=fxs_mul_q15_(weight_2,t.colour.y);int
_e45=fxs_mul_q15_(weight_2,t.colour.z);p_2.sum=(_e36 + ivec3(_e39,_e42,_e45));return weight_2;}ivec3 background_of(uint
word_1){uvec3 rgb=uvec3((word_1&255u),((word_1>>8u)&255u),((word_1>>16u)&255u));return ivec3((((rgb*8192u)+
uvec3(127u))/uvec3(255u)));}void put_colour(inout Pixel p_3,uint at){ivec3 background_q13_1=ivec3(0);uint word_2=0u;
ivec3 _e3=p_3.sum;ivec3 sum_1=min(_e3,ivec3(32767));int transmittance_2=p_3.transmittance;uint
_e11=_group_0_binding_0_cs.format;if((_e11==3u)){uvec3 rgb_1=uvec3(min((((sum_1*65535)+ ivec3(4096))>>uvec3(13u)),
ivec3(65535)));uint alpha=uint(((((FXS_CLEAR_Q15_ - transmittance_2)*65535)+ 16384)>>15u));uint
_e38=_group_0_binding_0_cs.colour;_group_1_binding_3_cs[(_e38 +(2u*at))]=(rgb_1.x|(rgb_1.y<<16u));uint
_e51=_group_0_binding_0_cs.colour;_group_1_binding_3_cs[((_e51 +(2u*at))+ 1u)]=(rgb_1.z|(alpha<<16u));return;}ivec4
_e64=_group_0_binding_0_cs.background_q13_;background_q13_1=_e64.xyz;uint _e69=_group_0_binding_0_cs.backdrop;
if((_e69!=NOTHING)){uint _e75=_group_0_binding_0_cs.backdrop;uint _e78=_group_1_binding_3_cs[(_e75 + at)];ivec3
_e79=background_of(_e78);background_q13_1=_e79;}int _e82=background_q13_1.x;int _e83=fxs_resolve_8bit(sum_1.x,
transmittance_2,_e82);uint r=uint(_e83);int _e87=background_q13_1.y;int _e88=fxs_resolve_8bit(sum_1.y,transmittance_2,
_e87);uint g_1=uint(_e88);int _e92=background_q13_1.z;int _e93=fxs_resolve_8bit(sum_1.z,transmittance_2,_e92);uint
b_11=uint(_e93);word_2=(((r|(g_1<<8u))|(b_11<<16u))|4278190080u);uint _e106=_group_0_binding_0_cs.format;
if((_e106==1u)){uint _e109=word_2;int _e112=fxs_coverage_8bit(transmittance_2);
word_2=((_e109&16777215u)|(uint(_e112)<<24u));}uint _e119=_group_0_binding_0_cs.format;if((_e119==2u)){
word_2=((((((r*31u)+ 127u)/255u)<<11u)|((((g_1*63u)+ 127u)/255u)<<5u))|(((b_11*31u)+ 127u)/255u));}uint
_e149=_group_0_binding_0_cs.colour;uint _e152=word_2;_group_1_binding_3_cs[(_e149 + at)]=_e152;return;}uvec2
corner_of(uint tile_1,uint number_2){uint _e4=_group_0_binding_0_cs.tile_bits;uint halves=(_e4 - 3u);int
_e10=_group_0_binding_0_cs.tiles.x;uint across=uint(_e10);uint _e17=_group_0_binding_0_cs.tile_bits;
return((uvec2((tile_1%across),(tile_1/across))<<uvec2(_e17))+(uvec2((number_2&halves),((number_2>>1u)&halves))*SIDE));}
uint of_first(uint thread_2,uint number_3){if((thread_2==0u)){shared_number=number_3;}memoryBarrierShared();barrier();
uint _e6=shared_number;memoryBarrierShared();barrier();return _e6;}Patch patch_at(uint thread_3,uint tile_2,uint
number_4,uvec2 rows,uint list,uint count){uint shift=0u;bool local_2=false;uvec2 _e6=corner_of(tile_2,number_4);uint
_e11=_group_0_binding_0_cs.rates;if((_e11!=NOTHING)){int _e17=_group_0_binding_0_cs.size.x;uint macros=((uint(_e17)+
31u)/32u);uint _e26=_group_0_binding_0_cs.rates;uint _e37=_group_1_binding_3_cs[((_e26
+((_e6.y/32u)*macros))+(_e6.x/32u))];uint _e38=of_first(thread_3,_e37);shift=_e38;}uint _e39=shift;if((_e39>0u)){uvec2
_e45=corner_of(tile_2,0u);local_2=any(notEqual(_e6,_e45));}else{local_2=false;}bool _e49=local_2;if(_e49){int
_e53=_group_0_binding_0_cs.size.x;int _e58=_group_0_binding_0_cs.size.y;return Patch(uint(_e53),uint(_e58),0u,rows,0u,
0u);}uint _e65=shift;uvec2 first_4=(_e6 + uvec2(((1u<<_e65)>>1u)));uint _e73=shift;return Patch(first_4.x,first_4.y,
_e73,rows,list,count);}Share share_of(uvec3 group_1){uint number_5=((group_1.y*ROW_OF_GROUPS)+ group_1.x);uint
_e8=_group_0_binding_0_cs.tile_bits;uint halves_1=(_e8 - 3u);uint longest_1=_group_1_binding_0_cs[31];uint
by_rows=((SIDE*longest_1)<<(2u*halves_1));uint whole=(number_5 - min(number_5,by_rows));uint
patch_number=((number_5>=by_rows)?(whole +(by_rows/SIDE)):(number_5/SIDE));uvec2 rows_1=((number_5>=by_rows)?uvec2(0u,
7u):uvec2((number_5%SIDE)));uint _e39=tile_at((patch_number>>(2u*halves_1)));return Share(_e39,patch_number,rows_1);}
Patch patch_of(Share share,uint thread_4){uint _e4=list_of(share.tile);uint count_1=_group_1_binding_0_cs[_e4];uint
_e9=list_of(share.tile);uint _e13=_group_1_binding_0_cs[(_e9 + 1u)];uint list_1=(_e13 - count_1);Patch
_e18=patch_at(thread_4,share.tile,share.number,share.rows,list_1,count_1);return _e18;}Place place_of(Patch here_3,uint
thread_5){bool local_3=false;bool local_4=false;bool local_5=false;uint column_2=(thread_5%APART);uint
row_3=(thread_5/APART);uvec2 columns=uvec2(column_2,(column_2 + APART));uvec2
x_8=(uvec2(here_3.x)+(columns<<uvec2(here_3.shift)));uint y_1=(here_3.y +(row_3<<here_3.shift));uint side=min(SIDE,
(16u>>here_3.shift));int _e27=_group_0_binding_0_cs.size.x;int _e35=_group_0_binding_0_cs.size.x;int
_e45=_group_0_binding_0_cs.size.y;if((y_1<uint(_e45))){local_3=(row_3<side);}else{local_3=false;}bool _e52=local_3;
if(_e52){local_4=(row_3>=here_3.rows.x);}else{local_4=false;}bool _e59=local_4;if(_e59){local_5=(row_3<=here_3.rows.y);}
else{local_5=false;}bool _e66=local_5;return Place(column_2,row_3,(uvec2((y_1*uint(_e27)))+ x_8),
bvec2(bvec2(lessThan(x_8,uvec2(uint(_e35))).x&&lessThan(columns,uvec2(side)).x,lessThan(x_8,
uvec2(uint(_e35))).y&&lessThan(columns,uvec2(side)).y).x&&bvec2(_e66).x,bvec2(lessThan(x_8,
uvec2(uint(_e35))).x&&lessThan(columns,uvec2(side)).x,lessThan(x_8,uvec2(uint(_e35))).y&&lessThan(columns,
uvec2(side)).y).y&&bvec2(_e66).y));}uint bit_of(Place place,bool second){return(1u<<((((place.row%4u)*8u)+
place.column)+(second?APART:0u)));}void clear_rounds(uint thread_6,Place place_1){if((thread_6<2u)){
open_pixels[thread_6]=0u;touching[thread_6]=0u;}if((thread_6==0u)){open_round=0u;}memoryBarrierShared();barrier();
if(any(place_1.inside)){uint _e23=bit_of(place_1,false);uint _e29=bit_of(place_1,true);uint
_e34=atomicOr(open_pixels[(place_1.row/4u)],((place_1.inside.x?_e23:0u)|(place_1.inside.y?_e29:0u)));}
memoryBarrierShared();barrier();return;}void close_pixel(Place place_2,bool second_1){uint _e7=bit_of(place_2,second_1);
uint _e9=atomicAnd(open_pixels[(place_2.row/4u)],~(_e7));return;}void put_splat(uint thread_7,Fetched f_3){int
_e9=_group_0_binding_0_cs.cut_q11_;int _e10=fxs_limit_q11_(int((f_3.b.y&65535u)),_e9);shapes[thread_7]=f_3.a;
shades[thread_7]=uvec4(f_3.b.xyz,uint(_e10));return;}void place_splat(Patch here_4,uint thread_8,Fetched f_4,uint
round_){if(((f_4.entry&CUT_OFF)!=0u)){return;}Fetched _e9=relative(f_4,here_4);put_splat(thread_8,_e9);bool
_e10=touch(_e9,here_4);if(_e10){uint _e17=atomicOr(touching[(round_%2u)],(1u<<thread_8));return;}else{return;}}uint
pixel_of(uint at_1,uint shift_1,uint i_3){int _e6=_group_0_binding_0_cs.size.x;uint width=uint(_e6);return(((at_1
-(((1u<<shift_1)>>1u)*(width + 1u)))+((i_3>>shift_1)*width))+(i_3&((1u<<shift_1)- 1u)));}void put_pixel(inout Pixel p_4,
uint at_2){uint _e4=_group_0_binding_0_cs.colour;if((_e4!=NOTHING)){put_colour(p_4,at_2);}uint
_e9=_group_0_binding_0_cs.coverage;if((_e9!=NOTHING)){uint _e15=_group_0_binding_0_cs.coverage;int
_e19=p_4.transmittance;int _e20=fxs_coverage_8bit(_e19);_group_1_binding_3_cs[(_e15 + at_2)]=uint(_e20);return;}else{
return;}}uint key_of(uint depth){bool local_6=false;int _e3=zeros_of((depth|1u));if(!((depth==NOTHING))){
local_6=(depth==0u);}else{local_6=true;}bool _e12=local_6;if(_e12){return depth;}int
_e17=_group_0_binding_0_cs.depth_bits;return((uint(((63 - _e3)- _e17))<<26u)|(((depth<<uint(_e3))>>5u)&67108863u));}
uint depth_of_key(uint key){int _e8=_group_0_binding_0_cs.depth_bits;int shift_3=(((int((key>>26u))- 32)+ _e8)- 26);
uint mantissa=(67108864u|(key&67108863u));if((shift_3>5)){return 4294967294u;}if((shift_3>=0)){
return(mantissa<<uint(shift_3));}if((shift_3>-32)){return(mantissa>>uint(-(shift_3)));}return 0u;}uvec2 depth_sum(int
weight,uint key_1){int code_q15_=min(int((((key_1&67108863u)+ 1024u)>>11u)),32767);int
_e18=_group_0_binding_0_cs.depth_bits;int shift_4=(min(((int((key_1>>26u))- 32)+ _e18),32)+ 8);if((shift_4<0)){return
uvec2(0u,0u);}int _e29=fxs_mul_q15_(weight,code_q15_);uvec2 _e35=shift_left(uvec2(uint((weight + _e29)),0u),
uint(shift_4));return _e35;}uint mean_depth(uvec2 sum,int transmittance){uint weight_3=uint((FXS_CLEAR_Q15_ -
transmittance));if((weight_3==0u)){return NOTHING;}uvec2 _e12=add_wide(sum,uvec2((weight_3<<7u),0u));uvec2
_e14=shift_right(_e12,8u);uint a_19=((_e14.y>>16u)%weight_3);uint b_12=((a_19<<16u)|(_e14.y&65535u));uint
c_2=(((b_12%weight_3)<<16u)|(_e14.x>>16u));uint d=(((c_2%weight_3)<<16u)|(_e14.x&65535u));if((_e14.y>=weight_3)){return
4294967294u;}return min((((c_2/weight_3)<<16u)|(d/weight_3)),4294967294u);}void note(inout Traced t_1,int before,int
weight_1,uint key_2,uint slot){uvec2 _e7=t_1.sum;uvec2 _e8=depth_sum(weight_1,key_2);uvec2 _e9=add_wide(_e7,_e8);
t_1.sum=_e9;if((before>=HALF_Q15_)){t_1.median=key_2;}int _e14=t_1.weight;if((weight_1>_e14)){t_1.weight=weight_1;
t_1.largest=slot;return;}else{return;}}void put_traces(inout Traced t_2,int transmittance_1,uint at_3){uint
_e5=_group_0_binding_0_cs.mean_depth;if((_e5!=NOTHING)){uint _e11=_group_0_binding_0_cs.mean_depth;uvec2 _e15=t_2.sum;
uint _e16=mean_depth(_e15,transmittance_1);_group_1_binding_3_cs[(_e11 + at_3)]=_e16;}uint
_e19=_group_0_binding_0_cs.median_depth;if((_e19!=NOTHING)){uint _e25=_group_0_binding_0_cs.median_depth;uint
_e29=t_2.median;uint _e30=depth_of_key(_e29);_group_1_binding_3_cs[(_e25 +
at_3)]=((transmittance_1>=HALF_Q15_)?NOTHING:_e30);}uint _e37=_group_0_binding_0_cs.id;if((_e37!=NOTHING)){uint
_e43=_group_0_binding_0_cs.id;uint _e49=t_2.largest;_group_1_binding_3_cs[(_e43 +(2u*at_3))]=_e49;return;}else{return;}}
uint depth_of(uint entry_1){if((entry_1==NOTHING)){return NOTHING;}uint _e7=_group_0_binding_0_cs.depths;uint
_e12=_group_1_binding_3_cs[(_e7 +(entry_1&2147483647u))];return _e12;}void trace_splat(inout Pixel p_5,inout Traced t_3,
Taken taken,uint column_1,uvec2 entry_2){uint _e7=t_3.limit;if((entry_2.y<=_e7)){int before_3=p_5.transmittance;int
_e11=blend_splat(p_5,taken,column_1);if((_e11>0)){note(t_3,before_3,_e11,entry_2.y,entry_2.x);return;}else{return;}}
else{return;}}Traced traced_at(bool inside,uint at_4){Traced t_4=Traced(4294967295u,0,4294967295u,4294967295u,uvec2(0u,
0u));bool local_7=false;if(inside){uint _e15=_group_0_binding_0_cs.occluder;local_7=(_e15!=NOTHING);}else{local_7=false;
}bool _e19=local_7;if(_e19){uint _e24=_group_0_binding_0_cs.occluder;uint _e27=_group_1_binding_3_cs[(_e24 + at_4)];
uint _e28=key_of(_e27);t_4.limit=_e28;}Traced _e29=t_4;return _e29;}void put_traced(inout Pixel p_6,inout Traced t_5,
uint at_5){put_pixel(p_6,at_5);int _e4=p_6.transmittance;put_traces(t_5,_e4,at_5);return;}void trace_patch(Patch here_5,
uint thread_9){Pixel p_7=Pixel(0,ivec3(0));Pixel q_1=Pixel(0,ivec3(0));Traced s=Traced(0u,0,0u,0u,uvec2(0u));Traced
t_6=Traced(0u,0,0u,0u,uvec2(0u));bvec2 open=bvec2(false);Fetched fetched=Fetched(0u,uvec4(0u),uvec4(0u));uint
depth_1=0u;uint entry_3=0u;uint first_1=0u;uint bits=0u;bool local_8=false;bool local_9=false;bool local_10=false;bool
local_11=false;uint i_4=0u;uint _e2=lane_of(thread_9);Place _e3=place_of(here_5,thread_9);
p_7=Pixel((_e3.inside.x?FXS_CLEAR_Q15_:0),ivec3(0));q_1=Pixel((_e3.inside.y?FXS_CLEAR_Q15_:0),ivec3(0));Traced
_e26=traced_at(_e3.inside.x,_e3.at.x);s=_e26;Traced _e32=traced_at(_e3.inside.y,_e3.at.y);t_6=_e32;open=_e3.inside;uint
_e36=fetch_entry(here_5,_e2);Fetched _e37=fetch_splat(_e36);fetched=_e37;uint _e40=fetched.entry;uint
_e41=depth_of(_e40);depth_1=_e41;uint _e45=fetch_entry(here_5,(SOME + _e2));entry_3=_e45;clear_rounds(thread_9,_e3);
for(;(first_1<here_5.count);first_1=(first_1 + SOME)){{uint _e52=first_1;uint round_1=((_e52/SOME)+ 1u);bvec2 _e57=open;
if(any(_e57)){open_round=round_1;}Fetched _e60=fetched;place_splat(here_5,thread_9,_e60,round_1);if((thread_9<SOME)){
uint _e66=fetched.entry;uint _e67=depth_1;own[thread_9]=uvec2(_e66,_e67);}uint _e69=entry_3;Fetched
_e70=fetch_splat(_e69);fetched=_e70;uint _e71=entry_3;uint _e72=depth_of(_e71);depth_1=_e72;uint _e73=first_1;uint
_e77=fetch_entry(here_5,((_e73 + 64u)+ _e2));entry_3=_e77;memoryBarrierShared();barrier();uint _e79=open_round;
memoryBarrierShared();barrier();if((_e79!=round_1)){break;}if((thread_9==0u)){touching[((round_1 + 1u)%2u)]=0u;}uint
_e94=touching[(round_1%2u)];bits=_e94;for(;(bits!=0u);bits=(bits&(bits - 1u))){{uint _e99=bits;uint
i_5=uint(findLSB(_e99));Taken _e102=take(i_5,_e3.row);uvec2 _e106=own[i_5];trace_splat(p_7,s,_e102,_e3.column,_e106);
Taken _e108=take(i_5,_e3.row);uvec2 _e114=own[i_5];trace_splat(q_1,t_6,_e108,(_e3.column + APART),_e114);}}bool
_e121=open.x;if(_e121){int _e125=p_7.transmittance;if(!((_e125<FXS_CLOSED_Q15_))){uint _e134=own[0].y;uint
_e136=s.limit;local_9=(_e134>_e136);}else{local_9=true;}bool _e139=local_9;local_8=_e139;}else{local_8=false;}bool
_e141=local_8;if(_e141){open.x=false;close_pixel(_e3,false);}bool _e146=open.y;if(_e146){int _e150=q_1.transmittance;
if(!((_e150<FXS_CLOSED_Q15_))){uint _e159=own[0].y;uint _e161=t_6.limit;local_11=(_e159>_e161);}else{local_11=true;}
bool _e164=local_11;local_10=_e164;}else{local_10=false;}bool _e166=local_10;if(_e166){open.y=false;close_pixel(_e3,
true);}memoryBarrierShared();barrier();}}for(;(i_4<(1u<<(2u*here_5.shift)));i_4=(i_4 + 1u)){{if(_e3.inside.x){uint
_e187=i_4;uint _e188=pixel_of(_e3.at.x,here_5.shift,_e187);put_traced(p_7,s,_e188);}if(_e3.inside.y){uint _e194=i_4;
uint _e195=pixel_of(_e3.at.y,here_5.shift,_e194);put_traced(q_1,t_6,_e195);}}}return;}void main(){uvec3
group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;Share _e2=share_of(group);if((_e2.tile==NOTHING)){return;}
Patch _e6=patch_of(_e2,thread);trace_patch(_e6,thread);return;}
