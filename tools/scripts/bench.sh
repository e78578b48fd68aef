#!/bin/sh
# bench.sh [PART...]: runs benchmarks and writes their results to a document, each part between its marker lines.
# Default parts: tables, gles, sizes, limits, stereo, levels. On a failure or an interrupt the document is unchanged.
# More parts, half an hour each: fit and fit_stages (options FIT_STEPS, FIT_SIZE, FIT_CPUS), cuts, budgets, steps and
# boards (options CAPTURED: scenes; KEPT: folder of intermediate files).
# B: build folder; SCENES: folder of scenes; PHOTOS: folder of photographs; DOCUMENT: docs/measured.md, or a copy.
set -eu
B=${B:-build} SCENES=${SCENES:-../shared/scenes} PHOTOS=${PHOTOS:-../shared/photos}
DOCUMENT=${DOCUMENT:-docs/measured.md}
work=$(mktemp -d)
trap 'rm -rf "$work" "$DOCUMENT.new"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
two=2
[ "$(getconf _NPROCESSORS_ONLN)" -ge 2 ] || two=1

field() { sed -n "s/.*\"$1\": \([0-9.]*\).*/\1/p"; }

# row LABEL OPTION...: runs a benchmark and prints a table row with the times of its stages.
row() {
    label=$1
    shift
    json=$("$B/fixsplat" bench --json "$@")
    printf '| %s ' "$label"
    for stage in project shade sort bin blend resolve frame_ms; do
        printf '| %s ' "$(echo "$json" | field $stage)"
    done
    printf '|\n'
    frame=$(echo "$json" | field frame_ms)
}

head_row() {
    printf '| %s | project | shade | sort | bin | blend | resolve | frame |\n|---|---|---|---|---|---|---|---|\n' "$1"
}

landscape() {
    [ -f "$work/$1.ply" ] || "$B/fixsplat" make-scene landscape --count "$1" -o "$work/$1.ply"
}

growth() {
    printf '### Growth with the number of Gaussians\n\nlandscape, 1280x720, milliseconds: plain C, one thread; then everything, %s threads.\n' $two
    printf 'A row with C is plain C on one thread. A row without C uses the fastest kernels of all stages on %s threads.\n\n' $two
    head_row 'Gaussians'
    for count in 100000 300000 1000000 3000000 10000000; do
        landscape $count
        row "$count, C" "$work/$count.ply" --cpu c --threads 1
        row "$count" "$work/$count.ply" --threads $two
        [ $count = 1000000 ] || [ $count = 10000000 ] || rm "$work/$count.ply"
    done
    row '10000000 at 1920x1080' "$work/10000000.ply" --threads $two --size 1920x1080
    rm "$work/10000000.ply"
}

frame_of() {
    json=$("$B/fixsplat" bench --json "$@")
    echo "$json" | field frame_ms
}

scene_rows() {
    name=$1 file=$2
    shift 2
    row "$name" "$file" --threads $two --size 1280x720 "$@" >"$work/row"
    large=$(frame_of "$file" --threads $two --size 1920x1080 "$@")
    single=$(frame_of "$file" --threads 1 --size 1280x720 "$@")
    plain=$(frame_of "$file" --cpu c --threads 1 --size 1280x720 "$@")
    awk -v frame="$frame" -v large="$large" -v single="$single" -v plain="$plain" '
        { printf "%s %s | %s | %s | %.2f | %.1f | %.0f |\n", $0, large, single, plain, single / frame, plain / frame,
                 1000 / frame }' "$work/row"
}

