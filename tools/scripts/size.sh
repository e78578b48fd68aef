#!/bin/sh
# size.sh BUILD: prints the bytes of code and data of each part, without debugging information.
build=${1:?build folder}
stripped=$(mktemp) || exit 1
objects=$(mktemp -d) || exit 1
trap 'rm -rf "$stripped" "$objects"' EXIT

row() { printf '%-24s %9s %9s %9s\n' "$@"; }

part() {
    name=$1 size=$2
    shift 2
    for file in "$@"; do
        shift
        [ -f "$file" ] && set -- "$@" "$file"
    done
    if [ $# = 0 ]; then
        row "$name" - - -
    else
        row "$name" $("$size" "$@" | awk 'NR > 1 { text += $1; data += $2; bss += $3 } END { print text, data, bss }')
    fi
}

objects_of() {
    for source in "$1"/*.c; do
        echo "$build/${source%.c}.o"
    done
}

row "bytes, $(uname -m)" text data bss
for folder in src/*/ src/*/*/ kernels kernels/*/ kernels/*/*/ port/*/ tools; do
    folder=${folder%/}
    ls "$folder"/*.c >/dev/null 2>&1 && part "$folder" size $(objects_of "$folder")
done
strip -o "$stripped" "$build/fixsplat" && part "fixsplat, stripped" size "$stripped"

if command -v arm-none-eabi-gcc >/dev/null 2>&1; then
    for source in src/core/*.c; do
        object=$objects/$(basename "$source" .c).o
        arm-none-eabi-gcc -std=c99 -Isrc/include -I. -Os -mcpu=cortex-m3 -mthumb -c "$source" -o "$object" || exit 1
    done
    part "src/core, Cortex-M3 -Os" arm-none-eabi-size "$objects"/*.o
fi
