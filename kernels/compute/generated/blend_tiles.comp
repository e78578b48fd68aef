#version 310 es
precision highp float;precision highp int;layout(local_size_x=32,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Pixel{int transmittance;ivec3 sum;};struct Fetched{
uint entry;uvec4 a;uvec4 b;};struct Patch{uint x;uint y;uint shift;uvec2 rows;uint list;uint count;};struct Taken{uint
u;uint ux;uint level_q26_;int limit_q11_;ivec3 colour;};struct Share{uint tile;uint number;uvec2 rows;};struct Place{
uint column;uint row;uvec2 at;bvec2 inside;};const int FXS_FAINT_Q11_=22697;const int FXS_ALPHA_MAX_Q15_=32440;const
int FXS_CLEAR_Q15_=32767;const int FXS_CLOSED_Q15_=33;const uint ROW_OF_GROUPS=32768u;const uint CLASSES=16u;const uint
CUT_OFF=2147483648u;const uint NOTHING=4294967295u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const uint LIST=8u;
const uint SIDE=8u;const uint SOME=32u;const uint APART=4u;layout(std140,binding=0)uniform Frame_block_0Compute{Frame
_group_0_binding_0_cs;};layout(std430,binding=0)readonly buffer type_11_block_1Compute{uint _group_1_binding_0_cs[];};
shared uvec4 shapes[32];shared uvec4 shades[32];shared uint touching[2];shared uint open_round;shared uint
open_pixels[2];shared uint shared_number;layout(std430,binding=1)readonly buffer type_11_block_2Compute{uint
_group_1_binding_1_cs[];};layout(std430,binding=2)readonly buffer type_15_block_3Compute{uvec4 _group_1_binding_2_cs[];}
;layout(std430,binding=3)buffer type_11_block_4Compute{uint _group_1_binding_3_cs[];};int fxs_mul_q15_(int a,int b){
return(((a*b)+ 16384)>>15u);}int fxs_min(int a_1,int b_1){return((a_1<b_1)?a_1:b_1);}int fxs_coordinate_q13_(int
coordinate_q24_){int c=0;c=(coordinate_q24_>>11u);int _e4=c;int _e6=fxs_min(_e4,32767);int _e7=c;
return((_e7<-32767)?-32767:_e6);}int fxs_limit_q11_(int offset_q11_1,int cut_q11_){int _e4=fxs_min((offset_q11_1 +
cut_q11_),FXS_FAINT_Q11_);return _e4;}int fxs_mul_add_q15_(int a_2,int b_2,int c_1){return(((a_2*b_2)+((c_1*32768)+
16384))>>15u);}int fxs_alpha_q15_(int level_q11_){int p_1=0;int _e3=fxs_mul_add_q15_(-4236,level_q11_,16016);p_1=_e3;
int _e5=p_1;int _e7=fxs_mul_add_q15_(_e5,level_q11_,-32730);p_1=_e7;int _e8=p_1;int _e10=fxs_mul_add_q15_(_e8,
level_q11_,32767);p_1=_e10;int _e11=p_1;int _e12=p_1;int _e13=fxs_mul_q15_(_e11,_e12);p_1=_e13;int _e14=p_1;int
_e15=p_1;int _e16=fxs_mul_q15_(_e14,_e15);p_1=_e16;int _e17=p_1;int _e18=p_1;int _e19=fxs_mul_q15_(_e17,_e18);p_1=_e19;
int _e20=p_1;int _e22=fxs_min(_e20,FXS_ALPHA_MAX_Q15_);return _e22;}int fxs_weight_q15_(int alpha_q15_,int
transmittance_q15_){int _e2=fxs_mul_q15_(alpha_q15_,transmittance_q15_);return _e2;}int fxs_accumulate_q13_(int
sum_q13_,int weight_q15_,int colour_q13_){int _e3=fxs_mul_q15_(weight_q15_,colour_q13_);int _e6=fxs_min((sum_q13_ +
_e3),32767);return _e6;}int fxs_resolve_8bit(int sum_q13_1,int transmittance_q15_1,int background_q13_){int
_e3=fxs_accumulate_q13_(sum_q13_1,transmittance_q15_1,background_q13_);int _e11=fxs_min((((_e3*255)+ 4096)>>13u),255);
return _e11;}int fxs_coverage_8bit(int transmittance_q15_2){return((((FXS_CLEAR_Q15_ - transmittance_q15_2)*255)+
16384)>>15u);}uint list_of(uint tile){return(TILES +(LIST*tile));}uint classes_before(uint number,uvec4 sizes,inout
uint start,inout uint all_){uint _e4=all_;uint w=(_e4 + sizes.w);uint z=(w + sizes.z);uint y=(z + sizes.y);uint x=(y +
sizes.x);uvec4 ends=uvec4(x,y,z,w);uvec4 before=mix(uvec4(0u),uvec4(1u),greaterThanEqual(uvec4(number),ends));uvec4
last=(before*ends);all_=x;uint _e22=start;start=max(_e22,max(max(last.x,last.y),max(last.z,last.w)));return(((before.x
+ before.y)+ before.z)+ before.w);}uvec4 class_sizes(uint first){uint at_3=(CLASS_COUNTS + first);uint
_e5=_group_1_binding_0_cs[at_3];uint _e10=_group_1_binding_0_cs[(at_3 + 1u)];uint _e15=_group_1_binding_0_cs[(at_3 +
2u)];uint _e20=_group_1_binding_0_cs[(at_3 + 3u)];return uvec4(_e5,_e10,_e15,_e20);}uint tile_at(uint number_1){uint
start_1=0u;uint all_1=0u;uvec4 _e2=class_sizes(12u);uvec4 _e4=class_sizes(8u);uvec4 _e6=class_sizes(4u);uvec4
_e8=class_sizes(0u);uint _e13=classes_before(number_1,_e2,start_1,all_1);uint _e14=classes_before(number_1,_e4,start_1,
all_1);uint _e16=classes_before(number_1,_e6,start_1,all_1);uint _e18=classes_before(number_1,_e8,start_1,all_1);uint
before_1=(((_e13 + _e14)+ _e16)+ _e18);if((before_1==CLASSES)){return NOTHING;}uint _e26=_group_0_binding_0_cs.classes;
int _e32=_group_0_binding_0_cs.tiles.x;int _e36=_group_0_binding_0_cs.tiles.y;uint _e42=start_1;uint
_e45=_group_1_binding_0_cs[(((_e26 +((15u - before_1)*uint((_e32*_e36))))+ number_1)- _e42)];return _e45;}uint
lane_of(uint thread_2){return((thread_2<SOME)?thread_2:1073741824u);}uint fetch_entry(Patch here,uint i_1){
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
_e29=fxs_weight_q15_(_e26,_e28);int weight=(counts_1?_e29:0);int _e33=p_2.transmittance;p_2.transmittance=(_e33 -
weight);ivec3 _e36=p_2.sum;int _e39=fxs_mul_q15_(weight,t.colour.x);int _e42=fxs_mul_q15_(weight,t.colour.y);int
_e45=fxs_mul_q15_(weight,t.colour.z);p_2.sum=(_e36 + ivec3(_e39,_e42,_e45));return weight;}ivec3 background_of(uint
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
(tile_1/across))<<uvec2(_e17))+(uvec2((number_2&halves),((number_2>>1u)&halves))*SIDE));}uint of_first(uint thread_3,
uint number_3){if((thread_3==0u)){shared_number=number_3;}memoryBarrierShared();barrier();uint _e6=shared_number;
memoryBarrierShared();barrier();return _e6;}Patch patch_at(uint thread_4,uint tile_2,uint number_4,uvec2 rows,uint list,
uint count){uint shift=0u;bool local_2=false;uvec2 _e6=corner_of(tile_2,number_4);uint _e11=_group_0_binding_0_cs.rates;
if((_e11!=NOTHING)){int _e17=_group_0_binding_0_cs.size.x;uint macros=((uint(_e17)+ 31u)/32u);uint
_e26=_group_0_binding_0_cs.rates;uint _e37=_group_1_binding_3_cs[((_e26 +((_e6.y/32u)*macros))+(_e6.x/32u))];uint
_e38=of_first(thread_4,_e37);shift=_e38;}uint _e39=shift;if((_e39>0u)){uvec2 _e45=corner_of(tile_2,0u);
local_2=any(notEqual(_e6,_e45));}else{local_2=false;}bool _e49=local_2;if(_e49){int _e53=_group_0_binding_0_cs.size.x;
int _e58=_group_0_binding_0_cs.size.y;return Patch(uint(_e53),uint(_e58),0u,rows,0u,0u);}uint _e65=shift;uvec2
first_4=(_e6 + uvec2(((1u<<_e65)>>1u)));uint _e73=shift;return Patch(first_4.x,first_4.y,_e73,rows,list,count);}Share
share_of(uvec3 group_2){uint number_5=((group_2.y*ROW_OF_GROUPS)+ group_2.x);uint _e8=_group_0_binding_0_cs.tile_bits;
uint halves_1=(_e8 - 3u);uint longest_1=_group_1_binding_0_cs[31];uint by_rows=((SIDE*longest_1)<<(2u*halves_1));uint
whole=(number_5 - min(number_5,by_rows));uint patch_number=((number_5>=by_rows)?(whole
+(by_rows/SIDE)):(number_5/SIDE));uvec2 rows_1=((number_5>=by_rows)?uvec2(0u,7u):uvec2((number_5%SIDE)));uint
_e39=tile_at((patch_number>>(2u*halves_1)));return Share(_e39,patch_number,rows_1);}Patch patch_of(Share share,uint
thread_5){uint _e4=list_of(share.tile);uint count_1=_group_1_binding_0_cs[_e4];uint _e9=list_of(share.tile);uint
_e13=_group_1_binding_0_cs[(_e9 + 1u)];uint list_1=(_e13 - count_1);Patch _e18=patch_at(thread_5,share.tile,
share.number,share.rows,list_1,count_1);return _e18;}Place place_of(Patch here_3,uint thread_6){bool local_3=false;bool
local_4=false;bool local_5=false;uint column_1=(thread_6%APART);uint row_3=(thread_6/APART);uvec2
columns=uvec2(column_1,(column_1 + APART));uvec2 x_1=(uvec2(here_3.x)+(columns<<uvec2(here_3.shift)));uint
y_1=(here_3.y +(row_3<<here_3.shift));uint side=min(SIDE,(16u>>here_3.shift));int _e27=_group_0_binding_0_cs.size.x;int
_e35=_group_0_binding_0_cs.size.x;int _e45=_group_0_binding_0_cs.size.y;if((y_1<uint(_e45))){local_3=(row_3<side);}else{
local_3=false;}bool _e52=local_3;if(_e52){local_4=(row_3>=here_3.rows.x);}else{local_4=false;}bool _e59=local_4;
if(_e59){local_5=(row_3<=here_3.rows.y);}else{local_5=false;}bool _e66=local_5;return Place(column_1,row_3,
(uvec2((y_1*uint(_e27)))+ x_1),bvec2(bvec2(lessThan(x_1,uvec2(uint(_e35))).x&&lessThan(columns,uvec2(side)).x,
lessThan(x_1,uvec2(uint(_e35))).y&&lessThan(columns,uvec2(side)).y).x&&bvec2(_e66).x,bvec2(lessThan(x_1,
uvec2(uint(_e35))).x&&lessThan(columns,uvec2(side)).x,lessThan(x_1,uvec2(uint(_e35))).y&&lessThan(columns,
uvec2(side)).y).y&&bvec2(_e66).y));}uint bit_of(Place place,bool second){return(1u<<((((place.row%4u)*8u)+
place.column)+(second?APART:0u)));}void clear_rounds(uint thread_7,Place place_1){if((thread_7<2u)){
open_pixels[thread_7]=0u;touching[thread_7]=0u;}if((thread_7==0u)){open_round=0u;}memoryBarrierShared();barrier();
if(any(place_1.inside)){uint _e23=bit_of(place_1,false);uint _e29=bit_of(place_1,true);uint
_e34=atomicOr(open_pixels[(place_1.row/4u)],((place_1.inside.x?_e23:0u)|(place_1.inside.y?_e29:0u)));}
memoryBarrierShared();barrier();return;}void close_pixel(Place place_2,bool second_1){uint _e7=bit_of(place_2,second_1);
uint _e9=atomicAnd(open_pixels[(place_2.row/4u)],~(_e7));return;}void put_splat(uint thread_8,Fetched f_3){int
_e9=_group_0_binding_0_cs.cut_q11_;int _e10=fxs_limit_q11_(int((f_3.b.y&65535u)),_e9);shapes[thread_8]=f_3.a;
shades[thread_8]=uvec4(f_3.b.xyz,uint(_e10));return;}void place_splat(Patch here_4,uint thread_9,Fetched f_4,uint
round_){if(((f_4.entry&CUT_OFF)!=0u)){return;}Fetched _e9=relative(f_4,here_4);put_splat(thread_9,_e9);bool
_e10=touch(_e9,here_4);if(_e10){uint _e17=atomicOr(touching[(round_%2u)],(1u<<thread_9));return;}else{return;}}uint
pixel_of(uint at_1,uint shift_1,uint i_3){int _e6=_group_0_binding_0_cs.size.x;uint width=uint(_e6);return(((at_1
-(((1u<<shift_1)>>1u)*(width + 1u)))+((i_3>>shift_1)*width))+(i_3&((1u<<shift_1)- 1u)));}void put_pixel(inout Pixel p_4,
uint at_2){uint _e4=_group_0_binding_0_cs.colour;if((_e4!=NOTHING)){put_colour(p_4,at_2);}uint
_e9=_group_0_binding_0_cs.coverage;if((_e9!=NOTHING)){uint _e15=_group_0_binding_0_cs.coverage;int
_e19=p_4.transmittance;int _e20=fxs_coverage_8bit(_e19);_group_1_binding_3_cs[(_e15 + at_2)]=uint(_e20);return;}else{
return;}}void blend_round(inout Pixel p_5,inout Pixel q,Place place_3,uint round_1){uint bits=0u;Taken other=Taken(0u,
0u,0u,0,ivec3(0));uint _e8=touching[(round_1%2u)];bits=_e8;while(true){uint _e10=bits;if((_e10!=0u)){}else{break;}{uint
_e13=bits;uint _e14=bits;uint rest=(_e13&(_e14 - 1u));uint _e18=bits;Taken _e21=take(uint(findLSB(_e18)),place_3.row);
Taken _e26=take((uint(findLSB(rest))%SOME),place_3.row);other=_e26;int _e30=other.limit_q11_;
other.limit_q11_=((rest==0u)?-1:_e30);int _e36=blend_splat(p_5,_e21,place_3.column);int _e40=blend_splat(q,_e21,
(place_3.column + APART));Taken _e41=other;int _e43=blend_splat(p_5,_e41,place_3.column);Taken _e44=other;int
_e48=blend_splat(q,_e44,(place_3.column + APART));bits=(rest&(rest - 1u));}}return;}void blend_patch(Patch here_5,uint
thread_10){Pixel p_6=Pixel(0,ivec3(0));Pixel q_1=Pixel(0,ivec3(0));bvec2 open=bvec2(false);Fetched fetched=Fetched(0u,
uvec4(0u),uvec4(0u));Fetched next=Fetched(0u,uvec4(0u),uvec4(0u));uint entry_1=0u;uint first_1=0u;bool local_6=false;
bool local_7=false;uint i_4=0u;uint _e2=lane_of(thread_10);Place _e3=place_of(here_5,thread_10);
p_6=Pixel((_e3.inside.x?FXS_CLEAR_Q15_:0),ivec3(0));q_1=Pixel((_e3.inside.y?FXS_CLEAR_Q15_:0),ivec3(0));open=_e3.inside;
uint _e24=fetch_entry(here_5,_e2);Fetched _e25=fetch_splat(_e24);fetched=_e25;uint _e29=fetch_entry(here_5,(SOME +
_e2));Fetched _e30=fetch_splat(_e29);next=_e30;uint _e34=fetch_entry(here_5,(64u + _e2));entry_1=_e34;
clear_rounds(thread_10,_e3);for(;(first_1<here_5.count);first_1=(first_1 + SOME)){{uint _e41=first_1;uint
round_2=((_e41/SOME)+ 1u);bvec2 _e46=open;if(any(_e46)){open_round=round_2;}Fetched _e49=fetched;place_splat(here_5,
thread_10,_e49,round_2);Fetched _e50=next;fetched=_e50;uint _e51=entry_1;Fetched _e52=fetch_splat(_e51);next=_e52;uint
_e53=first_1;uint _e57=fetch_entry(here_5,((_e53 + 96u)+ _e2));entry_1=_e57;memoryBarrierShared();barrier();uint
_e59=open_round;memoryBarrierShared();barrier();if((_e59!=round_2)){break;}if((thread_10==0u)){touching[((round_2 +
1u)%2u)]=0u;}if((_e3.row<SIDE)){blend_round(p_6,q_1,_e3,round_2);}bool _e74=open.x;if(_e74){int _e78=p_6.transmittance;
local_6=(_e78<FXS_CLOSED_Q15_);}else{local_6=false;}bool _e82=local_6;if(_e82){open.x=false;close_pixel(_e3,false);}
bool _e87=open.y;if(_e87){int _e91=q_1.transmittance;local_7=(_e91<FXS_CLOSED_Q15_);}else{local_7=false;}bool
_e95=local_7;if(_e95){open.y=false;close_pixel(_e3,true);}memoryBarrierShared();barrier();}}for(;
(i_4<(1u<<(2u*here_5.shift)));i_4=(i_4 + 1u)){{if(_e3.inside.x){uint _e116=i_4;uint _e117=pixel_of(_e3.at.x,
here_5.shift,_e116);put_pixel(p_6,_e117);}if(_e3.inside.y){uint _e123=i_4;uint _e124=pixel_of(_e3.at.y,here_5.shift,
_e123);put_pixel(q_1,_e124);}}}return;}void main(){uvec3 group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;Share
_e2=share_of(group);if((_e2.tile==NOTHING)){return;}Patch _e6=patch_of(_e2,thread);blend_patch(_e6,thread);return;}