scenes() {
    printf '### Scenes\n\nTimes are milliseconds at 1280x720 with %s threads, except in the columns `1920x1080` (%s threads), `1 thread` and\n' $two $two
    printf '`C, 1 thread` (plain C). The columns `times` are ratios of `1 thread` and `C, 1 thread` to `frame`.\n\n'
    printf '| scene | project | shade | sort | bin | blend | resolve | frame | 1920x1080 | 1 thread | C, 1 thread | '
    printf 'times 1 thread | times C | frames a second |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n'
    landscape 1000000
    scene_rows 'landscape 1,000,000, all in view' "$work/1000000.ply"
    scene_rows 'landscape 1,000,000, from the shore' "$work/1000000.ply" \
        --eye 4.6,-1.9,-12.7 --look 0,-2.2,0 --fov 52
    if [ -d "$SCENES" ]; then
        for view in 8 40 72; do
            scene_rows "snowmiku, view $view" "$SCENES/snowmiku/snowmiku.ply" \
                --cameras "$SCENES/snowmiku/cameras.json" --view $view
        done
        scene_rows guitar "$SCENES/guitar/guitar.ply"
        scene_rows luma-seal "$SCENES/luma-seal/luma-seal.ply"
        scene_rows boatyard-tile3 "$SCENES/boatyard-tile3/boatyard-tile3.ply" --up 0,0,1
        scene_rows kitchen-marble "$SCENES/kitchen-marble/kitchen-marble.ply"
        scene_rows statue-st-peter "$SCENES/statue-st-peter/st-peter.ply"
        scene_rows donut "$SCENES/donut/donut.ply" --up 0,0,1
        scene_rows fruit-drops "$SCENES/fruit-drops/fruit_drops_minimal.ply"
    fi
}

import_row() {
    for threads in 1 $two; do
        for run in 1 2 3; do
            "$B/fixsplat" bench --json "$2" --threads $threads --size 64x64 >"$work/json"
            field load_ms <"$work/json"
        done | sort -n | sed -n 2p >"$work/load$threads"
    done
    awk -v name="$1" -v n="$(field gaussians <"$work/json")" -v one="$(cat "$work/load1")" -v two="$(cat "$work/load$two")" \
        'BEGIN { printf "| %s | %d | %.0f | %.0f | %.2f |\n", name, n, one, two, n / two / 1000 }'
}

imports() {
    printf '### Import\n\nA time is the median of three runs in milliseconds, from an open file in the page cache to the packed scene.\n\n'
    printf '| file | Gaussians | 1 thread | %s threads | million a second |\n|---|---|---|---|---|\n' $two
    landscape 3000000
    import_row 'landscape, .ply, degree 3' "$work/3000000.ply"
    rm "$work/3000000.ply"
    if [ -d "$SCENES" ]; then
        for file in snowmiku/snowmiku.ply guitar/guitar.compressed.ply luma-seal/luma-seal.splat \
            kitchen-marble/kitchen-marble.spz statue-st-peter/st-peter.sog boatyard-tile3/boatyard-tile3.glb; do
            import_row "${file#*/}" "$SCENES/$file"
        done
    fi
}

cutoff_rows() {
    name=$1 file=$2
    shift 2
    for cutoff in mahalanobis square; do
        for cpu in c all; do
            json=$("$B/fixsplat" bench --json "$file" --threads 1 --size 1280x720 --cutoff $cutoff --cpu $cpu "$@")
            eval "blend_$cpu=$(echo "$json" | field blend)"
        done
        json=$("$B/fixsplat" render "$file" --size 1280x720 --cutoff $cutoff -o "$work/$cutoff.png" --stats=pairs "$@")
        distance=-
        [ $cutoff = mahalanobis ] || distance=$("$B/fixsplat" compare "$work/mahalanobis.png" "$work/square.png" |
            sed 's/PSNR \([0-9.]*\) dB.*/\1/')
        printf '| %s, %s | %s | %s | %s | %s | %s | %s |\n' "$name" $cutoff "$(echo "$json" | sed 's/bytes.*//' | field entries)" \
            "$(echo "$json" | field pairs_evaluated)" "$(echo "$json" | field pairs_blended)" "$blend_c" "$blend_all" \
            "$distance"
    done
}

cutoffs() {
    printf '### The cut-offs\n\nThe columns `pairs` count pairs of a splat and a pixel (1280x720). The columns `blend` have milliseconds of this stage by\n'
    printf 'one thread. PSNR compares the picture with the cut-off square with the picture with the cut-off mahalanobis.\n\n'
    printf '| scene, cut-off | tile entries | pairs evaluated | pairs blended | blend, C | blend | PSNR, dB |\n'
    printf '|---|---|---|---|---|---|---|\n'
    landscape 1000000
    cutoff_rows 'landscape 1,000,000' "$work/1000000.ply"
    [ ! -d "$SCENES" ] || cutoff_rows 'snowmiku, view 8' "$SCENES/snowmiku/snowmiku.ply" \
        --cameras "$SCENES/snowmiku/cameras.json" --view 8
}

