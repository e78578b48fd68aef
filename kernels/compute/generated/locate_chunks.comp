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
motion_degree;uint motion_cut_q16_;uint motion_flags;uvec4 crops[32];};struct Located{uvec2 base_q16_[3];int m_q16_[9];
int scale_q16_;int shift;int plane_zeros;int near;};const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;const uint
RECORD=64u;const uint DRAWN=3u;const uvec2 LIMIT_Q32_=uvec2(0u,268435456u);layout(std140,binding=0)uniform
Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std140,binding=1)uniform Object_block_1Compute{Object
_group_0_binding_1_cs;};layout(std430,binding=0)readonly buffer type_13_block_2Compute{uint _group_1_binding_0_cs[];};
layout(std430,binding=1)buffer type_13_block_3Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)buffer
type_15_block_4Compute{uint _group_1_binding_2_cs[];};shared uint seen_bits[4];uvec2 wide_of(int x){return
uvec2(uint(x),uint((x>>31u)));}uvec2 add_wide(uvec2 a,uvec2 b){uint low_3=(a.x + b.x);return uvec2(low_3,((a.y +
b.y)+((low_3<a.x)?1u:0u)));}uvec2 sub_wide(uvec2 a_1,uvec2 b_1){return uvec2((a_1.x - b_1.x),((a_1.y -
b_1.y)-((a_1.x<b_1.x)?1u:0u)));}bool is_negative(uvec2 a_2){return(int(a_2.y)<0);}uvec2 negate(uvec2 a_3){uvec2
_e5=add_wide(~(a_3),uvec2(1u,0u));return _e5;}uvec2 magnitude(uvec2 a_4){bool _e1=is_negative(a_4);if(_e1){uvec2
_e2=negate(a_4);return _e2;}return a_4;}bool less(uvec2 a_5,uvec2 b_2){
return((a_5.y==b_2.y)?(a_5.x<b_2.x):(int(a_5.y)<int(b_2.y)));}uvec2 mul_wide(uint a_6,uint b_3){uint high;uint low;
umulExtended(a_6,b_3,high,low);return uvec2(low,high);}uvec2 mul_mixed(int a_8,uint b_5){uvec2 _e3=mul_wide(uint(a_8),
b_5);return uvec2(_e3.x,(_e3.y -((a_8<0)?b_5:0u)));}uvec2 mul_signed(int a_9,int b_6){uvec2 _e3=mul_mixed(a_9,
uint(b_6));return uvec2(_e3.x,(_e3.y -((b_6<0)?uint(a_9):0u)));}uvec2 mul_word(uvec2 a_10,uint b_7){uvec2
_e3=mul_wide(a_10.x,b_7);return uvec2(_e3.x,(_e3.y +(a_10.y*b_7)));}uvec2 shift_left(uvec2 a_11,uint n){if((n==0u)){
return a_11;}if((n>=32u)){return uvec2(0u,(a_11.x<<(n - 32u)));}return uvec2((a_11.x<<n),((a_11.y<<n)|(a_11.x>>(32u -
n))));}uvec2 shift_right(uvec2 a_12,uint n_1){if((n_1==0u)){return a_12;}if((n_1>=32u)){return uvec2((a_12.y>>(n_1 -
32u)),0u);}return uvec2(((a_12.x>>n_1)|(a_12.y<<(32u - n_1))),(a_12.y>>n_1));}uvec2 shift_signed(uvec2 a_13,uint n_2){
int high_4=int(a_13.y);if((n_2==0u)){return a_13;}if((n_2>=32u)){return uvec2(uint((high_4>>(n_2 - 32u))),
uint((high_4>>31u)));}return uvec2(((a_13.x>>n_2)|(a_13.y<<(32u - n_2))),uint((high_4>>n_2)));}int low_of(uvec2 a_15){
return int(a_15.x);}int zeros_of(uint x_2){return int(uint(31 - findMSB(x_2)));}int zeros_of_wide(uvec2 x_3){int
_e2=zeros_of(x_3.x);int _e6=zeros_of(x_3.y);return((x_3.y!=0u)?_e6:(32 + _e2));}int exp2_q15_(int f_q15_){int p=0;
p=(((256*f_q15_)+ 16384)>>15u);int _e8=p;p=((((_e8 - 1820)*f_q15_)+ 16384)>>15u);int _e16=p;p=((((_e16 + 7904)*f_q15_)+
16384)>>15u);int _e24=p;p=((((_e24 - 22724)*f_q15_)+ 16384)>>15u);int _e32=p;return(32768 + _e32);}uint half_of(uint
word,uint i){return((word>>(16u*(i%2u)))&65535u);}uvec2 crop_bound(uint crop,uint i_1,bool high){uint
word_1=((2u*i_1)+(high?6u:0u));uvec4 four=_group_0_binding_1_cs.crops[((4u*crop)+(word_1/4u))];
return(((word_1%4u)==2u)?four.zw:four.xy);}bool lies_in(inout uvec2 low[3],inout uvec2 high_1[3],uint crop_1,bool any_){
bool inside=true;uint i_2=0u;bool local_1=false;bool local_2=false;for(;(i_2<3u);i_2=(i_2 + 1u)){{uint _e11=i_2;uvec2
_e13=low[_e11];uint _e14=i_2;uvec2 _e16=high_1[_e14];uvec2 first=(any_?_e16:_e13);uint _e18=i_2;uvec2 _e20=high_1[_e18];
uint _e21=i_2;uvec2 _e23=low[_e21];uvec2 last=(any_?_e23:_e20);bool _e25=inside;if(_e25){uint _e28=i_2;uvec2
_e30=crop_bound(crop_1,_e28,false);bool _e31=less(first,_e30);local_1=!(_e31);}else{local_1=false;}bool _e34=local_1;
if(_e34){uint _e37=i_2;uvec2 _e39=crop_bound(crop_1,_e37,true);bool _e40=less(_e39,last);local_2=!(_e40);}else{
local_2=false;}bool _e43=local_2;inside=_e43;}}bool _e47=inside;return _e47;}bool is_within_crops(inout uvec2 low_1[3],
inout uvec2 high_2[3]){bool kept=false;uint crop_2=0u;bool local_3=false;bool local_4=false;bool local_5=false;uint
_e4=_group_0_binding_1_cs.keep_count;kept=(_e4==0u);for(;(crop_2<_group_0_binding_1_cs.crop_count);crop_2=(crop_2 +
1u)){{uint _e18=crop_2;uint _e24=_group_0_binding_1_cs.crops[((4u*_e18)+ 3u)].x;bool outside=(_e24!=0u);if(outside){
uint _e29=crop_2;bool _e31=lies_in(low_1,high_2,_e29,false);local_3=_e31;}else{local_3=false;}bool _e33=local_3;
if(_e33){return false;}bool _e35=kept;if(!(_e35)){if(!(outside)){uint _e42=crop_2;bool _e44=lies_in(low_1,high_2,_e42,
true);local_5=_e44;}else{local_5=false;}bool _e46=local_5;local_4=_e46;}else{local_4=true;}bool _e48=local_4;kept=_e48;}
}bool _e52=kept;return _e52;}bool is_within(uvec2 x_7,uvec2 most){bool local_6=false;bool _e2=less(most,x_7);if(!(_e2)){
uvec2 _e6=negate(most);bool _e7=less(x_7,_e6);local_6=!(_e7);}else{local_6=false;}bool _e10=local_6;return _e10;}uvec2
origin_of(uint at,uint i_3){uint _e7=_group_1_binding_0_cs[(at +(2u*i_3))];uint _e15=_group_1_binding_0_cs[((at
+(2u*i_3))+ 1u)];return uvec2(_e7,_e15);}uint step_shift_of(uint at_1){uint _e5=_group_1_binding_0_cs[(at_1 + 18u)];
return(_e5>>16u);}uvec2 reach_of(uint at_2,uint i_4){uint _e7=_group_1_binding_0_cs[((at_2 + 6u)+ i_4)];uvec2
_e9=mul_wide(_e7,65535u);uint _e10=step_shift_of(at_2);uvec2 _e11=shift_left(_e9,_e10);return _e11;}bool is_valid(uint
at_3){bool local_7=false;bool local_8=false;bool valid=false;uint i_5=0u;bool local_9=false;bool local_10=false;bool
local_11=false;bool local_12=false;bool local_13=false;uint codes=_group_1_binding_0_cs[(at_3 + 19u)];uint
_e10=_group_1_binding_0_cs[(at_3 + 9u)];int scale_q16_=int(_e10);uint _e12=step_shift_of(at_3);if(!((_e12>12u))){
local_7=((codes>>16u)>=4u);}else{local_7=true;}bool _e23=local_7;if(!(_e23)){local_8=(abs(scale_q16_)>2097152);}else{
local_8=true;}bool _e31=local_8;if(_e31){return false;}uvec2 _e36=mul_wide((codes&65535u),1046529u);uvec2
_e38=shift_right(_e36,8u);int _e39=low_of(_e38);valid=((scale_q16_ - _e39)>=-2097152);for(;(i_5<3u);i_5=(i_5 + 1u)){{
uint _e52=i_5;uint _e55=_group_1_binding_0_cs[((at_3 + 10u)+ _e52)];uvec2 _e57=wide_of(int(_e55));uint _e61=i_5;uint
_e64=_group_1_binding_0_cs[((at_3 + 13u)+ _e61)];uvec2 _e66=mul_wide(_e64,255u);uvec2 _e68=shift_right(_e66,4u);uint
_e72=i_5;uint _e77=_group_1_binding_0_cs[((at_3 + 17u)+(_e72/2u))];uint _e78=i_5;uint _e79=half_of(_e77,_e78);bool
_e80=valid;if(_e80){uint _e83=i_5;uvec2 _e84=origin_of(at_3,_e83);bool _e86=is_within(_e84,LIMIT_Q32_);local_9=_e86;}
else{local_9=false;}bool _e88=local_9;if(_e88){uint _e91=i_5;uvec2 _e92=origin_of(at_3,_e91);uint _e93=i_5;uvec2
_e94=reach_of(at_3,_e93);uvec2 _e95=add_wide(_e92,_e94);bool _e97=is_within(_e95,LIMIT_Q32_);local_10=_e97;}else{
local_10=false;}bool _e99=local_10;if(_e99){bool _e105=is_within(_e57,uvec2(4194304u,0u));local_11=_e105;}else{
local_11=false;}bool _e107=local_11;if(_e107){uvec2 _e110=add_wide(_e57,_e68);bool _e114=is_within(_e110,uvec2(4194304u,
0u));local_12=_e114;}else{local_12=false;}bool _e116=local_12;if(_e116){local_13=(_e79<=32767u);}else{local_13=false;}
bool _e122=local_13;valid=_e122;}}bool _e126=valid;return _e126;}Located locate(uint at_4){Located
l=Located(uvec2[3](uvec2(0u),uvec2(0u),uvec2(0u)),int[9](0,0,0,0,0,0,0,0,0),0,0,0,0);uvec2 offset[3]=uvec2[3](uvec2(0u),
uvec2(0u),uvec2(0u));uvec2 most_1=uvec2(0u,0u);uint i_6=0u;bool local_14=false;uint i_7=0u;uvec2 base_q30_=uvec2(0u);
uint j=0u;for(;(i_6<3u);i_6=(i_6 + 1u)){{uint _e12=i_6;uint _e14=i_6;uvec2 _e15=origin_of(at_4,_e14);uint _e18=i_6;
uvec4 _e20=_group_0_binding_1_cs.position_q32_[_e18];uvec2 _e22=sub_wide(_e15,_e20.xy);offset[_e12]=_e22;uvec2
_e23=most_1;uint _e24=i_6;uvec2 _e26=offset[_e24];uvec2 _e27=magnitude(_e26);uint _e28=i_6;uvec2 _e29=reach_of(at_4,
_e28);uvec2 _e30=add_wide(_e27,_e29);most_1=(_e23|_e30);}}uvec2 _e35=most_1;int _e36=zeros_of_wide(_e35);uint
_e40=most_1.x;uint _e42=most_1.y;int bits=(((_e40|_e42)!=0u)?(64 - _e36):0);uint _e53=_group_1_binding_0_cs[(at_4 +
9u)];l.scale_q16_=int(_e53);l.shift=max((bits - 29),0);int _e62=l.shift;int _e65=_group_0_binding_1_cs.plane_exponent;
l.plane_zeros=min(max((_e62 - _e65),-22),38);uvec2 _e72=_group_0_binding_1_cs.near_q32_;int _e74=l.shift;uvec2
_e76=shift_signed(_e72,uint(_e74));int _e78=low_of(_e76);if((_e76.y==0u)){int _e84=low_of(_e76);local_14=(_e84>=0);}
else{local_14=false;}bool _e88=local_14;l.near=(_e88?_e78:2147483647);for(;(i_7<3u);i_7=(i_7 + 1u)){{base_q30_=uvec2(0u,
0u);j=0u;for(;(j<3u);j=(j + 1u)){{uint _e107=i_7;uint _e109=j;int
r_q30_=_group_0_binding_1_cs.rotation_q30_[_e107][_e109];uvec2 _e112=base_q30_;uint _e113=j;uvec2 _e115=offset[_e113];
int _e117=l.shift;uvec2 _e119=shift_signed(_e115,uint(_e117));int _e120=low_of(_e119);uvec2 _e121=mul_signed(r_q30_,
_e120);uvec2 _e122=add_wide(_e112,_e121);base_q30_=_e122;uint _e126=j;uint _e129=_group_1_binding_0_cs[((at_4 + 6u)+
_e126)];uvec2 _e130=mul_mixed(r_q30_,_e129);uvec2 _e132=shift_signed(_e130,14u);uint _e135=i_7;uint _e137=j;uint
_e140=step_shift_of(at_4);uvec2 _e141=shift_left(_e132,_e140);int _e143=l.shift;uvec2 _e145=shift_signed(_e141,
uint(_e143));int _e146=low_of(_e145);l.m_q16_[((3u*_e135)+ _e137)]=_e146;}}uint _e151=i_7;uvec2 _e153=base_q30_;uvec2
_e155=shift_signed(_e153,14u);l.base_q16_[_e151]=_e155;}}Located _e159=l;return _e159;}uvec2 reach_across(inout Located
l_1){int _e2=l_1.scale_q16_;int _e4=l_1.shift;int _e9=_group_0_binding_1_cs.jacobian_exponent;int log2_q16_1=(_e2
+(((32 - _e4)+ _e9)*65536));int whole=-((-(log2_q16_1)>>16u));if((whole>40)){return uvec2(4294967295u,536870911u);}
if((whole<0)){return uvec2(4u,0u);}int _e33=exp2_q15_(((-(log2_q16_1)&65535)>>1u));uint size_q15_=uint(_e33);uvec2
_e38=shift_left(uvec2(size_q15_,0u),uint(whole));uvec2 _e40=shift_right(_e38,15u);uvec2 _e42=mul_word(_e40,7u);uvec2
_e44=shift_right(_e42,1u);uvec2 _e48=add_wide(_e44,uvec2(4u,0u));return _e48;}uvec2 farthest(inout Located l_2,uint i_8,
int sign_,int slope_q23_){uvec2 across=uvec2(0u);int slope_of_z_q23_=0;uvec2 sum=uvec2(0u);uint j_1=0u;int
_e5=l_2.plane_zeros;int shift_1=(9 - _e5);uvec2 _e10=l_2.base_q16_[2];uvec2 _e12=shift_signed(_e10,16u);int
_e13=low_of(_e12);uvec2 _e14=mul_signed(slope_q23_,_e13);uvec2 _e16=shift_signed(_e14,23u);across=_e16;
slope_of_z_q23_=slope_q23_;int _e21=_group_0_binding_1_cs.orthographic;if((_e21!=0)){uvec2 _e24=wide_of(slope_q23_);
uvec2 _e28=shift_left(_e24,uint(max(shift_1,0)));across=_e28;if((shift_1<0)){uvec2 _e31=wide_of(slope_q23_);uvec2
_e34=shift_signed(_e31,uint(-(shift_1)));across=_e34;}slope_of_z_q23_=0;}uvec2 _e38=l_2.base_q16_[i_8];uvec2
_e40=shift_signed(_e38,16u);int _e41=low_of(_e40);int axis=((sign_*_e41)+ 2);uvec2 _e45=wide_of(axis);uvec2 _e46=across;
uvec2 _e47=sub_wide(_e45,_e46);sum=_e47;for(;(j_1<3u);j_1=(j_1 + 1u)){{uint _e57=j_1;int _e60=l_2.m_q16_[((3u*i_8)+
_e57)];uvec2 _e62=wide_of((sign_*_e60));int _e63=slope_of_z_q23_;uint _e66=j_1;int _e69=l_2.m_q16_[(6u + _e66)];uvec2
_e70=mul_signed(_e63,_e69);uvec2 _e72=shift_signed(_e70,23u);uvec2 _e73=sub_wide(_e62,_e72);bool _e77=less(uvec2(0u,0u),
_e73);if(_e77){uvec2 _e79=shift_left(_e73,16u);uvec2 _e80=sub_wide(_e79,_e73);uvec2 _e82=shift_right(_e80,16u);uvec2
_e83=sum;uvec2 _e87=add_wide(_e82,uvec2(1u,0u));uvec2 _e88=add_wide(_e83,_e87);sum=_e88;}}}uvec2 _e92=sum;return _e92;}
bool lies_beyond(inout Located l_3,uint i_9,int sign_1,int slope_q23_1,uvec2 reach){uvec2 _e5=farthest(l_3,i_9,sign_1,
slope_q23_1);uvec2 _e6=add_wide(_e5,reach);bool _e7=is_negative(_e6);return _e7;}bool can_be_seen(inout Located l_4){
uvec2 z_q16_=uvec2(0u);uint j_2=6u;uint i_10=0u;bool local_15=false;uvec2 _e3=l_4.base_q16_[2];z_q16_=_e3;for(;(j_2<9u);
j_2=(j_2 + 1u)){{uvec2 _e10=z_q16_;uint _e12=j_2;int _e14=l_4.m_q16_[_e12];uvec2 _e18=mul_signed(max(_e14,0),65535);
uvec2 _e19=add_wide(_e10,_e18);z_q16_=_e19;}}int _e24=l_4.near;uvec2 _e25=wide_of(_e24);uvec2 _e26=z_q16_;uvec2
_e28=shift_signed(_e26,16u);bool _e29=less(_e25,_e28);if(!(_e29)){return false;}int _e34=_group_0_binding_0_cs.cutoff;
if((_e34==1)){return true;}uvec2 _e38=reach_across(l_4);for(;(i_10<2u);i_10=(i_10 + 1u)){{uint _e44=i_10;uint _e48=i_10;
int _e50=_group_0_binding_1_cs.edge_low_q23_[_e48];bool _e51=lies_beyond(l_4,_e44,1,_e50,_e38);if(!(_e51)){uint
_e55=i_10;uint _e59=i_10;int _e61=_group_0_binding_1_cs.edge_high_q23_[_e59];bool _e63=lies_beyond(l_4,_e55,-1,-(_e61),
_e38);local_15=_e63;}else{local_15=true;}bool _e65=local_15;if(_e65){return false;}}}return true;}bool has_chunk(uint
at_5){uvec2 low_2[3]=uvec2[3](uvec2(0u),uvec2(0u),uvec2(0u));uvec2 high_3[3]=uvec2[3](uvec2(0u),uvec2(0u),uvec2(0u));
uint i_11=0u;bool local_16=false;for(;(i_11<3u);i_11=(i_11 + 1u)){{uint _e8=i_11;uint _e10=i_11;uvec2
_e11=origin_of(at_5,_e10);low_2[_e8]=_e11;uint _e12=i_11;uint _e14=i_11;uvec2 _e16=low_2[_e14];uint _e17=i_11;uvec2
_e18=reach_of(at_5,_e17);uvec2 _e19=add_wide(_e16,_e18);high_3[_e12]=_e19;}}uint _e25=_group_0_binding_1_cs.crop_count;
if(!((_e25==0u))){bool _e31=is_within_crops(low_2,high_3);local_16=_e31;}else{local_16=true;}bool _e33=local_16;return
_e33;}void put_wide(uint at_6,uvec2 x_8){_group_1_binding_1_cs[at_6]=x_8.x;_group_1_binding_1_cs[(at_6 + 1u)]=x_8.y;
return;}void put_record(uint to,uint at_7,inout Located l_5,uint share_q8_){uint i_12=0u;uint i_13=0u;uint i_14=0u;int
_e5=l_5.plane_zeros;int _e14=l_5.plane_zeros;int plane_side=((_e14>7)?(1<<uint((38 - min(_e5,38)))):2147483647);for(;
(i_12<3u);i_12=(i_12 + 1u)){{uint _e25=i_12;uint _e29=i_12;uvec2 _e31=l_5.base_q16_[_e29];put_wide((to +(2u*_e25)),
_e31);uint _e35=i_12;uint _e38=i_12;uvec2 _e39=origin_of(at_7,_e38);uint _e42=i_12;uvec4
_e44=_group_0_binding_1_cs.eye_q32_[_e42];uvec2 _e46=sub_wide(_e39,_e44.xy);put_wide(((to + 22u)+(2u*_e35)),_e46);uint
_e50=i_12;uint _e53=i_12;uvec2 _e54=origin_of(at_7,_e53);put_wide(((to + 28u)+(2u*_e50)),_e54);uint _e58=i_12;uint
_e64=i_12;uint _e67=_group_1_binding_0_cs[((at_7 + 6u)+ _e64)];_group_1_binding_1_cs[((to + 34u)+ _e58)]=_e67;uint
_e71=i_12;uint _e77=i_12;uint _e80=_group_1_binding_0_cs[((at_7 + 10u)+ _e77)];_group_1_binding_1_cs[((to + 38u)+
_e71)]=_e80;uint _e84=i_12;uint _e90=i_12;uint _e93=_group_1_binding_0_cs[((at_7 + 13u)+ _e90)];
_group_1_binding_1_cs[((to + 41u)+ _e84)]=_e93;uint _e97=i_12;uint _e103=i_12;uint _e108=_group_1_binding_0_cs[((at_7 +
17u)+(_e103/2u))];uint _e109=i_12;uint _e110=half_of(_e108,_e109);_group_1_binding_1_cs[((to + 44u)+ _e97)]=_e110;}}
for(;(i_13<9u);i_13=(i_13 + 1u)){{uint _e122=i_13;uint _e126=i_13;int _e128=l_5.m_q16_[_e126];
_group_1_binding_1_cs[((to + 6u)+ _e122)]=uint(_e128);}}int _e138=l_5.scale_q16_;_group_1_binding_1_cs[(to +
15u)]=uint(_e138);uint _e148=_group_1_binding_0_cs[(at_7 + 19u)];_group_1_binding_1_cs[(to + 16u)]=(_e148&65535u);uint
_e159=_group_1_binding_0_cs[(at_7 + 19u)];_group_1_binding_1_cs[(to + 17u)]=(_e159>>16u);int _e167=l_5.shift;
_group_1_binding_1_cs[(to + 18u)]=uint(_e167);int _e174=l_5.plane_zeros;_group_1_binding_1_cs[(to + 19u)]=uint(_e174);
_group_1_binding_1_cs[(to + 20u)]=uint(plane_side);int _e186=l_5.near;_group_1_binding_1_cs[(to + 21u)]=uint(_e186);
uint _e192=step_shift_of(at_7);_group_1_binding_1_cs[(to + 37u)]=_e192;_group_1_binding_1_cs[(to + 47u)]=share_q8_;for(;
(i_14<12u);i_14=(i_14 + 1u)){{uint _e205=i_14;uint _e211=i_14;uint _e214=_group_1_binding_0_cs[((at_7 + 20u)+ _e211)];
_group_1_binding_1_cs[((to + 48u)+ _e205)]=_e214;}}return;}bool look_at(uint place){uint index=0u;uint drawn=256u;
Located l_6=Located(uvec2[3](uvec2(0u),uvec2(0u),uvec2(0u)),int[9](0,0,0,0,0,0,0,0,0),0,0,0,0);bool local_17=false;uint
_e3=_group_0_binding_1_cs.first_chunk;index=(place - _e3);uint _e10=_group_0_binding_0_cs.drawn;if((_e10!=0u)){uint
_e16=_group_0_binding_0_cs.drawn;uint _e21=_group_1_binding_1_cs[(_e16 +(DRAWN*place))];index=_e21;uint
_e25=_group_0_binding_0_cs.drawn;uint _e32=_group_1_binding_1_cs[((_e25 +(DRAWN*place))+ 1u)];drawn=_e32;}uint
_e34=index;uint at_8=(32u*_e34);bool _e36=is_valid(at_8);if(!(_e36)){_group_1_binding_2_cs[3]=1u;return false;}Located
_e42=locate(at_8);l_6=_e42;int _e45=l_6.scale_q16_;uint _e46=drawn;l_6.scale_q16_=(_e45 +(int((_e46>>16u))<<8u));bool
_e53=can_be_seen(l_6);if(!(!(_e53))){bool _e58=has_chunk(at_8);local_17=!(_e58);}else{local_17=true;}bool _e61=local_17;
if(_e61){return false;}uint _e65=_group_0_binding_0_cs.records;uint _e69=drawn;put_record((_e65 +(RECORD*place)),at_8,
l_6,(_e69&65535u));return true;}void main(){uvec3 group=gl_WorkGroupID;uint thread=gl_LocalInvocationIndex;bool
local=false;uint _e4=_group_0_binding_1_cs.first_place;uint place_1=((((_e4/32u)*32u)+(((group.y*ROW_OF_GROUPS)+
group.x)*THREADS))+ thread);uint _e20=_group_0_binding_1_cs.first_place;if((place_1>=_e20)){uint
_e26=_group_0_binding_1_cs.end_place;local=(place_1<_e26);}else{local=false;}bool inside_1=local;if((thread<4u)){
seen_bits[thread]=0u;}memoryBarrierShared();barrier();if(inside_1){bool _e35=look_at(place_1);if(_e35){uint
_e44=atomicOr(seen_bits[(thread/32u)],(1u<<(thread%32u)));}}memoryBarrierShared();barrier();if((thread<4u)){uint
bits_1=seen_bits[thread];if((bits_1!=0u)){uint _e55=_group_0_binding_0_cs.seen;uint
_e62=atomicOr(_group_1_binding_2_cs[((_e55 +((place_1 - thread)/32u))+ thread)],bits_1);return;}else{return;}}else{
return;}}
