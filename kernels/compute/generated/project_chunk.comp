#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Object{uvec4 position_q32_[3];uvec4 eye_q32_[3];
ivec4 rotation_q30_[3];ivec4 row_q15_[2];ivec4 forward_q15_[2];ivec4 tint_q13_;uvec2 near_q32_;uvec2 dilation_q30_;
ivec2 f_q12_;ivec2 c_q12_;ivec2 slope_low_q23_;ivec2 slope_high_q23_;ivec2 edge_low_q23_;ivec2 edge_high_q23_;uint
focal_q32_;int focal_exponent;int veil_exponent;int jacobian_exponent;int offset_q11_;int degree;int antialiased;int
orthographic;int plane_exponent;uint profile;int scene_degree;uint chunk_words;uint palette_entries;int
palette_step_q19_;uint scale_mantissa;int scale_exponent;int plain;uint crop_count;uint keep_count;uint first_chunk;
uint first_place;uint end_place;uint span;uint part_chunk;uint rows_at;uint part_chunks;uint motion_at;uint
motion_degree;uint motion_cut_q16_;uint motion_flags;uvec4 crops[32];};struct Splat{uint u0_q24_;uint v0_q24_;int
ux_q24_;int uy_q24_;int vy_q24_;int offset_q11_;ivec2 rows;};struct Bounds{ivec2 c_q14_;uint breadth_q8_;int shear_q8_;
int half_width_q8_;uint square_radius;};struct Span{int first;int last;};struct Projected{ivec3 camera;int zeros;uint
inverse_q30_;ivec2 slope_q23_;ivec2 position_q14_;bool out_of_range;};struct Covariance{uint a_q30_;uint c_q30_;int
b_q30_;uvec2 det_q60_;uvec2 det_undilated_q60_;int exponent;};struct Root{uint m;uint inverse_q30_;int half_;};struct
Placed{Splat splat;Bounds bounds;};struct Axis{int slope_q23_;int position_q14_;bool out_of_range;};struct Axes{ivec3
axis_q15_;ivec3 side_x_q15_;ivec3 side_y_q15_;int cos_q15_;int sin_q15_;};struct Codes{uvec3 position;uint rotation;
uint scale;uint colour;};struct Basis{ivec4 a;ivec4 b;ivec4 c;ivec4 d;};struct Half{uint first_slot;uint place;uint
index;bool inside;};const int FXS_CUT_Q11_=18432;const int FXS_FAINT_Q11_=22697;const uint CHUNK=256u;const uint
THREADS=128u;const uint ROW_OF_GROUPS=32768u;const uint RECORD=64u;const uint LARGE=8u;const int LARGE_ROWS=8;const
uint SPAN=8u;const uint DRAWN=3u;const int BOX_COLUMNS=6;const int BOX_ROWS=7;const uint TILES=64u;const uint LIST=8u;
const int EVERYWHERE_Q8_=1073741824;const int SIDE_Q23_=536870912;const uint SMALL=2u;const uint COMPACT=1u;
layout(std140,binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std140,binding=1)uniform
Object_block_1Compute{Object _group_0_binding_1_cs;};shared uint record[64];layout(std430,binding=0)readonly buffer
type_21_block_2Compute{uint _group_1_binding_0_cs[];};layout(std430,binding=1)buffer type_21_block_3Compute{uint
_group_1_binding_1_cs[];};layout(std430,binding=2)buffer type_25_block_4Compute{uint _group_1_binding_2_cs[];};
layout(std430,binding=3)buffer type_26_block_5Compute{uvec4 _group_1_binding_3_cs[];};shared uint visible_here;int
fxs_mul_q15_(int a,int b){return(((a*b)+ 16384)>>15u);}int fxs_min(int a_1,int b_1){return((a_1<b_1)?a_1:b_1);}int
fxs_limit_q11_(int offset_q11_1,int cut_q11_){int _e4=fxs_min((offset_q11_1 + cut_q11_),FXS_FAINT_Q11_);return _e4;}
uvec2 wide_of(int x){return uvec2(uint(x),uint((x>>31u)));}uvec2 add_wide(uvec2 a_3,uvec2 b_3){uint low_2=(a_3.x +
b_3.x);return uvec2(low_2,((a_3.y + b_3.y)+((low_2<a_3.x)?1u:0u)));}uvec2 sub_wide(uvec2 a_4,uvec2 b_4){return
uvec2((a_4.x - b_4.x),((a_4.y - b_4.y)-((a_4.x<b_4.x)?1u:0u)));}bool is_negative(uvec2 a_5){return(int(a_5.y)<0);}uvec2
negate(uvec2 a_6){uvec2 _e5=add_wide(~(a_6),uvec2(1u,0u));return _e5;}uvec2 magnitude(uvec2 a_7){bool
_e1=is_negative(a_7);if(_e1){uvec2 _e2=negate(a_7);return _e2;}return a_7;}bool less(uvec2 a_8,uvec2 b_5){
return((a_8.y==b_5.y)?(a_8.x<b_5.x):(int(a_8.y)<int(b_5.y)));}uvec2 mul_wide(uint a_9,uint b_6){uint high;uint low;
umulExtended(a_9,b_6,high,low);return uvec2(low,high);}uint mul_high(uint a_10,uint b_7){uvec2 _e2=mul_wide(a_10,b_7);
return _e2.y;}uvec2 mul_mixed(int a_11,uint b_8){uvec2 _e3=mul_wide(uint(a_11),b_8);return uvec2(_e3.x,(_e3.y
-((a_11<0)?b_8:0u)));}uvec2 mul_signed(int a_12,int b_9){uvec2 _e3=mul_mixed(a_12,uint(b_9));return uvec2(_e3.x,(_e3.y
-((b_9<0)?uint(a_12):0u)));}uvec2 mul_word(uvec2 a_13,uint b_10){uvec2 _e3=mul_wide(a_13.x,b_10);return uvec2(_e3.x,
(_e3.y +(a_13.y*b_10)));}uvec2 shift_left(uvec2 a_14,uint n){if((n==0u)){return a_14;}if((n>=32u)){return uvec2(0u,
(a_14.x<<(n - 32u)));}return uvec2((a_14.x<<n),((a_14.y<<n)|(a_14.x>>(32u - n))));}uvec2 shift_right(uvec2 a_15,uint
n_1){if((n_1==0u)){return a_15;}if((n_1>=32u)){return uvec2((a_15.y>>(n_1 - 32u)),0u);}return
uvec2(((a_15.x>>n_1)|(a_15.y<<(32u - n_1))),(a_15.y>>n_1));}uvec2 shift_signed(uvec2 a_16,uint n_2){int
high_3=int(a_16.y);if((n_2==0u)){return a_16;}if((n_2>=32u)){return uvec2(uint((high_3>>(n_2 - 32u))),
uint((high_3>>31u)));}return uvec2(((a_16.x>>n_2)|(a_16.y<<(32u - n_2))),uint((high_3>>n_2)));}uvec2 shift_up(uvec2
a_17,uint n_3){uvec2 _e7=shift_right(uvec2(4294967295u,4294967295u),(64u - n_3));uvec2 _e8=add_wide(a_17,_e7);uvec2
_e9=shift_signed(_e8,n_3);return _e9;}uvec2 round_shift(uvec2 x_1,int n_4){uvec2 _e5=shift_signed(x_1,uint((n_4 - 1)));
uvec2 _e9=add_wide(_e5,uvec2(1u,0u));uvec2 _e11=shift_signed(_e9,1u);return _e11;}int low_of(uvec2 a_18){return
int(a_18.x);}int zeros_of(uint x_2){return int(uint(31 - findMSB(x_2)));}int zeros_of_wide(uvec2 x_3){int
_e2=zeros_of(x_3.x);int _e6=zeros_of(x_3.y);return((x_3.y!=0u)?_e6:(32 + _e2));}int divide_by(int x_4,uint n_5){
return((x_4<0)?-((-(x_4)>>n_5)):(x_4>>n_5));}uint reciprocal(uint m){uint y_q30_=0u;uint _e3=mul_high(m,2021161081u);
y_q30_=(3031741620u - _e3);uint _e7=y_q30_;uint _e11=y_q30_;uint _e12=mul_high(m,_e11);uint _e15=mul_high((2u*_e7),
(2u*(2147483648u - _e12)));y_q30_=_e15;uint _e17=y_q30_;uint _e21=y_q30_;uint _e22=mul_high(m,_e21);uint
_e25=mul_high((2u*_e17),(2u*(2147483648u - _e22)));y_q30_=_e25;uint _e27=y_q30_;uint _e31=y_q30_;uint _e32=mul_high(m,
_e31);uint _e35=mul_high((2u*_e27),(2u*(2147483648u - _e32)));return _e35;}uint rsqrt_step(uint m_1,uint y_q30_1){uint
_e8=mul_high((2u*y_q30_1),y_q30_1);uint _e9=mul_high(m_1,_e8);uint _e12=mul_high((2u*y_q30_1),(2u*(1610612736u - _e9)));
return _e12;}uint rsqrt(uint m_2){uint _e3=mul_high(m_2,1431655765u);uint _e5=rsqrt_step(m_2,(2369829601u - _e3));uint
_e6=rsqrt_step(m_2,_e5);uint _e7=rsqrt_step(m_2,_e6);return _e7;}uint sqrt_of(uint x_5){if((x_5==0u)){return 0u;}int
_e4=zeros_of(x_5);uint shift_3=(uint(_e4)&4294967294u);uint m_3=(x_5<<shift_3);uint _e9=rsqrt(m_3);uint
_e10=mul_high(m_3,_e9);return(_e10>>(14u +(shift_3/2u)));}int exp2_q15_(int f_q15_){int p_1=0;p_1=(((256*f_q15_)+
16384)>>15u);int _e8=p_1;p_1=((((_e8 - 1820)*f_q15_)+ 16384)>>15u);int _e16=p_1;p_1=((((_e16 + 7904)*f_q15_)+
16384)>>15u);int _e24=p_1;p_1=((((_e24 - 22724)*f_q15_)+ 16384)>>15u);int _e32=p_1;return(32768 + _e32);}int
log2_q16_(uvec2 x_6){int q=0;int _e1=zeros_of_wide(x_6);uvec2 _e3=shift_left(x_6,uint(_e1));uvec2 _e5=shift_left(_e3,
1u);int t_q15_=int((_e5.y>>17u));q=(((-2776*t_q15_)+ 16384)>>15u);int _e17=q;q=((((_e17 + 6897)*t_q15_)+ 16384)>>15u);
int _e25=q;q=((((_e25 - 9697)*t_q15_)+ 16384)>>15u);int _e33=q;q=((((_e33 + 14605)*(32768 - t_q15_))+ 16384)>>15u);int
_e47=q;return(((63 - _e1)*65536)+(2*((((32768 + _e47)*(t_q15_>>1u))+ 8192)>>14u)));}uint list_of(uint tile){
return(TILES +(LIST*tile));}uint half_of(uint word,uint i){return((word>>(16u*(i%2u)))&65535u);}uvec2 crop_bound(uint
crop,uint i_1,bool high){uint word_5=((2u*i_1)+(high?6u:0u));uvec4
four=_group_0_binding_1_cs.crops[((4u*crop)+(word_5/4u))];return(((word_5%4u)==2u)?four.zw:four.xy);}bool lies_in(inout
uvec2 low[3],inout uvec2 high_1[3],uint crop_1,bool any_){bool inside=true;uint i_2=0u;bool local=false;bool
local_1=false;for(;(i_2<3u);i_2=(i_2 + 1u)){{uint _e11=i_2;uvec2 _e13=low[_e11];uint _e14=i_2;uvec2 _e16=high_1[_e14];
uvec2 first=(any_?_e16:_e13);uint _e18=i_2;uvec2 _e20=high_1[_e18];uint _e21=i_2;uvec2 _e23=low[_e21];uvec2
last=(any_?_e23:_e20);bool _e25=inside;if(_e25){uint _e28=i_2;uvec2 _e30=crop_bound(crop_1,_e28,false);bool
_e31=less(first,_e30);local=!(_e31);}else{local=false;}bool _e34=local;if(_e34){uint _e37=i_2;uvec2
_e39=crop_bound(crop_1,_e37,true);bool _e40=less(_e39,last);local_1=!(_e40);}else{local_1=false;}bool _e43=local_1;
inside=_e43;}}bool _e47=inside;return _e47;}bool is_within_crops(inout uvec2 low_1[3],inout uvec2 high_2[3]){bool
kept=false;uint crop_2=0u;bool local_2=false;bool local_3=false;bool local_4=false;uint
_e4=_group_0_binding_1_cs.keep_count;kept=(_e4==0u);for(;(crop_2<_group_0_binding_1_cs.crop_count);crop_2=(crop_2 +
1u)){{uint _e18=crop_2;uint _e24=_group_0_binding_1_cs.crops[((4u*_e18)+ 3u)].x;bool outside=(_e24!=0u);if(outside){
uint _e29=crop_2;bool _e31=lies_in(low_1,high_2,_e29,false);local_2=_e31;}else{local_2=false;}bool _e33=local_2;
if(_e33){return false;}bool _e35=kept;if(!(_e35)){if(!(outside)){uint _e42=crop_2;bool _e44=lies_in(low_1,high_2,_e42,
true);local_4=_e44;}else{local_4=false;}bool _e46=local_4;local_3=_e46;}else{local_3=true;}bool _e48=local_3;kept=_e48;}
}bool _e52=kept;return _e52;}ivec2 whole_tiles(){ivec2 _e2=_group_0_binding_0_cs.whole;return((_e2 +
ivec2(15))>>uvec2(4u));}int number_at(uint at){uint _e3=record[at];return int(_e3);}uvec2 wide_at(uint at_1){uint
_e3=record[at_1];uint _e8=record[(at_1 + 1u)];return uvec2(_e3,_e8);}int camera_of(uint i_3,uvec3 code){uvec2
_e4=wide_at((2u*i_3));uint _e11=record[(6u +(3u*i_3))];uint _e18=record[(7u +(3u*i_3))];uint _e25=record[(8u
+(3u*i_3))];uvec3 m_q16_=uvec3(_e11,_e18,_e25);uvec3 below=((m_q16_&uvec3(65535u))*code);ivec3
above=((ivec3(m_q16_)>>uvec3(16u))*ivec3(code));uvec3 rest_1=(below&uvec3(65535u));uint low_4=((((_e4.x&65535u)+
rest_1.x)+ rest_1.y)+ rest_1.z);uint carried=((((below.x>>16u)+(below.y>>16u))+(below.z>>16u))+(low_4>>16u));
return((((int(((_e4.y<<16u)|(_e4.x>>16u)))+ above.x)+ above.y)+ above.z)+ int(carried));}Axis project_axis(int x_7,int
side,int zeros,uint inverse_q30_,int f_q12_,int c_q12_){bool local_5=false;int slope=0;bool local_6=false;
if(!((x_7>=side))){local_5=(-(x_7)>=side);}else{local_5=true;}bool off_axis=local_5;uvec2 _e14=mul_mixed(x_7,
inverse_q30_);uvec2 _e17=round_shift(_e14,(39 - zeros));int _e18=low_of(_e17);slope=_e18;if(off_axis){
slope=((x_7<0)?-536870912:SIDE_Q23_);}uvec2 _e25=wide_of(c_q12_);uvec2 _e27=shift_left(_e25,2u);uvec2
_e31=sub_wide(_e27,uvec2(8192u,0u));int _e32=slope;uvec2 _e33=mul_signed(f_q12_,_e32);uvec2 _e35=round_shift(_e33,21);
uvec2 _e36=add_wide(_e35,_e31);int _e37=slope;int _e38=low_of(_e36);if(!(off_axis)){uvec2 _e42=magnitude(_e36);bool
_e46=less(_e42,uvec2(1073741824u,0u));local_6=!(_e46);}else{local_6=true;}bool _e49=local_6;return Axis(_e37,_e38,_e49);
}bool project_centre(inout Projected centre,uvec3 code_1){uint inverse_q30_1=1073741824u;int side_1=0;bool
local_7=false;int _e3=camera_of(2u,code_1);int _e5=number_at(21u);if((_e3<=_e5)){return false;}int
_e10=_group_0_binding_1_cs.orthographic;bool parallel=(_e10!=0);int _e14=zeros_of(uint(_e3));int _e16=number_at(19u);
int zeros_2=(parallel?_e16:_e14);int _e21=number_at(20u);side_1=_e21;if(!(parallel)){uint
_e27=reciprocal((uint(_e3)<<uint(zeros_2)));inverse_q30_1=_e27;side_1=(64*min(_e3,33554431));}int _e34=camera_of(0u,
code_1);int _e36=camera_of(1u,code_1);centre.camera=ivec3(_e34,_e36,_e3);centre.zeros=zeros_2;uint _e40=inverse_q30_1;
centre.inverse_q30_=_e40;int _e43=centre.camera.x;int _e44=side_1;uint _e45=inverse_q30_1;int
_e49=_group_0_binding_1_cs.f_q12_.x;int _e53=_group_0_binding_1_cs.c_q12_.x;Axis _e54=project_axis(_e43,_e44,zeros_2,
_e45,_e49,_e53);int _e57=centre.camera.y;int _e58=side_1;uint _e59=inverse_q30_1;int
_e63=_group_0_binding_1_cs.f_q12_.y;int _e67=_group_0_binding_1_cs.c_q12_.y;Axis _e68=project_axis(_e57,_e58,zeros_2,
_e59,_e63,_e67);centre.slope_q23_=ivec2(_e54.slope_q23_,_e68.slope_q23_);centre.position_q14_=ivec2(_e54.position_q14_,
_e68.position_q14_);if(!(_e54.out_of_range)){local_7=_e68.out_of_range;}else{local_7=true;}bool _e84=local_7;
centre.out_of_range=_e84;return true;}ivec3 jacobian_row(uint i_4,int slope_q23_){int
_e5=_group_0_binding_1_cs.slope_low_q23_[i_4];int _e9=_group_0_binding_1_cs.slope_high_q23_[i_4];int
slope_1=min(max(slope_q23_,_e5),_e9);int _e13=_group_0_binding_1_cs.jacobian_exponent;int
slope_q15_=(((slope_1>>uint((7 + _e13)))+ 1)>>1u);ivec4 _e25=_group_0_binding_1_cs.forward_q15_[i_4];ivec3
forward=_e25.xyz;ivec4 _e30=_group_0_binding_1_cs.row_q15_[i_4];return(_e30.xyz -(((slope_q15_*forward)+
ivec3(16384))>>uvec3(15u)));}uint axis_bits(ivec3 falls_q16_){uint _e3=_group_0_binding_1_cs.profile;bool
small=(_e3==SMALL);int gap=(min(abs((falls_q16_.y - falls_q16_.x)),abs((falls_q16_.z - falls_q16_.x)))>>4u);return
uint(min(((small?8:11)+((5*gap)>>16u)),(small?10:14)));}ivec3 falls_of(uint scale_word,uint step_q24_){uvec3
code_7=((uvec3(scale_word)>>uvec3(0u,10u,19u))&uvec3(1023u,1023u,1022u));return ivec3(((((code_7*code_7)*step_q24_)+
uvec3(128u))>>uvec3(8u)));}bool axes_of(inout Axes axes,int x_8,int y){uint square_q30_=(uint((x_8*x_8))+ uint((y*y)));
if((square_q30_>1073741824u)){return false;}uint m_4=(2147483648u - square_q30_);uint _e13=rsqrt(m_4);uint
_e14=mul_high(m_4,_e13);int s_q15_=int(((_e14 + 8192u)>>14u));int xx_q15_=(((x_8*x_8)+ 16384)>>15u);int
yy_q15_=(((y*y)+ 16384)>>15u);int xy_q15_1=(((x_8*y)+ 16384)>>15u);int xs_q15_=(((x_8*s_q15_)+ 16384)>>15u);int
ys_q15_=(((y*s_q15_)+ 16384)>>15u);axes.axis_q15_=ivec3(xs_q15_,ys_q15_,(int(((m_4 + 16384u)>>15u))- 32768));
axes.side_x_q15_=ivec3((32768 - xx_q15_),-(xy_q15_1),-(xs_q15_));axes.side_y_q15_=ivec3(-(xy_q15_1),(32768 - yy_q15_),
-(ys_q15_));return true;}bool read_axes(inout Axes axes_1,uint word_1,uint bits){bool _e10=axes_of(axes_1,
(int(word_1)>>16u),(int((word_1<<bits))>>16u));if(!(_e10)){return false;}int u=(int((word_1<<(2u*bits)))>>16u);int
uu_q15_=(((u*u)+ 16384)>>15u);int _e26=fxs_mul_q15_(uu_q15_,7373);int _e29=fxs_mul_q15_(uu_q15_,(40141 - _e26));
axes_1.cos_q15_=(32768 - _e29);int _e34=fxs_mul_q15_(uu_q15_,2066);int _e37=fxs_mul_q15_(uu_q15_,(20619 - _e34));int
_e40=fxs_mul_q15_(u,(51317 - _e37));axes_1.sin_q15_=_e40;return true;}uint screen_size(inout Projected centre_1,int
size_q16_,inout int exponent){int whole=-((-(size_q16_)>>16u));int _e12=exp2_q15_(((-(size_q16_)&65535)>>1u));uint
size_q15_=uint(_e12);uint _e15=centre_1.inverse_q30_;uvec2 _e16=mul_wide(size_q15_,_e15);uvec2 _e18=shift_right(_e16,
15u);uint over_z_q30_=_e18.x;uint _e22=_group_0_binding_1_cs.focal_q32_;uint _e23=mul_high(over_z_q30_,_e22);int
_e24=zeros_of(_e23);int _e26=number_at(18u);int _e29=centre_1.zeros;int _e33=_group_0_binding_1_cs.focal_exponent;int
_e37=_group_0_binding_1_cs.jacobian_exponent;exponent=((((((whole - _e26)+ _e29)+ _e33)+ _e37)+ 2)- _e24);
return(_e23<<uint(_e24));}bool off_picture(inout Projected centre_2,int exponent_1){bool local_8=false;uint
radius_q14_=(57344u*((1u<<uint(max(exponent_1,0)))+ 1u));ivec2 position_4=centre_2.position_q14_;ivec2
_e13=whole_tiles();uvec2 end=(uvec2(_e13)<<uvec2(18u));if(!(any(greaterThan(uvec2(max(-(position_4),ivec2(0))),
uvec2(radius_q14_))))){local_8=any(greaterThan(uvec2(max(position_4,ivec2(0))),(end + uvec2(radius_q14_))));}else{
local_8=true;}bool _e38=local_8;return _e38;}int dot_i(ivec3 a_19,ivec3 b_11){
return(((a_19.x*b_11.x)+(a_19.y*b_11.y))+(a_19.z*b_11.z));}uvec2 square_wide(int x_9){uint size=uint(abs(x_9));uvec2
_e3=mul_wide(size,size);return _e3;}Covariance covariance_of(ivec3 p_2,ivec3 q_1,int exponent_2,uint
least_dilation_q30_){Covariance out_=Covariance(0u,0u,0,uvec2(0u),uvec2(0u),0);uint dilation=0u;int _e5=dot_i(p_2,p_2);
uint a_26=uint(_e5);int _e7=dot_i(q_1,q_1);uint c_4=uint(_e7);uvec2 _e16=square_wide(((p_2.y*q_1.z)-(p_2.z*q_1.y)));
uvec2 _e24=square_wide(((p_2.z*q_1.x)-(p_2.x*q_1.z)));uvec2 _e25=add_wide(_e16,_e24);uvec2
_e33=square_wide(((p_2.x*q_1.y)-(p_2.y*q_1.x)));uvec2 _e34=add_wide(_e25,_e33);dilation=least_dilation_q30_;
if((exponent_2<15)){uint _e38=dilation;dilation=max(_e38,(322122547u>>uint((2*exponent_2))));}uvec2
_e49=add_wide(uvec2(a_26,0u),uvec2(c_4,0u));uint _e50=dilation;uvec2 _e53=add_wide(_e49,uvec2(_e50,0u));int
_e55=dot_i(p_2,q_1);out_.b_q30_=_e55;out_.det_undilated_q60_=_e34;uint _e58=dilation;uvec2 _e59=mul_word(_e53,_e58);
uvec2 _e60=add_wide(_e34,_e59);out_.det_q60_=_e60;uint _e62=dilation;out_.a_q30_=(a_26 + _e62);uint _e65=dilation;
out_.c_q30_=(c_4 + _e65);out_.exponent=exponent_2;Covariance _e68=out_;return _e68;}Root root_of_q60_(uvec2 x_10){int
_e1=zeros_of_wide(x_10);int zeros_3=(_e1&-2);uvec2 _e5=shift_left(x_10,uint(zeros_3));uint m_5=_e5.y;uint
_e7=rsqrt(m_5);return Root(m_5,_e7,(2 -(zeros_3/2)));}Root root_of_q30_(uint x_11){int _e1=zeros_of(x_11);int
zeros_4=(_e1&-2);uint m_6=(x_11<<uint(zeros_4));uint _e6=rsqrt(m_6);return Root(m_6,_e6,(1 -(zeros_4/2)));}uint
scale_down(uint x_12,int shift){if((shift>32)){return 0u;}return(((x_12>>uint((shift - 1)))+ 1u)>>1u);}uint
sqrt_q8_(Root r,int exponent_3){uint _e4=mul_high(r.m,r.inverse_q30_);uint _e9=scale_down(_e4,((22 - r.half_)-
exponent_3));return _e9;}uint product_shifted(uint a_20,uint b_12,uint n_6){uvec2 _e3=mul_wide(a_20,b_12);uvec2
_e4=shift_right(_e3,n_6);return _e4.x;}void whiten(inout Placed out_1,inout Covariance s,Root c_2,inout Projected
centre_3,uint r_q12_){int e_1=s.exponent;int b_q30_=s.b_q30_;uvec2 _e10=s.det_q60_;Root _e11=root_of_q60_(_e10);uint
_e13=s.a_q30_;Root _e14=root_of_q30_(_e13);uint _e17=mul_high(c_2.m,c_2.inverse_q30_);uint _e20=mul_high(_e11.m,
_e11.inverse_q30_);uint _e24=product_shifted(c_2.inverse_q30_,_e11.inverse_q30_,31u);uint
_e30=scale_down(c_2.inverse_q30_,((6 + c_2.half_)+ e_1));int vy=int(_e30);uint _e34=product_shifted(_e17,
_e11.inverse_q30_,30u);uint _e41=scale_down(_e34,(((6 - c_2.half_)+ _e11.half_)+ e_1));int ux=int(_e41);uvec2
_e43=mul_mixed(b_q30_,_e24);uvec2 _e50=round_shift(_e43,(((35 + c_2.half_)+ _e11.half_)+ e_1));int _e51=low_of(_e50);
int uy=-(_e51);uint _e53=sqrt_q8_(_e14,e_1);uint _e55=product_shifted(_e53,r_q12_,12u);ivec2
position_5=centre_3.position_q14_;uint _e61=product_shifted(_e20,c_2.inverse_q30_,30u);uint _e68=scale_down(_e61,(((22
- _e11.half_)+ c_2.half_)- e_1));uvec2 _e70=mul_mixed(b_q30_,c_2.inverse_q30_);uvec2 _e75=round_shift(_e70,((52 +
c_2.half_)- e_1));int _e76=low_of(_e75);out_1.bounds=Bounds(position_5,_e68,_e76,int(((_e55 +(_e55>>8u))+ 32u)),0u);
uvec2 _e86=mul_signed(position_5.x,ux);uvec2 _e88=mul_signed(position_5.y,uy);uvec2 _e89=add_wide(_e86,_e88);uvec2
_e91=mul_signed(position_5.y,vy);uvec2 _e96=shift_up(_e89,14u);out_1.splat.u0_q24_=(1024u - _e96.x);uvec2
_e103=shift_up(_e91,14u);out_1.splat.v0_q24_=(1024u - _e103.x);out_1.splat.ux_q24_=ux;out_1.splat.uy_q24_=uy;
out_1.splat.vy_q24_=vy;return;}bool clip(inout Placed out_2,uint sigma_q8_,uint r_q12_1){int half_height=0;bool
local_9=false;bool local_10=false;bool local_11=false;bool local_12=false;uint _e4=product_shifted(sigma_q8_,r_q12_1,
12u);half_height=int(_e4);int _e7=half_height;int _e8=half_height;half_height=(_e7 +((_e8>>8u)+ 32));int
half_width=out_2.bounds.half_width_q8_;ivec2 _e19=out_2.bounds.c_q14_;ivec2 c_q8_=(_e19>>uvec2(6u));int
_e24=half_height;int first_1=(((c_q8_.y - _e24)+ 255)>>8u);int _e31=half_height;int last_1=((c_q8_.y + _e31)>>8u);ivec2
size_1=_group_0_binding_0_cs.whole;if(!(((c_q8_.x + half_width)<0))){local_9=((c_q8_.x - half_width)>((size_1.x -
1)<<8u));}else{local_9=true;}bool _e54=local_9;if(!(_e54)){local_10=(last_1<0);}else{local_10=true;}bool _e61=local_10;
if(!(_e61)){local_11=(first_1>=size_1.y);}else{local_11=true;}bool _e68=local_11;if(!(_e68)){local_12=(first_1>last_1);}
else{local_12=true;}bool _e74=local_12;if(_e74){return false;}out_2.splat.rows=ivec2(max(first_1,0),min(last_1,
(size_1.y - 1)));return true;}bool square(inout Placed out_3,inout Covariance s_1){uvec2 least_q60_=uvec2(1u,0u);uvec2
more=uvec2(0u);bool local_13=false;int e_2=s_1.exponent;uint _e5=s_1.a_q30_;uint _e9=s_1.c_q30_;uvec2
_e12=add_wide(uvec2(_e5,0u),uvec2(_e9,0u));uvec2 _e14=shift_right(_e12,1u);uint mid_q30_=_e14.x;if((e_2<15)){uvec2
_e28=shift_right(uvec2(2576980377u,26843545u),uint((4*e_2)));least_q60_=_e28;}uvec2 _e29=mul_wide(mid_q30_,mid_q30_);
uvec2 _e31=s_1.det_q60_;uvec2 _e32=sub_wide(_e29,_e31);more=_e32;uvec2 _e34=least_q60_;bool _e35=less(_e32,_e34);
if(_e35){uvec2 _e36=least_q60_;more=_e36;}uvec2 _e37=more;Root _e38=root_of_q60_(_e37);uint _e41=mul_high(_e38.m,
_e38.inverse_q30_);uvec2 _e45=shift_left(uvec2(_e41,0u),1u);uvec2 _e52=shift_right(_e45,uint((1 - _e38.half_)));uvec2
_e53=add_wide(uvec2(mid_q30_,0u),_e52);uvec2 _e55=shift_left(_e53,30u);Root _e56=root_of_q60_(_e55);uint
_e57=sqrt_q8_(_e56,e_2);int radius_1=int((((3u*_e57)+ 255u)>>8u));out_3.bounds.square_radius=uint(radius_1);int
_e73=_group_0_binding_0_cs.whole.y;out_3.splat.rows=ivec2(0,(_e73 - 1));ivec2 _e80=out_3.bounds.c_q14_;ivec2
pixel=(_e80>>uvec2(14u));if(all(greaterThanEqual(((pixel + ivec2(radius_1))+ ivec2(15)),ivec2(16)))){ivec2
_e95=whole_tiles();local_13=all(lessThan(pixel,(ivec2(radius_1)+(16*_e95))));}else{local_13=false;}bool _e103=local_13;
return _e103;}uint veil_dilation_q30_(int exponent_4){if((exponent_4>31)){return 64u;}uvec2
_e6=_group_0_binding_1_cs.dilation_q30_;uvec2 _e10=shift_right(_e6,uint((2*exponent_4)));uvec2 _e14=add_wide(_e10,
uvec2(1u,0u));return((_e14.y!=0u)?4294967295u:max(_e14.x,64u));}int cut_to_16_q26_(uvec2 x_13){uvec2
most=uvec2(1073741824u,0u);uvec2 _e4=magnitude(x_13);bool _e5=less(most,_e4);if(_e5){bool _e6=is_negative(x_13);
return(_e6?-1073741824:1073741824);}int _e10=low_of(x_13);return _e10;}int shift_and_cut(uvec2 x_14,int shift_1){
if((shift_1<0)){int _e4=cut_to_16_q26_(x_14);uvec2 _e5=wide_of(_e4);uvec2 _e8=shift_left(_e5,uint(-(shift_1)));int
_e9=cut_to_16_q26_(_e8);return _e9;}uvec2 _e13=shift_signed(x_14,uint(min(shift_1,62)));int _e14=cut_to_16_q26_(_e13);
return _e14;}int from_middle_q26_(inout Projected centre_4,uint i_5,int exponent_5){int _e5=centre_4.camera[i_5];uint
_e7=centre_4.inverse_q30_;uvec2 _e8=mul_mixed(_e5,_e7);uvec2 _e10=shift_signed(_e8,34u);int _e11=low_of(_e10);int
_e15=_group_0_binding_1_cs.c_q12_[i_5];uvec2 _e16=wide_of(_e15);ivec2 _e17=whole_tiles();uvec2
_e23=wide_of(((_e17[i_5]<<15u)+ 2048));uvec2 _e24=sub_wide(_e16,_e23);int _e28=_group_0_binding_1_cs.f_q12_[i_5];uvec2
_e29=mul_signed(_e28,_e11);int _e33=centre_4.zeros;int _e35=shift_and_cut(_e29,((14 + exponent_5)- _e33));uvec2
_e36=wide_of(_e35);uvec2 _e38=shift_left(_e24,14u);int _e39=shift_and_cut(_e38,exponent_5);uvec2 _e40=wide_of(_e39);
uvec2 _e41=add_wide(_e36,_e40);int _e42=cut_to_16_q26_(_e41);return _e42;}bool veil(inout Placed out_4,inout Covariance
s_2,inout Projected centre_5,uint r_q12_2){bool local_14=false;int e_3=s_2.exponent;int shift_4=(min(e_3,60)- 6);ivec2
_e10=whole_tiles();ivec2 middle_1=(_e10*8);uint _e14=s_2.c_q30_;Root _e15=root_of_q30_(_e14);uvec2 _e17=s_2.det_q60_;
Root _e18=root_of_q60_(_e17);uint _e22=product_shifted(_e15.inverse_q30_,_e18.inverse_q30_,31u);uint
_e25=mul_high(_e15.m,_e15.inverse_q30_);uvec2 _e27=mul_wide(_e25,_e18.inverse_q30_);uvec2 _e29=shift_right(_e27,30u);
uvec2 _e31=shift_left(_e29,2u);uvec2 _e37=round_shift(_e31,((14 - _e15.half_)+ _e18.half_));int _e38=low_of(_e37);int
_e40=s_2.b_q30_;uvec2 _e41=mul_mixed(_e40,_e22);uvec2 _e47=round_shift(_e41,((41 + _e15.half_)+ _e18.half_));int
_e48=low_of(_e47);int uy_q18_=-(_e48);uvec2 _e56=round_shift(uvec2(_e15.inverse_q30_,0u),(12 + _e15.half_));int
_e57=low_of(_e56);int _e59=from_middle_q26_(centre_5,0u,e_3);int _e61=from_middle_q26_(centre_5,1u,e_3);uvec2
_e62=mul_signed(_e59,_e38);uvec2 _e63=mul_signed(_e61,uy_q18_);uvec2 _e64=add_wide(_e62,_e63);uvec2 _e66=shift_up(_e64,
20u);uvec2 _e67=mul_signed(_e61,_e57);uvec2 _e69=shift_up(_e67,20u);uvec2 _e70=wide_of(_e38);uvec2
_e71=round_shift(_e70,shift_4);int _e72=low_of(_e71);uvec2 _e73=wide_of(uy_q18_);uvec2 _e74=round_shift(_e73,shift_4);
int _e75=low_of(_e74);uvec2 _e76=wide_of(_e57);uvec2 _e77=round_shift(_e76,shift_4);int _e78=low_of(_e77);
out_4.splat.u0_q24_=(((1024u - _e66.x)- uint((middle_1.x*_e72)))- uint((middle_1.y*_e75)));out_4.splat.v0_q24_=((1024u
- _e69.x)- uint((middle_1.y*_e78)));out_4.splat.ux_q24_=_e72;out_4.splat.uy_q24_=_e75;out_4.splat.vy_q24_=_e78;int
_e112=_group_0_binding_0_cs.whole.y;out_4.splat.rows=ivec2(0,(_e112 - 1));int _e126=_group_0_binding_0_cs.cutoff;
out_4.bounds=Bounds(ivec2(0),0u,0,EVERYWHERE_Q8_,((_e126==1)?131072u:0u));uvec2 r_q24_=uvec2(((r_q12_2 + 1u)*4096u),0u);
uvec2 _e139=mul_signed(middle_1.x,_e72);uvec2 _e142=mul_signed(middle_1.y,abs(_e75));uvec2 _e143=add_wide(_e139,_e142);
uvec2 _e144=add_wide(r_q24_,_e143);uvec2 _e145=magnitude(_e66);bool _e146=less(_e144,_e145);if(!(_e146)){uvec2
_e151=mul_signed(middle_1.y,_e78);uvec2 _e152=add_wide(r_q24_,_e151);uvec2 _e153=magnitude(_e69);bool _e154=less(_e152,
_e153);local_14=!(_e154);}else{local_14=false;}bool _e157=local_14;return _e157;}int axis_size_q15_(int below_q16_,uint
size_q32_,int shift_2){int _e7=exp2_q15_(((below_q16_&65535)>>1u));uint ratio_q15_=uint(_e7);uint
_e10=product_shifted(ratio_q15_,size_q32_,31u);uint _e14=scale_down(_e10,(shift_2 +(below_q16_>>16u)));return int(_e14);
}int dot_q15_(ivec3 a_21,ivec3 b_13){int _e2=dot_i(a_21,b_13);return((_e2 + 16384)>>15u);}ivec3 screen_axes(ivec3 row,
Axes axes_2,ivec3 sizes_q15_){int _e4=dot_q15_(row,axes_2.side_x_q15_);int _e6=dot_q15_(row,axes_2.side_y_q15_);int
_e8=dot_q15_(row,axes_2.axis_q15_);int _e10=fxs_mul_q15_(_e8,sizes_q15_.x);int
_e21=fxs_mul_q15_(((((_e4*axes_2.cos_q15_)+(_e6*axes_2.sin_q15_))+ 16384)>>15u),sizes_q15_.y);int
_e32=fxs_mul_q15_(((((_e6*axes_2.cos_q15_)-(_e4*axes_2.sin_q15_))+ 16384)>>15u),sizes_q15_.z);return ivec3(_e10,_e21,
_e32);}bool project_shape(inout Placed out_5,inout Projected centre_6,uint scale_word_1,uint rotation_word){int
size_exponent=0;bool local_15=false;Axes axes_3=Axes(ivec3(0),ivec3(0),ivec3(0),0,0);uint least=64u;Covariance
s_3=Covariance(0u,0u,0,uvec2(0u),uvec2(0u),0);int offset_q11_2=0;uint r2_q11_=0u;uint _e6=record[16];ivec3
_e7=falls_of(scale_word_1,_e6);int least_q16_=min(min(_e7.x,_e7.y),_e7.z);int _e15=number_at(15u);uint
_e17=screen_size(centre_6,(_e15 - least_q16_),size_exponent);int _e18=size_exponent;if(!((_e18>16))){bool
_e25=centre_6.out_of_range;local_15=_e25;}else{local_15=true;}bool is_veil=local_15;if(is_veil){int _e28=size_exponent;
int _e31=_group_0_binding_1_cs.veil_exponent;if((_e28<_e31)){return false;}}else{int _e34=size_exponent;bool
_e35=off_picture(centre_6,_e34);if(_e35){return false;}}int _e37=size_exponent;int exponent_6=max(_e37,0);uint
_e41=axis_bits(_e7);bool _e42=read_axes(axes_3,rotation_word,_e41);if(!(_e42)){return false;}int
_e48=centre_6.slope_q23_.x;ivec3 _e49=jacobian_row(0u,_e48);int _e53=centre_6.slope_q23_.y;ivec3 _e54=jacobian_row(1u,
_e53);int _e57=size_exponent;int shift_5=((1 + exponent_6)- _e57);int _e61=axis_size_q15_((_e7.x - least_q16_),_e17,
shift_5);int _e64=axis_size_q15_((_e7.y - least_q16_),_e17,shift_5);int _e67=axis_size_q15_((_e7.z - least_q16_),_e17,
shift_5);ivec3 sizes_q15_1=ivec3(_e61,_e64,_e67);Axes _e69=axes_3;ivec3 _e70=screen_axes(_e49,_e69,sizes_q15_1);Axes
_e71=axes_3;ivec3 _e72=screen_axes(_e54,_e71,sizes_q15_1);if(is_veil){uint _e75=veil_dilation_q30_(exponent_6);
least=_e75;}uint _e76=least;Covariance _e77=covariance_of(_e70,_e72,exponent_6,_e76);s_3=_e77;int
_e81=out_5.splat.offset_q11_;offset_q11_2=_e81;int _e85=_group_0_binding_1_cs.antialiased;if((_e85!=0)){uint
_e90=s_3.det_undilated_q60_.x;uint _e93=s_3.det_undilated_q60_.y;if(((_e90|_e93)==0u)){return false;}uvec2
_e99=s_3.det_q60_;int _e100=log2_q16_(_e99);uvec2 _e102=s_3.det_undilated_q60_;int _e103=log2_q16_(_e102);int
log2_=(_e100 - _e103);int _e105=offset_q11_2;uvec2 _e107=mul_signed(log2_,45426);uvec2 _e111=add_wide(_e107,
uvec2(1048576u,0u));uvec2 _e113=shift_signed(_e111,21u);int _e114=low_of(_e113);offset_q11_2=(_e105 + _e114);}int
_e116=offset_q11_2;if((_e116>FXS_FAINT_Q11_)){return false;}int _e122=offset_q11_2;out_5.splat.offset_q11_=_e122;int
_e123=offset_q11_2;int _e125=fxs_limit_q11_(_e123,FXS_CUT_Q11_);int _e126=offset_q11_2;r2_q11_=uint((_e125 - _e126));
int _e132=_group_0_binding_0_cs.cutoff;if((_e132==1)){int _e136=offset_q11_2;r2_q11_=uint((FXS_FAINT_Q11_ - _e136));}
uint _e139=r2_q11_;uint _e144=sqrt_of(((_e139 + 1u)<<13u));uint r_q12_5=(_e144 + 1u);if(is_veil){bool _e147=veil(out_5,
s_3,centre_6,r_q12_5);return _e147;}uint _e149=s_3.c_q30_;Root _e150=root_of_q30_(_e149);whiten(out_5,s_3,_e150,
centre_6,r_q12_5);int _e153=_group_0_binding_0_cs.cutoff;if((_e153==1)){bool _e156=square(out_5,s_3);return _e156;}uint
_e157=sqrt_q8_(_e150,exponent_6);bool _e158=clip(out_5,_e157,r_q12_5);return _e158;}bool enter_window(inout Placed
out_6){bool local_16=false;ivec2 _e3=_group_0_binding_0_cs.size;ivec2 _e6=_group_0_binding_0_cs.whole;if(all(equal(_e3,
_e6))){return true;}ivec2 _e12=_group_0_binding_0_cs.first;uvec2 first_2=uvec2(_e12);ivec2 _e16=out_6.splat.rows;int
_e20=_group_0_binding_0_cs.first.y;ivec2 rows_7=(_e16 - ivec2(_e20));uint _e25=out_6.splat.u0_q24_;int
_e29=out_6.splat.ux_q24_;int _e35=out_6.splat.uy_q24_;out_6.splat.u0_q24_=(_e25
+((first_2.x*uint(_e29))+(first_2.y*uint(_e35))));uint _e42=out_6.splat.v0_q24_;int _e46=out_6.splat.vy_q24_;
out_6.splat.v0_q24_=(_e42 +(first_2.y*uint(_e46)));int _e57=_group_0_binding_0_cs.size.y;
out_6.splat.rows=min(max(rows_7,ivec2(0)),ivec2((_e57 - 1)));int _e64=out_6.bounds.half_width_q8_;
if((_e64!=EVERYWHERE_Q8_)){ivec2 _e69=out_6.bounds.c_q14_;ivec2 _e72=_group_0_binding_0_cs.first;
out_6.bounds.c_q14_=(_e69 -(_e72<<uvec2(14u)));}if((rows_7.y>=0)){int _e86=_group_0_binding_0_cs.size.y;
local_16=(rows_7.x<_e86);}else{local_16=false;}bool _e89=local_16;return _e89;}uint depth_key(int z){int
_e2=zeros_of(uint(z));int _e4=number_at(18u);return((uint((((_e4 - _e2)- 1)+
32))<<26u)|(((uint(z)<<uint(_e2))>>5u)&67108863u));}uint falling_q30_(uint l_q16_){uint whole_1=(l_q16_>>16u);
if((whole_1>30u)){return 0u;}int _e11=exp2_q15_((int((l_q16_&65535u))>>1u));return((uint(_e11)<<15u)>>whole_1);}uint
octaves_below_q16_(uint x_q30_){int _e3=log2_q16_(uvec2(x_q30_,0u));return uint(max((1966080 - _e3),0));}uint
share_of_q11_(uint offset_q11_3,uint share_q8_){if((offset_q11_3>22697u)){return(22697u + 1u);}uint
_e12=falling_q30_((((offset_q11_3*94548u)+ 2048u)>>12u));uint clear_q30_=(1073741824u - min(_e12,1063004406u));uint
_e18=octaves_below_q16_(clear_q30_);uint _e22=falling_q30_(((_e18*share_q8_)>>8u));uint share_q30_=(1073741824u - _e22);
if((share_q30_==0u)){return(22697u + 1u);}uint _e28=octaves_below_q16_(share_q30_);uvec2 _e30=mul_wide(_e28,90852u);
uvec2 _e34=add_wide(_e30,uvec2(1048576u,0u));uvec2 _e36=shift_right(_e34,21u);uint offset=_e36.x;return min(offset,
(22697u + 1u));}uint byte_at(uint byte){uint _e5=_group_1_binding_0_cs[(byte/4u)];return((_e5>>(8u*(byte%4u)))&255u);}
uint spread_11_(uint code_2){return((code_2<<5u)|(code_2>>6u));}uint spread_scale(uint x_15,uint y_1,uint z_1){
return((((x_15<<3u)|(x_15>>4u))|(((y_1<<3u)|(y_1>>4u))<<10u))|(((z_1<<3u)|(z_1>>3u))<<20u));}Codes small_codes(uint
rows,uint g){uint a_27=_group_1_binding_0_cs[(rows + g)];uint b_36=_group_1_binding_0_cs[((rows + CHUNK)+ g)];uint
c_5=_group_1_binding_0_cs[((rows + 512u)+ g)];uint _e23=byte_at((((4u*rows)+ 3072u)+ g));uint red=((b_36>>11u)&127u);
uint green=((b_36>>18u)&127u);uint blue=((b_36>>25u)&63u);uint _e38=spread_11_((a_27&2047u));uint
_e43=spread_11_(((a_27>>11u)&2047u));uint _e46=spread_11_((b_36&2047u));uint _e75=spread_scale((c_5&127u),
((c_5>>7u)&127u),((c_5>>14u)&63u));return Codes(uvec3(_e38,_e43,_e46),
((((c_5&4293918720u)|(_e23<<12u))|(((a_27>>22u)&3u)<<10u))|((b_36>>31u)<<9u)),
(((_e75|(((red>>5u)&1u)<<29u))|(((green>>5u)&1u)<<30u))|(((blue>>3u)&1u)<<31u)),
(((((red<<1u)|(red>>6u))|(((green<<1u)|(green>>6u))<<8u))|(((blue<<2u)|(blue>>4u))<<16u))|(a_27&4278190080u)));}Codes
codes_of(uint rows_1,uint g_1){uint _e4=_group_0_binding_1_cs.profile;if((_e4==SMALL)){Codes _e7=small_codes(rows_1,
g_1);return _e7;}uint half_=(rows_1 +(g_1/2u));uint _e13=_group_1_binding_0_cs[half_];uint _e14=half_of(_e13,g_1);uint
_e19=_group_1_binding_0_cs[(half_ + 128u)];uint _e20=half_of(_e19,g_1);uint _e25=_group_1_binding_0_cs[(half_ + 256u)];
uint _e26=half_of(_e25,g_1);uint _e33=_group_1_binding_0_cs[((rows_1 + 384u)+ g_1)];uint
_e39=_group_1_binding_0_cs[((rows_1 + 640u)+ g_1)];uint _e45=_group_1_binding_0_cs[((rows_1 + 896u)+ g_1)];return
Codes(uvec3(_e14,_e20,_e26),_e33,_e39,_e45);}uvec2 from_eye(uint i_6,uint position){uvec2 _e6=wide_at((22u +(2u*i_6)));
uint _e11=record[(34u + i_6)];uvec2 _e12=mul_wide(_e11,position);uint _e15=record[37];uvec2 _e16=shift_left(_e12,_e15);
uvec2 _e17=add_wide(_e6,_e16);return _e17;}int unit_q15_(int x_16,uint zeros_1,uint inverse_q30_2){uvec2
_e8=mul_mixed((x_16*(1<<(zeros_1/2u))),inverse_q30_2);uvec2 _e10=round_shift(_e8,31);int _e11=low_of(_e10);return
min(max(_e11,-32767),32767);}ivec3 direction_q15_(uvec3 position_1){uvec2 _e3=from_eye(0u,position_1.x);uvec2
_e6=from_eye(1u,position_1.y);uvec2 _e9=from_eye(2u,position_1.z);uvec2 _e10=magnitude(_e3);uvec2 _e11=magnitude(_e6);
uvec2 _e13=magnitude(_e9);uvec2 most_1=(((_e10|_e11)|_e13)|uvec2(1u,0u));int _e19=zeros_of_wide(most_1);uint
shift_6=uint(max((49 - _e19),0));uvec2 _e25=shift_signed(_e3,shift_6);int _e26=low_of(_e25);uvec2 _e27=shift_signed(_e6,
shift_6);int _e28=low_of(_e27);uvec2 _e29=shift_signed(_e9,shift_6);int _e30=low_of(_e29);ivec3 d_2=ivec3(_e26,_e28,
_e30);uint square_1=max(((uint((d_2.x*d_2.x))+ uint((d_2.y*d_2.y)))+ uint((d_2.z*d_2.z))),1u);int
_e48=zeros_of(square_1);uint zeros_5=(uint(_e48)&4294967294u);uint _e53=rsqrt((square_1<<zeros_5));int
_e55=unit_q15_(d_2.x,zeros_5,_e53);int _e57=unit_q15_(d_2.y,zeros_5,_e53);int _e59=unit_q15_(d_2.z,zeros_5,_e53);return
ivec3(_e55,_e57,_e59);}Basis basis_of(ivec3 d,int degree){Basis b_14=Basis(ivec4(0),ivec4(0),ivec4(0),ivec4(0));int
x_17=d.x;int y_2=d.y;int z_2=d.z;int _e8=fxs_mul_q15_(-16011,y_2);int _e10=fxs_mul_q15_(16011,z_2);int
_e12=fxs_mul_q15_(-16011,x_17);b_14.a=ivec4(_e8,_e10,_e12,0);if((degree<2)){Basis _e17=b_14;return _e17;}int
_e18=fxs_mul_q15_(x_17,x_17);int _e19=fxs_mul_q15_(y_2,y_2);int _e20=fxs_mul_q15_(z_2,z_2);int _e21=fxs_mul_q15_(x_17,
y_2);int _e22=fxs_mul_q15_(y_2,z_2);int _e23=fxs_mul_q15_(x_17,z_2);int _e27=fxs_mul_q15_(17900,_e21);b_14.a.w=(2*_e27);
int _e32=fxs_mul_q15_(17900,_e22);int _e40=fxs_mul_q15_(10335,(((2*_e20)- _e18)- _e19));int _e42=fxs_mul_q15_(17900,
_e23);int _e47=fxs_mul_q15_(17900,(_e18 - _e19));b_14.b=ivec4((-2*_e32),_e40,(-2*_e42),_e47);if((degree<3)){Basis
_e51=b_14;return _e51;}int _e54=fxs_mul_q15_(19335,y_2);int _e59=divide_by(((3*_e18)- _e19),1u);int
_e60=fxs_mul_q15_(_e54,_e59);int _e64=fxs_mul_q15_(23680,_e21);int _e65=fxs_mul_q15_(_e64,z_2);int
_e69=fxs_mul_q15_(14976,y_2);int _e75=divide_by((((4*_e20)- _e18)- _e19),2u);int _e76=fxs_mul_q15_(_e69,_e75);int
_e80=fxs_mul_q15_(12228,z_2);int _e90=divide_by((((2*_e20)-(3*_e18))-(3*_e19)),2u);int _e91=fxs_mul_q15_(_e80,_e90);
b_14.c=ivec4((-2*_e60),(4*_e65),(-4*_e76),(4*_e91));int _e97=fxs_mul_q15_(14976,x_17);int _e103=divide_by((((4*_e20)-
_e18)- _e19),2u);int _e104=fxs_mul_q15_(_e97,_e103);int _e108=fxs_mul_q15_(23680,z_2);int _e110=fxs_mul_q15_(_e108,
(_e18 - _e19));int _e114=fxs_mul_q15_(19335,x_17);int _e119=divide_by((_e18 -(3*_e19)),1u);int _e120=fxs_mul_q15_(_e114,
_e119);b_14.d=ivec4((-4*_e104),(2*_e110),(-2*_e120),0);Basis _e125=b_14;return _e125;}ivec3 sh_of(uint at_2,uint k){
uint word_6=((at_2 +((3u*k)*CHUNK))/4u);uvec3 up=uvec3((24u -(8u*(at_2%4u))));uint _e18=_group_1_binding_0_cs[word_6];
uint _e23=_group_1_binding_0_cs[(word_6 + 64u)];uint _e28=_group_1_binding_0_cs[(word_6 + 128u)];uvec3 words=uvec3(_e18,
_e23,_e28);return(ivec3((words<<up))>>uvec3(24u));}ivec3 band_sum_q16_(ivec3 band_q15_,int step_q19_){
return(((((band_q15_ + ivec3(512))>>uvec3(10u))*step_q19_)+ ivec3(128))>>uvec3(8u));}ivec3 bands_q16_(Basis b_15,uint
rows_2,uint g_2){ivec3 sum=ivec3(0);uint at_5=(((4u*rows_2)+ 4608u)+ g_2);ivec3 _e11=sh_of(at_5,0u);ivec3
_e16=sh_of(at_5,1u);ivec3 _e22=sh_of(at_5,2u);int _e26=number_at(44u);ivec3
_e27=band_sum_q16_((((b_15.a.x*_e11)+(b_15.a.y*_e16))+(b_15.a.z*_e22)),_e26);sum=_e27;int
_e31=_group_0_binding_1_cs.degree;if((_e31>1)){ivec3 _e34=sum;ivec3 _e38=sh_of(at_5,3u);ivec3 _e43=sh_of(at_5,4u);ivec3
_e49=sh_of(at_5,5u);ivec3 _e55=sh_of(at_5,6u);ivec3 _e61=sh_of(at_5,7u);int _e65=number_at(45u);ivec3
_e66=band_sum_q16_((((((b_15.a.w*_e38)+(b_15.b.x*_e43))+(b_15.b.y*_e49))+(b_15.b.z*_e55))+(b_15.b.w*_e61)),_e65);
sum=(_e34 + _e66);}int _e70=_group_0_binding_1_cs.degree;if((_e70>2)){ivec3 _e73=sum;ivec3 _e77=sh_of(at_5,8u);ivec3
_e82=sh_of(at_5,9u);ivec3 _e88=sh_of(at_5,10u);ivec3 _e94=sh_of(at_5,11u);ivec3 _e100=sh_of(at_5,12u);ivec3
_e106=sh_of(at_5,13u);ivec3 _e112=sh_of(at_5,14u);int _e116=number_at(46u);ivec3
_e117=band_sum_q16_((((((((b_15.c.x*_e77)+(b_15.c.y*_e82))+(b_15.c.z*_e88))+(b_15.c.w*_e94))+(b_15.d.x*_e100))+(b_15.d.y*_e106))+(b_15.d.z*_e112)),
_e116);sum=(_e73 + _e117);}ivec3 _e119=sum;return _e119;}int dot_of(ivec4 b_16,uint word_2){ivec4
bytes_1=(ivec4((uvec4(word_2)<<uvec4(24u,16u,8u,0u)))>>uvec4(24u));
return((((b_16.x*bytes_1.x)+(b_16.y*bytes_1.y))+(b_16.z*bytes_1.z))+(b_16.w*bytes_1.w));}int dot_16_(Basis b_17,uint
a_22,uint c_3,uint d_1,uint e){int _e6=dot_of(b_17.a,a_22);int _e8=dot_of(b_17.b,c_3);int _e11=dot_of(b_17.c,d_1);int
_e14=dot_of(b_17.d,e);return(((_e6 + _e8)+ _e11)+ _e14);}int mean_dot(Basis b_18,uint channel){uint at_6=(48u
+(4u*channel));uint _e8=record[at_6];uint _e13=record[(at_6 + 1u)];uint _e18=record[(at_6 + 2u)];uint _e23=record[(at_6
+ 3u)];int _e24=dot_16_(b_18,_e8,_e13,_e18,_e23);return _e24;}int entry_dot(Basis b_19,uint at_3){uint
_e4=_group_1_binding_0_cs[at_3];uint _e9=_group_1_binding_0_cs[(at_3 + 1u)];uint _e14=_group_1_binding_0_cs[(at_3 +
2u)];uint _e19=_group_1_binding_0_cs[(at_3 + 3u)];int _e20=dot_16_(b_19,_e4,_e9,_e14,_e19);return _e20;}ivec3
entry_sum(Basis b_20,uint stage,uint code_3){uint _e7=_group_0_binding_1_cs.palette_entries;uint
index_1=min((code_3&127u),(_e7 - 1u));uint _e14=_group_0_binding_1_cs.palette_entries;uint at_7=(12u*((stage*_e14)+
index_1));int _e25=entry_dot(b_20,at_7);int _e28=entry_dot(b_20,(at_7 + 4u));int _e31=entry_dot(b_20,(at_7 + 8u));
return((((code_3&128u)!=0u)?-1:1)*ivec3(_e25,_e28,_e31));}uint bits_at(uint byte_1,uint bit){uint at_8=(byte_1
+(bit/8u));uint shift_7=((8u*(at_8%4u))+(bit%8u));uint _e16=_group_1_binding_0_cs[(at_8/4u)];uint low_5=(_e16>>shift_7);
if((shift_7==0u)){return low_5;}uint _e26=_group_1_binding_0_cs[((at_8/4u)+ 1u)];return(low_5|(_e26<<(32u - shift_7)));}
int odd_dot(ivec4 b_21,uint bits_1){ivec4 code_8=ivec4((((uvec4(bits_1)>>uvec4(0u,3u,6u,9u))&uvec4(7u))^uvec4(4u)));
ivec4 odd=((2*code_8)- ivec4(7));return((((b_21.x*odd.x)+(b_21.y*odd.y))+(b_21.z*odd.z))+(b_21.w*odd.w));}uint
sh_count(int degree_1){return uint((((degree_1 + 1)*(degree_1 + 1))- 1));}int residual_q16_(Basis b_22,uint record_at,
uint channel_1,uint gain){int _e9=_group_0_binding_1_cs.scene_degree;uint _e10=sh_count(_e9);uint first_3=(32u
+((3u*channel_1)*_e10));uint _e13=bits_at(record_at,first_3);uint _e16=bits_at(record_at,(first_3 + 24u));int
_e18=odd_dot(b_22.a,_e13);int _e22=odd_dot(b_22.b,(_e13>>12u));int _e25=odd_dot(b_22.c,_e16);int _e30=odd_dot(b_22.d,
(_e16>>12u));int odd_1=(((_e18 + _e22)+ _e25)+ _e30);return((odd_1*int((8u +(gain&7u))))>>(31u -(gain>>3u)));}int
scaled_q16_(int sum_1){int _e3=_group_0_binding_1_cs.palette_step_q19_;uvec2 _e4=mul_signed(sum_1,_e3);uvec2
_e6=shift_signed(_e4,18u);int _e7=low_of(_e6);return _e7;}ivec3 palette_q16_(Basis b_23,uint rows_3,uint g_3){uint
stages=0u;uint bytes=0u;uint at_4=0u;ivec3 sum_2=ivec3(0);uint stage_1=0u;ivec3 out_7=ivec3(0);int
degree_2=_group_0_binding_1_cs.scene_degree;uint _e8=_group_0_binding_1_cs.profile;bool compact=(_e8==COMPACT);
stages=((degree_2==1)?4u:6u);uint _e17=stages;bytes=_e17;at_4=((4u*rows_3)+ 3328u);if(compact){stages=3u;
bytes=((degree_2==1)?8u:((degree_2==2)?13u:21u));at_4=((4u*rows_3)+ 4608u);}uint _e38=at_4;uint _e39=bytes;at_4=(_e38
+(g_3*_e39));int _e43=mean_dot(b_23,0u);int _e45=mean_dot(b_23,1u);int _e47=mean_dot(b_23,2u);sum_2=ivec3(_e43,_e45,
_e47);for(;(stage_1<stages);stage_1=(stage_1 + 1u)){{ivec3 _e55=sum_2;uint _e56=stage_1;uint _e57=at_4;uint
_e58=stage_1;uint _e60=byte_at((_e57 + _e58));ivec3 _e61=entry_sum(b_23,_e56,_e60);sum_2=(_e55 + _e61);}}int
_e67=sum_2.x;int _e68=scaled_q16_(_e67);int _e70=sum_2.y;int _e71=scaled_q16_(_e70);int _e73=sum_2.z;int
_e74=scaled_q16_(_e73);out_7=ivec3(_e68,_e71,_e74);if(compact){uint _e77=at_4;uint _e80=byte_at((_e77 + 3u));ivec3
_e81=out_7;uint _e82=at_4;int _e84=residual_q16_(b_23,_e82,0u,_e80);uint _e85=at_4;int _e87=residual_q16_(b_23,_e85,1u,
_e80);uint _e88=at_4;int _e90=residual_q16_(b_23,_e88,2u,_e80);out_7=(_e81 + ivec3(_e84,_e87,_e90));}ivec3 _e93=out_7;
return _e93;}ivec3 shade(uint rows_4,uint g_4,Codes codes){ivec3 sum_q16_=ivec3(0);uvec3
upper=((uvec3(codes.colour)>>uvec3(0u,8u,16u))&uvec3(255u));uvec3
code_9=((upper<<uvec3(1u))|((uvec3(codes.scale)>>uvec3(29u,30u,31u))&uvec3(1u)));uint _e29=record[41];uint
_e32=record[42];uint _e35=record[43];uvec3 step_=(uvec3(_e29,_e32,_e35)*code_9);int _e39=number_at(38u);int
_e41=number_at(39u);int _e43=number_at(40u);sum_q16_=(ivec3(_e39,_e41,_e43)+ ivec3(((step_ + uvec3(8u))>>uvec3(4u))));
int _e56=_group_0_binding_1_cs.degree;if((_e56>0)){ivec3 _e60=direction_q15_(codes.position);int
_e63=_group_0_binding_1_cs.degree;Basis _e64=basis_of(_e60,_e63);uint _e67=_group_0_binding_1_cs.palette_entries;
if((_e67!=0u)){ivec3 _e70=sum_q16_;ivec3 _e71=palette_q16_(_e64,rows_4,g_4);sum_q16_=(_e70 + _e71);}else{ivec3
_e73=sum_q16_;ivec3 _e74=bands_q16_(_e64,rows_4,g_4);sum_q16_=(_e73 + _e74);}}ivec3 _e76=sum_q16_;return min(max(((_e76
+ ivec3(4))>>uvec3(3u)),ivec3(0)),ivec3(32767));}Span columns_between(int left_q8_,int right_q8_){bool local_17=false;
bool local_18=false;int first_4=((left_q8_ + 255)>>8u);int last_2=(right_q8_>>8u);if(!((last_2<0))){int
_e16=_group_0_binding_0_cs.size.x;local_17=(first_4>=_e16);}else{local_17=true;}bool _e19=local_17;if(!(_e19)){
local_18=(first_4>last_2);}else{local_18=true;}bool _e25=local_18;if(_e25){return Span(0,-1);}uint
_e33=_group_0_binding_0_cs.tile_bits;uint _e37=_group_0_binding_0_cs.tile_bits;int _e42=_group_0_binding_0_cs.tiles.x;
int _e48=_group_0_binding_0_cs.size.x;return Span((max(first_4,0)>>_e33),((last_2>=_e48)?(_e42 - 1):(last_2>>_e37)));}
Span columns_of(inout Bounds b_27){int _e3=b_27.c_q14_.x;int c_q8_1=(_e3>>6u);int _e7=b_27.half_width_q8_;int
_e10=b_27.half_width_q8_;Span _e12=columns_between((c_q8_1 - _e7),(c_q8_1 + _e10));return _e12;}int radius_q12_(int
offset_q11_4){int _e3=_group_0_binding_0_cs.cut_q11_;int _e4=fxs_limit_q11_(offset_q11_4,_e3);uint
_e11=sqrt_of((uint(((_e4 - offset_q11_4)+ 1))<<13u));return(int(_e11)+ 1);}int v_at_row(inout Splat s_4,inout Bounds
b_28,int row_7){int _e7=b_28.c_q14_.y;int _e10=s_4.vy_q24_;uvec2 _e11=mul_signed(((row_7<<14u)- _e7),_e10);uvec2
_e13=shift_signed(_e11,26u);int _e14=low_of(_e13);return _e14;}int half_at(inout Bounds b_29,int r_q12_3,int v_q12_){
uint _e7=sqrt_of(uint(((r_q12_3*r_q12_3)-(v_q12_*v_q12_))));uint root=(_e7 + 1u);uint _e11=b_29.breadth_q8_;uvec2
_e12=mul_wide(_e11,root);uvec2 _e14=shift_right(_e12,12u);return int(_e14.x);}Span ellipse_span(inout Splat s_5,inout
Bounds b_30,int r_1,int row_8){bool local_19=false;bool local_20=false;int left=0;int right=0;uvec2 tangent=uvec2(0u);
bool local_21=false;bool local_22=false;uint _e6=_group_0_binding_0_cs.tile_bits;int _e8=v_at_row(s_5,b_30,
(row_8<<_e6));uint _e13=_group_0_binding_0_cs.tile_bits;int _e17=v_at_row(s_5,b_30,(((row_8 + 1)<<_e13)- 1));int
reach=b_30.half_width_q8_;if(!((_e8>(r_1 + 2)))){local_19=(_e17<(-(r_1)- 2));}else{local_19=true;}bool _e31=local_19;
if(_e31){local_20=(reach!=EVERYWHERE_Q8_);}else{local_20=false;}bool _e37=local_20;if(_e37){return Span(0,-1);}int
top=min(max(_e8,-(r_1)),r_1);int bottom=min(max((_e17 + 1),-(r_1)),r_1);int _e48=b_30.shear_q8_;uvec2
_e49=mul_signed(_e48,top);uvec2 _e51=shift_signed(_e49,12u);int _e52=low_of(_e51);int _e54=b_30.shear_q8_;uvec2
_e55=mul_signed(_e54,bottom);uvec2 _e57=shift_signed(_e55,12u);int _e58=low_of(_e57);int _e59=half_at(b_30,r_1,top);int
_e60=half_at(b_30,r_1,bottom);left=-(max((_e59 - _e52),(_e60 - _e58)));right=max((_e59 + _e52),(_e60 + _e58));int
_e71=b_30.shear_q8_;uvec2 _e75=mul_wide(uint(abs(_e71)),uint(r_1));uvec2 _e77=shift_right(_e75,12u);uvec2
_e80=mul_wide(_e77.x,uint(r_1));tangent=_e80;int _e83=b_30.shear_q8_;if((_e83<0)){uvec2 _e86=tangent;uvec2
_e87=negate(_e86);tangent=_e87;}uvec2 _e88=tangent;uvec2 _e89=negate(_e88);uvec2 _e90=mul_signed(top,reach);uvec2
_e91=mul_signed(bottom,reach);uvec2 _e92=tangent;bool _e93=less(_e92,_e90);if(!(_e93)){uvec2 _e97=tangent;bool
_e98=less(_e91,_e97);local_21=!(_e98);}else{local_21=false;}bool _e101=local_21;if(_e101){right=reach;}bool
_e102=less(_e89,_e90);if(!(_e102)){bool _e106=less(_e91,_e89);local_22=!(_e106);}else{local_22=false;}bool
_e109=local_22;if(_e109){left=-(reach);}int _e113=b_30.c_q14_.x;int c_q8_2=(_e113>>6u);int margin=((reach>>8u)+ 32);int
_e120=left;int _e125=right;Span _e131=columns_between((c_q8_2 + max((_e120 - margin),-(reach))),(c_q8_2 -
max((-(_e125)- margin),-(reach))));return _e131;}Span square_span(int centre_q14_,uint radius,int tiles){int
pixel_1=(centre_q14_>>14u);int first_5=((pixel_1 - int(radius))>>4u);int last_3=((((pixel_1 + int(radius))+ 15)>>4u)-
1);return Span(min(max(first_5,0),tiles),min(max(last_3,-1),(tiles - 1)));}Span rows_of(inout Splat s_6,inout Bounds
b_31){int _e4=_group_0_binding_0_cs.cutoff;if((_e4==1)){int _e9=b_31.c_q14_.y;uint _e11=b_31.square_radius;int
_e15=_group_0_binding_0_cs.tiles.y;Span _e16=square_span(_e9,_e11,_e15);return _e16;}int _e19=s_6.rows.x;uint
_e22=_group_0_binding_0_cs.tile_bits;int _e26=s_6.rows.y;uint _e29=_group_0_binding_0_cs.tile_bits;return
Span((_e19>>_e22),(_e26>>_e29));}Span span_of(inout Splat s_7,inout Bounds b_32,int r_q12_4,int row_9){int
_e6=_group_0_binding_0_cs.cutoff;if((_e6==1)){int _e11=b_32.c_q14_.x;uint _e13=b_32.square_radius;int
_e17=_group_0_binding_0_cs.tiles.x;Span _e18=square_span(_e11,_e13,_e17);return _e18;}Span _e19=ellipse_span(s_7,b_32,
r_q12_4,row_9);return _e19;}uint scale_depth(uint key){uint _e9=_group_0_binding_1_cs.scale_mantissa;uint
_e10=mul_high(((67108864u|(key&67108863u))<<5u),_e9);int _e11=zeros_of(_e10);int
_e17=_group_0_binding_1_cs.scale_exponent;int exponent_7=(((int((key>>26u))+ _e17)+ 1)- _e11);if((exponent_7<0)){return
0u;}if((exponent_7>63)){return 4294967295u;}return((uint(exponent_7)<<26u)|(((_e10<<uint(_e11))>>5u)&67108863u));}bool
is_kept(uvec3 position_3){uvec2 centre_7[3]=uvec2[3](uvec2(0u),uvec2(0u),uvec2(0u));uint i_8=0u;for(;(i_8<3u);i_8=(i_8
+ 1u)){{uint _e9=i_8;uint _e12=record[(34u + _e9)];uint _e13=i_8;uvec2 _e15=mul_wide(_e12,position_3[_e13]);uint
_e18=record[37];uvec2 _e19=shift_left(_e15,_e18);uint _e20=i_8;uint _e24=i_8;uvec2 _e27=wide_at((28u +(2u*_e24)));uvec2
_e28=add_wide(_e27,_e19);centre_7[_e20]=_e28;}}bool _e32=is_within_crops(centre_7,centre_7);return _e32;}int
offset_of(uint opacity_1,uint share_q8_1){uint offset_q11_5=0u;uint _e5=record[17];uint code_11=((CHUNK*_e5)+
opacity_1);uint _e12=_group_1_binding_1_cs[(code_11/2u)];uint _e13=half_of(_e12,code_11);offset_q11_5=_e13;
if((share_q8_1!=256u)){uint _e17=offset_q11_5;uint _e18=share_of_q11_(_e17,share_q8_1);offset_q11_5=_e18;}uint
_e19=offset_q11_5;int _e23=_group_0_binding_1_cs.offset_q11_;return(int(_e19)+ _e23);}void count_tiles(int row_10,Span
s_8){if((s_8.first>s_8.last)){return;}int _e8=_group_0_binding_0_cs.tiles.x;uint tile_1=uint((row_10*_e8));uint
_e15=list_of((tile_1 + uint(s_8.first)));uint _e18=atomicAdd(_group_1_binding_2_cs[_e15],1u);int
_e23=_group_0_binding_0_cs.tiles.x;if((s_8.last<(_e23 - 1))){uint _e33=list_of(((tile_1 + uint(s_8.last))+ 1u));uint
_e36=atomicAdd(_group_1_binding_2_cs[_e33],4294967295u);return;}else{return;}}void put_large(uint slot,inout Bounds
b_33,int first_row){uint _e6=atomicAdd(_group_1_binding_2_cs[1],1u);uint _e9=_group_0_binding_0_cs.large_room;
if((_e6<_e9)){uint _e13=_group_0_binding_0_cs.larges;uint at_9=(_e13 +(LARGE*_e6));_group_1_binding_1_cs[at_9]=slot;int
_e25=b_33.c_q14_.x;_group_1_binding_1_cs[(at_9 + 1u)]=uint(_e25);int _e33=b_33.c_q14_.y;_group_1_binding_1_cs[(at_9 +
2u)]=uint(_e33);uint _e40=b_33.breadth_q8_;_group_1_binding_1_cs[(at_9 + 3u)]=_e40;int _e46=b_33.shear_q8_;
_group_1_binding_1_cs[(at_9 + 4u)]=uint(_e46);int _e53=b_33.half_width_q8_;_group_1_binding_1_cs[(at_9 +
5u)]=uint(_e53);uint _e60=b_33.square_radius;_group_1_binding_1_cs[(at_9 + 6u)]=_e60;_group_1_binding_1_cs[(at_9 +
7u)]=uint(first_row);return;}else{return;}}uvec2 large_box(inout Bounds b_34){ivec2 centre_8=ivec2(0);ivec2
_e2=b_34.c_q14_;centre_8=max((_e2>>uvec2(11u)),ivec2(-1048575));int _e11=b_34.half_width_q8_;if((_e11==EVERYWHERE_Q8_)){
centre_8=ivec2(-1048576);}int _e17=centre_8.x;uint x_19=(uint(_e17)&2097151u);int _e22=centre_8.y;uint
y_3=(uint(_e22)&2097151u);return uvec2((x_19|(y_3<<21u)),((y_3>>11u)|4294966272u));}uvec2 list_splat(uint slot_1,inout
Placed out_8){Splat s_9=Splat(0u,0u,0,0,0,0,ivec2(0));Bounds b_35=Bounds(ivec2(0),0u,0,0,0u);bool local_23=false;bool
local_24=false;bool local_25=false;bool local_26=false;bool local_27=false;bool local_28=false;bool local_29=false;
uvec2 box=uvec2(0u,0u);int row_11=0;bool local_30=false;int row_12=0;bool local_31=false;Splat _e3=out_8.splat;s_9=_e3;
Bounds _e6=out_8.bounds;b_35=_e6;Span _e8=rows_of(s_9,b_35);Span _e9=columns_of(b_35);int
_e12=_group_0_binding_0_cs.cutoff;bool is_square=(_e12==1);if(!(is_square)){local_23=(_e9.first>_e9.last);}else{
local_23=false;}bool _e22=local_23;if(_e22){return uvec2(0u,0u);}int _e30=_group_0_binding_0_cs.tiles.x;uint
first_tile=uint(((_e8.first*_e30)+ _e9.first));if(!(is_square)){local_24=(_e8.first==_e8.last);}else{local_24=false;}
bool _e42=local_24;if(_e42){int _e47=s_9.rows.x;local_25=(_e47>0);}else{local_25=false;}bool _e51=local_25;if(_e51){int
_e56=s_9.rows.y;int _e60=_group_0_binding_0_cs.size.y;local_26=(_e56<(_e60 - 1));}else{local_26=false;}bool
_e65=local_26;if(_e65){local_27=((_e9.last - _e9.first)<4);}else{local_27=false;}bool _e74=local_27;if(_e74){
count_tiles(_e8.first,_e9);return uvec2(((2u<<uint((_e9.last - _e9.first)))- 1u),(first_tile<<10u));}if(!(is_square)){
local_28=((_e9.last - _e9.first)>=BOX_COLUMNS);}else{local_28=true;}bool _e96=local_28;if(!(_e96)){local_29=((_e8.last
- _e8.first)>=BOX_ROWS);}else{local_29=true;}bool large=local_29;int _e108=s_9.offset_q11_;int _e109=radius_q12_(_e108);
row_11=_e8.first;for(;(row_11<=_e8.last);row_11=(row_11 + 1)){{int _e119=row_11;Span _e120=span_of(s_9,b_35,_e109,
_e119);int _e121=row_11;count_tiles(_e121,_e120);if(!(large)){local_30=(_e120.first<=_e120.last);}else{local_30=false;}
bool _e129=local_30;if(_e129){uint bits_6=((2u<<uint((_e120.last - _e9.first)))-(1u<<uint((_e120.first - _e9.first))));
uvec2 _e143=box;int _e147=row_11;uvec2 _e152=shift_left(uvec2(bits_6,0u),uint((BOX_COLUMNS*(_e147 - _e8.first))));
box=(_e143|_e152);}}}row_12=_e8.first;for(;;row_12=(row_12 + LARGE_ROWS)){int _e159=row_12;if((_e159<=_e8.last)){
local_31=large;}else{local_31=false;}bool _e165=local_31;if(_e165){}else{break;}{int _e166=row_12;put_large(slot_1,b_35,
_e166);}}if(is_square){int _e172=b_35.c_q14_.x;uint _e174=b_35.square_radius;int _e178=_group_0_binding_0_cs.tiles.x;
Span _e179=square_span(_e172,_e174,_e178);uint _e183=_group_0_binding_0_cs.squares;_group_1_binding_1_cs[(_e183
+(2u*slot_1))]=(uint(_e179.first)|(uint((_e179.last + 1))<<16u));uint _e200=_group_0_binding_0_cs.squares;
_group_1_binding_1_cs[((_e200 +(2u*slot_1))+ 1u)]=(uint(_e8.first)|(uint((_e8.last + 1))<<16u));}if(large){uvec2
_e216=large_box(b_35);return _e216;}uint _e218=box.x;uint _e220=box.y;if(((_e218|_e220)==0u)){uvec2 _e224=box;return
_e224;}uint _e226=box.x;uint _e228=box.y;return uvec2(_e226,(_e228|(first_tile<<10u)));}void put_splat(uint slot_2,
inout Splat s_10,ivec3 colour_q13_1){uint _e8=s_10.u0_q24_;uint _e10=s_10.v0_q24_;int _e12=s_10.ux_q24_;int
_e15=s_10.uy_q24_;_group_1_binding_3_cs[(2u*slot_2)]=uvec4(_e8,_e10,uint(_e12),uint(_e15));int _e25=s_10.vy_q24_;int
_e28=s_10.offset_q11_;int _e44=s_10.rows.x;int _e48=s_10.rows.y;_group_1_binding_3_cs[((2u*slot_2)+
1u)]=uvec4(uint(_e25),(uint(_e28)|(uint(colour_q13_1.x)<<16u)),(uint(colour_q13_1.y)|(uint(colour_q13_1.z)<<16u)),
(uint(_e44)|(uint(_e48)<<16u)));return;}uvec2 project_gaussian(uint rows_6,uint slot_3){Codes codes_1=Codes(uvec3(0u),
0u,0u,0u);Projected centre_9=Projected(ivec3(0),0,0u,ivec2(0),ivec2(0),false);Placed out_9=Placed(Splat(0u,0u,0,0,0,0,
ivec2(0)),Bounds(ivec2(0),0u,0,0,0u));bool local_32=false;bool local_33=false;uint key_1=0u;Splat splat=Splat(0u,0u,0,0,
0,0,ivec2(0));uint g_11=(slot_3%CHUNK);Codes _e4=codes_of(rows_6,g_11);codes_1=_e4;uint
_e8=_group_0_binding_1_cs.motion_at;if((_e8!=0u)){uvec4 moved=_group_1_binding_3_cs[(2u*slot_3)];uint
_e19=half_of(moved.x,0u);uint _e22=half_of(moved.x,1u);uint _e25=half_of(moved.y,0u);codes_1.position=uvec3(_e19,_e22,
_e25);codes_1.rotation=moved.z;uint _e31=codes_1.colour;uint _e36=half_of(moved.y,1u);
codes_1.colour=((_e31&16777215u)|(_e36<<24u));}uint _e41=codes_1.colour;uint opacity_2=(_e41>>24u);if((opacity_2==0u)){
return uvec2(0u,0u);}uvec3 _e52=codes_1.position;bool _e53=project_centre(centre_9,_e52);if(!(_e53)){return uvec2(0u,
0u);}uint _e62=record[47];int _e63=offset_of(opacity_2,_e62);out_9.splat.offset_q11_=_e63;uint _e65=codes_1.scale;uint
_e67=codes_1.rotation;bool _e68=project_shape(out_9,centre_9,_e65,_e67);if(!(!(_e68))){bool _e73=enter_window(out_9);
local_32=!(_e73);}else{local_32=true;}bool _e76=local_32;if(_e76){return uvec2(0u,0u);}uint
_e82=_group_0_binding_1_cs.crop_count;if((_e82!=0u)){uvec3 _e88=codes_1.position;bool _e89=is_kept(_e88);
local_33=!(_e89);}else{local_33=false;}bool _e92=local_33;if(_e92){return uvec2(0u,0u);}int _e98=centre_9.camera.z;uint
_e99=depth_key(_e98);key_1=_e99;int _e103=_group_0_binding_1_cs.plain;if((_e103==0)){uint _e106=key_1;uint
_e107=scale_depth(_e106);key_1=_e107;}Codes _e108=codes_1;ivec3 _e109=shade(rows_6,g_11,_e108);ivec4
_e112=_group_0_binding_1_cs.tint_q13_;ivec3 colour=min((((_e109*_e112.xyz)+ ivec3(4096))>>uvec3(13u)),ivec3(32767));
Splat _e125=out_9.splat;splat=_e125;put_splat(slot_3,splat,colour);uint _e130=_group_0_binding_0_cs.depths;uint
_e133=key_1;_group_1_binding_1_cs[(_e130 + slot_3)]=_e133;uint _e136=atomicAdd(visible_here,1u);uvec2
_e137=list_splat(slot_3,out_9);return _e137;}Half half_of_chunk(uvec3 group_2){Half here=Half(0u,0u,0u,false);uint
_e3=_group_0_binding_0_cs.spans_at;uint _e7=_group_0_binding_1_cs.span;uint span=(_e3 +(SPAN*_e7));uint
half_1=((group_2.y*ROW_OF_GROUPS)+ group_2.x);uint _e19=_group_1_binding_1_cs[(span + 2u)];uint ordinal=(_e19
+(half_1/2u));uint _e36=_group_1_binding_1_cs[(span + 3u)];here=Half((THREADS*((2u*ordinal)+(half_1%2u))),0u,0u,
(ordinal<_e36));bool _e41=here.inside;if(_e41){uint _e46=_group_0_binding_0_cs.visible;uint
_e49=_group_1_binding_1_cs[(_e46 + ordinal)];here.place=_e49;uint _e52=here.place;uint
_e55=_group_0_binding_1_cs.first_chunk;here.index=(_e52 - _e55);uint _e59=_group_0_binding_0_cs.drawn;if((_e59!=0u)){
uint _e66=_group_0_binding_0_cs.drawn;uint _e69=here.place;uint _e73=_group_1_binding_1_cs[(_e66 +(DRAWN*_e69))];
here.index=_e73;}uint _e76=here.index;uint _e79=_group_0_binding_1_cs.part_chunk;uint
_e83=_group_0_binding_1_cs.part_chunks;here.inside=((_e76 - _e79)<_e83);}Half _e85=here;return _e85;}uint rows_at(uint
index){uint _e3=_group_0_binding_1_cs.rows_at;uint _e6=_group_0_binding_1_cs.part_chunk;uint
_e10=_group_0_binding_1_cs.chunk_words;return(_e3 +((index - _e6)*_e10));}void main(){uvec3 group_1=gl_WorkGroupID;uint
thread_1=gl_LocalInvocationIndex;Half _e2=half_of_chunk(group_1);if((thread_1==0u)){visible_here=0u;}
if((thread_1<RECORD)){uint _e14=_group_0_binding_0_cs.records;uint _e21=_group_1_binding_1_cs[((_e14
+(RECORD*_e2.place))+ thread_1)];record[thread_1]=_e21;}memoryBarrierShared();barrier();if(_e2.inside){uint
slot_4=(_e2.first_slot + thread_1);uint _e26=rows_at(_e2.index);uvec2 _e27=project_gaussian(_e26,slot_4);uint
_e31=_group_0_binding_0_cs.boxes;_group_1_binding_1_cs[(_e31 +(2u*slot_4))]=_e27.x;uint
_e40=_group_0_binding_0_cs.boxes;_group_1_binding_1_cs[((_e40 +(2u*slot_4))+ 1u)]=_e27.y;}memoryBarrierShared();
barrier();if((thread_1==0u)){uint _e53=visible_here;uint _e54=atomicAdd(_group_1_binding_2_cs[4],_e53);return;}else{
return;}}
