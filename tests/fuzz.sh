#!/bin/sh
# tests/fuzz.sh SECONDS: fuzzes each target, or those in TARGETS, for SECONDS. Failing inputs are kept in the build's
# folder fuzz.
. tests/scripts/lib/check.sh
seconds=${1:?seconds}
jobs=${JOBS:-$(getconf _NPROCESSORS_ONLN)}
out=${B:-build}/fuzz
fixsplat=$(cd "${B:-build}" && pwd)/fixsplat
photographs="$PWD/tests/jpeg_bytes.h $PWD/tests/heif_bytes.h"
work=$(mktemp -d) || exit 1
root=$PWD
trap 'rm -rf "$work"' EXIT

# ---- Seed files ------------------------------------------------------------------------------------------------------

rad() {
    json=$2
    while [ $((${#json} % 8)) != 0 ]; do json="$json "; done
    printf "$1\\$(printf %o $((${#json} % 256)))\\$(printf %o $((${#json} / 256)))\\0\\0%s" "$json"
}

seed_of_rad() {
    at=0 list=
    for column in center:f16:18 alpha:r8:3 rgb:r8_delta:9 scales:ln_0r8:9 orientation:oct88r8:9 sh1:s8:27 \
        child_count:u16:6 child_start:u32:12; do
        name=${column%%:*} bytes=${column##*:} encoding=${column#*:}
        list="$list${list:+,}{\"offset\":$at,\"bytes\":$bytes,\"property\":\"$name\",\"encoding\":\"${encoding%:*}\",$(
            )\"min\":0,\"max\":1}"
        at=$((at + bytes))
    done
    {
        rad RADC "{\"version\":1,\"base\":0,\"count\":3,\"properties\":[$list]}"
        printf "\\$(printf %o $at)\\0\\0\\0\\0\\0\\0\\0"
        head -c 75 /dev/zero
        printf '\2\0\0\0\0\0\1\0\0\0\0\0\0\0\0\0\0\0'
    } >chunk
    rad RAD0 "{\"version\":1,\"type\":\"gsplat\",\"count\":3,\"maxSh\":1,\"lodTree\":true,$(
        )\"chunks\":[{\"offset\":0,\"bytes\":$(wc -c <chunk)}]}"
    cat chunk
    rm chunk
}

zstd() {
    printf '\50\265\57\375\40'"\\$(printf %o "$1")\\$(printf %o $(($1 * 8 + 1)))\\0\\0"
    head -c "$1" /dev/zero
}

stream4d() {
    printf "\\$1\\$2\\1\\$(printf %o $3)\\0\\0\\0\\$(printf %o $(($3 + 9)))\\0\\0\\0"
}

seed_of_splat4d() {
    for size in 1 1 1 1 1 6 6 6 2 8; do
        stream4d 0 2 $size
        zstd $size
    done >still
    {
        printf '\12\0'
        for frames in 1 2; do
            attribute=0
            for numbers in 6 8 6 2 6; do
                stream4d $attribute $((frames - 1)) $((frames * numbers))
                attribute=$((attribute + 1))
            done
        done
        for size in 6 8 6 2 6 12 16 12 4 12; do
            zstd $size
        done
    } >group
    still=$(wc -c <still) group=$(wc -c <group)
    {
        printf 'SP4D\1\0\0\0\220\1\0\0%-400s' "{\"n\":2,\"t\":3,\"fps\":30,\"steps\":{\"pos\":0.004,$(
            )\"base_pos\":0.002,\"scale_log\":0.04,\"base_scale_log\":0.02,\"rgb\":9,\"alpha\":9,\"rot\":1},$(
            )\"static_section\":{\"offset\":412,\"len\":$still},\"gops\":[{\"offset\":$((412 + still)),$(
            )\"len\":$group,\"f0\":0,\"f1\":2}]}"
        cat still group
    } >splat4d
    rm still group
}

record4d() {
    cat >content
    size=$(wc -c <content)
    printf "\\$1\\$(printf %o $((size % 256)))\\$(printf %o $((size / 256)))\\0\\0\\0\\0\\0\\0"
    cat content
    rm content
}

numbers4d() {
    n=$(printf %o $2)
    printf "\\$1\\1\\2\\0\\$n\\1\\0\\0\\0\\$(printf %o $(($2 + 11)))\\0\\0\\0\\0\\0\\0\\0\\170\\1\\1"
    printf "\\$n\\0\\$(printf %o $((255 - $2)))\\377"
    head -c $(($2 + 4)) /dev/zero
}

