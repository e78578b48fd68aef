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
int half_width_q8_;uint square_radius;};struct Span{int first;int last;};const uint CHUNK=256u;const uint THREADS=128u;
const uint ROW_OF_GROUPS=32768u;const uint RECORD=64u;const uint LARGE=8u;const int LARGE_ROWS=8;const uint SPAN=8u;
const uint DRAWN=3u;const uint PAGE=4096u;const uint MERGES=19u;const uint BLOCK=512u;const uint CLASSES=16u;const uint
CUT_OFF=2147483648u;const uint NOTHING=4294967295u;const uint LARGE_BOX=4194303u;const uint MOTION_TURNS=1u;const uint
MOTION_FADES=2u;const int FAR_Q3_=-1048576;const int BOX_COLUMNS=6;const int BOX_ROWS=7;const uint VISIBLE_CHUNKS=0u;
const uint LARGES=1u;const uint PAGES=2u;const uint DAMAGED=3u;const uint VISIBLE=4u;const uint ENTRIES=5u;const uint
SHORT_BLOCKS=7u;const uint LONG_BLOCKS=8u;const uint LONGEST=9u;const uint CLASS_COUNTS=16u;const uint TILES=64u;const
uint LIST=8u;const int EVERYWHERE_Q8_=1073741824;const uint GROUP=16u;layout(std140,binding=0)uniform
Frame_block_0Compute{Frame _group_0_binding_0_cs;};shared uint sums[128];shared uint group_sums[8];layout(std430,
binding=0)buffer type_13_block_1Compute{uint _group_1_binding_0_cs[];};layout(std430,binding=1)buffer
type_13_block_2Compute{uint _group_1_binding_1_cs[];};layout(std430,binding=2)buffer type_15_block_3Compute{uint
_group_1_binding_2_cs[];};uint plus(uint a_16,uint b_8,bool cut){bool local=false;if(cut){local=((a_16 + b_8)<a_16);}
else{local=false;}bool _e10=local;return(_e10?4294967295u:(a_16 + b_8));}uint sum_before(uint thread_1,uint own_1,bool
cut_1){uint sum=0u;uint i_4=0u;uint sum_1=0u;uint i_5=0u;uint i_6=0u;sums[thread_1]=own_1;memoryBarrierShared();
barrier();if((thread_1<8u)){for(;(i_4<GROUP);i_4=(i_4 + 1u)){{uint _e14=sum;uint _e18=i_4;uint
_e21=sums[((GROUP*thread_1)+ _e18)];uint _e22=plus(_e14,_e21,cut_1);sum=_e22;}}uint _e28=sum;group_sums[thread_1]=_e28;}
memoryBarrierShared();barrier();for(;(i_5<(thread_1/GROUP));i_5=(i_5 + 1u)){{uint _e37=sum_1;uint _e39=i_5;uint
_e41=group_sums[_e39];uint _e42=plus(_e37,_e41,cut_1);sum_1=_e42;}}i_6=((thread_1/GROUP)*GROUP);for(;(i_6<thread_1);
i_6=(i_6 + 1u)){{uint _e53=sum_1;uint _e55=i_6;uint _e57=sums[_e55];uint _e58=plus(_e53,_e57,cut_1);sum_1=_e58;}}uint
_e62=sum_1;return _e62;}void put_arguments(uint at_2,uint groups){_group_1_binding_0_cs[(4u*at_2)]=min(groups,
ROW_OF_GROUPS);_group_1_binding_0_cs[((4u*at_2)+ 1u)]=(((groups + ROW_OF_GROUPS)- 1u)/ROW_OF_GROUPS);
_group_1_binding_0_cs[((4u*at_2)+ 2u)]=1u;return;}uint rank_of(uint place){uint _e4=_group_0_binding_0_cs.seen;uint
_e9=_group_1_binding_2_cs[(_e4 +(place/32u))];uint below=(_e9&((1u<<(place%32u))- 1u));uint
_e20=_group_0_binding_0_cs.ranks;uint _e25=_group_1_binding_1_cs[(_e20 +(place/32u))];return(_e25 +
uint(bitCount(below)));}void main(){uint thread=gl_LocalInvocationIndex;uint own=0u;uint i=0u;uint at=0u;uint i_1=0u;
uint bits=0u;uint i_2=0u;uint _e3=_group_0_binding_0_cs.places;uint words=((_e3/32u)+ 1u);uint each=(((words +
THREADS)- 1u)/THREADS);uint first=min((thread*each),words);uint end=min((first + each),words);i=first;for(;(i<end);i=(i
+ 1u)){{uint _e23=own;uint _e27=_group_0_binding_0_cs.seen;uint _e28=i;uint _e31=_group_1_binding_2_cs[(_e27 + _e28)];
own=(_e23 + uint(bitCount(_e31)));}}uint _e37=own;uint _e39=sum_before(thread,_e37,false);at=_e39;i_1=first;for(;
(i_1<end);i_1=(i_1 + 1u)){{uint _e47=_group_0_binding_0_cs.ranks;uint _e48=i_1;uint _e51=at;_group_1_binding_1_cs[(_e47
+ _e48)]=_e51;uint _e55=_group_0_binding_0_cs.seen;uint _e56=i_1;uint _e59=_group_1_binding_2_cs[(_e55 + _e56)];
bits=_e59;for(;(bits!=0u);bits=(bits&(bits - 1u))){{uint _e67=_group_0_binding_0_cs.visible;uint _e68=at;uint _e72=i_1;
uint _e74=bits;_group_1_binding_1_cs[(_e67 + _e68)]=((32u*_e72)+ min(uint(findLSB(_e74)),32u));uint _e77=at;at=(_e77 +
1u);}}}}memoryBarrierBuffer();barrier();memoryBarrierShared();barrier();i_2=thread;for(;
(i_2<=_group_0_binding_0_cs.spans);i_2=(i_2 + THREADS)){{uint _e96=_group_0_binding_0_cs.spans_at;uint _e98=i_2;uint
span=(_e96 +(SPAN*_e98));uint _e103=_group_1_binding_1_cs[span];uint _e104=rank_of(_e103);uint
_e109=_group_1_binding_1_cs[(span + 1u)];uint _e110=rank_of(_e109);_group_1_binding_1_cs[(span + 2u)]=_e104;
_group_1_binding_1_cs[(span + 3u)]=_e110;uint _e119=i_2;uint _e125=i_2;uint _e128=_group_0_binding_0_cs.spans;
put_arguments(_e119,max((2u*(_e110 - _e104)),((_e125==_e128)?1u:0u)));}}if((thread==127u)){uint _e139=at;
_group_1_binding_2_cs[0]=_e139;return;}else{return;}}
