#!/bin/sh
# ndk.sh FOLDER [BIONIC]: makes a stand-in for Android's NDK, which is not in Debian: its clang is Debian's, for
# AArch64. With BIONIC, the folder of a copy of Android's C library, its public headers are used, and libraries without
# code that have its names for API 29. Else the C library is Debian's for AArch64, which has other names for some
# functions. The headers of EGL, OpenGL ES and Vulkan are Debian's; jni.h is from the JDK.
folder=${1:?folder} bionic=$2 with=
bin=$folder/toolchains/llvm/prebuilt/linux-x86_64/bin
mkdir -p "$bin" "$folder/headers"
jdk=$(dirname "$(dirname "$(readlink -f "$(command -v javac)")")")/include
for name in EGL GLES2 GLES3 KHR vulkan vk_video; do ln -sfn /usr/include/$name "$folder/headers/$name"; done
ln -sf "$jdk/jni.h" "$jdk/linux/jni_md.h" "$folder/headers/"
echo 'Pkg.Revision = 0.0.0' >"$folder/source.properties"
ln -sf "$(command -v llvm-ar-14)" "$bin/llvm-ar"
libc=$bionic/libc
if [ "$bionic" ]; then
    mkdir -p "$folder/lib"
    for name in c m dl; do
        sed -n '/^[0-9 ]*[a-zA-Z_]/p' "$(dirname "$0")/names-29" | awk -v library=lib$name '$1 == library ":" {
            for (i = 2; i <= NF; i++) print ".globl " $i "\n.type " $i ",@function\n" $i ":" }' |
            clang --target=aarch64-linux-android29 -shared -nostdlib -fuse-ld=lld -Wl,-soname,lib$name.so -x assembler - \
                -o "$folder/lib/lib$name.so" || exit 1
    done
    flags="--target=aarch64-linux-android29 -nostdlibinc -isystem $libc/include -isystem $libc/kernel/uapi
        -isystem $libc/kernel/uapi/asm-arm64 -isystem $libc/kernel/android/uapi -mno-outline-atomics -nostartfiles
        -nodefaultlibs -L$folder/lib"
    with=-lc
else
    flags=--target=aarch64-linux-gnu
fi
cat >"$bin/aarch64-linux-android29-clang" <<END
#!/bin/sh
case " \$* " in *" -lpthread "*) echo "ld.lld: error: unable to find library -lpthread" >&2; exit 1 ;; esac
exec ${CCACHE:-} clang $(echo $flags) -fuse-ld=lld -Wno-unused-command-line-argument "\$@" -isystem $folder/headers $with
END
chmod +x "$bin/aarch64-linux-android29-clang"