seed_of_fourdgs() {
    one='\0\0\0\0\0\0\360\77' zero='\0\0\0\0\0\0\0\0'
    {
        printf '\2114DGS1\r\n'
        printf "\0\0\0\0\0\0\0\0$one\1\0\0\0\0\0\0\0$one\16\0\0\0gaussian-birth$(
            )$zero$zero$zero$zero$zero$zero\1\2\0\0\0\0" | record4d 1
        printf "\12\0\0\0uniform-v1$zero$zero$zero$one$one$one$one$one$one$one$one\1\0\0\0\0" | record4d 3
        printf "\1\0\0\0$zero$one" | record4d 4
        {
            printf "$zero$one\0\0\0\0\1\0\0\0\0\0\0\0\111\1\0\0\0\0\0\0\111\1\0\0\0\0\0\0"
            for stream in 0:3 1:3 2:1 3:3 4:3 5:1 6:3 7:1 10:1 11:1 12:1; do
                numbers4d ${stream%:*} ${stream#*:}
            done
        } | record4d 5
        {
            printf '\1'
            numbers4d 7 9
        } | record4d 7
        head -c 20 /dev/zero | record4d 2
    } >4dgs
}

seeds_of_scene() {
    seed_of_splat4d
    seed_of_fourdgs
    seed_of_rad >rad
    for scene in knot needles fog layers; do
        "$fixsplat" make-scene $scene --count 3 -o $scene.ply
    done
    {
        printf '%s\n' ply 'format ascii 1.0' 'comment SplatRenderMode: mip' 'element vertex 2'
        printf 'property double %s\n' x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2
        printf 'property uchar %s\n' rot_0 rot_1 rot_2 rot_3
        printf '%s\n' 'element face 1' 'property list uchar int index' end_header '0 0 0 1 .5 2e-1 2 -1 -2 -3 1 0 0 0' \
            '1 1 1 1 nan .2 inf -1 -2 -3 1 0 0 0' '3 0 1 2'
    } >ascii.ply
    sed 's/ascii/binary_big_endian/' ascii.ply >big.ply
    {
        printf '%s\n' ply 'format binary_little_endian 1.0' 'element vertex 2'
        printf 'property ushort %s\n' x y z opacity scale_0 scale_1 rot_0 rot_1 rot_2 rot_3
        printf 'property uchar %s\n' red green blue
        printf '%s\n' 'property float filter_3D' 'property float t' 'property int motion_1' 'property int motion_2' \
            end_header
        head -c 78 /dev/zero
    } >other.ply
    still='x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3'
    {
        printf '%s\n' ply 'format binary_little_endian 1.0' 'comment ftgs_version 1' 'comment use_velocity 1' \
            'comment min_duration 0.02' 'comment opacity_floor 0.0001' 'comment n_frames 9' 'element vertex 2'
        printf 'property float %s\n' $still time log_duration velocity_0 velocity_1 velocity_2
        echo end_header
        head -c 152 /dev/zero
    } >ftgs.ply
    {
        printf '%s\n' ply 'format ascii 1.0' 'comment cfg_args: duration=2 start=1 fps=30' 'element vertex 1'
        printf 'property float %s\n' $still trbf_center trbf_scale motion_0 motion_1 motion_2 motion_3 motion_4 motion_5 \
            motion_6 motion_7 motion_8 omega_0 omega_1 omega_2 omega_3
        printf '%s\n' end_header '1 2 3 0 0 0 1 -1 -1 -1 1 0 0 0 .5 -1 1 1 1 2 2 2 3 3 3 .1 .2 .3 .4'
    } >spacetime.ply
    {
        printf '%s\n' ply 'format binary_little_endian 1.0' 'element chunk 1'
        for attribute in '' scale_; do
            printf 'property float %s\n' min_${attribute}x min_${attribute}y min_${attribute}z \
                max_${attribute}x max_${attribute}y max_${attribute}z
        done
        printf '%s\n' 'element vertex 2'
        printf 'property uint packed_%s\n' position rotation scale color
        printf '%s\n' 'element sh 2'
        printf 'property uchar f_rest_%s\n' 0 1 2 3 4 5 6 7 8
        printf '%s\n' end_header
        head -c 98 /dev/zero
    } >compressed.ply
    for record in 1 2; do
        printf '\0\0\200\77\0\0\0\100\0\0\100\300\0\0\200\76\0\0\200\76\0\0\200\76\1\2\3\377\0\100\200\377'
    done >splat
    int='\0\0\0'
    for level in 0 1 2; do
        {
            printf "\0\1\0\0\1$int\1$int\3$int\3$int\\$level$int"
            head -c 4072 /dev/zero
            printf "\3$int\3$int\2$int\2$int\0\0\240\100\14$int\0$int\0$int\1$int\1$int\1$int"
            head -c 980 /dev/zero
            printf "\1$int"
            head -c 264 /dev/zero
        } >ksplat$level
    done
}

