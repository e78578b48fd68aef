#!/bin/sh
# The package for Android, without Android: the classes and the JNI on this machine's Java, with stand-ins for the
# libraries and classes of Android, and the library for AArch64, by a stand-in for the NDK.
. tests/scripts/lib/check.sh
B=${B:-build}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
case $B in /*) ;; *) B=$PWD/$B ;; esac
parts=$B/tests/android command=$B/fixsplat

# ---- The package, which is built while Java draws

ndk=$parts/ndk
by_make() {
    sh tests/android/ndk.sh "$ndk" && NVCC=none ANDROID_NDK_HOME=$ndk ANDROID_HOME=/none \
        make -s B="$parts/by_ndk" AAR="$work/fixsplat.aar" aar
}
made() { cat "$work/made" && [ -e "$work/fixsplat.aar" ]; }
library=$work/aar/jni/arm64-v8a/libfixsplat.so
module=$work/aar/prefab/modules/fixsplat

# Names of glibc for functions that have other names in Android's C library; bcmp is clang's for memcmp on glibc.
in_android() {
    sed -e 's/@.*//' -e 's/^__errno_location$/__errno/' -e 's/^\(fcntl\)64$/\1/' -e 's/^__sysv_\(signal\)$/\1/' \
        -e 's/^__ctype_b_loc$/isspace/' -e 's/^bcmp$/memcmp/' -e 's/^__\(getauxval\)$/\1/'
}
needed() { readelf -dW "$library" | sed -n 's/.*(NEEDED).*\[\([^.]*\)\.so.*/\1/p' | LC_ALL=C sort | tr '\n' ' '; }
unknown() {
    sed -n 's/^lib[a-z]*: //p' tests/android/names-29 | tr ' ' '\n' | LC_ALL=C sort -u >"$work/names"
    nm -D --undefined-only "$library" | awk '$1 == "U" { print $2 }' | in_android | LC_ALL=C sort -u |
        LC_ALL=C comm -23 - "$work/names"
}
by_cmake() {
    cmake -S tests/android -B "$work/outside" -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
        -DCMAKE_C_COMPILER="$(echo "$ndk"/toolchains/llvm/prebuilt/*/bin/aarch64-linux-android29-clang)" \
        -DMODULE="$module" && cmake --build "$work/outside"
}
drawn() {
    "${CC:-cc}" -Isrc/include tests/outside/all.c -o "$work/all" "$B"/libfixsplat.so.*.*.* || return
    ln -s "$B"/libfixsplat.so.*.*.* "$work/libfixsplat.so.1"
    LD_LIBRARY_PATH=$work "$work/all" "$work/scenes/knot.ply" "$work/here.fxs" >"$work/here" &&
        qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="${library%/*}" "$work/outside/with-module" \
            "$work/scenes/knot.ply" "$work/by_qemu.fxs" >"$work/by_qemu" &&
        cmp "$work/here" "$work/by_qemu" && cmp "$work/here.fxs" "$work/by_qemu.fxs"
}

# ---- Java on this machine: Check.java draws by each way, and compares with the command's pictures

scenes() {
    mkdir -p "$work/scenes/assets" && cd "$work/scenes" || return
    "$command" make-scene knot --count 6000 -o knot.ply && "$command" convert knot.ply tree.fxs --levels &&
        "$command" convert knot.ply flat.fxs &&
        { printf 'pad!'; cat tree.fxs; } >assets/tree.fxs && cp assets/tree.fxs assets/tree.fxs.z
}

