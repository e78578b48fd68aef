#version 310 es
precision highp float;precision highp int;layout(local_size_x=128,local_size_y=1,local_size_z=1)in;struct Frame{ivec2
size;ivec2 tiles;ivec2 first;ivec2 whole;uint places;uint spans;uint merges;uint large_room;uint page_room;uint drawn;
uint seen;uint ranks;uint visible;uint records;uint depths;uint boxes;uint larges;uint spans_at;uint finishes;uint
classes;uint blocks;uint block_room;uint spare;uint tile_bits;uint cleared;int cutoff;int cut_q11_;uint format;ivec4
background_q13_;int depth_bits;uint colour;uint coverage;uint mean_depth;uint median_depth;uint id;uint occluder;uint
backdrop;uint scratch;uint squares;uint rates;uint moments;};const uint THREADS=128u;const uint ROW_OF_GROUPS=32768u;
const uint BLOCK=512u;const uint LARGE_BOX=4194303u;const uint TILES=64u;const uint LIST=8u;layout(std140,
binding=0)uniform Frame_block_0Compute{Frame _group_0_binding_0_cs;};layout(std430,binding=0)buffer
type_14_block_1Compute{uint _group_1_binding_0_cs[];};layout(std430,binding=1)readonly buffer type_14_block_2Compute{
uint _group_1_binding_1_cs[];};layout(std430,binding=2)buffer type_16_block_3Compute{uint _group_1_binding_2_cs[];};
layout(std430,binding=3)buffer type_14_block_4Compute{uint _group_1_binding_3_cs[];};uint list_of(uint tile){
return(TILES +(LIST*tile));}uint bound_words(){uint _e3=_group_0_binding_0_cs.places;return(4u*_e3);}uint
list_room(uint longest,uint larges,uint visible){return max(min((max(longest,BLOCK)+ larges),visible),1u);}bool fits(){
bool local_11=false;bool local_12=false;uint _e2=_group_1_binding_2_cs[2];uint _e5=_group_0_binding_0_cs.page_room;
if((_e2<=_e5)){uint _e11=_group_1_binding_2_cs[1];uint _e14=_group_0_binding_0_cs.large_room;local_11=(_e11<=_e14);}
else{local_11=false;}bool _e17=local_11;if(_e17){uint _e22=_group_1_binding_2_cs[9];uint
_e26=_group_0_binding_0_cs.merges;local_12=(_e22<=(BLOCK<<_e26));}else{local_12=false;}bool _e30=local_12;return _e30;}
void put_entry(uint tile_1,uint entry){uint _e4=list_of(tile_1);uint _e9=atomicAdd(_group_1_binding_2_cs[(_e4 + 1u)],
1u);_group_1_binding_3_cs[_e9]=entry;return;}void fill_box(uint slot){uvec2 bits=uvec2(0u);uint bit=0u;uint
_e4=_group_0_binding_0_cs.boxes;uint _e9=_group_1_binding_1_cs[(_e4 +(2u*slot))];uint _e13=_group_0_binding_0_cs.boxes;
uint _e20=_group_1_binding_1_cs[((_e13 +(2u*slot))+ 1u)];bits=uvec2(_e9,_e20);uint _e24=bits.y;uint
first_tile=(_e24>>10u);int _e30=_group_0_binding_0_cs.tiles.x;uint across=uint(_e30);uint _e33=bits.y;
bits.y=(_e33&1023u);if((first_tile==LARGE_BOX)){return;}while(true){uint _e39=bits.x;uint _e41=bits.y;
if(((_e39|_e41)!=0u)){}else{break;}{bit=0u;uint _e48=bits.x;if((_e48!=0u)){uint _e52=bits.x;bit=min(uint(findLSB(_e52)),
32u);uint _e55=bits.x;uint _e57=bits.x;bits.x=(_e55&(_e57 - 1u));}else{uint _e63=bits.y;bit=(32u +
min(uint(findLSB(_e63)),32u));uint _e67=bits.y;uint _e69=bits.y;bits.y=(_e67&(_e69 - 1u));}uint _e73=bit;uint _e78=bit;
put_entry(((first_tile +((_e73/6u)*across))+(_e78%6u)),slot);}}return;}void put_arguments(uint at,uint groups){
_group_1_binding_0_cs[(4u*at)]=min(groups,ROW_OF_GROUPS);_group_1_binding_0_cs[((4u*at)+ 1u)]=(((groups +
ROW_OF_GROUPS)- 1u)/ROW_OF_GROUPS);_group_1_binding_0_cs[((4u*at)+ 2u)]=1u;return;}void put_later(){uint i_1=0u;bool
local_13=false;uint i_2=0u;uint _e3=_group_0_binding_0_cs.tile_bits;uint patches=(2u*(_e3 - 3u));int
_e10=_group_0_binding_0_cs.tiles.x;int _e14=_group_0_binding_0_cs.tiles.y;uint tiles_1=uint((_e10*_e14));uint
empty=_group_1_binding_2_cs[16];uint longest_1=_group_1_binding_2_cs[31];uint _e25=_group_1_binding_2_cs[8];uint
_e28=_group_0_binding_0_cs.block_room;uint long_=min(_e25,_e28);bool _e30=fits();put_arguments(0u,(_e30?(((tiles_1 -
empty)+(7u*longest_1))<<patches):0u));put_arguments(21u,(_e30?(empty<<patches):0u));uint _e47=_group_1_binding_2_cs[7];
uint _e51=_group_0_binding_0_cs.block_room;put_arguments(1u,(_e30?min((_e47 + long_),_e51):0u));for(;
(i_1<_group_0_binding_0_cs.merges);i_1=(i_1 + 1u)){{uint _e62=i_1;if(_e30){uint _e69=_group_1_binding_2_cs[9];uint
_e71=i_1;local_13=(_e69>(BLOCK<<_e71));}else{local_13=false;}bool _e75=local_13;put_arguments((2u + _e62),
(_e75?long_:0u));}}uint _e82=_group_1_binding_2_cs[9];uint _e85=_group_1_binding_2_cs[1];uint
_e88=_group_1_binding_2_cs[4];uint _e89=list_room(_e82,_e85,_e88);uint _e92=_group_0_binding_0_cs.scratch;uint
_e93=bound_words();uint at_once=min(((_e92 - _e93)/(2u*_e89)),tiles_1);uint _e103=_group_1_binding_2_cs[0];
put_arguments(22u,(_e30?0u:(2u*_e103)));for(;(i_2<_group_0_binding_0_cs.finishes);i_2=(i_2 + 1u)){{uint _e115=i_2;
put_arguments((23u + _e115),(_e30?0u:min(at_once,ROW_OF_GROUPS)));uint _e124=i_2;uint _e130=i_2;
_group_1_binding_0_cs[((4u*(23u + _e124))+ 2u)]=(_e130 + 1u);}}return;}void main(){uvec3 group=gl_WorkGroupID;uint
thread=gl_LocalInvocationIndex;bool local=false;bool local_1=false;uint half_=((group.y*ROW_OF_GROUPS)+ group.x);
if((half_==0u)){local=(thread==0u);}else{local=false;}bool _e14=local;if(_e14){put_later();}uint
_e19=_group_1_binding_2_cs[0];if(((half_/2u)<_e19)){bool _e23=fits();local_1=_e23;}else{local_1=false;}bool
_e25=local_1;if(_e25){fill_box(((half_*THREADS)+ thread));return;}else{return;}}