seeds_of_spz() {
    int='\0\0\0' long='\0\0\0\0\0\0\0' zeros='\0\0\0\0'
    for version in 1 2 3; do
        for degree in 0 1; do
            {
                printf "\\$degree""NGSP\\$version$int\\2$int\\$degree\\14\\2\\0"
                head -c $((2 * ((version == 1 ? 6 : 9) + (version == 3 ? 4 : 3) + 7 + 9 * degree))) /dev/zero
                printf "\\3\\0\\276\\255\\4$int\\6$int"
            } >spz$version$degree
        done
    done
    {
        printf "\\0NGSP\\4$int\\1$int\\0\\14\\0\\5\\40$int$zeros$zeros$zeros"
        for size in 9 1 3 3 4; do
            printf "\\$(printf %o $((size + 9)))$long\\$(printf %o $size)$long"
        done
        for size in 9 1 3 3 4; do
            zstd $size
        done
    } >spz4
}

gltf() {
    size=$(printf %s "$1" | wc -c)
    printf "\\$(printf %o $((size % 256)))\\$(printf %o $((size / 256)))"
    printf %s "$1"
    head -c 200 /dev/zero
}

seeds_of_gltf() {
    head='{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"meshes":[{"primitives":[{'
    tail='}]}],"buffers":[{"byteLength":200}],"bufferViews":[{"buffer":0,"byteLength":200,"byteStride":20}]'
    attribute='{"bufferView":0,"byteOffset":8,"componentType":5126,"count":3,"type":'
    coefficient='"KHR_gaussian_splatting:SH_DEGREE'
    gltf "$head"'"extensions":{"KHR_gaussian_splatting":{"kernel":"ellipse"}},"attributes":{"POSITION":0,'"$(
        )"'"KHR_gaussian_splatting:ROTATION":1,"KHR_gaussian_splatting:SCALE":0,"KHR_gaussian_splatting:OPACITY":2,'"$(
        )$coefficient"'_0_COEF_0":0,'"$coefficient"'_1_COEF_0":0,'"$coefficient"'_1_COEF_1":0,'"$(
        )$coefficient"'_1_COEF_2":0}'"$tail"',"nodes":[{"children":[1]},{"mesh":0,"scale":[1,2,3],'"$(
        )"'"rotation":[0,0,1,0],"translation":[1,2,3]}],"accessors":['"$(
        )$attribute"'"VEC3"},'"$attribute"'"VEC4"},'"$attribute"'"SCALAR"}]}' >plain
    sparse='"sparse":{"count":2,"values":{"bufferView":1},'"$(
        )"'"indices":{"bufferView":1,"byteOffset":72,"componentType":5121}}'
    gltf "$head"'"extensions":{"KHR_gaussian_splatting":{}},"attributes":{"POSITION":0,"_ROTATION":1,"_SCALE":0,'"$(
        )"'"_OPACITY":2,"_SH_DEGREE_0_COEF_0":3}'"${tail%]}"',{"buffer":0,"byteLength":120}],"nodes":[{"mesh":0}],'"$(
        )"'"accessors":['"$attribute"'"VEC3",'"$sparse"'},'"$attribute"'"VEC4"},'"$attribute"'"SCALAR"},'"$(
        )"'{"componentType":5126,"count":3,"type":"VEC3",'"$sparse"'}]}' >sparse
    gltf "$head"'"extensions":{"KHR_gaussian_splatting":{"extensions":{"EXT_splat_opacity":{"opacityAccessor":0},'"$(
        )"'"KHR_gaussian_splatting_compression_spz_2":{"bufferView":0}}}}'"$tail"',"nodes":[{"mesh":0}],'"$(
        )"'"accessors":[{"componentType":5126,"count":3,"type":"SCALAR"}]}' >opacity
    gltf "$head"'"extensions":{"KHR_spz_gaussian_splats_compression":{"bufferView":0}}'"$tail"',"nodes":[{"mesh":0,'"$(
        )"'"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}]}' >compressed
}

