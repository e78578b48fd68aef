#!/bin/sh
# Checks that each source folder includes only its own headers and the headers that the tables below allow.
cd "$(dirname "$0")/../.." || exit 1
faults=

# Each line names a folder, then the other folders whose headers its files may include. The first line that matches a
# folder counts.
rooms='
src/core
src/base        src/core
src/gaussian    src/base src/core
src/camera      src/gaussian src/base src/core
src/image       src/camera src/base src/core
src/open        src/scene src/select src/pack src/gaussian src/camera src/base src/core port/posix port/backend
src/pack        src/gaussian src/base src/core
src/select      src/pack src/gaussian src/base src/core
src/scene       src/select src/pack src/gaussian src/base src/core
src/surface     src/scene src/select src/pack src/gaussian src/camera src/base src/core
src/fit         src/scene src/select src/pack src/gaussian src/image src/camera src/base src/core
kernels/simd/lanes  src/core
kernels/simd    kernels/simd/lanes kernels src/core
kernels/gl      src/core
kernels/gles    kernels/gl src/core
kernels/compute kernels/gl src/core
kernels/vulkan  kernels/compute src/core
kernels/cuda    src/core
kernels/fit/vulkan  src/fit src/base kernels/vulkan kernels/compute src/core port/vulkan
kernels/fit     src/fit kernels/cuda
kernels/pack    src/pack
kernels         kernels/simd/lanes src/core
port            src kernels/gl kernels/gles kernels/compute kernels/vulkan kernels/cuda kernels/fit kernels
tools           public
'

public='
src/core      fixsplat pace rates packed parts stage pixel fixed declarations weigh
src/base      allocator message scene sound system output
src/gaussian  pack start
src/camera    camera view_more
src/image     image film picture_metrics
src/select    select
src/scene     world placements edits time_range
src/surface   surface collide
src/fit       fit fit_more
kernels       kernels
kernels/gl    gl gl_contexts
kernels/cuda  cuda
kernels/vulkan  vulkan
port/posix    pager pager_more
port/backend  backend backends renderer
port/board    board
'

files() {
    find "$@" -type f \( -name '*.[ch]' -o -name '*.inc' -o -name '*.cu' -o -name '*.cuh' \) 2>/dev/null
}

