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
motion_degree;uint motion_cut_q16_;uint motion_flags;uvec4 crops[32];};struct Axes{ivec3 axis_q15_;ivec3 side_x_q15_;
ivec3 side_y_q15_;int cos_q15_;int sin_q15_;};struct Codes{uvec3 position;uint rotation;uint scale;uint colour;};struct
Moment{ivec3 power_q15_;int shift;};struct Half{uint first_slot;uint place;uint index;bool inside;};const uint
CHUNK=256u;const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;const uint RECORD=64u;const uint SPAN=8u;const uint
DRAWN=3u;const uint MOTION_TURNS=1u;const uint MOTION_FADES=2u;const uint SMALL=2u;const uint ROW=128u;layout(std140,
binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std140,binding=1)uniform
Object_block_1Compute{Object _group_0_binding_1_cs;};layout(std430,binding=0)readonly buffer type_21_block_2Compute{
uint _group_1_binding_0_cs[];};layout(std430,binding=1)buffer type_21_block_3Compute{uint _group_1_binding_1_cs[];};
layout(std430,binding=3)buffer type_26_block_4Compute{uvec4 _group_1_binding_3_cs[];};int fxs_mul_q15_(int a,int b){
return(((a*b)+ 16384)>>15u);}uvec2 mul_wide(uint a_9,uint b_6){uint high;uint low;umulExtended(a_9,b_6,high,low);return
uvec2(low,high);}uint mul_high(uint a_10,uint b_7){uvec2 _e2=mul_wide(a_10,b_7);return _e2.y;}int zeros_of(uint x_2){
return int(uint(31 - findMSB(x_2)));}uint reciprocal(uint m){uint y_q30_=0u;uint _e3=mul_high(m,2021161081u);
y_q30_=(3031741620u - _e3);uint _e7=y_q30_;uint _e11=y_q30_;uint _e12=mul_high(m,_e11);uint _e15=mul_high((2u*_e7),
(2u*(2147483648u - _e12)));y_q30_=_e15;uint _e17=y_q30_;uint _e21=y_q30_;uint _e22=mul_high(m,_e21);uint
_e25=mul_high((2u*_e17),(2u*(2147483648u - _e22)));y_q30_=_e25;uint _e27=y_q30_;uint _e31=y_q30_;uint _e32=mul_high(m,
_e31);uint _e35=mul_high((2u*_e27),(2u*(2147483648u - _e32)));return _e35;}uint rsqrt_step(uint m_1,uint y_q30_1){uint
_e8=mul_high((2u*y_q30_1),y_q30_1);uint _e9=mul_high(m_1,_e8);uint _e12=mul_high((2u*y_q30_1),(2u*(1610612736u - _e9)));
return _e12;}uint rsqrt(uint m_2){uint _e3=mul_high(m_2,1431655765u);uint _e5=rsqrt_step(m_2,(2369829601u - _e3));uint
_e6=rsqrt_step(m_2,_e5);uint _e7=rsqrt_step(m_2,_e6);return _e7;}int exp2_q15_(int f_q15_){int p_1=0;
p_1=(((256*f_q15_)+ 16384)>>15u);int _e8=p_1;p_1=((((_e8 - 1820)*f_q15_)+ 16384)>>15u);int _e16=p_1;p_1=((((_e16 +
7904)*f_q15_)+ 16384)>>15u);int _e24=p_1;p_1=((((_e24 - 22724)*f_q15_)+ 16384)>>15u);int _e32=p_1;return(32768 + _e32);}
uint half_of(uint word,uint i){return((word>>(16u*(i%2u)))&65535u);}uint axis_bits(ivec3 falls_q16_){uint
_e3=_group_0_binding_1_cs.profile;bool small=(_e3==SMALL);int gap=(min(abs((falls_q16_.y - falls_q16_.x)),
abs((falls_q16_.z - falls_q16_.x)))>>4u);return uint(min(((small?8:11)+((5*gap)>>16u)),(small?10:14)));}ivec3
falls_of(uint scale_word,uint step_q24_){uvec3 code_7=((uvec3(scale_word)>>uvec3(0u,10u,19u))&uvec3(1023u,1023u,1022u));
return ivec3(((((code_7*code_7)*step_q24_)+ uvec3(128u))>>uvec3(8u)));}bool axes_of(inout Axes axes,int x_8,int y){uint
square_q30_=(uint((x_8*x_8))+ uint((y*y)));if((square_q30_>1073741824u)){return false;}uint m_4=(2147483648u -
square_q30_);uint _e13=rsqrt(m_4);uint _e14=mul_high(m_4,_e13);int s_q15_=int(((_e14 + 8192u)>>14u));int
xx_q15_=(((x_8*x_8)+ 16384)>>15u);int yy_q15_=(((y*y)+ 16384)>>15u);int xy_q15_1=(((x_8*y)+ 16384)>>15u);int
xs_q15_=(((x_8*s_q15_)+ 16384)>>15u);int ys_q15_=(((y*s_q15_)+ 16384)>>15u);axes.axis_q15_=ivec3(xs_q15_,ys_q15_,
(int(((m_4 + 16384u)>>15u))- 32768));axes.side_x_q15_=ivec3((32768 - xx_q15_),-(xy_q15_1),-(xs_q15_));
axes.side_y_q15_=ivec3(-(xy_q15_1),(32768 - yy_q15_),-(ys_q15_));return true;}bool read_axes(inout Axes axes_1,uint
word_1,uint bits){bool _e10=axes_of(axes_1,(int(word_1)>>16u),(int((word_1<<bits))>>16u));if(!(_e10)){return false;}int
u=(int((word_1<<(2u*bits)))>>16u);int uu_q15_=(((u*u)+ 16384)>>15u);int _e26=fxs_mul_q15_(uu_q15_,7373);int
_e29=fxs_mul_q15_(uu_q15_,(40141 - _e26));axes_1.cos_q15_=(32768 - _e29);int _e34=fxs_mul_q15_(uu_q15_,2066);int
_e37=fxs_mul_q15_(uu_q15_,(20619 - _e34));int _e40=fxs_mul_q15_(u,(51317 - _e37));axes_1.sin_q15_=_e40;return true;}
uint byte_at(uint byte){uint _e5=_group_1_binding_0_cs[(byte/4u)];return((_e5>>(8u*(byte%4u)))&255u);}uint
spread_11_(uint code_2){return((code_2<<5u)|(code_2>>6u));}uint spread_scale(uint x_15,uint y_1,uint z_1){
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
Codes(uvec3(_e14,_e20,_e26),_e33,_e39,_e45);}int signed_half(uint word_3,uint i_7){return(int((word_3<<(16u
-(16u*(i_7%2u)))))>>16u);}Moment moment_of(uint place){uint _e4=_group_0_binding_0_cs.moments;uint
low_5=_group_1_binding_1_cs[(_e4 +(2u*place))];uint _e13=_group_0_binding_0_cs.moments;uint
high_4=_group_1_binding_1_cs[((_e13 +(2u*place))+ 1u)];int _e22=signed_half(low_5,0u);int _e24=signed_half(low_5,1u);
int _e26=signed_half(high_4,0u);return Moment(ivec3(_e22,_e24,_e26),(int((high_4<<8u))>>24u));}int motion_code(uint
row_1,uint g_5){uint _e7=_group_1_binding_0_cs[(row_1 +(g_5/2u))];int _e8=signed_half(_e7,g_5);return _e8;}ivec3
motion_codes(uint row_2,uint g_6){int _e2=motion_code(row_2,g_6);int _e5=motion_code((row_2 + ROW),g_6);int
_e8=motion_code((row_2 + 256u),g_6);return ivec3(_e2,_e5,_e8);}uvec3 drifted(uvec3 code_4,uint row_3,uint g_7,Moment
moment){ivec3 sum_3=ivec3(0);uint k_1=0u;for(;(k_1<_group_0_binding_1_cs.motion_degree);k_1=(k_1 + 1u)){{ivec3
_e14=sum_3;uint _e16=k_1;ivec3 _e19=motion_codes((row_3 +(384u*_e16)),g_7);uint _e21=k_1;sum_3=(_e14
+(((_e19*moment.power_q15_[_e21])+ ivec3(16384))>>uvec3(15u)));}}if((moment.shift>=0)){ivec3 _e37=sum_3;
sum_3=(_e37*(1<<uint(moment.shift)));}else{ivec3 _e43=sum_3;sum_3=((_e43 + ivec3((1<<uint((-(moment.shift)-
1)))))>>uvec3(uint(-(moment.shift))));}ivec3 _e59=sum_3;return uvec3(min(max((ivec3(code_4)+ _e59),ivec3(0)),
ivec3(65535)));}ivec4 turn_at(uint row_4,uint g_8,int u_q15_){int _e3=motion_code(row_4,g_8);ivec3
_e6=motion_codes((row_4 + ROW),g_8);ivec4 codes_2=ivec4(_e3,_e6);ivec4 q_q13_=((((codes_2*u_q15_)+
ivec4(32768))>>uvec4(16u))+ ivec4(8192,0,0,0));uvec4 squares_q26_=uvec4((q_q13_*q_q13_));uint
square_q26_=max((((squares_q26_.x + squares_q26_.y)+ squares_q26_.z)+ squares_q26_.w),1u);int
_e32=zeros_of(square_q26_);uint zeros_4=(uint(_e32)&4294967294u);uint _e37=rsqrt((square_q26_<<zeros_4));int
inverse_q14_=int((_e37>>16u));return((((2*q_q13_)*inverse_q14_)+ ivec4((1<<(15u -(zeros_4/2u)))))>>uvec4((16u
-(zeros_4/2u))));}ivec3 products_q15_(ivec3 a_23,ivec3 b_24){return(((a_23*b_24)+ ivec3(16384))>>uvec3(15u));}int
sum_of_products_q15_(ivec3 a_24,ivec3 b_25){ivec3 _e2=products_q15_(a_24,b_25);return((_e2.x + _e2.y)+ _e2.z);}ivec3
cross_q15_(ivec3 a_25,ivec3 b_26){ivec3 _e4=products_q15_(a_25.yzx,b_26.zxy);ivec3 _e7=products_q15_(a_25.zxy,b_26.yzx);
return(_e4 - _e7);}ivec3 turned(ivec3 v_q15_,ivec4 turn_q15_){ivec3 _e3=cross_q15_(turn_q15_.yzw,v_q15_);ivec3
_e6=products_q15_(ivec3(turn_q15_.x),_e3);ivec3 _e8=cross_q15_(turn_q15_.yzw,_e3);return(v_q15_ +(2*(_e6 + _e8)));}uint
axis_code(int x_q15_,uint rest,uint bits_2){int most_1=((1<<(bits_2 - 1u))- 1);int code_9=(((x_q15_ - int((rest>>(16u +
bits_2))))+(1<<(15u - bits_2)))>>(16u - bits_2));return uint(min(max(code_9,(-(most_1)- 1)),most_1));}uint
axis_towards_0_(uint code_5){int x_18=int(code_5);return uint(((x_18>0)?(x_18 - 1):((x_18<-1)?(x_18 + 1):x_18)));}int
roll_of(inout Axes axes_4,ivec3 second_q15_){ivec3 _e3=axes_4.side_x_q15_;int _e4=sum_of_products_q15_(second_q15_,_e3);
ivec3 _e6=axes_4.side_y_q15_;int _e7=sum_of_products_q15_(second_q15_,_e6);int d_2=(_e7*((_e4<0)?-1:1));uint
_e22=reciprocal((uint((32768 + min(abs(_e4),32767)))<<16u));int inverse_q15_=int((_e22>>16u));int
_e29=fxs_mul_q15_(min(max(d_2,-32768),32768),inverse_q15_);int t_q15_1=min(max(_e29,-32767),32767);int
_e33=fxs_mul_q15_(t_q15_1,t_q15_1);int _e35=fxs_mul_q15_(_e33,1627);int _e38=fxs_mul_q15_(_e33,(6102 - _e35));int
_e41=fxs_mul_q15_(_e33,(13400 - _e38));int factor_q15_=(41689 - _e41);int _e44=fxs_mul_q15_(t_q15_1,factor_q15_);return
min(max(_e44,-32768),32767);}uint rotation_word_1(int x_q15_1,int y_q15_,int u_q15_1,uint bits_3,uint roll){uint
behind_y=(uint(((u_q15_1 +(1<<(15u - roll)))>>(16u - roll)))<<(32u - roll));uint _e17=axis_code(y_q15_,behind_y,bits_3);
uint behind_x=((_e17<<(32u - bits_3))|(behind_y>>bits_3));uint _e23=axis_code(x_q15_1,behind_x,bits_3);uint
word_7=((_e23<<(32u - bits_3))|(behind_x>>bits_3));int x_read=(int(word_7)>>16u);int y_read=(int(behind_x)>>16u);
if(((uint((x_read*x_read))+ uint((y_read*y_read)))<=1073741824u)){return word_7;}uint _e42=axis_towards_0_(_e23);uint
_e46=axis_towards_0_(_e17);return((_e42<<(32u - bits_3))|(((_e46<<(32u - bits_3))|(behind_y>>bits_3))>>bits_3));}uint
write_axes(ivec3 first_q15_,ivec3 second_q15_1,uint bits_4){ivec2 xy_q15_=ivec2(0);Axes axes_5=Axes(ivec3(0),ivec3(0),
ivec3(0),0,0);int z_q15_=min(abs(first_q15_.z),32767);uint _e12=rsqrt((uint((32768 + z_q15_))<<15u));int
inverse_q14_1=int((_e12>>16u));xy_q15_=((((((first_q15_.z<0)?-1:1)*first_q15_.xy)*inverse_q14_1)+
ivec2(16384))>>uvec2(15u));int _e34=xy_q15_.x;int _e36=xy_q15_.y;bool _e37=axes_of(axes_5,_e34,_e36);if(!(_e37)){ivec2
_e39=xy_q15_;ivec2 _e40=xy_q15_;xy_q15_=(_e39 -(_e40>>uvec2(10u)));int _e46=xy_q15_.x;int _e48=xy_q15_.y;bool
_e49=axes_of(axes_5,_e46,_e48);if(!(_e49)){return 0u;}}uint _e56=_group_0_binding_1_cs.profile;uint
roll_1=(((_e56==SMALL)?23u:32u)-(2u*bits_4));int _e64=xy_q15_.x;int _e66=xy_q15_.y;int _e67=roll_of(axes_5,
second_q15_1);uint _e68=rotation_word_1(_e64,_e66,_e67,bits_4,roll_1);return _e68;}uint turned_word(uint word_4,uint
bits_5,ivec4 turn_q15_1){Axes axes_6=Axes(ivec3(0),ivec3(0),ivec3(0),0,0);bool _e4=read_axes(axes_6,word_4,bits_5);
if(!(_e4)){return word_4;}ivec3 _e7=axes_6.side_x_q15_;int _e9=axes_6.cos_q15_;ivec3 _e12=axes_6.side_y_q15_;int
_e14=axes_6.sin_q15_;ivec3 second_q15_2=((((_e7*_e9)+(_e12*_e14))+ ivec3(16384))>>uvec3(15u));ivec3
_e24=axes_6.axis_q15_;ivec3 _e25=turned(_e24,turn_q15_1);ivec3 _e26=turned(second_q15_2,turn_q15_1);uint
_e27=write_axes(_e25,_e26,bits_5);return _e27;}uint faded(uint code_6,uint row_5,uint g_9,int u_q15_2){int
_e8=motion_code(row_5,g_9);uint distance_q13_=uint(abs((((u_q15_2 + 2)>>2u)- _e8)));uint
_e19=_group_1_binding_0_cs[((row_5 + ROW)+(g_9/2u))];uint _e20=half_of(_e19,g_9);int
_e26=exp2_q15_((int((_e20&4095u))<<3u));uint product_q13_=((distance_q13_*uint(_e26))>>15u);uint octaves=(_e20>>12u);
uint widths_q13_=((product_q13_<<(8u - min(octaves,8u)))>>(max(octaves,8u)- 8u));uint widths_q12_=(min(widths_q13_,
32766u)>>1u);uint octaves_q16_=((widths_q12_*widths_q12_)>>8u);uint _e52=_group_0_binding_1_cs.motion_cut_q16_;
if((octaves_q16_>_e52)){return 0u;}int _e60=exp2_q15_(int(((octaves_q16_&65535u)>>1u)));uint
left_q15_=(uint(_e60)>>(octaves_q16_>>16u));return(((code_6*left_q15_)+ 16384u)>>15u);}uvec4 animated(uint rows_5,uint
g_10,Moment moment_1,uint scale_step_q24_){uint row_6=0u;uvec3 position_2=uvec3(0u);uint rotation=0u;uint opacity=0u;
Codes _e4=codes_of(rows_5,g_10);uint _e7=_group_0_binding_1_cs.motion_at;row_6=(rows_5 + _e7);uint _e11=row_6;uvec3
_e12=drifted(_e4.position,_e11,g_10,moment_1);position_2=_e12;rotation=_e4.rotation;opacity=(_e4.colour>>24u);uint
_e20=row_6;uint _e24=_group_0_binding_1_cs.motion_degree;row_6=(_e20 +(384u*_e24));uint
_e29=_group_0_binding_1_cs.profile;if((_e29==SMALL)){uint _e33=position_2.x;uint _e36=spread_11_((_e33>>5u));uint
_e38=position_2.y;uint _e41=spread_11_((_e38>>5u));uint _e43=position_2.z;uint _e46=spread_11_((_e43>>5u));
position_2=uvec3(_e36,_e41,_e46);}uint _e50=_group_0_binding_1_cs.motion_flags;if(((_e50&MOTION_TURNS)!=0u)){ivec3
_e56=falls_of(_e4.scale,scale_step_q24_);uint _e57=axis_bits(_e56);uint _e58=rotation;uint _e59=row_6;ivec4
_e62=turn_at(_e59,g_10,moment_1.power_q15_.x);uint _e63=turned_word(_e58,_e57,_e62);rotation=_e63;uint _e64=row_6;
row_6=(_e64 + 512u);}uint _e69=_group_0_binding_1_cs.motion_flags;if(((_e69&MOTION_FADES)!=0u)){uint _e74=opacity;uint
_e75=row_6;uint _e78=faded(_e74,_e75,g_10,moment_1.power_q15_.x);opacity=_e78;}uint _e80=position_2.x;uint
_e82=position_2.y;uint _e87=position_2.z;uint _e88=opacity;uint _e92=rotation;return uvec4((_e80|(_e82<<16u)),
(_e87|(_e88<<16u)),_e92,0u);}Half half_of_chunk(uvec3 group_2){Half here=Half(0u,0u,0u,false);uint
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
_e10=_group_0_binding_1_cs.chunk_words;return(_e3 +((index - _e6)*_e10));}void main(){uvec3 group=gl_WorkGroupID;uint
thread=gl_LocalInvocationIndex;Half _e2=half_of_chunk(group);if(_e2.inside){uint slot_4=(_e2.first_slot + thread);uint
_e9=_group_0_binding_0_cs.records;uint scale_step_q24_1=_group_1_binding_1_cs[((_e9 +(RECORD*_e2.place))+ 16u)];uint
_e23=rows_at(_e2.index);Moment _e27=moment_of(_e2.place);uvec4 _e28=animated(_e23,(slot_4%CHUNK),_e27,scale_step_q24_1);
_group_1_binding_3_cs[(2u*slot_4)]=_e28;return;}else{return;}}
