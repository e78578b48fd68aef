#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;
layout(std140,binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=2)buffer
type_15_block_1Compute{uint _group_1_binding_2_cs[];};void main(){uvec3 at_1=gl_GlobalInvocationID;uint
i_8=(((at_1.y*ROW_OF_GROUPS)*THREADS)+ at_1.x);uint _e10=_group_0_binding_0_cs.cleared;if((i_8<_e10)){
_group_1_binding_2_cs[i_8]=0u;return;}else{return;}}