seeds_of_mesh() {
    {
        printf '0'
        printf 'v %s\n' '0 0 0' '0 0 2' '0 2 0' '0 2 2' '2 0 0' '2 0 2' '2 2 0' '2 2 2' '5 5 5' '6 5 5' '6 6 5' \
            '5.5 5.2 5' '5 6 5'
        printf 'f %s\n' '1 2 4 3' '5 7 8 6' '1 5 6 2' '3 4 8 7' '1/1/1 3/2/1 7//1 5' '2 -7 -6 4' '9 10 11 12 13'
    } >obj
    {
        printf '0'
        printf '%s\n' ply 'format ascii 1.0' 'element vertex 5'
        printf 'property float %s\n' x y z
        printf '%s\n' 'element face 3' 'property list uchar int vertex_index' end_header '0 0 0' '1 0 0' '1 1 0' '0 1 0' \
            '0.2 0.2 1' '5 0 1 2 4 3' '3 1 2 4' '4 0 1 2 3'
    } >ply
    sed 's/ascii/binary_little_endian/; s/uchar/int/' ply >binary
    {
        printf '1'
        gltf '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1]},{"mesh":0,'"$(
            )"'"scale":[1,-1,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5},{"attributes":'"$(
            )"'{"POSITION":0},"indices":1,"mode":6}]}],"buffers":[{"byteLength":200}],"bufferViews":[{"buffer":0,'"$(
            )"'"byteLength":200,"byteStride":20}],"accessors":[{"bufferView":0,"byteOffset":8,"componentType":5126,'"$(
            )"'"count":4,"type":"VEC3"},{"bufferView":0,"componentType":5121,"count":4,"type":"SCALAR"}]}' | head -c -200
        printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0'
        printf '\0\0\0\0\0\0\200\77\0\0\0\0\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77'
        head -c 120 /dev/zero
    } >glb
}

colmap() {
    printf "$2" >cameras
    printf "\\$1\\$(printf %o $(wc -c <cameras))\\0$2$3"
    rm cameras
}

seeds_of_camera() {
    printf '\0\0\0[{"img_name": "a", "width": 8, "height": 6, "fx": 9, "fy": 9, %s}]' \
        '"position": [0, 0, 1], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]' >inria
    printf '\0\0\0{"camera_angle_x": 0.7, "w": 8, "h": 6, "cx": 4, "frames": [{"file_path": "a", %s}]}' \
        '"transform_matrix": [[1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 1, 4], [0, 0, 0, 1]]' >transforms
    colmap 2 '# cameras\n1 PINHOLE 8 6 9 9 4 3\n' '# images\n1 1 0 0 0 0 0 1 1 a.png\n2.5 3 -1\n' >text
    int='\1\0\0\0' long='\1\0\0\0\0\0\0\0' zero='\0\0\0\0\0\0\0\0' unit='\0\0\0\0\0\0\360\77'
    colmap 1 "$long$int$int$long$long$unit$unit$unit$unit" \
        "$long$int$unit$zero$zero$zero$zero$zero$unit${int}a.png\\0$long$unit$unit$long" >binary
    printf '\3\0\0#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\na.jpg,1,2,3,90,45,-5,%s\n' \
        '24,.01,-.02,.1,.01,0,0,.001,.002' >csv
    printf '\0\0\0{"camera_model": "THIN_PRISM_FISHEYE", "w": 8, "h": 6, "fl_x": 9, "k1": 0.1, "sx1": 0.01, %s}' \
        '"train_filenames": ["a"], "test_filenames": ["b"], "frames": []' >lists
    colmap 4 '# Bundle file v0.3\n1 0\n9 .1 .01\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n' 'a.jpg 0 9\n' >bundler
    printf '\5\0\0<document><chunk><transform><rotation>1 0 0 0 1 0 0 0 1</rotation>%s%s%s%s%s' \
        '<scale>2</scale></transform><sensors><sensor id="0" type="fisheye"><resolution width="8" height="6"/>' \
        '<calibration class="adjusted"><f>9</f><k1>.1</k1><b1>1</b1><b2>1</b2></calibration></sensor></sensors>' \
        '<components><component id="0"/></components><cameras><camera label="a" sensor_id="0" component_id="0">' \
        '<transform>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</transform></camera></cameras></chunk></document>' >metashape
}

part() {
    printf "$1" >part
    size=$(wc -c <part)
    printf "\\$(printf %o $((size % 256)))\\$(printf %o $((size / 256)))$1"
    rm part
}

