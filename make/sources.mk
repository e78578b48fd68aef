# Source files, compiler flags and optional libraries. make, CMakeLists.txt and tools/scripts/probe.sh read this file.
# Each line is NAME := WORDS without references to other names, because CMake and sh read the file as text.

SOURCES_CORE := src/core/*.c kernels/*.c
KERNELS_x86 := kernels/simd/x86/*.c
KERNELS_arm := kernels/simd/arm/*.c
KERNELS_wasm := kernels/simd/wasm/*.c

# Source files of the library: for every system, for one operating system, for one processor, or for an optional
# library.
SOURCES_LIBRARY := src/base/*.c src/gaussian/*.c src/scene/*.c src/scene/read/*.c src/scene/write/*.c \
                   src/scene/edit/*.c src/open/*.c src/pack/*.c src/camera/*.c src/image/*.c src/fit/*.c src/fit/photos/*.c \
                   src/fit/stages/*.c src/fit/refine/*.c src/select/*.c src/surface/*.c
SOURCES_posix := port/posix/*.c
SOURCES_win32 := port/win32/*.c
SOURCES_PORT := port/backend/*.c port/board/*.c port/xr/*.c
# Source files that need POSIX threads but no other POSIX functions. mingw-w64 provides these threads on Windows.
THREADED_win32 := port/posix/pager.c port/posix/pager_url.c port/posix/pool.c
STAGES_x86 := kernels/fit/fit_sse41.c kernels/fit/fit_avx2.c kernels/fit/fit_avx512.c kernels/pack/*_avx2.c
STAGES_arm := kernels/fit/fit_neon.c
SOURCES_GLES := kernels/gl/*.c kernels/gles/*.c kernels/compute/*.c
SOURCES_VULKAN := kernels/vulkan/*.c kernels/fit/vulkan/*.c port/vulkan/*.c
SOURCES_CUDA := kernels/cuda/cuda.cu kernels/fit/cuda/cuda_fit.cu
SOURCES_EGL := port/gl/egl.c
SOURCES_OSMESA := port/gl/osmesa.c

# Shader files. tools/scripts/shaders.sh turns them into C headers, kernels/gles/shaders.h and
# kernels/compute/shaders.h.
SHADERS_gles := src/include/fixsplat/internal/pixel.h kernels/gl/*.vert kernels/gles/*.vert kernels/gl/*.frag kernels/gles/*.frag
SHADERS_compute := kernels/compute/generated/*.comp kernels/compute/*.frag kernels/compute/*.glsl \
                   kernels/gl/*.vert kernels/gl/*.frag
# tools/scripts/vulkan_shaders.sh -c turns these into kernels/vulkan/shaders.h and kernels/fit/vulkan/shaders.h.
SHADERS_vulkan := kernels/vulkan/generated/*.spv
SHADERS_fit_vulkan := kernels/fit/vulkan/generated/*.spv

# Source files of the command fixsplat. The separate programs for the window and for the web server contain them too,
# except main.c.
SOURCES_TOOL := tools/*/*.c
NOT_TOOL := tools/view/% tools/serve/serve%
SOURCES_VIEW := port/window/*.c tools/view/*.c
SOURCES_WEB := tools/serve/serve*.c port/http/*.c
SOURCES_WEB_posix := port/posix/http/*.c
SOURCES_WEB_win32 := port/win32/http/*.c

# -ffp-contract=off: without fused a * b + c, results are identical on all machines.
STANDARD := -std=c99 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion
# gcc wrongly assumes that the Windows stack is aligned to more than 16 bytes (gcc bug 54412).
FLAGS_win32 := -Wa,-muse-unaligned-vector-move -Wno-float-conversion
PIC_posix := -fPIC -fno-semantic-interposition -fvisibility=hidden
CUDA_FLAGS := -diag-suppress 177 -gencode arch=compute_90,code=sm_90 -gencode arch=compute_80,code=compute_80 \
              -gencode arch=compute_75,code=compute_75 \
              -Xcompiler -fno-exceptions,-fno-rtti,-fno-threadsafe-statics,-fPIC,-fvisibility=hidden
CUDA_FIT_FLAGS := -fmad=false

# Kinds of source files that need special compiler flags. FILES_kind lists source files without .c, FLAGS_kind their
# flags. Where flags conflict, later kinds win.
KINDS := WRAPS ALIGNED FAST SSE41 AVX2 AVX512 VECTORISED SINGLES
# Kind WRAPS: integers wrap around, because unused vector lanes may overflow.
FILES_WRAPS := src/image/image_encode kernels/%
FLAGS_WRAPS := -fwrapv
# Kind ALIGNED: functions start at a cache line, because their speed depends on the position in the line.
FILES_ALIGNED := kernels/simd/x86/%
FLAGS_ALIGNED := -falign-functions=64
# Kind FAST: hot code is compiled with -O3 instead of -O2.
FILES_FAST := kernels/% src/pack/%
FLAGS_FAST := -O3
FILES_SSE41 := %_sse41
FLAGS_SSE41 := -msse4.1
FILES_AVX2 := %_avx2
FLAGS_AVX2 := -mavx2
FILES_AVX512 := %_avx512
FLAGS_AVX512 := -mavx512f -mavx512bw -mavx512dq -mavx512vl -mavx512cd -mavx512vbmi
# Kind VECTORISED: code that reads neither errno nor floating-point traps. So the compiler may vectorise its loops with
# identical results.
FILES_VECTORISED := src/pack/coarsen src/pack/pack_c kernels/pack/%
FLAGS_VECTORISED := -O3 -fno-math-errno -fno-trapping-math
# Kind SINGLES: float arithmetic without excess precision, which i686 and s390x have by default. No flags are added if
# FLT_EVAL_METHOD is 0, else the first entry of SINGLES_BY that makes it 0. In an entry, a comma stands for a space.
FILES_SINGLES := src/fit/% kernels/fit/% kernels/pack/% src/camera/% src/pack/% src/scene/% src/gaussian/% \
                 src/select/% src/surface/% src/image/photograph tests/gpu/test_fit% tests/test_fit_%
SINGLES_BY := -msse2,-mfpmath=sse -msse2 -fexcess-precision=fast

# LIBRARY_name: the header and the linker options of an optional library. A library with the option -ldl alone is
# loaded at run time.
LIBRARY_CJSON := cjson/cJSON.h -lcjson
LIBRARY_EXPAT := expat.h -lexpat
LIBRARY_ZIP := zip.h -lzip
LIBRARY_ZLIB := zlib.h -lz
LIBRARY_DEFLATE := libdeflate.h -ldeflate
LIBRARY_ZSTD := zstd.h -lzstd
LIBRARY_PNG := png.h -lpng
LIBRARY_JPEG := jpeglib.h -ljpeg
LIBRARY_WEBP := webp/decode.h -lwebp
LIBRARY_EXIF := libexif/exif-data.h -lexif
LIBRARY_HEIF := libheif/heif.h -ldl
LIBRARY_STB := stb/stb_image_write.h
LIBRARY_SDL := SDL2/SDL.h -lSDL2
LIBRARY_TTF := SDL2/SDL_ttf.h -lSDL2_ttf
LIBRARY_MICROHTTPD := microhttpd.h -lmicrohttpd
LIBRARY_QRENCODE := qrencode.h -lqrencode
LIBRARY_CURL := curl/curl.h -ldl
LIBRARY_GLES := GLES3/gl3.h -ldl
LIBRARY_EGL := EGL/egl.h
LIBRARY_OSMESA := GL/osmesa.h
LIBRARY_VULKAN := vulkan/vulkan_core.h -ldl
LIBRARY_OPENXR := openxr/openxr.h -ldl

LINKED := CJSON EXPAT ZIP PNG JPEG WEBP EXIF HEIF ZLIB DEFLATE ZSTD GLES VULKAN OPENXR CURL
LINKED_VIEW := TTF SDL
LINKED_WEB := MICROHTTPD QRENCODE
SOCKETS_win32 := -lws2_32 -liphlpapi
