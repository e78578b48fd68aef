#!/bin/sh
# aar.sh BUILD AAR: builds the package for Android, for arm64-v8a and Android 10 (API 29) or later. Environment
# variables: ANDROID_NDK_HOME; ANDROID_HOME, the folder of the SDK with android.jar; ZIP_TIME, seconds since 1970, the
# time of the files in the package.
build=${1:?build folder} aar=${2:?package}
api=29 abi=arm64-v8a
fail() { echo "aar: $*" >&2; exit 1; }

[ "$ANDROID_NDK_HOME" ] || fail "ANDROID_NDK_HOME is not set: it names the folder of Android's NDK"
tools=$(echo "$ANDROID_NDK_HOME"/toolchains/llvm/prebuilt/*/bin)
clang=$tools/aarch64-linux-android$api-clang
[ -x "$clang" ] || fail "ANDROID_NDK_HOME=$ANDROID_NDK_HOME: there is no toolchains/llvm/prebuilt/*/bin/${clang##*/}"
for program in javac jar zip; do
    command -v $program >/dev/null || fail "not here: $program; apt install openjdk-17-jdk-headless zip"
done
classes=$(ls "$ANDROID_HOME"/platforms/android-*/android.jar 2>/dev/null | sort -V | tail -n 1)

unset MAKEFLAGS MAKELEVEL
make -s B="$build" CC="$clang" AR="$tools/llvm-ar" NVCC=none CFLAGS="${CFLAGS:--O2}" \
    "$build/jni/libfixsplat.so" || exit 1
for name in GLES VULKAN; do
    grep -q "^FOUND += $name$" "$build/probe.mk" || fail "$ANDROID_NDK_HOME: there are no headers of $name"
done

stage=$build/aar library=$build/jni/libfixsplat.so
rm -rf "$stage" "$build/classes"
mkdir -p "$stage/jni/$abi" "$stage/prefab/modules/fixsplat/libs/android.$abi" "$build/classes/android" \
    "$build/classes/fixsplat" "$(dirname "$aar")" || exit 1
if [ "$classes" ]; then
    echo "aar: Java is compiled against $classes"
else
    echo "aar: Java is compiled against stand-ins (tests/android/stubs), as ANDROID_HOME has no android.jar"
    javac --release 8 -Xlint:-options -d "$build/classes/android" $(find tests/android/stubs -name '*.java') || exit 1
    classes=$build/classes/android
fi
javac --release 8 -Xlint:all,-options -cp "$classes" -d "$build/classes/fixsplat" \
    port/android/java/org/fixsplat/*.java || exit 1
in_time() { find "$1" -exec touch -d "@${ZIP_TIME:-315532800}" {} +; }
pack() { (cd "$1" && TZ=UTC && export TZ && in_time . && find . -type f | LC_ALL=C sort | zip -X -q -9 "$2" -@); }
version=$(sed -n 's/^#define FXS_VERSION "\(.*\)"/\1/p' src/include/fixsplat/fixsplat.h)
module=$stage/prefab/modules/fixsplat
rm -f "$aar" "$stage/classes.jar"
pack "$build/classes/fixsplat" "$(cd "$stage" && pwd)/classes.jar" || exit 1
cp port/android/AndroidManifest.xml port/android/proguard.txt "$stage/"
: >"$stage/R.txt"
cp "$library" "$stage/jni/$abi/"
cp "$library" "$module/libs/android.$abi/"
mkdir -p "$module/include/fixsplat/internal"
cp src/include/fixsplat/*.h "$module/include/fixsplat/"
cp src/include/fixsplat/internal/*.h "$module/include/fixsplat/internal/"
(cd "$module/include/fixsplat" && rm fit.h cuda.h internal/fit_more.h internal/declarations.h)
revision=$(sed -n 's/^Pkg.Revision *= *\([0-9]*\).*/\1/p' "$ANDROID_NDK_HOME/source.properties" 2>/dev/null)
cat >"$stage/prefab/prefab.json" <<END
{"schema_version": 2, "name": "fixsplat", "version": "$version", "dependencies": []}
END
echo '{"export_libraries": [], "library_name": "libfixsplat"}' >"$module/module.json"
cat >"$module/libs/android.$abi/abi.json" <<END
{"abi": "$abi", "api": $api, "ndk": ${revision:-0}, "stl": "none", "static": false}
END
mkdir -p "$(dirname "$aar")"
pack "$stage" "$(cd "$(dirname "$aar")" && pwd)/${aar##*/}" || exit 1
ls -l "$aar" | awk '{ print "aar: " $NF ", " $5 " bytes" }'