compile() {
    javac -Xlint:all -Werror -d "$work/classes" port/android/java/org/fixsplat/*.java tests/android/*.java \
        docs/examples/android/MainActivity.java $(find tests/android/stubs -name '*.java')
}

has_cuda=false
nm "$parts/libfixsplat.so" 2>/dev/null | grep -q cudaMalloc && has_cuda=true

# use WAY EVENTS: runs Check by a way to draw, with a life of EVENTS random events.
use() {
    EGL_PLATFORM=surfaceless LIBGL_ALWAYS_SOFTWARE=1 LD_LIBRARY_PATH=$parts/stand_in timeout 1500 \
        java -XX:TieredStopAtLevel=1 -Xcheck:jni -Dcuda="$has_cuda" -Dstand_in="$parts/stand_in/libEGL.so" \
        -Djava.library.path="$parts" \
        -cp "$work/classes" org.fixsplat.Check "$command" "$work/scenes" "$1" "$2" >"$work/$1" 2>&1 ||
        echo "FAIL status $?" >>"$work/$1"
}

# tell WAY: prints the lines of a run. Whatever else it printed is a fault: of JNI, or of the validation layer.
tell() {
    while read -r result text; do
        case $result in
        ok) ok "$1: $text" ;;
        FAIL) fail "$1: ${text%%: *}" "${text#*: }" ;;
        esac
    done <"$work/$1"
    check "$1: no complaint of Java's or Vulkan's" equal "$(grep -Ev '^(ok|FAIL) ' "$work/$1" | head -n 12)" ""
}

has_ndk=yes
for program in javac clang ld.lld aarch64-linux-gnu-gcc qemu-aarch64 zip unzip; do have $program || has_ndk=; done
[ -d /usr/include/vulkan ] || has_ndk=
[ -z "$has_ndk" ] || by_make >"$work/made" 2>&1 &
check "scenes" scenes
if ! have javac || [ ! -e "$parts/libfixsplat.so" ]; then
    skip "Java" "no JDK, or no headers of EGL and Vulkan here"
else
    check "the classes compile" compile
    use gles-compute 60
    use gles 60
    VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation use vulkan 500
    for way in gles-compute gles vulkan; do tell $way; done
fi

# ---- The package

check "without an NDK, one line" equal "$(env -u ANDROID_NDK_HOME make -s aar 2>&1 | grep -v '^make')" \
    "aar: ANDROID_NDK_HOME is not set: it names the folder of Android's NDK"
check "an NDK that is not there, one line" equal "$(ANDROID_NDK_HOME=/none make -s aar 2>&1 | grep -vc '^make')" 1
wait
if [ -z "$has_ndk" ]; then
    skip "the package" "no JDK, clang, lld, compiler and qemu for AArch64, zip or headers of Vulkan here"
else
    check "make aar" made
    check "unpacks" unzip -q "$work/fixsplat.aar" -d "$work/aar"
    bytes=$(stat -c %s "$library")
    check "the library has less than 1.5 MB ($bytes bytes)" test "$bytes" -lt 1500000
    check "pages of 16 KiB" equal "$(readelf -lW "$library" | awk '$1 == "LOAD" { print $NF }' | sort -u)" 0x4000
    check "it needs Android's C library alone" equal "$(needed)" "libc libm "
    check "it calls what Android has at API 29" equal "$(unknown)" ""
    check "it exports fxs_ and JNI_OnLoad" equal \
        "$(nm -D --defined-only "$library" | awk '$2 != "A" && $3 !~ /^fxs_/ { sub(/@.*/, "", $3); print $3 }')" JNI_OnLoad
    check "the module has the same library" cmp "$library" "$module/libs/android.arm64-v8a/libfixsplat.so"
    check "its files" equal "$(cd "$work/aar" && find * -type f ! -path '*/include/*' ! -path '*/libs/*' |
        LC_ALL=C sort | tr '\n' ' ')" "AndroidManifest.xml R.txt classes.jar jni/arm64-v8a/libfixsplat.so $(
        )prefab/modules/fixsplat/module.json prefab/prefab.json proguard.txt "
    check "its JSON" sh -c "for f in $module/module.json $work/aar/prefab/prefab.json $module/libs/*/abi.json; do
        python3 -m json.tool \$f || exit 1; done"
    check "CMake takes the module" by_cmake
    check "as AArch64, it packs and draws the same bytes" drawn
fi
finish