sog() {
    part "$1" && part "$2" && part "$3"
    for width in 0 0 0 0 0 277 0; do
        part "RIFF\36\0\0\0WEBPVP8L\21\0\0\0/\\$width\0\0\20\7P\344\42\27\271\375\201\210\350\177\0\0"
    done
    part '' && part "$4"
}

seeds_of_sog() {
    codebook="\"codebook\":[null$(printf ',%.0s1' $(seq 255))]"
    ends='"mins":[0,1,2],"maxs":[1,2,3]'
    means="\"means\":{\"shape\":[1,3],$ends,\"files\":[\"0\",\"1\"]},\"quats\":{\"files\":[\"3\"]}"
    leaf='"lods":{"0":{"file":0,"offset":0,"count":1},"1":{"file":0,"offset":0,"count":0}}'
    sog '' "{$means,\"scales\":{$ends,\"files\":[\"2\"]},
        \"sh0\":{\"mins\":[1,2,3,4],\"maxs\":[2,3,4,5],\"files\":[\"4\"]},
        \"shN\":{\"mins\":0,\"maxs\":1,\"files\":[\"5\",\"6\"]}}" '' '' >first
    sog '' "{\"version\":2,\"count\":1,$means,\"scales\":{$codebook,\"files\":[\"2\"]},\"antialias\":true,
        \"sh0\":{$codebook,\"files\":[\"4\"]},
        \"shN\":{\"count\":9,\"bands\":1,$codebook,\"files\":[\"5\",\"6\"]}}" \
        "{\"version\":1,\"lodLevels\":2,\"environment\":\"meta.json\",\"filenames\":[\"meta.json\"],
        \"tree\":{\"children\":[{$leaf},{}]}}" '' >second
    sog '' "{\"version\":4,\"count\":1,$means,\"scales\":{\"codebook\":[1],\"files\":[\"2\"]},
        \"sh0\":{\"codebook\":[0,1],\"files\":[\"4\"]},\"playback\":{\"duration\":2,\"fps\":9,\"loop\":false},
        \"timeline\":{\"type\":1,\"mins\":[0,0.1],\"maxs\":[1,2],\"files\":[\"5\",\"6\"]}}" '' '' >moving
    sog '' "{\"version\":4,\"count\":1,$means,\"scales\":{\"codebook\":[1],\"files\":[\"2\"]},
        \"sh0\":{\"codebook\":[0],\"files\":[\"4\"]},\"fps\":9,
        \"timeline\":{\"type\":0,\"N\":3,\"delta\":21845,\"files\":[\"5\",\"6\"]}}" '' '' >frames
    zip='PK\3\4\24\0\0\0\0\0\0\0!\0C\277\246\243\2\0\0\0\2\0\0\0\11\0\0\0meta.json{}PK\1\2\24\3\24\0\0\0\0\0\0\0'\
'!\0C\277\246\243\2\0\0\0\2\0\0\0\11\0\0\0\0\0\0\0\0\0\0\0\200\1\0\0\0\0meta.json'\
'PK\5\6\0\0\0\0\1\0\1\0\067\0\0\0)\0\0\0\0\0'
    run='{"file":0,"offset":0,"count":1}'
    sog "$zip" '' '{"lodLevels":2,"filenames":["a.sog"],"tree":{"lods":{"1":'"$run"'}}}' "$zip" >zip
    {
        part '' && part '' && part ''
        attributes='"POSITION":0,"_ROTATION":1,"_SCALE":0,"COLOR_0":1'
        accessor='{"bufferView":0,"componentType":5126,"count":1,"type":"VEC'
        part '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{'"$(
            )"'"extensions":{"KHR_gaussian_splatting":{}},"attributes":{'"$attributes"'}}]}],"buffers":[{'"$(
            )"'"byteLength":16,"uri":"data:;base64,AACAPwAAgD8AAIA/AACAPw=="}],"bufferViews":[{"buffer":0,'"$(
            )"'"byteLength":16}],"accessors":['"$accessor"'3"},'"$accessor"'4"}]}'
        part '{"asset":{"version":"1.0"},"geometricError":1,"root":{"content":{"url":"0"},"children":[]}}'
        for name in 2 3 4 5 6; do
            part ''
        done
        part '{"asset":{"version":"1.1"},"geometricError":1,"root":{"refine":"ADD","children":[{"refine":"REPLACE",'"$(
            )"'"transform":[1,0,0,0,0,1,0,0,0,0,1,0,1e7,2,3,1],"contents":[{"uri":"%%31"}]}]}}'
        part ''
    } >tiles
    {
        part ''
        part '{"means":{"shape":[1,3],"dtype":"float32","mins":[0,1,2],"maxs":[1,2,3]},"scales":{"mins":[0,1,2],'"$(
            )"'"maxs":[1,2,3]},"quats":{"mins":[0,1,2,3],"maxs":[1,2,3,4]},"opacities":{"mins":[0],"maxs":[1]},'"$(
            )"'"sh0":{"mins":[0,1,2],"maxs":[1,2,3]}}'
        part ''
        pixel='\211PNG\015\012\032\012\000\000\000\015IHDR\000\000\000\001\000\000\000\001\010\006\000\000\000\037'\