gles_rows() {
    name=$1 file=$2
    shift 2
    for backend in cpu gles gles-fetch; do
        json=$("$B/fixsplat" bench --json "$file" --threads $two --size 1280x720 --backend $backend "$@")
        "$B/fixsplat" render "$file" --size 1280x720 --backend $backend -o "$work/$backend.ppm" "$@"
        printf '| %s, %s | %s | %s | %s | %s |\n' "$name" $backend "$(echo "$json" | field frame_ms)" \
            "$(echo "$json" | field blend)" "$(echo "$json" | field device_ms | sed 's/^0.000$/-/')" \
            "$("$B/fixsplat" compare "$work/cpu.ppm" "$work/$backend.ppm" | sed 's/, SSIM.*//')"
    done
}

gles() {
    device=$("$B/fixsplat" info --backends | sed -n 's/^gles  *here: \(.*\) (OpenGL.*/\1/p')
    [ "$device" ] || return 0
    printf 'On %s, 1280x720, milliseconds, %s threads. blend: for a back end, upload, draw and reading back; device: ' \
        "$device" $two
    printf 'the part of it from the first upload to the last draw, by the device.\n\n'
    printf '| scene, back end | frame | blend | device | against cpu |\n|---|---|---|---|---|\n'
    landscape 1000000
    gles_rows 'landscape 1,000,000' "$work/1000000.ply"
    if [ -d "$SCENES" ]; then
        for view in 8 40 72; do
            gles_rows "snowmiku, view $view" "$SCENES/snowmiku/snowmiku.ply" \
                --cameras "$SCENES/snowmiku/cameras.json" --view $view
        done
        gles_rows statue-st-peter "$SCENES/statue-st-peter/st-peter.ply"
    fi
}

limit_rows() {
    name=$1 file=$2 all=
    shift 2
    bytes=$("$B/fixsplat" render "$file" --threads 1 --size 1280x720 --stats "$@" | sed 's/.*"bytes"//' | field frame)
    for share in 1 2 4 8; do
        set -- "$@" --threads 1 --size 1280x720 --max-memory $((bytes / share))
        mb=$(awk "BEGIN {printf \"%.1f\", $bytes / $share / 1e6}")
        if ! json=$("$B/fixsplat" render "$file" --stats "$@" 2>"$work/needs"); then
            least=$(sed 's/.* \([0-9]*\) bytes$/\1/' "$work/needs")
            printf '| %s, 1/%s | %s | too little: %s | | | | | |\n' "$name" $share $mb \
                "$(awk "BEGIN {printf \"%.1f\", $least / 1e6}")"
            continue
        fi
        bands=$(echo "$json" | field bands) json=$("$B/fixsplat" bench --json "$file" --frames 20 "$@")
        frame=$(echo "$json" | field frame_ms)
        all=${all:-$frame}
        printf '| %s, 1/%s | %s | %s | %s | %s | %s | %s | %s |\n' "$name" $share $mb "$bands" \
            "$(echo "$json" | field project)" "$(echo "$json" | field shade)" "$(echo "$json" | field bin)" $frame \
            "$(awk "BEGIN {printf \"%.2f\", $frame / $all}")"
    done
}

limits() {
    printf 'Times are milliseconds at 1280x720 with one thread.\n\n| view, share of the memory | MB | bands | project | shade | bin | frame | times |\n'
    printf '|---|---|---|---|---|---|---|---|\n'
    landscape 1000000
    limit_rows 'landscape 1,000,000, all in view' "$work/1000000.ply"
    [ ! -d "$SCENES" ] || limit_rows 'snowmiku, view 8' "$SCENES/snowmiku/snowmiku.ply" \
        --cameras "$SCENES/snowmiku/cameras.json" --view 8
}

sizes() {
    printf 'The table compares 8-bit pictures (960x640) with double precision from the file'\''s floats: mean (worst) of four views.\n\n'
    FXS_PROCESSORS=all FXS_SCENES=$SCENES "$B/tests/test_quality" | grep '^|' | grep -v 'pixel stage alone'
}