files src kernels port tools | xargs grep -HE '^[ 	]*#[ 	]*include' |
    sed -E 's/^([^:]*):[^"<]*(["<])([^">]*).*/\1 \2 \3/' |
    ROOMS=$rooms PUBLIC=$public awk '
    function says(why) { print $1 ": " why }
    function within(path, room) { return index(path "/", room "/") == 1 }
    function room_of(path,    i) {
        for (i = 1; i <= count; i++)
            if (within(path, room[i]))
                return i
        return 0
    }
    function may(i, path,    words, k, n) {
        if (within(path, room[i]))
            return 1
        n = split(allowed[i], words, " ")
        for (k = 1; k <= n; k++)
            if (words[k] == "kernels" ? path !~ /^kernels\/.*\// && path ~ /^kernels/ : within(path, words[k]))
                return 1
        return 0
    }
    BEGIN {
        n = split(ENVIRON["ROOMS"], lines, "\n")
        for (i = 1; i <= n; i++)
            if (split(lines[i], words, " ")) {
                room[++count] = words[1]
                allowed[count] = substr(lines[i], length(words[1]) + 1)
            }
        n = split(ENVIRON["PUBLIC"], lines, "\n")
        for (i = 1; i <= n; i++) {
            m = split(lines[i], words, " ")
            for (k = 2; k <= m; k++)
                owner[words[k] ".h"] = words[1]
        }
    }
    {
        name = $3
        sub(/.*\//, "", name)
        folder = $1
        sub(/\/[^\/]*$/, "", folder)
        if (folder ~ /^src\/include\/fixsplat/) {
            base = $1
            sub(/.*\//, "", base)
            if (!(base in owner)) {
                if (!(base in told)) says("no room is said for it in tests/gates/include_rules.sh")
                told[base] = 1
                next
            }
            folder = owner[base]
            if ($2 == "\"" && $3 !~ /\//)
                $3 = "fixsplat/" $3
            $2 = "<"
        }
        i = room_of(folder "/x")
        isa = $3 ~ /^([a-z]*mmintrin\.h|cpuid\.h|arm_(neon|mve|acle)\.h|sys\/auxv\.h|wasm_simd128\.h)$/
        plain = $3 ~ /^std(int|def)\.h$/
        if ($2 == "<" && $3 ~ /^fixsplat\//) {
            if (folder ~ /^tools/ || folder ~ /^port/)
                next
            if (!(name in owner)) says("no public header " $3)
            else if (!may(i, owner[name] "/" name)) says("includes <" $3 "> of " owner[name])
        } else if ($2 == "<") {
            if (folder == "src/core" && !plain && !($1 == "src/core/memory.h" && $3 == "string.h") ||
                folder ~ /^kernels\/simd\/lanes/ && !plain ||
                folder ~ /^kernels(\/simd|$)/ && !plain && !isa ||
                folder ~ /^src/ && $3 ~ /^(unistd|fcntl|pthread|signal|sched|dirent|sys\/.*|cuda.*|GL.*|EGL.*|vulkan.*)(\.h)?$/ ||
                folder ~ /^(kernels|port)/ && folder !~ /^((kernels|port)\/vulkan|port\/android)/ && $3 ~ /^vulkan\// ||
                folder ~ /^tools/ && $3 ~ /^(cuda|GL|EGL|vulkan)/)
                says("includes <" $3 ">")
        } else if ($3 ~ /\//) {
            if (folder ~ /^tools/)
                ok = $3 ~ /^(src|port|tools)\/[a-z\/_]*\.h$/ && $3 !~ /_internal\.h$/
            else
                ok = may(i, $3) && !(folder ~ /^port/ && $3 ~ /^kernels\/.*\// && $3 !~ /\/(gl_functions|plan|cuda_fit|vulkan_fit)\.h$/)
            if (!ok) says("includes \"" $3 "\"")
        }
    }' >"${TMPDIR:-/tmp}/include_rules.$$"
faults=$(cat "${TMPDIR:-/tmp}/include_rules.$$")
rm -f "${TMPDIR:-/tmp}/include_rules.$$"

faults="$faults$(files src kernels port tools tests | xargs grep -nE '#[ 	]*include[ 	]*"\.' | sed 's/$/: a way up/')"

# File names must be unique in the folders src, kernels, port and tools. Names such as README.md, package.json and *.py
# are exempt.
twice=$(find src kernels port tools -type f ! -name 'README.md' ! -name package.json ! -name '*.py' | sed 's|.*/||' | sort | uniq -d | tr '\n' ' ')
[ -z "$twice" ] || faults="$faults two files are called $twice"

# Code in src/core and kernels must not allocate memory or print, except in GPU back ends, fitting and packing. Code in
# src must not open files or start threads.
calls='(^|[^A-Za-z0-9_>.])(malloc|calloc|realloc|free|alloca|[a-z]*printf|puts|fopen|fread|fwrite|exit|abort)[ \t]*\('
calling=$(files src/core kernels | xargs awk -f tests/gates/strip_comments.awk | grep -E "$calls" | grep -Ev '^kernels/(fit|pack|vulkan|gles/gles\.c|compute/compute\.c)' | cut -d: -f1,2 |
    tr '\n' ' ')
[ -z "$calling" ] || faults="$faults allocates or prints: $calling"
calls='(^|[^A-Za-z0-9_>.])(fopen|open|creat|rename|unlink|stat|lstat|realpath|mmap|pthread_create|fork|system)[ \t]*\('
calling=$(files src | xargs awk -f tests/gates/strip_comments.awk | grep -E "$calls" | cut -d: -f1,2 | tr '\n' ' ')
[ -z "$calling" ] || faults="$faults opens a file or starts a thread: $calling"

if [ -n "$faults" ]; then
    printf '%s\n' "$faults"
    echo "FAIL include_rules"
    exit 1
fi
echo "ok   include_rules"