'\025\304\211\000\000\000\015IDATx\332cph8\360\037\000\005\004\002\200\343\300\021\220\000\000\000\000IEND\256B\140'\
'\202'
        for name in 1 2 3 4 5 6; do
            part "$pixel"
        done
    } >gsplat
    {
        for name in 1 2 3 4 5 6 7 8 9 10 11 12; do
            part ''
        done
        bounds='"min":[0,1,2],"max":[1,2,3]'
        part '{"totalLevel":2,"attributes":[{"name":"scale",'"$bounds"'},{"name":"shcoef",'"$bounds"'}]}'
        int='\1\0\0\0' row='\40\0\0\0' zero='\0\0\0\0'
        part "$int$int$zero$zero$row$int$row$zero$row"
        record='\0\0\200\77\0\0\0\100\0\0\100\300\1\2\3\377abcdefghijklmnop'
        part "$record$record"
        sh="$record$record"
        part "$sh$sh"
        part "$record$sh"
    } >lcc
}

fxs() {
    printf "\\$1\\144\\17\\0\\0\\3\\144\\17\\0\\0\\$2\\20\\40\\60\\$2\\0\\$1\\$2\\0\\0"
    if [ "$3" ]; then cat "$3"; fi
}

seeds_of_fxs() {
    for degree in 0 1 2 3; do
        "$fixsplat" make-scene knot --count 40 -o scene.ply
        "$fixsplat" convert scene.ply less.ply --sh-degree $degree
        for profile in default compact small; do
            "$fixsplat" convert less.ply scene.fxs --profile $profile
            fxs 1 $degree$degree scene.fxs >$profile$degree
            fxs 3 $degree$degree scene.fxs >checked-$profile$degree
        done
    done >"$work/seeds.log"
    rm scene.ply less.ply scene.fxs
    for flags in 0 24 50 120 124 160 164 170 260 264 270 370; do
        for options in 0 1 10 31 47 365 371; do
            fxs $flags $options >made-$flags-$options
        done
    done
}

seeds_of_scribble() { seeds_of_fxs; }

seeds_of_pager() {
    for kind in 0 1 2 3 4; do
        for profile in 0 1 2; do
            printf "\\$profile\\37\\$kind\\5\\1\\2\\0\\0\\7\\7\\7\\7" >sound-$kind-$profile
            printf "\\6$profile\\11\\$kind\\3\\0\\0\\0\\0\\1\\2\\3\\4\\3\\1\\0\\0\\377\\0" >edited-$kind-$profile
        done
    done
}

seeds_of_pack() {
    for profile in 0 1 2 11; do
        {
            printf "\\$profile"
            for number in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do
                printf "\\0\\0\\$(printf %o $((number * 16)))\\77"
            done
            head -c 2000 /dev/zero
        } >$profile
    done
}

seeds_of_image() {
    "$fixsplat" make-scene knot --count 20 -o scene.ply
    "$fixsplat" render scene.ply --size 8x6 -o scene.png
    "$fixsplat" render scene.ply --size 8x6 -o scene.ppm
    for name in baseline_jpeg progressive_jpeg grey_jpeg turned_heif; do
        for byte in $(sed -n "/ $name/,/}/ { /uint8/ !p }" $photographs | tr -dc '0-9 \n'); do
            printf "\\$(printf %o "$byte")"
        done >$name
    done
    "$fixsplat" render scene.ply --size 8x6 -o scene.webp
    rm scene.ply
    tiff='Exif\0\0II*\0\10\0\0\0\2\0' entry='\0\1\0\0\0'
    tiff="$tiff\\22\1\3$entry\6\0\0\0\151\207\4$entry\46\0\0\0\0\0\0\0"
    tiff="$tiff\3\0\232\202\5$entry\120\0\0\0\235\202\5$entry\120\0\0\0\47\210\3$entry\144\0\0\0\0\0\0\0"
    {
        printf '\377\330\377\341\0\140'
        printf "$tiff\34\0\0\0\12\0\0\0"
        tail -c +3 grey_jpeg
    } >exif
}

