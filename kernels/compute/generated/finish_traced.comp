#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Pixel{int transmittance;ivec3 sum;};struct Fetched{
uint entry;uvec4 a;uvec4 b;};struct Patch{uint x;uint y;uint shift;uvec2 rows;uint list;uint count;};struct Taken{uint
u;uint ux;uint level_q26_;int limit_q11_;ivec3 colour;};struct Place{uint column;uint row;uvec2 at;bvec2 inside;};
struct Traced{uint limit;int weight;uint largest;uint median;uvec2 sum;};struct Box{uvec2 first;uvec2 end;uvec2 mask;
bool large;};struct Lists{uint halves;uint list;uint room;};struct Turn{Lists lists;uint first;uint end;};const int
FXS_FAINT_Q11_=22697;const int FXS_ALPHA_MAX_Q15_=32440;const int FXS_CLEAR_Q15_=32767;const int FXS_CLOSED_Q15_=33;
const uint THREADS=128u;const uint BLOCK=512u;const uint CUT_OFF=2147483648u;const uint NOTHING=4294967295u;const uint
LARGE_BOX=4194303u;const int FAR_Q3_=-1048576;const uint GROUP=16u;const uint SIDE=8u;const uint SOME=32u;const uint
APART=4u;const uint SAMPLES=16u;const uint RANGE=16u;const uint BINS=256u;const uint SPARE=2147483648u;const int
HALF_Q15_=16384;layout(std140,binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};shared uint
sums[128];shared uint group_sums[8];layout(std430,binding=0)buffer type_14_block_1Compute{uint _group_1_binding_0_cs[];}
;shared uvec4 shapes[32];shared uvec4 shades[32];shared uint touching[2];shared uint open_round;shared uint
open_pixels[2];shared uint shared_number;layout(std430,binding=1)buffer type_14_block_2Compute{uint
_group_1_binding_1_cs[];};layout(std430,binding=2)readonly buffer type_18_block_3Compute{uvec4 _group_1_binding_2_cs[];}
;layout(std430,binding=3)buffer type_14_block_4Compute{uint _group_1_binding_3_cs[];};shared uvec2 keys[512];shared
uint bins[257];shared uint samples[16];shared uint ranks[16];shared uvec2 bounds[16];shared uint below_split[2];shared
uint splits[2];shared uvec2 own_2[32];shared uint found;shared uint near_count;shared uint near[128];int
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
wide_of(int x){return uvec2(uint(x),uint((x>>31u)));}uvec2 add_wide(uvec2 a_3,uvec2 b_3){uint low_1=(a_3.x + b_3.x);
return uvec2(low_1,((a_3.y + b_3.y)+((low_1<a_3.x)?1u:0u)));}bool is_negative(uvec2 a_5){return(int(a_5.y)<0);}uvec2
negate(uvec2 a_6){uvec2 _e5=add_wide(~(a_6),uvec2(1u,0u));return _e5;}uvec2 magnitude(uvec2 a_7){bool
_e1=is_negative(a_7);if(_e1){uvec2 _e2=negate(a_7);return _e2;}return a_7;}bool less(uvec2 a_8,uvec2 b_5){
return((a_8.y==b_5.y)?(a_8.x<b_5.x):(int(a_8.y)<int(b_5.y)));}uvec2 mul_wide(uint a_9,uint b_6){uint high;uint low;
umulExtended(a_9,b_6,high,low);return uvec2(low,high);}uvec2 mul_mixed(int a_11,uint b_8){uvec2 _e3=mul_wide(uint(a_11),
b_8);return uvec2(_e3.x,(_e3.y -((a_11<0)?b_8:0u)));}uvec2 mul_signed(int a_12,int b_9){uvec2 _e3=mul_mixed(a_12,
uint(b_9));return uvec2(_e3.x,(_e3.y -((b_9<0)?uint(a_12):0u)));}uvec2 shift_left(uvec2 a_14,uint n){if((n==0u)){return
a_14;}if((n>=32u)){return uvec2(0u,(a_14.x<<(n - 32u)));}return uvec2((a_14.x<<n),((a_14.y<<n)|(a_14.x>>(32u - n))));}
uvec2 shift_right(uvec2 a_15,uint n_1){if((n_1==0u)){return a_15;}if((n_1>=32u)){return uvec2((a_15.y>>(n_1 - 32u)),0u);
}return uvec2(((a_15.x>>n_1)|(a_15.y<<(32u - n_1))),(a_15.y>>n_1));}int zeros_of(uint x_2){return int(uint(31 -
findMSB(x_2)));}int zeros_of_wide(uvec2 x_3){int _e2=zeros_of(x_3.x);int _e6=zeros_of(x_3.y);return((x_3.y!=0u)?_e6:(32
+ _e2));}uint bound_words(){uint _e3=_group_0_binding_0_cs.places;return(4u*_e3);}uint list_room(uint longest,uint
larges,uint visible){return max(min((max(longest,BLOCK)+ larges),visible),1u);}uint plus(uint a_19,uint b_11,bool cut){
bool local_1=false;if(cut){local_1=((a_19 + b_11)<a_19);}else{local_1=false;}bool _e10=local_1;
return(_e10?4294967295u:(a_19 + b_11));}uint sum_before(uint thread_3,uint own,bool cut_1){uint sum=0u;uint i_3=0u;uint
sum_1=0u;uint i_4=0u;uint i_5=0u;sums[thread_3]=own;memoryBarrierShared();barrier();if((thread_3<8u)){for(;(i_3<GROUP);
i_3=(i_3 + 1u)){{uint _e14=sum;uint _e18=i_3;uint _e21=sums[((GROUP*thread_3)+ _e18)];uint _e22=plus(_e14,_e21,cut_1);
sum=_e22;}}uint _e28=sum;group_sums[thread_3]=_e28;}memoryBarrierShared();barrier();for(;(i_4<(thread_3/GROUP));
i_4=(i_4 + 1u)){{uint _e37=sum_1;uint _e39=i_4;uint _e41=group_sums[_e39];uint _e42=plus(_e37,_e41,cut_1);sum_1=_e42;}}
i_5=((thread_3/GROUP)*GROUP);for(;(i_5<thread_3);i_5=(i_5 + 1u)){{uint _e53=sum_1;uint _e55=i_5;uint _e57=sums[_e55];
uint _e58=plus(_e53,_e57,cut_1);sum_1=_e58;}}uint _e62=sum_1;return _e62;}uint lane_of(uint thread_4){
return((thread_4<SOME)?thread_4:1073741824u);}uint fetch_entry(Patch here,uint i_7){if((i_7<here.count)){uint
_e8=_group_1_binding_1_cs[(here.list + i_7)];return _e8;}return NOTHING;}Fetched fetch_splat(uint entry){Fetched
f=Fetched(0u,uvec4(0u),uvec4(0u));f.entry=entry;if(((entry&CUT_OFF)==0u)){uvec4 _e12=_group_1_binding_2_cs[(2u*entry)];
f.a=_e12;uvec4 _e20=_group_1_binding_2_cs[((2u*entry)+ 1u)];f.b=_e20;}Fetched _e21=f;return _e21;}Fetched
relative(Fetched f_1,Patch here_1){Fetched g=Fetched(0u,uvec4(0u),uvec4(0u));g=f_1;uint first_6=((max((f_1.b.w&65535u),
here_1.y)- here_1.y)>>here_1.shift);uint last_1=((max((f_1.b.w>>16u),here_1.y)- here_1.y)>>here_1.shift);
g.a=uvec4(((f_1.a.x +(here_1.x*f_1.a.z))+(here_1.y*f_1.a.w)),(f_1.a.y +(here_1.y*f_1.b.x)),
(f_1.a.zw<<uvec2(here_1.shift)));g.b.x=(f_1.b.x<<here_1.shift);g.b.w=(first_6|(last_1<<16u));Fetched _e60=g;return _e60;
}uint open_of(uint row){uint _e5=open_pixels[(row/4u)];return((_e5>>(8u*(row%4u)))&255u);}bool touch(Fetched f_2,Patch
here_2){uint u=0u;uint v=0u;bool touches=false;uint row_1=0u;bool local_2=false;int offset_q11_2=int((f_2.b.y&65535u));
int _e9=_group_0_binding_0_cs.cut_q11_;int _e10=fxs_limit_q11_(offset_q11_2,_e9);uint ux=f_2.a.z;uint
first_7=max((f_2.b.w&65535u),here_2.rows.x);uint last_2=min((f_2.b.w>>16u),here_2.rows.y);u=(f_2.a.x
+(first_7*f_2.a.w));v=(f_2.a.y +(first_7*f_2.b.x));row_1=first_7;for(;(row_1<=last_2);row_1=(row_1 + 1u)){{uint
_e46=row_1;uint _e47=open_of(_e46);uint _e48=u;int left=int((_e48 +(uint(findLSB(_e47))*ux)));uint _e53=u;int
right=int((_e53 +(uint(findMSB(_e47))*ux)));int u_q13_1=min((max(max(left,-(right)),0)>>11u),32767);uint _e66=v;int
_e68=fxs_coordinate_q13_(int(_e66));int _e69=fxs_mul_q15_(_e68,_e68);int most_q26_=(((((_e10 - _e69)- offset_q11_2)+
1)*32768)- 16384);bool _e78=touches;if((_e47!=0u)){local_2=((u_q13_1*u_q13_1)<most_q26_);}else{local_2=false;}bool
_e86=local_2;touches=(_e78||_e86);uint _e88=u;u=(_e88 + f_2.a.w);uint _e92=v;v=(_e92 + f_2.b.x);}}bool _e99=touches;
return _e99;}Taken take(uint i_8,uint row_2){uvec4 shape=shapes[i_8];uvec4 shade=shades[i_8];int v_1=int((shape.y
+(row_2*shade.x)));int _e13=fxs_coordinate_q13_(v_1);int _e14=fxs_mul_q15_(_e13,_e13);int level_q11_1=(_e14 +
int((shade.y&65535u)));return Taken((shape.x +(row_2*shape.w)),shape.z,((uint(level_q11_1)<<15u)+ 16384u),int(shade.w),
ivec3(uvec3((shade.y>>16u),(shade.z&65535u),(shade.z>>16u))));}int blend_splat(inout Pixel p_2,Taken t,uint column){
bool local_3=false;int _e8=fxs_coordinate_q13_(int((t.u +(column*t.ux))));int level=int(((uint((_e8*_e8))+
t.level_q26_)>>15u));if((level<=t.limit_q11_)){int _e21=p_2.transmittance;local_3=(_e21>=FXS_CLOSED_Q15_);}else{
local_3=false;}bool counts_1=local_3;int _e26=fxs_alpha_q15_(level);int _e28=p_2.transmittance;int
_e29=fxs_weight_q15_(_e26,_e28);int weight_2=(counts_1?_e29:0);int _e33=p_2.transmittance;p_2.transmittance=(_e33 -
weight_2);ivec3 _e36=p_2.sum;int _e39=fxs_mul_q15_(weight_2,t.colour.x);int _e42=fxs_mul_q15_(weight_2,t.colour.y);int
_e45=fxs_mul_q15_(weight_2,t.colour.z);p_2.sum=(_e36 + ivec3(_e39,_e42,_e45));return weight_2;}ivec3 background_of(uint
word_1){uvec3 rgb=uvec3((word_1&255u),((word_1>>8u)&255u),((word_1>>16u)&255u));return ivec3((((rgb*8192u)+
uvec3(127u))/uvec3(255u)));}void put_colour(inout Pixel p_3,uint at){ivec3 background_q13_1=ivec3(0);uint word_2=0u;
ivec3 _e3=p_3.sum;ivec3 sum_4=min(_e3,ivec3(32767));int transmittance_2=p_3.transmittance;uint
_e11=_group_0_binding_0_cs.format;if((_e11==3u)){uvec3 rgb_1=uvec3(min((((sum_4*65535)+ ivec3(4096))>>uvec3(13u)),
ivec3(65535)));uint alpha=uint(((((FXS_CLEAR_Q15_ - transmittance_2)*65535)+ 16384)>>15u));uint
_e38=_group_0_binding_0_cs.colour;_group_1_binding_3_cs[(_e38 +(2u*at))]=(rgb_1.x|(rgb_1.y<<16u));uint
_e51=_group_0_binding_0_cs.colour;_group_1_binding_3_cs[((_e51 +(2u*at))+ 1u)]=(rgb_1.z|(alpha<<16u));return;}ivec4
_e64=_group_0_binding_0_cs.background_q13_;background_q13_1=_e64.xyz;uint _e69=_group_0_binding_0_cs.backdrop;
if((_e69!=NOTHING)){uint _e75=_group_0_binding_0_cs.backdrop;uint _e78=_group_1_binding_3_cs[(_e75 + at)];ivec3
_e79=background_of(_e78);background_q13_1=_e79;}int _e82=background_q13_1.x;int _e83=fxs_resolve_8bit(sum_4.x,
transmittance_2,_e82);uint r=uint(_e83);int _e87=background_q13_1.y;int _e88=fxs_resolve_8bit(sum_4.y,transmittance_2,
_e87);uint g_1=uint(_e88);int _e92=background_q13_1.z;int _e93=fxs_resolve_8bit(sum_4.z,transmittance_2,_e92);uint
b_14=uint(_e93);word_2=(((r|(g_1<<8u))|(b_14<<16u))|4278190080u);uint _e106=_group_0_binding_0_cs.format;
if((_e106==1u)){uint _e109=word_2;int _e112=fxs_coverage_8bit(transmittance_2);
word_2=((_e109&16777215u)|(uint(_e112)<<24u));}uint _e119=_group_0_binding_0_cs.format;if((_e119==2u)){
word_2=((((((r*31u)+ 127u)/255u)<<11u)|((((g_1*63u)+ 127u)/255u)<<5u))|(((b_14*31u)+ 127u)/255u));}uint
_e149=_group_0_binding_0_cs.colour;uint _e152=word_2;_group_1_binding_3_cs[(_e149 + at)]=_e152;return;}uvec2
corner_of(uint tile_3,uint number_2){uint _e4=_group_0_binding_0_cs.tile_bits;uint halves_1=(_e4 - 3u);int
_e10=_group_0_binding_0_cs.tiles.x;uint across=uint(_e10);uint _e17=_group_0_binding_0_cs.tile_bits;
return((uvec2((tile_3%across),(tile_3/across))<<uvec2(_e17))+(uvec2((number_2&halves_1),
((number_2>>1u)&halves_1))*SIDE));}uint of_first(uint thread_5,uint number_3){if((thread_5==0u)){shared_number=number_3;
}memoryBarrierShared();barrier();uint _e6=shared_number;memoryBarrierShared();barrier();return _e6;}Patch patch_at(uint
thread_6,uint tile_4,uint number_4,uvec2 rows,uint list,uint count){uint shift=0u;bool local_4=false;uvec2
_e6=corner_of(tile_4,number_4);uint _e11=_group_0_binding_0_cs.rates;if((_e11!=NOTHING)){int
_e17=_group_0_binding_0_cs.size.x;uint macros=((uint(_e17)+ 31u)/32u);uint _e26=_group_0_binding_0_cs.rates;uint
_e37=_group_1_binding_3_cs[((_e26 +((_e6.y/32u)*macros))+(_e6.x/32u))];uint _e38=of_first(thread_6,_e37);shift=_e38;}
uint _e39=shift;if((_e39>0u)){uvec2 _e45=corner_of(tile_4,0u);local_4=any(notEqual(_e6,_e45));}else{local_4=false;}bool
_e49=local_4;if(_e49){int _e53=_group_0_binding_0_cs.size.x;int _e58=_group_0_binding_0_cs.size.y;return
Patch(uint(_e53),uint(_e58),0u,rows,0u,0u);}uint _e65=shift;uvec2 first_8=(_e6 + uvec2(((1u<<_e65)>>1u)));uint
_e73=shift;return Patch(first_8.x,first_8.y,_e73,rows,list,count);}Place place_of(Patch here_3,uint thread_8){bool
local_5=false;bool local_6=false;bool local_7=false;uint column_2=(thread_8%APART);uint row_4=(thread_8/APART);uvec2
columns_2=uvec2(column_2,(column_2 + APART));uvec2 x_8=(uvec2(here_3.x)+(columns_2<<uvec2(here_3.shift)));uint
y_1=(here_3.y +(row_4<<here_3.shift));uint side=min(SIDE,(16u>>here_3.shift));int _e27=_group_0_binding_0_cs.size.x;int
_e35=_group_0_binding_0_cs.size.x;int _e45=_group_0_binding_0_cs.size.y;if((y_1<uint(_e45))){local_5=(row_4<side);}else{
local_5=false;}bool _e52=local_5;if(_e52){local_6=(row_4>=here_3.rows.x);}else{local_6=false;}bool _e59=local_6;
if(_e59){local_7=(row_4<=here_3.rows.y);}else{local_7=false;}bool _e66=local_7;return Place(column_2,row_4,
(uvec2((y_1*uint(_e27)))+ x_8),bvec2(bvec2(lessThan(x_8,uvec2(uint(_e35))).x&&lessThan(columns_2,uvec2(side)).x,
lessThan(x_8,uvec2(uint(_e35))).y&&lessThan(columns_2,uvec2(side)).y).x&&bvec2(_e66).x,bvec2(lessThan(x_8,
uvec2(uint(_e35))).x&&lessThan(columns_2,uvec2(side)).x,lessThan(x_8,uvec2(uint(_e35))).y&&lessThan(columns_2,
uvec2(side)).y).y&&bvec2(_e66).y));}uint bit_of(Place place,bool second){return(1u<<((((place.row%4u)*8u)+
place.column)+(second?APART:0u)));}void clear_rounds(uint thread_9,Place place_1){if((thread_9<2u)){
open_pixels[thread_9]=0u;touching[thread_9]=0u;}if((thread_9==0u)){open_round=0u;}memoryBarrierShared();barrier();
if(any(place_1.inside)){uint _e23=bit_of(place_1,false);uint _e29=bit_of(place_1,true);uint
_e34=atomicOr(open_pixels[(place_1.row/4u)],((place_1.inside.x?_e23:0u)|(place_1.inside.y?_e29:0u)));}
memoryBarrierShared();barrier();return;}void close_pixel(Place place_2,bool second_1){uint _e7=bit_of(place_2,second_1);
uint _e9=atomicAnd(open_pixels[(place_2.row/4u)],~(_e7));return;}void put_splat(uint thread_10,Fetched f_3){int
_e9=_group_0_binding_0_cs.cut_q11_;int _e10=fxs_limit_q11_(int((f_3.b.y&65535u)),_e9);shapes[thread_10]=f_3.a;
shades[thread_10]=uvec4(f_3.b.xyz,uint(_e10));return;}void place_splat(Patch here_4,uint thread_11,Fetched f_4,uint
round_){if(((f_4.entry&CUT_OFF)!=0u)){return;}Fetched _e9=relative(f_4,here_4);put_splat(thread_11,_e9);bool
_e10=touch(_e9,here_4);if(_e10){uint _e17=atomicOr(touching[(round_%2u)],(1u<<thread_11));return;}else{return;}}uint
pixel_of(uint at_1,uint shift_1,uint i_9){int _e6=_group_0_binding_0_cs.size.x;uint width=uint(_e6);return(((at_1
-(((1u<<shift_1)>>1u)*(width + 1u)))+((i_9>>shift_1)*width))+(i_9&((1u<<shift_1)- 1u)));}void put_pixel(inout Pixel p_4,
uint at_2){uint _e4=_group_0_binding_0_cs.colour;if((_e4!=NOTHING)){put_colour(p_4,at_2);}uint
_e9=_group_0_binding_0_cs.coverage;if((_e9!=NOTHING)){uint _e15=_group_0_binding_0_cs.coverage;int
_e19=p_4.transmittance;int _e20=fxs_coverage_8bit(_e19);_group_1_binding_3_cs[(_e15 + at_2)]=uint(_e20);return;}else{
return;}}uvec2 keyed(uint entry_1){uint _e4=_group_0_binding_0_cs.depths;uint _e9=_group_1_binding_3_cs[(_e4
+(entry_1&2147483647u))];return uvec2(entry_1,_e9);}uvec2 key_at(uint at_3){if(((at_3&SPARE)!=0u)){uint
_e8=_group_0_binding_0_cs.spare;uint _e13=_group_1_binding_3_cs[(_e8 +(at_3&2147483647u))];uvec2 _e14=keyed(_e13);
return _e14;}uint _e17=_group_1_binding_1_cs[at_3];uvec2 _e18=keyed(_e17);return _e18;}void put_entry(uint at_4,uint
entry_2){if(((at_4&SPARE)!=0u)){uint _e9=_group_0_binding_0_cs.spare;_group_1_binding_3_cs[(_e9
+(at_4&2147483647u))]=entry_2;return;}else{_group_1_binding_1_cs[at_4]=entry_2;return;}}bool is_below(uvec2 a_20,uvec2
b_12){return((a_20.y==b_12.y)?(a_20.x<b_12.x):(a_20.y<b_12.y));}uint merges_of(uint count_1){return(max((32u - uint(31
- findMSB((count_1 - 1u)))),9u)- 9u);}void place_bins(uint thread_13,uint some){uint bin=(2u*thread_13);uint
size=bins[bin];uint _e11=bins[(bin + 1u)];uint _e14=sum_before(thread_13,(size + _e11),false);bins[bin]=_e14;bins[(bin
+ 1u)]=(_e14 + size);if((thread_13==0u)){bins[256]=some;}memoryBarrierShared();barrier();return;}void bound_ranges(uint
thread_14,uint at_5,uint some_1){uint below=0u;uint i_10=0u;bool local_8=false;bool local_9=false;uint
sample_=(thread_14%SAMPLES);if((thread_14<SAMPLES)){uvec2 _e16=key_at((at_5 +(((thread_14*max(some_1,
SAMPLES))/SAMPLES)%some_1)));samples[thread_14]=_e16.y;ranks[thread_14]=0u;}memoryBarrierShared();barrier();uint
own_3=samples[sample_];for(;(i_10<2u);i_10=(i_10 + 1u)){{uint _e35=i_10;uint other_2=(((thread_14/SAMPLES)*2u)+ _e35);
uint _e37=below;uint _e42=samples[other_2];if(!((_e42<own_3))){uint _e49=samples[other_2];if((_e49==own_3)){
local_9=(other_2<sample_);}else{local_9=false;}bool _e55=local_9;local_8=_e55;}else{local_8=true;}bool _e57=local_8;
below=(_e37 +(_e57?1u:0u));}}uint _e65=below;uint _e66=atomicAdd(ranks[sample_],_e65);memoryBarrierShared();barrier();
if((thread_14<SAMPLES)){uint _e72=ranks[thread_14];bounds[_e72].x=own_3;}memoryBarrierShared();barrier();
if((thread_14<SAMPLES)){uint _e84=bounds[min((thread_14 + 1u),15u)].x;uint _e88=bounds[thread_14].x;uint width_1=(_e84
- _e88);bounds[thread_14].y=(max((32u - uint(31 - findMSB(width_1))),4u)- 4u);}memoryBarrierShared();barrier();return;}
uint bin_of(uint depth){uint range=0u;uint step_=8u;for(;(step_!=0u);step_=(step_>>1u)){{uint _e8=range;uint _e10=step_;
uint _e12=range;uint _e13=step_;uint _e17=bounds[(_e12 + _e13)].x;range=(_e8 +((_e17<=depth)?_e10:0u));}}uint
_e25=range;uvec2 bound_1=bounds[_e25];uint _e29=range;return((RANGE*_e29)+ min(((max(depth,bound_1.x)-
bound_1.x)>>bound_1.y),15u));}void sort_block(uint thread_15,uint at_6,uint some_2,uint to){uvec2
own_1[4]=uvec2[4](uvec2(0u),uvec2(0u),uvec2(0u),uvec2(0u));uint bin_of_own[4]=uint[4](0u,0u,0u,0u);uint
place_3[4]=uint[4](0u,0u,0u,0u);uint i_11=0u;uint k=0u;uint k_1=0u;uint k_2=0u;uint k_3=0u;uint below_1=0u;uint i_12=0u;
i_11=thread_15;for(;(i_11<BINS);i_11=(i_11 + THREADS)){{uint _e12=i_11;bins[_e12]=0u;}}for(;(k<4u);k=(k + 1u)){{uint
_e23=k;if(((thread_15 +(_e23*THREADS))<some_2)){uint _e28=k;uint _e31=k;uvec2 _e35=key_at(((at_6 +
thread_15)+(_e31*THREADS)));own_1[_e28]=_e35;}}}bound_ranges(thread_15,at_6,some_2);for(;(k_1<4u);k_1=(k_1 + 1u)){{uint
_e44=k_1;if(((thread_15 +(_e44*THREADS))<some_2)){uint _e49=k_1;uint _e51=k_1;uint _e54=own_1[_e51].y;uint
_e55=bin_of(_e54);bin_of_own[_e49]=_e55;uint _e56=k_1;uint _e59=k_1;uint _e61=bin_of_own[_e59];uint
_e64=atomicAdd(bins[_e61],1u);place_3[_e56]=_e64;}}}memoryBarrierShared();barrier();place_bins(thread_15,some_2);for(;
(k_2<4u);k_2=(k_2 + 1u)){{uint _e73=k_2;if(((thread_15 +(_e73*THREADS))<some_2)){uint _e80=k_2;uint
_e82=bin_of_own[_e80];uint _e84=bins[_e82];uint _e85=k_2;uint _e87=place_3[_e85];uint _e90=k_2;uvec2 _e92=own_1[_e90];
keys[(_e84 + _e87)]=_e92;}}}memoryBarrierShared();barrier();for(;(k_3<4u);k_3=(k_3 + 1u)){{uint _e101=k_3;
if(((thread_15 +(_e101*THREADS))<some_2)){uint _e107=k_3;uint _e109=bin_of_own[_e107];uint first_9=bins[_e109];uint
_e113=k_3;uint _e115=bin_of_own[_e113];uint end=bins[(_e115 + 1u)];below_1=first_9;i_12=first_9;for(;(i_12<end);
i_12=(i_12 + 1u)){{uint _e124=below_1;uint _e128=i_12;uvec2 _e130=keys[_e128];uint _e131=k_3;uvec2 _e133=own_1[_e131];
bool _e134=is_below(_e130,_e133);below_1=(_e124 +(_e134?1u:0u));}}uint _e140=below_1;uint _e142=k_3;uint
_e145=own_1[_e142].x;put_entry((to + _e140),_e145);}}}return;}uint split(uint thread_16,uint first_1,uint a_21,uint
second_2,uint b_13,uint d,uint run){uint low=0u;uint high=0u;uint i_13=0u;bool local_10=false;uint
side_1=(thread_16/64u);low=(d - min(d,b_13));high=min(d,a_21);for(;(i_13<=(run/6u));i_13=(i_13 + 1u)){{uint _e20=high;
uint _e21=low;uint step_3=(((_e20 - _e21)+ 63u)/64u);uint _e27=low;uint place_5=(_e27 +((thread_16%64u)*step_3));
below_split[side_1]=0u;memoryBarrierShared();barrier();uint _e35=high;if((place_5<_e35)){uvec2 _e40=key_at((first_1 +
place_5));uvec2 _e45=key_at((((second_2 + d)- 1u)- place_5));bool _e46=is_below(_e40,_e45);local_10=_e46;}else{
local_10=false;}bool _e48=local_10;if(_e48){uint _e52=atomicAdd(below_split[side_1],1u);}memoryBarrierShared();
barrier();uint below_3=below_split[side_1];memoryBarrierShared();barrier();uint _e56=high;uint _e57=low;high=min(_e56,
(_e57 +(below_3*step_3)));uint _e61=low;low=(_e61 +((below_3!=0u)?(((below_3 - 1u)*step_3)+ 1u):0u));}}uint _e75=low;
return _e75;}uint count_below(uint first_2,uint count_2,uvec2 key){uint below_2=0u;uint step_1=256u;bool local_11=false;
for(;(step_1!=0u);step_1=(step_1>>1u)){{uint _e10=below_2;uint _e11=step_1;uint next_1=(_e10 + _e11);
if((next_1<=count_2)){uvec2 _e21=keys[((first_2 + next_1)- 1u)];bool _e22=is_below(_e21,key);local_11=_e22;}else{
local_11=false;}bool _e24=local_11;if(_e24){below_2=next_1;}}}uint _e28=below_2;return _e28;}void merge_block(uint
thread_17,uint source,uint to_1,uint count_3,uint block,uint run_1){uint i_14=0u;uint i_15=0u;uint
start_2=((block>>(run_1 + 1u))<<(run_1 + 1u));uint both=min((count_3 - start_2),(2u<<run_1));uint a_22=min(both,
(1u<<run_1));uint d_2=(block - start_2);uint some_3=min((both - d_2),BLOCK);uint first_10=(source + start_2);uint
second_3=(first_10 + a_22);uint _e34=split(thread_17,first_10,a_22,second_3,(both - a_22),(d_2
+((thread_17/64u)*some_3)),run_1);splits[(thread_17/64u)]=_e34;memoryBarrierShared();barrier();uint _e37=splits[1];uint
_e40=splits[0];uint of_first_1=(_e37 - _e40);i_14=thread_17;for(;(i_14<some_3);i_14=(i_14 + THREADS)){{uint
_e48=splits[0];uint _e50=i_14;uint _e55=splits[0];uint _e57=i_14;uint _e59=i_14;uint
at_15=((_e59<of_first_1)?((first_10 + _e55)+ _e57):((((second_3 + d_2)- _e48)+ _e50)- of_first_1));uint _e63=i_14;uvec2
_e65=key_at(at_15);keys[_e63]=_e65;}}memoryBarrierShared();barrier();i_15=thread_17;for(;(i_15<some_3);i_15=(i_15 +
THREADS)){{uint _e73=i_15;uvec2 key_4=keys[_e73];uint _e76=i_15;bool is_first=(_e76<of_first_1);uint
_e82=count_below((is_first?of_first_1:0u),(is_first?(some_3 - of_first_1):of_first_1),key_4);uint _e84=i_15;uint
_e86=i_15;put_entry((((to_1 + block)+(is_first?_e86:(_e84 - of_first_1)))+ _e82),key_4.x);}}return;}uint key_of(uint
depth_1){bool local_14=false;int _e3=zeros_of((depth_1|1u));if(!((depth_1==NOTHING))){local_14=(depth_1==0u);}else{
local_14=true;}bool _e12=local_14;if(_e12){return depth_1;}int _e17=_group_0_binding_0_cs.depth_bits;return((uint(((63
- _e3)- _e17))<<26u)|(((depth_1<<uint(_e3))>>5u)&67108863u));}uint depth_of_key(uint key_1){int
_e8=_group_0_binding_0_cs.depth_bits;int shift_3=(((int((key_1>>26u))- 32)+ _e8)- 26);uint
mantissa=(67108864u|(key_1&67108863u));if((shift_3>5)){return 4294967294u;}if((shift_3>=0)){
return(mantissa<<uint(shift_3));}if((shift_3>-32)){return(mantissa>>uint(-(shift_3)));}return 0u;}uvec2 depth_sum(int
weight,uint key_2){int code_q15_=min(int((((key_2&67108863u)+ 1024u)>>11u)),32767);int
_e18=_group_0_binding_0_cs.depth_bits;int shift_4=(min(((int((key_2>>26u))- 32)+ _e18),32)+ 8);if((shift_4<0)){return
uvec2(0u,0u);}int _e29=fxs_mul_q15_(weight,code_q15_);uvec2 _e35=shift_left(uvec2(uint((weight + _e29)),0u),
uint(shift_4));return _e35;}uint mean_depth(uvec2 sum_3,int transmittance){uint weight_3=uint((FXS_CLEAR_Q15_ -
transmittance));if((weight_3==0u)){return NOTHING;}uvec2 _e12=add_wide(sum_3,uvec2((weight_3<<7u),0u));uvec2
_e14=shift_right(_e12,8u);uint a_23=((_e14.y>>16u)%weight_3);uint b_15=((a_23<<16u)|(_e14.y&65535u));uint
c_2=(((b_15%weight_3)<<16u)|(_e14.x>>16u));uint d_3=(((c_2%weight_3)<<16u)|(_e14.x&65535u));if((_e14.y>=weight_3)){
return 4294967294u;}return min((((c_2/weight_3)<<16u)|(d_3/weight_3)),4294967294u);}void note(inout Traced t_1,int
before,int weight_1,uint key_3,uint slot){uvec2 _e7=t_1.sum;uvec2 _e8=depth_sum(weight_1,key_3);uvec2 _e9=add_wide(_e7,
_e8);t_1.sum=_e9;if((before>=HALF_Q15_)){t_1.median=key_3;}int _e14=t_1.weight;if((weight_1>_e14)){t_1.weight=weight_1;
t_1.largest=slot;return;}else{return;}}void put_traces(inout Traced t_2,int transmittance_1,uint at_7){uint
_e5=_group_0_binding_0_cs.mean_depth;if((_e5!=NOTHING)){uint _e11=_group_0_binding_0_cs.mean_depth;uvec2 _e15=t_2.sum;
uint _e16=mean_depth(_e15,transmittance_1);_group_1_binding_3_cs[(_e11 + at_7)]=_e16;}uint
_e19=_group_0_binding_0_cs.median_depth;if((_e19!=NOTHING)){uint _e25=_group_0_binding_0_cs.median_depth;uint
_e29=t_2.median;uint _e30=depth_of_key(_e29);_group_1_binding_3_cs[(_e25 +
at_7)]=((transmittance_1>=HALF_Q15_)?NOTHING:_e30);}uint _e37=_group_0_binding_0_cs.id;if((_e37!=NOTHING)){uint
_e43=_group_0_binding_0_cs.id;uint _e49=t_2.largest;_group_1_binding_3_cs[(_e43 +(2u*at_7))]=_e49;return;}else{return;}}
uint depth_of(uint entry_4){if((entry_4==NOTHING)){return NOTHING;}uint _e7=_group_0_binding_0_cs.depths;uint
_e12=_group_1_binding_3_cs[(_e7 +(entry_4&2147483647u))];return _e12;}void trace_splat(inout Pixel p_7,inout Traced t_3,
Taken taken,uint column_1,uvec2 entry_5){uint _e7=t_3.limit;if((entry_5.y<=_e7)){int before_3=p_7.transmittance;int
_e11=blend_splat(p_7,taken,column_1);if((_e11>0)){note(t_3,before_3,_e11,entry_5.y,entry_5.x);return;}else{return;}}
else{return;}}Traced traced_at(bool inside,uint at_8){Traced t_4=Traced(4294967295u,0,4294967295u,4294967295u,uvec2(0u,
0u));bool local_15=false;if(inside){uint _e15=_group_0_binding_0_cs.occluder;local_15=(_e15!=NOTHING);}else{
local_15=false;}bool _e19=local_15;if(_e19){uint _e24=_group_0_binding_0_cs.occluder;uint
_e27=_group_1_binding_3_cs[(_e24 + at_8)];uint _e28=key_of(_e27);t_4.limit=_e28;}Traced _e29=t_4;return _e29;}void
put_traced(inout Pixel p_8,inout Traced t_5,uint at_9){put_pixel(p_8,at_9);int _e4=p_8.transmittance;put_traces(t_5,_e4,
at_9);return;}void trace_patch(Patch here_6,uint thread_19){Pixel p_9=Pixel(0,ivec3(0));Pixel q_3=Pixel(0,ivec3(0));
Traced s=Traced(0u,0,0u,0u,uvec2(0u));Traced t_6=Traced(0u,0,0u,0u,uvec2(0u));bvec2 open_1=bvec2(false);Fetched
fetched_1=Fetched(0u,uvec4(0u),uvec4(0u));uint depth_2=0u;uint entry_6=0u;uint first_4=0u;uint bits_1=0u;bool
local_16=false;bool local_17=false;bool local_18=false;bool local_19=false;uint i_17=0u;uint _e2=lane_of(thread_19);
Place _e3=place_of(here_6,thread_19);p_9=Pixel((_e3.inside.x?FXS_CLEAR_Q15_:0),ivec3(0));
q_3=Pixel((_e3.inside.y?FXS_CLEAR_Q15_:0),ivec3(0));Traced _e26=traced_at(_e3.inside.x,_e3.at.x);s=_e26;Traced
_e32=traced_at(_e3.inside.y,_e3.at.y);t_6=_e32;open_1=_e3.inside;uint _e36=fetch_entry(here_6,_e2);Fetched
_e37=fetch_splat(_e36);fetched_1=_e37;uint _e40=fetched_1.entry;uint _e41=depth_of(_e40);depth_2=_e41;uint
_e45=fetch_entry(here_6,(SOME + _e2));entry_6=_e45;clear_rounds(thread_19,_e3);for(;(first_4<here_6.count);
first_4=(first_4 + SOME)){{uint _e52=first_4;uint round_3=((_e52/SOME)+ 1u);bvec2 _e57=open_1;if(any(_e57)){
open_round=round_3;}Fetched _e60=fetched_1;place_splat(here_6,thread_19,_e60,round_3);if((thread_19<SOME)){uint
_e66=fetched_1.entry;uint _e67=depth_2;own_2[thread_19]=uvec2(_e66,_e67);}uint _e69=entry_6;Fetched
_e70=fetch_splat(_e69);fetched_1=_e70;uint _e71=entry_6;uint _e72=depth_of(_e71);depth_2=_e72;uint _e73=first_4;uint
_e77=fetch_entry(here_6,((_e73 + 64u)+ _e2));entry_6=_e77;memoryBarrierShared();barrier();uint _e79=open_round;
memoryBarrierShared();barrier();if((_e79!=round_3)){break;}if((thread_19==0u)){touching[((round_3 + 1u)%2u)]=0u;}uint
_e94=touching[(round_3%2u)];bits_1=_e94;for(;(bits_1!=0u);bits_1=(bits_1&(bits_1 - 1u))){{uint _e99=bits_1;uint
i_20=uint(findLSB(_e99));Taken _e102=take(i_20,_e3.row);uvec2 _e106=own_2[i_20];trace_splat(p_9,s,_e102,_e3.column,
_e106);Taken _e108=take(i_20,_e3.row);uvec2 _e114=own_2[i_20];trace_splat(q_3,t_6,_e108,(_e3.column + APART),_e114);}}
bool _e121=open_1.x;if(_e121){int _e125=p_9.transmittance;if(!((_e125<FXS_CLOSED_Q15_))){uint _e134=own_2[0].y;uint
_e136=s.limit;local_17=(_e134>_e136);}else{local_17=true;}bool _e139=local_17;local_16=_e139;}else{local_16=false;}bool
_e141=local_16;if(_e141){open_1.x=false;close_pixel(_e3,false);}bool _e146=open_1.y;if(_e146){int
_e150=q_3.transmittance;if(!((_e150<FXS_CLOSED_Q15_))){uint _e159=own_2[0].y;uint _e161=t_6.limit;
local_19=(_e159>_e161);}else{local_19=true;}bool _e164=local_19;local_18=_e164;}else{local_18=false;}bool
_e166=local_18;if(_e166){open_1.y=false;close_pixel(_e3,true);}memoryBarrierShared();barrier();}}for(;
(i_17<(1u<<(2u*here_6.shift)));i_17=(i_17 + 1u)){{if(_e3.inside.x){uint _e187=i_17;uint _e188=pixel_of(_e3.at.x,
here_6.shift,_e187);put_traced(p_9,s,_e188);}if(_e3.inside.y){uint _e194=i_17;uint _e195=pixel_of(_e3.at.y,here_6.shift,
_e194);put_traced(q_3,t_6,_e195);}}}return;}ivec2 centre_q3_(uvec2 box){uint y_2=((box.x>>21u)|(box.y<<11u));
return(ivec2((uvec2(box.x,y_2)<<uvec2(11u)))>>uvec2(11u));}uvec2 columns_of(uint slot_1,ivec2 centre){uvec4
a_24=_group_1_binding_2_cs[(2u*slot_1)];uint _e14=_group_1_binding_2_cs[((2u*slot_1)+ 1u)].x;uint vy=max(_e14,1u);uint
ratio_q6_=(((uint(abs(int(a_24.w)))<<6u)/vy)+ 65u);uint pixels=((67108864u/max(a_24.z,1u))+ 1u);int
half_1=(int(min(((pixels*min(ratio_q6_,((67108864u/pixels)+ 1u)))>>6u),1048575u))+ 1);int
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
uvec2 _e60=shift_right(mask,(6u*_e58));columns_1=(_e56|(_e60.x&63u));}}uvec2 first_11=uvec2((tile_7%across_1),
(tile_7/across_1));int _e71=zeros_of_wide(mask);uint rows_3=((uint((63 - _e71))/6u)+ 1u);uint _e80=columns_1;return
Box(first_11,(first_11 + uvec2((32u - uint(31 - findMSB(_e80))),rows_3)),mask,false);}bool is_near(ivec2 d_1,ivec2
slope_q24_){uint _e5=_group_0_binding_0_cs.tile_bits;uint half_tile=(4u<<_e5);uvec2 _e9=mul_signed(d_1.x,slope_q24_.x);
uvec2 _e12=mul_signed(d_1.y,slope_q24_.y);uvec2 _e13=add_wide(_e9,_e12);uvec2 _e15=wide_of(536870912);uvec2
_e23=mul_wide((uint(abs(slope_q24_.x))+ uint(abs(slope_q24_.y))),half_tile);uvec2 _e24=add_wide(_e15,_e23);uvec2
_e25=magnitude(_e13);bool _e26=less(_e24,_e25);return!(_e26);}bool reaches(uint slot_4,uvec2 box_1,uvec2 at_10){bool
local_20=false;ivec2 _e3=centre_q3_(box_1);if((_e3.x==FAR_Q3_)){return true;}uvec4
a_25=_group_1_binding_2_cs[(2u*slot_4)];uint _e20=_group_0_binding_0_cs.tile_bits;ivec2 d_4=(ivec2((((2u*at_10)+
uvec2(1u))<<uvec2((_e20 + 2u))))- _e3);bool _e29=is_near(d_4,ivec2(a_25.zw));if(_e29){uint
_e39=_group_1_binding_2_cs[((2u*slot_4)+ 1u)].x;bool _e43=is_near(d_4,ivec2(0,int(_e39)));local_20=_e43;}else{
local_20=false;}bool _e45=local_20;return _e45;}bool has_tile(uint slot_5,uvec2 at_11){bool local_21=false;Box
_e2=box_of(slot_5);if(!(any(lessThan(at_11,_e2.first)))){local_21=any(greaterThanEqual(at_11,_e2.end));}else{
local_21=true;}bool _e13=local_21;if(_e13){return false;}if(_e2.large){bool _e17=reaches(slot_5,_e2.mask,at_11);return
_e17;}uvec2 place_6=(at_11 - _e2.first);uvec2 _e26=shift_right(_e2.mask,((6u*place_6.y)+ place_6.x));
return((_e26.x&1u)!=0u);}bool bound_has(uint half_,uvec2 at_12){bool local_22=false;uint
_e6=_group_1_binding_1_cs[(2u*half_)];uint _e13=_group_1_binding_1_cs[((2u*half_)+ 1u)];uvec2 range_3=uvec2(_e6,_e13);
if(all(greaterThanEqual(at_12,(range_3&uvec2(65535u))))){local_22=all(lessThan(at_12,(range_3>>uvec2(16u))));}else{
local_22=false;}bool _e28=local_22;return _e28;}uint gather_list(uint thread_20,uvec2 at_13,uint halves,uint list_1){
uint first_5=0u;uint i_18=0u;if((thread_20==0u)){found=0u;}for(;(first_5<halves);first_5=(first_5 + THREADS)){{
if((thread_20==0u)){near_count=0u;}memoryBarrierShared();barrier();uint _e16=first_5;if(((_e16 + thread_20)<halves)){
uint _e19=first_5;bool _e21=bound_has((_e19 + thread_20),at_13);if(_e21){uint _e25=atomicAdd(near_count,1u);uint
_e27=first_5;near[_e25]=(_e27 + thread_20);}}memoryBarrierShared();barrier();uint _e30=near_count;uint
_e31=of_first(thread_20,_e30);i_18=0u;for(;(i_18<_e31);i_18=(i_18 + 1u)){{uint _e37=i_18;uint _e39=near[_e37];uint
slot_6=((_e39*THREADS)+ thread_20);bool _e43=has_tile(slot_6,at_13);if(_e43){uint _e47=atomicAdd(found,1u);
_group_1_binding_1_cs[(list_1 + _e47)]=slot_6;}}}memoryBarrierShared();barrier();}}memoryBarrierBuffer();barrier();uint
_e57=found;uint _e58=of_first(thread_20,_e57);return _e58;}void sort_list(uint thread_21,uint list_2,uint count_4,uint
spare){uint source_1=0u;uint to_2=0u;uint block_1=0u;uint i_19=0u;uint block_2=0u;uint _e4=merges_of(count_4);
source_1=(((_e4%2u)==1u)?spare:list_2);uint _e12=source_1;to_2=((list_2 + spare)- _e12);for(;(block_1<count_4);
block_1=(block_1 + BLOCK)){{uint _e19=block_1;uint _e21=block_1;uint _e25=source_1;uint _e26=block_1;
sort_block(thread_21,(list_2 + _e19),min((count_4 - _e21),BLOCK),(_e25 + _e26));memoryBarrierShared();barrier();}}for(;
(i_19<_e4);i_19=(i_19 + 1u)){{memoryBarrierBuffer();barrier();memoryBarrierShared();barrier();block_2=0u;for(;
(block_2<count_4);block_2=(block_2 + BLOCK)){{uint _e39=source_1;uint _e40=to_2;uint _e41=block_2;uint _e43=i_19;
merge_block(thread_21,_e39,_e40,count_4,_e41,(9u + _e43));memoryBarrierShared();barrier();}}uint _e48=to_2;
source_1=_e48;uint _e50=source_1;to_2=((list_2 + spare)- _e50);}}memoryBarrierBuffer();barrier();memoryBarrierShared();
barrier();return;}Lists lists_of(uint group_5,uint thread_22){uint _e5=_group_1_binding_0_cs[0];uint
_e7=of_first(thread_22,(2u*_e5));uint _e10=_group_1_binding_0_cs[9];uint _e13=_group_1_binding_0_cs[1];uint
_e16=_group_1_binding_0_cs[4];uint _e17=list_room(_e10,_e13,_e16);uint _e18=of_first(thread_22,_e17);uint
_e19=bound_words();return Lists(_e7,(_e19 +((2u*_e18)*group_5)),_e18);}uint list_tile(uint thread_23,uint tile_5,Lists
lists){int _e6=_group_0_binding_0_cs.tiles.x;uint across_2=uint(_e6);uint _e13=gather_list(thread_23,
uvec2((tile_5%across_2),(tile_5/across_2)),lists.halves,lists.list);sort_list(thread_23,lists.list,_e13,(lists.list +
lists.room));return _e13;}Patch whole_patch(uint thread_24,uint tile_6,uint number_5,uint list_3,uint count_5){Patch
_e8=patch_at(thread_24,tile_6,number_5,uvec2(0u,7u),list_3,count_5);return _e8;}uint patches(){uint
_e4=_group_0_binding_0_cs.tile_bits;return(1u<<(2u*(_e4 - 3u)));}uint tiles_before(uint step_2){int
_e4=_group_0_binding_0_cs.tiles.x;int _e8=_group_0_binding_0_cs.tiles.y;uint _e13=_group_0_binding_0_cs.finishes;int
_e19=_group_0_binding_0_cs.tiles.x;int _e23=_group_0_binding_0_cs.tiles.y;uint _e28=_group_0_binding_0_cs.finishes;uint
_e33=_group_0_binding_0_cs.finishes;return(((uint((_e4*_e8))/_e13)*step_2)+(((uint((_e19*_e23))%_e28)*step_2)/_e33));}
Turn turn_of(uvec3 group_6,uvec3 groups_2,uint thread_25){if(((group_6.z + 1u)!=groups_2.z)){return Turn(Lists(0u,0u,
0u),0u,0u);}Lists _e16=lists_of(group_6.x,thread_25);uint _e18=tiles_before(group_6.z);uint
_e22=tiles_before(groups_2.z);return Turn(_e16,(_e18 + group_6.x),_e22);}void main(){uvec3 group_2=gl_WorkGroupID;uvec3
groups_1=gl_NumWorkGroups;uint thread_2=gl_LocalInvocationIndex;uint tile_1=0u;uint i_1=0u;Turn _e3=turn_of(group_2,
groups_1,thread_2);tile_1=_e3.first;for(;(tile_1<_e3.end);tile_1=(tile_1 + groups_1.x)){{uint _e9=tile_1;uint
_e11=list_tile(thread_2,_e9,_e3.lists);i_1=0u;for(;(i_1<patches());i_1=(i_1 + 1u)){{uint _e17=tile_1;uint _e18=i_1;
Patch _e21=whole_patch(thread_2,_e17,_e18,_e3.lists.list,_e11);trace_patch(_e21,thread_2);memoryBarrierShared();
barrier();}}}}return;}