# Prints the times to render one eye and both eyes. Each is the fastest of alternating runs, because other programs can
# only slow a run.
stereo_row() {
    name=$1 file=$2 apart=$3
    shift 3
    rm -f "$work"/turn-*
    for stereo in '' "--stereo $apart" '' "--stereo $apart" '' "--stereo $apart"; do
        "$B/fixsplat" bench --json "$file" --threads 1 --frames 20 --size 1280x720 $stereo "$@" | field frame_ms_min \
            >>"$work/turn-${stereo%% *}"
    done
    awk -v name="$name" -v one="$(sort -n "$work/turn-" | head -n 1)" -v two="$(sort -n "$work/turn---stereo" | head -n 1)" \
        'BEGIN { printf "| %s | %s | %s | %.2f |\n", name, one, two, two / one }'
}

stereo() {
    printf 'Each eye has 1280x720 pixels. The distance between the eyes is 2 %% of the distance to the middle of the scene. Times are\n'
    printf 'milliseconds of the fastest of 60 frames with one thread.\n\n'
    printf '| view | one eye | two eyes | ratio |\n|---|---|---|---|\n'
    landscape 1000000
    stereo_row 'landscape 1,000,000, all in view' "$work/1000000.ply" 2.6
    stereo_row 'landscape 1,000,000, from the shore' "$work/1000000.ply" 0.27 --eye 4.6,-1.9,-12.7 --look 0,-2.2,0 --fov 52
    if [ -d "$SCENES" ]; then
        for view in 8 40 72; do
            stereo_row "snowmiku, view $view" "$SCENES/snowmiku/snowmiku.ply" 0.1 \
                --cameras "$SCENES/snowmiku/cameras.json" --view $view
        done
    fi
}

# Prints table rows for a scene and its decimated versions, with PSNR "equal" for the full scene. Runs alternate and the
# fastest counts, because other programs can only slow a run.
level_rows() {
    name=$1 file=$2 cameras=$3 view=$4 shares='100 50 25 10 5'
    for share in $shares; do
        "$B/fixsplat" convert "$file" "$work/level-$share.fxs" --decimate $share%
    done
    rm -f "$work"/turn-*
    for share in $shares $shares $shares; do
        "$B/fixsplat" bench --json "$work/level-$share.fxs" --threads $two --size 1280x720 --frames 60 $cameras $view |
            field frame_ms_min >>"$work/turn-$share"
    done
    for share in $shares; do
        "$B/fixsplat" info "$work/level-$share.fxs" --compare "$file" --views 8 $cameras >"$work/compared"
        printf '| %s | %s %% | %s | %s | %s | %s |\n' "$name" $share "$(awk '/^Gaussians/ { print $2 + 0 }' "$work/compared")" \
            "$(wc -c <"$work/level-$share.fxs")" "$(awk '/^mean/ { print $2 }' "$work/compared")" \
            "$(sort -n "$work/turn-$share" | head -n 1)"
    done
}

levels() {
    printf 'A row is an .fxs of the Gaussians that `convert --decimate` leaves. PSNR is the mean of 8 views, against the floats of\n'
    printf 'the whole scene. `frame` is the fastest of 180 frames in ms (1280x720, %s threads, snowmiku: view 8).\n\n' $two
    printf '| scene | left | Gaussians | bytes | PSNR, dB | frame |\n|---|---|---|---|---|---|\n'
    if [ -d "$SCENES" ]; then
        level_rows snowmiku "$SCENES/snowmiku/snowmiku.ply" "--cameras $SCENES/snowmiku/cameras.json" '--view 8'
        level_rows statue "$SCENES/statue-st-peter/st-peter.ply" '' ''
    fi
}

detail() {
    [ -d "$B/page/node_modules" ] || sh tools/scripts/page_modules.sh "$B/page" >&2
    node tests/web/budgets.mjs "$1" "$B/fixsplat" "$SCENES" "$B/page/node_modules" "${KEPT:-$B/levels}" ${CAPTURED:-}
}
cuts() { detail cuts; }
budgets() { detail budgets; }
steps() { detail steps; }
boards() { detail boards; }