photos() {
    layout=$1
    shift
    sizes=
    for part; do
        printf "$part" >part
        bytes=$(wc -c <part)
        sizes="$sizes\\$(printf %03o $((bytes % 256)))\\$(printf %03o $((bytes / 256)))"
    done
    rm part
    printf "\\$layout$sizes$1$2$3"
    printf 'P6\n4 3\n255\n123456789abcdefghijklmnopqrstuvwxyz.'
}

seeds_of_photos() {
    int='\1\0\0\0' long='\1\0\0\0\0\0\0\0' zero='\0\0\0\0\0\0\0\0' unit='\0\0\0\0\0\0\360\77'
    size='\4\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0'
    photos 0 "$long$int\4\0\0\0$size$unit$unit$unit$unit$unit$zero$zero$zero" \
        "$long$int$unit$zero$zero$zero$zero$zero$unit${int}a\0$zero" \
        "$long$long$unit$unit${unit}abc$unit$long$long" >binary
    for lens in 'SIMPLE_RADIAL 4 3 5 2 1.5 -.1' 'OPENCV_FISHEYE 4 3 5 5 2 1.5 0 0 0 0'; do
        photos 21 "1 $lens\n" '1 1 0 0 0 0 0 1 1 a\n\n2 1 0 0 0 0 0 2 1 a\n\n' '1 2 3 4 5 6 7\n' >"text-${lens%% *}"
    done
    photos 1 '1 PINHOLE 4 3 5 5 2 1.5\n' "1 1 0 0 0 0 0 1 1 $(printf %05000d 0)/a\n\n" '1 2 3 4 5 6 7\n' >long
    frame='"transform_matrix": [[1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 1, 4], [0, 0, 0, 1]]}]}'
    ply='ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n'
    ply="${ply}end_header\n1 2 3\n"
    photos 6 "{\"w\": 4, \"h\": 3, \"fl_x\": 5, \"k1\": 0.1, \"ply_file_path\": \"p.ply\", \"frames\": [{$(
        )\"file_path\": \"./a\", $frame" "{\"camera_angle_x\": 0.7, \"frames\": [{\"file_path\": \"a.png\", $frame" \
        "$ply" >transforms
    photos 142 "{\"w\": 4, \"h\": 3, \"fl_x\": 5, \"frames\": [{\"file_path\": \"./a\", \"mask_path\": \"a.png\", $frame" '' \
        "$ply" >masks
    photos 3 '[{"img_name": "a", "width": 8, "height": 6, "fx": 9, "fy": 9, "position": [0, 0, 1], '"$(
        )"'"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]' '' "$ply" >inria
    photos 40 '#name,x,y,alt,heading,pitch,roll,f\na,1,2,3,90,45,-5,24\n' '' "$ply" >csv
    photos 41 '<document><chunk><sensors><sensor id="0"><resolution width="4" height="3"/><calibration><f>5</f>'"$(
        )"'</calibration></sensor></sensors><cameras><camera label="a" sensor_id="0"><transform>1 0 0 0 0 1 0 0 '"$(
        )"'0 0 1 0 0 0 0 1</transform></camera></cameras></chunk></document>' '' "$ply" >metashape
    photos 42 '# Bundle file v0.3\n1 1\n5 .1 .01\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n0 0 -5\n1 2 3\n0\n' 'a\n' '' >bundler
    photos 43 "{\"w\": 4, \"h\": 3, \"fl_x\": 5, \"is_fisheye\": true, \"train_filenames\": [\"a\"], \"frames\": [{$(
        )\"file_path\": \"a\", $frame" '' '' >lists
}

# A fit of a few Gaussians.
seeds_of_checkpoint() {
    (
        . "$root/tests/scripts/lib/photos.sh"
        mkdir made && cd made && make_photographs 3 &&
            "$fixsplat" fit set --steps 4 --save-every 3 --max-gaussians 9 -o a.fxs
    ) >"$work/seeds.log" 2>&1
    mv made/a.fxs.fit a
    rm -r made
}

sanitizers=address,undefined,float-cast-overflow
# -O0 compiles four times faster.
[ "$seconds" -gt 1 ] && optimised=-O1 || optimised=-O0
# The fill pattern leaves unwritten strings without a final 0.
compile="clang -std=c11 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off -Isrc/include -I. \
    -ftrivial-auto-var-init=pattern -gline-tables-only $optimised -fsanitize=fuzzer-no-link,$sanitizers \
    -fno-sanitize-recover=all"

