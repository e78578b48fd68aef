#!/bin/sh
# Makes each change of tests/mutants.txt in a copy of the tree, one at a time, builds it and runs tests until one is
# red. A change that none notices survives: it wants a test, or a line that says why it changes nothing.
#
#     sh tests/mutants.sh              all of them
#     sh tests/mutants.sh src/core/bin.c    those whose line contains the text
#
# JOBS: changes at a time, each in a tree of its own (the number of processors). FOLDER: where the trees are, and stay,
# so that a later run builds less (a new one in /tmp, removed at the end). Fails where a change survives, is noticed
# against the list's word, or no longer has its place.
JOBS=${JOBS:-$(nproc)}
list=tests/mutants.txt
here=$(pwd)
if [ -z "$FOLDER" ]; then
    folder=$(mktemp -d /tmp/mutants-XXXXXX) || exit 1
    trap 'rm -rf "$folder"' EXIT
    trap 'exit 1' INT TERM
else
    mkdir -p "$FOLDER" && folder=$(cd "$FOLDER" && pwd) || exit 1
fi
export FXS_SCENES=$folder/none     # captured scenes: too slow here
ulimit -c 0
ulimit -v 8388608

# The tests for a file, by what notices most in the least time.
tests_of() {
    case $1 in
    src/core/stereo.c | src/core/eyes.c) echo stereo scribble ;;
    src/core/scene.c | src/include/fixsplat/packed.h) echo scene random pack fxs_file stages kernels bands ;;
    src/core/slices.c) echo bands strip objects stop ;;
    src/core/bands.c) echo random bands stereo stages scene scribble ;;
    src/core/chunk.c | src/core/frame.* | src/core/draw.c | src/core/times.c | src/core/prepare.c | src/core/lists.c | src/core/runs.c) echo random stages scene stereo kernels bands scribble stop golden foveate ;;
    src/include/fixsplat/pixel.h | src/include/fixsplat/fixed.h) echo random fixed stages kernels pixel scene golden ;;
    src/core/opacity.inc) echo pack random stages kernels ;;
    src/core/object.c | src/core/trace.c | src/core/targets.c | src/core/pick.c) echo targets objects stages ;;
    src/core/*) echo random stages scene stereo kernels bands golden targets objects foveate ;;
    port/board/*) echo strip ;;
    src/fit/photo* | */lens.c) echo photos photo_bytes ;;
    src/fit/profile* | src/fit/quantise.h) echo fit_profile fit_steps ;;
    src/fit/checkpoint.c) echo checkpoint ;;
    src/fit/*.h | src/fit/fit*.c | src/fit/stepper.c) echo fit_gradient fit_loss fit_numbers fit_steps ;;
    src/fit/*) echo fit_model fit_steps ;;
    port/backend/foveate.c) echo foveate ;;
    kernels/gles/*) echo gles ;;
    kernels/fit/*) echo fit_gradient fit_loss ;;
    kernels/*) echo kernels foveate random stereo golden bands ;;
    */camera.c | */message.c) echo camera_file golden ;;
    */camera* | */colmap_text.c | */view_list.c) echo camera_file photos ;;
    */byte_reader.c) echo pack splat ksplat ply compressed_ply spz scene_input ;;
    */image_file.c | */image_encode.c | */png.c) echo image_file photo_bytes ;;
    */output.c) echo image_file ply splat spz fxs_file ;;
    */encode.c | */pack.c | */order.c | */palette.c) echo fxs_bytes fxs_file pack scene_filter golden ;;
    */fxs_file.c) echo fxs_bytes fxs_file scene_input ;;
    */scene_write.c | */held_write.c | */csv_write.c | */gltf_write.c | */sog_write.c | */compressed_ply_write.c | \
        */codebook_write.c | */zip_write.c) echo scene_write ;;
    */scene_decimate.c) echo scene_decimate ;;
    */ply*) echo ply compressed_ply scene_input allocation pack ;;
    */compressed_ply.c) echo compressed_ply scene_input allocation ;;
    */gltf.c) echo gltf bombs scene_input allocation ;;
    */sog.c | */zip.c) echo sog gltf bombs scene_input allocation ;;
    */spz*) echo spz gltf bombs scene_input allocation ;;
    */splat*) echo splat scene_input allocation ;;
    */ksplat.c) echo ksplat scene_input allocation ;;
    */lcc.c) echo lcc scene_input allocation ;;
    */scene_filter.c | */floaters.c) echo scene_filter scene_input allocation ;;
    port/backend/processor.c | */world*.c | */merge.c | tools/*) echo cli.sh ;;
    port/posix/pool.c) echo threads allocation ;;
    port/posix/map.c) echo fxs_file ;;
    *) echo bombs splat ply gltf sog spz ksplat compressed_ply camera_file scene_filter scene_input allocation pack ;;
    esac
}

build() {
    make -s -f Makefile -f "$folder/keep.mk" CFLAGS=-O1 NVCC=none "$@"
}

# What make builds for a test: a program of its own, or the command for a script.
built_for() {
    case $1 in
    *.sh) echo build/fixsplat ;;
    *) echo "build/tests/test_$1" ;;
    esac
}

objects() {
    find build/src build/kernels build/port build/tools -name '*.o' | sort | xargs cat | cksum
}

# Runs a test of the tree that this is in. Its time without a change, and ten seconds, are its limit.
run_test() {
    limit=$(($(cat "$folder/time.$1" 2>/dev/null || echo 90) * 4 + 10))
    case $1 in
    *.sh) timeout "$limit" sh "tests/scripts/$1" >test.log 2>&1 ;;
    *) timeout "$limit" "build/tests/test_$1" >test.log 2>&1 ;;
    esac
}

# Times a test without a change; one that is red then already is left out.
measure() {
    start=$(date +%s)
    if run_test "$1"; then
        echo $(($(date +%s) - start + 1)) >"$folder/time.$1"
    else
        echo "$1 is red without a change, and left out:"
        tail -n 5 test.log
    fi
}

# Replaces the fragment, which must stand in the file once; else prints how often it does.
change() {
    FRAGMENT=$2 BY=$3 awk '
        { text[NR] = $0
          for (at = 1; (i = index(substr($0, at), ENVIRON["FRAGMENT"])) > 0; at = column + 1) {
              column = at + i - 1; line = NR; n++
          } }
        END { if (n != 1) { print n + 0 > "/dev/stderr"; exit 1 }
              for (i = 1; i <= NR; i++)
                  print i == line ? substr(text[i], 1, column - 1) ENVIRON["BY"] \
                                    substr(text[i], column + length(ENVIRON["FRAGMENT"])) : text[i] }' "$1"
}

# What becomes of the change that is in the tree: a word, and the test that noticed.
judge() {
    build build/libfixsplat.a build/fixsplat >build.log 2>&1 || { echo "does not compile"; return; }
    [ "$(objects)" != "$(cat "$folder/objects")" ] || { echo "not built"; return; }
    for test in $(tests_of "$1"); do
        [ -f "$folder/time.$test" ] || continue
        build "$(built_for "$test")" >build.log 2>&1 || { echo "does not compile"; return; }
        run_test "$test" || { echo "caught by $test"; return; }
    done
    echo survived
}

# Puts back what a change made new.
restore() {
    find build "$1" -newer "$folder/stamp.$2" -type f | while read -r file; do
        cp -p "$folder/tree/$file" "$file"
    done
}

# One line of the list, in the tree of a job.
mutate() {
    line=$1 file=${1%% | *} rest=${1#* | }
    fragment=${rest%% ==> *} rest=${rest#* ==> }
    by=${rest%% ## *} why=
    [ "$by" = "$rest" ] || why=${rest#* ## }
    start=$(date +%s)
    touch "$folder/stamp.$2"
    if ! [ -f "$file" ]; then
        outcome="no such file"
    elif count=$(change "$file" "$fragment" "$by" 2>&1 >changed); then
        cat changed >"$file"
        outcome=$(judge "$file")
    else
        outcome="stands there $count times"
    fi
    restore "$file" "$2" 2>/dev/null
    [ "$outcome" = survived ] && [ -n "$why" ] && outcome="changes nothing"
    printf '%s, %d s: %s\n' "$outcome" $(($(date +%s) - start)) "${line%% ## *}"
}

# A job takes lines that no other has taken.
work() {
    cd "$folder/tree.$1" || exit 1
    number=0
    while read -r line; do
        number=$((number + 1))
        mkdir "$folder/taken/$number" 2>/dev/null && mutate "$line" "$1"
    done <"$folder/list"
}

grep ' ==> ' $list | grep -v '^#' | grep -F -- "${1:-}" >"$folder/list"
[ -s "$folder/list" ] || { echo "no line of $list has \"$1\""; exit 1; }
wanted=$(while read -r line; do tests_of "${line%% | *}"; done <"$folder/list" | tr ' ' '\n' | sort -u)
echo .SECONDARY: >"$folder/keep.mk"
rm -rf "$folder"/tree.* "$folder"/time.* "$folder/taken"
mkdir -p "$folder/tree" "$folder/taken"
tar cf - Makefile make src kernels port tools tests | tar xf - -C "$folder/tree" || exit 1

cd "$folder/tree" || exit 1
build -j"$JOBS" build/libfixsplat.a build/fixsplat $(for test in $wanted; do built_for "$test"; done) >build.log 2>&1 ||
    { cat build.log; exit 1; }
objects >"$folder/objects"
for test in $wanted; do
    measure "$test"
done
start=$(date +%s)
job=0
while [ $job -lt "$JOBS" ]; do
    cp -a "$folder/tree" "$folder/tree.$job"
    work $job >"$folder/out.$job" &
    job=$((job + 1))
done
wait
cd "$here" || exit 1

cat "$folder"/out.* >"$folder/report"
rm -f "$folder"/out.*
sort "$folder/report"
count() {
    grep -c "^$1" "$folder/report"
}
bad=$(grep -Evc '^(caught|changes nothing|not built)' "$folder/report")
echo "$(count .) changes: $(count caught) caught, $(count survived) survived," \
     "$(count 'changes nothing') change nothing, $(count 'not built') not built here," \
     "$(count 'does not compile') do not compile," \
     "$(grep -Ec '^(stands|no such)' "$folder/report") have lost their place; $(($(date +%s) - start)) s by $JOBS jobs"
[ "$bad" = 0 ]
