#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};struct Splat{uint u0_q24_;uint v0_q24_;int ux_q24_;int
uy_q24_;int vy_q24_;int offset_q11_;ivec2 rows;};struct Bounds{ivec2 c_q14_;uint breadth_q8_;int shear_q8_;int
half_width_q8_;uint square_radius;};struct Span{int first;int last;};const int FXS_FAINT_Q11_=22697;const uint
ROW_OF_GROUPS=32768u;const uint LARGE=8u;const int LARGE_ROWS=8;const uint BLOCK=512u;const uint CUT_OFF=2147483648u;
const uint TILES=64u;const uint LIST=8u;const int EVERYWHERE_Q8_=1073741824;layout(std140,binding=0)uniform
Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=0)readonly buffer type_13_block_1Compute{uvec4
_group_1_binding_0_cs[];};layout(std430,binding=1)readonly buffer type_14_block_2Compute{uint _group_1_binding_1_cs[];};
layout(std430,binding=2)buffer type_16_block_3Compute{uint _group_1_binding_2_cs[];};layout(std430,binding=3)buffer
type_14_block_4Compute{uint _group_1_binding_3_cs[];};shared ivec4 spans[8];int fxs_min(int a_1,int b_2){
return((a_1<b_2)?a_1:b_2);}int fxs_limit_q11_(int offset_q11_1,int cut_q11_){int _e4=fxs_min((offset_q11_1 + cut_q11_),
FXS_FAINT_Q11_);return _e4;}uvec2 add_wide(uvec2 a_3,uvec2 b_4){uint low=(a_3.x + b_4.x);return uvec2(low,((a_3.y +
b_4.y)+((low<a_3.x)?1u:0u)));}uvec2 negate(uvec2 a_6){uvec2 _e5=add_wide(~(a_6),uvec2(1u,0u));return _e5;}bool
less(uvec2 a_8,uvec2 b_6){return((a_8.y==b_6.y)?(a_8.x<b_6.x):(int(a_8.y)<int(b_6.y)));}uvec2 mul_wide(uint a_9,uint
b_7){uint high;uint low;umulExtended(a_9,b_7,high,low);return uvec2(low,high);}uint mul_high(uint a_10,uint b_8){uvec2
_e2=mul_wide(a_10,b_8);return _e2.y;}uvec2 mul_mixed(int a_11,uint b_9){uvec2 _e3=mul_wide(uint(a_11),b_9);return
uvec2(_e3.x,(_e3.y -((a_11<0)?b_9:0u)));}uvec2 mul_signed(int a_12,int b_10){uvec2 _e3=mul_mixed(a_12,uint(b_10));
return uvec2(_e3.x,(_e3.y -((b_10<0)?uint(a_12):0u)));}uvec2 shift_right(uvec2 a_15,uint n_1){if((n_1==0u)){return a_15;
}if((n_1>=32u)){return uvec2((a_15.y>>(n_1 - 32u)),0u);}return uvec2(((a_15.x>>n_1)|(a_15.y<<(32u - n_1))),
(a_15.y>>n_1));}uvec2 shift_signed(uvec2 a_16,uint n_2){int high=int(a_16.y);if((n_2==0u)){return a_16;}if((n_2>=32u)){
return uvec2(uint((high>>(n_2 - 32u))),uint((high>>31u)));}return uvec2(((a_16.x>>n_2)|(a_16.y<<(32u - n_2))),
uint((high>>n_2)));}int low_of(uvec2 a_18){return int(a_18.x);}int zeros_of(uint x_2){return int(uint(31 -
findMSB(x_2)));}uint rsqrt_step(uint m_1,uint y_q30_1){uint _e8=mul_high((2u*y_q30_1),y_q30_1);uint _e9=mul_high(m_1,
_e8);uint _e12=mul_high((2u*y_q30_1),(2u*(1610612736u - _e9)));return _e12;}uint rsqrt(uint m_2){uint _e3=mul_high(m_2,
1431655765u);uint _e5=rsqrt_step(m_2,(2369829601u - _e3));uint _e6=rsqrt_step(m_2,_e5);uint _e7=rsqrt_step(m_2,_e6);
return _e7;}uint sqrt_of(uint x_5){if((x_5==0u)){return 0u;}int _e4=zeros_of(x_5);uint shift=(uint(_e4)&4294967294u);
uint m_3=(x_5<<shift);uint _e9=rsqrt(m_3);uint _e10=mul_high(m_3,_e9);return(_e10>>(14u +(shift/2u)));}uint
list_of(uint tile){return(TILES +(LIST*tile));}Span columns_between(int left_q8_,int right_q8_){bool local_5=false;bool
local_6=false;int first=((left_q8_ + 255)>>8u);int last=(right_q8_>>8u);if(!((last<0))){int
_e16=_group_0_binding_0_cs.size.x;local_5=(first>=_e16);}else{local_5=true;}bool _e19=local_5;if(!(_e19)){
local_6=(first>last);}else{local_6=true;}bool _e25=local_6;if(_e25){return Span(0,-1);}uint
_e33=_group_0_binding_0_cs.tile_bits;uint _e37=_group_0_binding_0_cs.tile_bits;int _e42=_group_0_binding_0_cs.tiles.x;
int _e48=_group_0_binding_0_cs.size.x;return Span((max(first,0)>>_e33),((last>=_e48)?(_e42 - 1):(last>>_e37)));}int
radius_q12_(int offset_q11_2){int _e3=_group_0_binding_0_cs.cut_q11_;int _e4=fxs_limit_q11_(offset_q11_2,_e3);uint
_e11=sqrt_of((uint(((_e4 - offset_q11_2)+ 1))<<13u));return(int(_e11)+ 1);}int v_at_row(inout Splat s_1,inout Bounds
b_13,int row){int _e7=b_13.c_q14_.y;int _e10=s_1.vy_q24_;uvec2 _e11=mul_signed(((row<<14u)- _e7),_e10);uvec2
_e13=shift_signed(_e11,26u);int _e14=low_of(_e13);return _e14;}int half_at(inout Bounds b_14,int r_q12_,int v_q12_){
uint _e7=sqrt_of(uint(((r_q12_*r_q12_)-(v_q12_*v_q12_))));uint root=(_e7 + 1u);uint _e11=b_14.breadth_q8_;uvec2
_e12=mul_wide(_e11,root);uvec2 _e14=shift_right(_e12,12u);return int(_e14.x);}Span ellipse_span(inout Splat s_2,inout
Bounds b_15,int r,int row_1){bool local_7=false;bool local_8=false;int left=0;int right=0;uvec2 tangent=uvec2(0u);bool
local_9=false;bool local_10=false;uint _e6=_group_0_binding_0_cs.tile_bits;int _e8=v_at_row(s_2,b_15,(row_1<<_e6));uint
_e13=_group_0_binding_0_cs.tile_bits;int _e17=v_at_row(s_2,b_15,(((row_1 + 1)<<_e13)- 1));int reach=b_15.half_width_q8_;
if(!((_e8>(r + 2)))){local_7=(_e17<(-(r)- 2));}else{local_7=true;}bool _e31=local_7;if(_e31){
local_8=(reach!=EVERYWHERE_Q8_);}else{local_8=false;}bool _e37=local_8;if(_e37){return Span(0,-1);}int top=min(max(_e8,
-(r)),r);int bottom=min(max((_e17 + 1),-(r)),r);int _e48=b_15.shear_q8_;uvec2 _e49=mul_signed(_e48,top);uvec2
_e51=shift_signed(_e49,12u);int _e52=low_of(_e51);int _e54=b_15.shear_q8_;uvec2 _e55=mul_signed(_e54,bottom);uvec2
_e57=shift_signed(_e55,12u);int _e58=low_of(_e57);int _e59=half_at(b_15,r,top);int _e60=half_at(b_15,r,bottom);
left=-(max((_e59 - _e52),(_e60 - _e58)));right=max((_e59 + _e52),(_e60 + _e58));int _e71=b_15.shear_q8_;uvec2
_e75=mul_wide(uint(abs(_e71)),uint(r));uvec2 _e77=shift_right(_e75,12u);uvec2 _e80=mul_wide(_e77.x,uint(r));
tangent=_e80;int _e83=b_15.shear_q8_;if((_e83<0)){uvec2 _e86=tangent;uvec2 _e87=negate(_e86);tangent=_e87;}uvec2
_e88=tangent;uvec2 _e89=negate(_e88);uvec2 _e90=mul_signed(top,reach);uvec2 _e91=mul_signed(bottom,reach);uvec2
_e92=tangent;bool _e93=less(_e92,_e90);if(!(_e93)){uvec2 _e97=tangent;bool _e98=less(_e91,_e97);local_9=!(_e98);}else{
local_9=false;}bool _e101=local_9;if(_e101){right=reach;}bool _e102=less(_e89,_e90);if(!(_e102)){bool _e106=less(_e91,
_e89);local_10=!(_e106);}else{local_10=false;}bool _e109=local_10;if(_e109){left=-(reach);}int _e113=b_15.c_q14_.x;int
c_q8_1=(_e113>>6u);int margin=((reach>>8u)+ 32);int _e120=left;int _e125=right;Span _e131=columns_between((c_q8_1 +
max((_e120 - margin),-(reach))),(c_q8_1 - max((-(_e125)- margin),-(reach))));return _e131;}Span square_span(int
centre_q14_,uint radius,int tiles){int pixel=(centre_q14_>>14u);int first_1=((pixel - int(radius))>>4u);int
last_1=((((pixel + int(radius))+ 15)>>4u)- 1);return Span(min(max(first_1,0),tiles),min(max(last_1,-1),(tiles - 1)));}
Span rows_of(inout Splat s_3,inout Bounds b_16){int _e4=_group_0_binding_0_cs.cutoff;if((_e4==1)){int _e9=b_16.c_q14_.y;
uint _e11=b_16.square_radius;int _e15=_group_0_binding_0_cs.tiles.y;Span _e16=square_span(_e9,_e11,_e15);return _e16;}
int _e19=s_3.rows.x;uint _e22=_group_0_binding_0_cs.tile_bits;int _e26=s_3.rows.y;uint
_e29=_group_0_binding_0_cs.tile_bits;return Span((_e19>>_e22),(_e26>>_e29));}Span span_of(inout Splat s_4,inout Bounds
b_17,int r_q12_1,int row_2){int _e6=_group_0_binding_0_cs.cutoff;if((_e6==1)){int _e11=b_17.c_q14_.x;uint
_e13=b_17.square_radius;int _e17=_group_0_binding_0_cs.tiles.x;Span _e18=square_span(_e11,_e13,_e17);return _e18;}Span
_e19=ellipse_span(s_4,b_17,r_q12_1,row_2);return _e19;}bool fits(){bool local_11=false;bool local_12=false;uint
_e2=_group_1_binding_2_cs[2];uint _e5=_group_0_binding_0_cs.page_room;if((_e2<=_e5)){uint _e11=_group_1_binding_2_cs[1];
uint _e14=_group_0_binding_0_cs.large_room;local_11=(_e11<=_e14);}else{local_11=false;}bool _e17=local_11;if(_e17){uint
_e22=_group_1_binding_2_cs[9];uint _e26=_group_0_binding_0_cs.merges;local_12=(_e22<=(BLOCK<<_e26));}else{
local_12=false;}bool _e30=local_12;return _e30;}void put_entry(uint tile_1,uint entry){uint _e4=list_of(tile_1);uint
_e9=atomicAdd(_group_1_binding_2_cs[(_e4 + 1u)],1u);_group_1_binding_3_cs[_e9]=entry;return;}Splat large_splat(uint
slot_1){uvec4 a_19=_group_1_binding_0_cs[(2u*slot_1)];uvec4 b_18=_group_1_binding_0_cs[((2u*slot_1)+ 1u)];return
Splat(a_19.x,a_19.y,int(a_19.z),int(a_19.w),int(b_18.x),int((b_18.y&65535u)),ivec2(int((b_18.w&65535u)),
int((b_18.w>>16u))));}void main(){uvec3 group_1=gl_WorkGroupID;uint thread_1=gl_LocalInvocationIndex;Splat s=Splat(0u,
0u,0,0,0,0,ivec2(0));Bounds b=Bounds(ivec2(0),0u,0,0,0u);bool local_2=false;ivec4 own=ivec4(0,-1,0,-1);bool
local_3=false;Span touched=Span(0,0);int column=0;bool local_4=false;uint number=((group_1.y*ROW_OF_GROUPS)+ group_1.x);
uint _e9=_group_0_binding_0_cs.larges;uint _e13=_group_0_binding_0_cs.large_room;uint at_1=(_e9 +(LARGE*min(number,
(_e13 - 1u))));uint slot_2=_group_1_binding_1_cs[at_1];Splat _e22=large_splat(slot_2);s=_e22;uint
_e28=_group_1_binding_1_cs[(at_1 + 1u)];uint _e34=_group_1_binding_1_cs[(at_1 + 2u)];uint
_e41=_group_1_binding_1_cs[(at_1 + 3u)];uint _e46=_group_1_binding_1_cs[(at_1 + 4u)];uint
_e52=_group_1_binding_1_cs[(at_1 + 5u)];uint _e58=_group_1_binding_1_cs[(at_1 + 6u)];b=Bounds(ivec2(int(_e28),
int(_e34)),_e41,int(_e46),int(_e52),_e58);uint _e65=_group_1_binding_1_cs[(at_1 + 7u)];int first_2=int(_e65);uint
_e69=_group_1_binding_2_cs[1];uint _e72=_group_0_binding_0_cs.large_room;if((number<min(_e69,_e72))){bool _e77=fits();
local_2=_e77;}else{local_2=false;}bool listed=local_2;if((int(thread_1)<LARGE_ROWS)){int row_3=(first_2 +
int(thread_1));if(listed){Span _e93=rows_of(s,b);local_3=(row_3<=_e93.last);}else{local_3=false;}bool _e97=local_3;
if(_e97){int _e99=s.offset_q11_;int _e100=radius_q12_(_e99);Span _e101=span_of(s,b,_e100,row_3);touched=_e101;int
_e105=_group_0_binding_0_cs.cutoff;if((_e105==1)){Span _e108=ellipse_span(s,b,_e100,row_3);touched=_e108;}int
_e112=touched.first;int _e114=touched.last;own=ivec4(_e101.first,_e101.last,_e112,_e114);}ivec4 _e118=own;
spans[thread_1]=_e118;}memoryBarrierShared();barrier();uint row_4=(thread_1/16u);ivec4 of_row=spans[row_4];
column=(of_row.x + int((thread_1%16u)));for(;(column<=of_row.y);column=(column + 16)){{int _e133=column;
if(!((_e133<of_row.z))){int _e139=column;local_4=(_e139>of_row.w);}else{local_4=true;}bool cut_off=local_4;int
_e149=_group_0_binding_0_cs.tiles.x;int _e151=column;put_entry(uint((((first_2 + int(row_4))*_e149)+ _e151)),
(slot_2|(cut_off?CUT_OFF:0u)));}}return;}