instructions_of() {
    case $1 in
    */image_encode.c) echo -fwrapv ;;
    *_sse41.c) echo -msse4.1 ;;
    *_avx2.c) echo -mavx2 ;;
    *_avx512.c) echo -mavx512f -mavx512bw -mavx512dq -mavx512vl -mavx512cd -mavx512vbmi -g0 ;;
    esac
}

build() {
    case $(clang -dumpmachine) in
    x86_64*) kernels='kernels/*.c kernels/simd/x86/*.c kernels/fit/fit_[sa]*.c kernels/pack/*.c' ;;
    aarch64*) kernels='kernels/*.c kernels/simd/arm/*.c kernels/fit/fit_neon.c' ;;
    *) kernels='kernels/*.c' ;;
    esac
    mkdir "$work/objects"
    for source in src/*/*.c src/*/*/*.c $kernels port/posix/output.c port/posix/files.c port/posix/pages.c port/posix/heif_library.c \
        port/posix/clock.c port/posix/pager*.c \
        port/backend/fit_engines.c port/backend/pack_stages.c tests/fuzz_*.c; do
        echo "$compile $features -DFXS_WITH_KERNELS $(instructions_of "$source") -c $source -o $work/objects/$(
            )$(basename "$source" .c).o"
    done | xargs -P "$jobs" -I COMMAND sh -c COMMAND || return
    for name in $targets; do
        mv "$work/objects/$name.o" "$work/$name.o"
    done
    ar rc "$work/library.a" "$work"/objects/*.o
    for name in $targets; do
        clang -fsanitize=fuzzer,$sanitizers "$work/$name.o" "$work/library.a" -lm -lpthread $libraries \
            -o "$work/$name" || return
    done
}

fuzz() {
    for name in $targets; do
        mkdir "$work/$name.corpus"
        (cd "$work/$name.corpus" && "seeds_of_${name#fuzz_}")
    done
    printf '%s\n' $targets | xargs -P "$jobs" -I NAME sh -c "$work/NAME -max_total_time=$seconds -max_len=16384 \
        -timeout=20 -rss_limit_mb=1100 -artifact_prefix=$out/NAME- $work/NAME.corpus >$work/NAME.log 2>&1
        echo \$? >$work/NAME.status"
}

said() {
    awk '/^#[0-9]+.* cov: / { runs = substr($1, 2); sub(/.* cov: /, ""); edges = $1 }
        /^Done / { runs = $2; rate = sprintf(", %d a second", $2 / $5) }
        END { printf "%d inputs%s, %d edges", runs, rate, edges }' "$work/$1.log"
}

echo 'int LLVMFuzzerTestOneInput(const char *data, long size) { return data && size < 0; }' >"$work/links.c"
if ! clang -fsanitize=fuzzer,$sanitizers "$work/links.c" -o "$work/links" 2>/dev/null; then
    skip fuzz "no clang with libFuzzer here"
    finish
    exit
fi
for library in CJSON:cjson/cJSON.h:-lcjson EXPAT:expat.h:-lexpat WEBP:webp/decode.h:-lwebp ZIP:zip.h:-lzip \
    ZLIB:zlib.h:-lz ZSTD:zstd.h:-lzstd EXIF:libexif/exif-data.h:-lexif HEIF:libheif/heif.h:-ldl PNG:png.h:-lpng \
    JPEG:jpeglib.h:-ljpeg STB:stb/stb_image_write.h:; do
    header=${library#*:}
    if echo "#include <${header%:*}>" | clang -E -x c - >/dev/null 2>&1; then
        features="$features -DFXS_WITH_${library%%:*}" libraries="$libraries ${library##*:}"
    fi
done
mkdir -p "$out"
targets=${TARGETS:-$(basename -s .c tests/fuzz_*.c | tr '\n' ' ')}
if ! build; then
    fail fuzz "does not build"
    finish
    exit
fi
fuzz
for name in $targets; do
    if [ "$(cat "$work/$name.status")" = 0 ]; then
        ok "$name: $(said "$name")"
    else
        grep -E -A 12 'ERROR|runtime error' "$work/$name.log" | head -n 24
        kept=$(sed -n 's/.*Test unit written to //p' "$work/$name.log")
        fail "$name: $(said "$name")" "${kept:-$(tail -n 1 "$work/$name.log")}"
    fi
done
times >"$work/times"
echo "processor time: $(tail -n 1 "$work/times" | sed 's/\.[0-9]*//g; s/ /, /') of the system"
finish
