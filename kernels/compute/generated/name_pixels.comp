#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};const uint CHUNK=256u;const uint THREADS=128u;const uint
ROW_OF_GROUPS=32768u;const uint SPAN=8u;const uint DRAWN=3u;const uint NOTHING=4294967295u;layout(std140,
binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=1)buffer
type_10_block_1Compute{uint _group_1_binding_1_cs[];};uint span_of(uint place){uint low=0u;uint high=0u;uint
_e5=_group_0_binding_0_cs.spans;high=_e5;while(true){uint _e7=high;uint _e8=low;if(((_e7 - _e8)>1u)){}else{break;}{uint
_e12=low;uint _e13=high;uint middle=((_e12 + _e13)/2u);uint _e20=_group_0_binding_0_cs.spans_at;uint
_e25=_group_1_binding_1_cs[(_e20 +(SPAN*middle))];if((_e25<=place)){low=middle;}else{high=middle;}}}uint
_e29=_group_0_binding_0_cs.spans_at;uint _e31=low;return(_e29 +(SPAN*_e31));}void main(){uvec3 group=gl_WorkGroupID;
uint thread=gl_LocalInvocationIndex;uvec2 id=uvec2(4294967295u);uint chunk=0u;uint pixel=((((group.y*ROW_OF_GROUPS)+
group.x)*THREADS)+ thread);uint _e12=_group_0_binding_0_cs.id;uint at=(_e12 +(2u*pixel));int
_e19=_group_0_binding_0_cs.size.x;int _e23=_group_0_binding_0_cs.size.y;if((pixel>=uint((_e19*_e23)))){return;}uint
slot=_group_1_binding_1_cs[at];if((slot!=NOTHING)){uint _e38=_group_0_binding_0_cs.visible;uint
place_1=_group_1_binding_1_cs[(_e38 +(slot/CHUNK))];uint _e44=span_of(place_1);chunk=place_1;uint
_e48=_group_0_binding_0_cs.drawn;if((_e48!=0u)){uint _e54=_group_0_binding_0_cs.drawn;uint
_e61=_group_1_binding_1_cs[((_e54 +(DRAWN*place_1))+ 2u)];chunk=_e61;}uint _e66=_group_1_binding_1_cs[(_e44 + 4u)];uint
_e67=chunk;uint _e72=_group_1_binding_1_cs[(_e44 + 5u)];id=uvec2(_e66,(((_e67 - _e72)*CHUNK)+(slot%CHUNK)));}uint
_e83=id.x;_group_1_binding_1_cs[at]=_e83;uint _e89=id.y;_group_1_binding_1_cs[(at + 1u)]=_e89;return;}