# Times the stages of a fit step, over 40 steps on one thread. The fit has made FIT_STEPS steps before.
fit_stages() {
    steps=${FIT_STEPS:-3000}
    set -- fit "$PHOTOS/snowmiku" -o "$work/stages.ply" --resolution "${FIT_SIZE:-600}"
    "$B/fixsplat" "$@" --threads $two --steps $((steps + 10000)) --save-every "$steps" 2>"$work/progress" &
    until [ -f "$work/stages.ply.fit" ]; do sleep 1 && kill -0 $!; done
    kill -KILL $!
    wait $! || mv "$work/stages.ply.fit" "$work/saved.fit"
    printf 'snowmiku at %s pixels after %s steps of the reference recipe, one thread, milliseconds a step.\n\n' \
        "${FIT_SIZE:-600}" "$steps"
    printf '| instruction sets | project | bin | blend | loss | back | update | all | Gaussians |\n'
    printf '|---|---|---|---|---|---|---|---|---|\n'
    for cpu in ${FIT_CPUS:-c sse41 avx2 avx512}; do
        "$B/fixsplat" "$@" --threads 1 --cpu "$cpu" --resume "$work/saved.fit" --steps $((steps + 40)) --json \
            >"$work/json" 2>"$work/progress"
        printf '| %s ' "$cpu"
        for stage in project bin blend loss back update; do
            printf '| %s ' "$(field $stage <"$work/json")"
        done
        awk -v s="$(field seconds <"$work/json")" -v n="$(field gaussians <"$work/json")" \
            'BEGIN { printf "| %.3f | %d |\n", 1000 * s / 40, n }'
    done
}

fit() {
    printf 'snowmiku at %s pixels, %s steps of the reference recipe, %s threads; 13 photographs held out.\n\n' \
        "${FIT_SIZE:-600}" "${FIT_STEPS:-3000}" $two
    printf '| cut-off | ms a step | Gaussians | PSNR, dB | 1 - SSIM |\n|---|---|---|---|---|\n'
    for cutoff in mahalanobis square; do
        "$B/fixsplat" fit "$PHOTOS/snowmiku" -o "$work/fit.fxs" --resolution "${FIT_SIZE:-600}" --threads $two \
            --steps "${FIT_STEPS:-3000}" --cutoff $cutoff --json >"$work/json" 2>"$work/progress"
        awk -v cutoff=$cutoff -v s="$(field seconds <"$work/json")" -v n="$(field steps <"$work/json")" \
            -v gaussians="$(field gaussians <"$work/json")" -v psnr="$(field psnr <"$work/json")" \
            -v ssim="$(field ssim <"$work/json")" \
            'BEGIN { printf "| %s | %.1f | %d | %.2f | %.4f |\n", cutoff, 1000 * s / n, gaussians, psnr, 1 - ssim }'
    done
}

tables() {
    growth
    echo
    scenes
    echo
    imports
    echo
    cutoffs
}

fail() {
    echo "bench.sh: $*" >&2
    exit 1
}

stamp() {
    commit=$(git rev-parse --short HEAD 2>/dev/null) || commit=unknown
    [ -z "$(git status --porcelain --untracked-files=no 2>/dev/null)" ] || commit="$commit with changes"
    printf 'Measured %s, commit %s, on %s (%s processors), %s.\n\n' "$(date -u +%Y-%m-%d)" "$commit" \
        "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$(getconf _NPROCESSORS_ONLN)" \
        "$(${CC:-cc} --version | head -n 1)"
}

# measure PART: prints a part of the document. Fails if a number is missing, which leaves two spaces in a table cell.
measure() {
    case $1 in
    tables | gles | sizes | limits | stereo | levels | cuts | budgets | steps | boards | fit | fit_stages) ;;
    *) fail "no part $1: expected tables, gles, sizes, limits, stereo, levels, cuts, budgets, steps, boards, fit or fit_stages" ;;
    esac
    {
        stamp
        $1
    } >"$work/$1"
    ! grep '|  |' "$work/$1" >&2 || fail "$1: a number is missing above; $DOCUMENT is as it was"
    cat "$work/$1"
}

put() {
    awk -v text="$work/$1" -v begin="<!-- $1: begin" -v end="<!-- $1: end" '
        index($0, begin) == 1 { print; print ""; while ((getline line < text) > 0) print line; skip = 1 }
        index($0, end) == 1 { skip = 0; ended = 1; print "" }
        !skip
        END { exit skip || !ended }' "$work/document" >"$work/document.new" ||
        fail "$DOCUMENT: no lines \"<!-- $1: begin\" and \"end\"; it is as it was"
    mv "$work/document.new" "$work/document"
}

cp "$DOCUMENT" "$work/document"
for part in ${*:-tables gles sizes limits stereo levels}; do
    measure "$part"
    put "$part"
done
cat "$work/document" >"$DOCUMENT.new"
mv "$DOCUMENT.new" "$DOCUMENT"
