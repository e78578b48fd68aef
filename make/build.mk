# Builds the command and the libraries: finds compilers and libraries, lists the sources, and has the rules.

# tools/probe.sh finds the compiler, the kernels for its processors and the optional libraries. It runs again when one
# of them changes. Without its library, a feature reports a clear message.
quoted = '$(subst ','\'',$(1))'
ifneq ($(filter-out $(DIST_GOALS) clean help headers core-headers uninstall windows,$(GOALS)),)
$(shell CC=$(call quoted,$(CC)) CPPFLAGS=$(call quoted,$(CPPFLAGS)) CFLAGS=$(call quoted,$(CFLAGS)) \
    LDFLAGS=$(call quoted,$(LDFLAGS)) NVCC=$(call quoted,$(NVCC)) sh tools/probe.sh $(B) >&2)
include $(B)/probe.mk
ifeq ($(filter CUDA,$(FOUND))$(filter none,$(NVCC)),)
$(info built without the CUDA back end: no $(NVCC) for this compiler's machine)
endif
endif
ifeq ($(origin AR),default)
AR := $(or $(AR_OF_CC),ar)
endif

# -ffp-contract=off: without contraction of a * b + c, procedural scenes and imports are identical everywhere.
INCLUDES := -Isrc/include -I.
FLAGS = -std=c99 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off $(INCLUDES) \
        -Wall -Wextra -Wpedantic -Wshadow -Wconversion $(FLAGS_$(SYSTEM)) $(FOUND:%=-DFXS_WITH_%) $(CFLAGS) $(CPPFLAGS)
# gcc assumes that the Windows stack is aligned to more than 16 bytes, which is wrong (gcc bug 54412), so vectors
# are moved as unaligned. Its isfinite gives a warning.
FOR_TESTS_win32 := -include tests/on_windows.h
FLAGS_win32 := -Wa,-muse-unaligned-vector-move -Wno-float-conversion
# Static and shared libraries use the same objects. The shared library exports only FXS_API declarations.
PIC_posix := -fPIC -fno-semantic-interposition -fvisibility=hidden
PIC_win32 := '-DFXS_API=__declspec(dllexport)'
PIC := $(if $(SHARED),$(PIC_$(SYSTEM)))
NVCC_FLAGS = -O3 -std=c++17 $(INCLUDES) -diag-suppress 177 -gencode arch=compute_90,code=sm_90 \
             -gencode arch=compute_80,code=compute_80 -gencode arch=compute_75,code=compute_75 \
             -Xcompiler -fno-exceptions,-fno-rtti,-fno-threadsafe-statics,-fPIC,-fvisibility=hidden
LIBS := $(foreach name,CJSON EXPAT ZIP PNG JPEG WEBP EXIF HEIF ZLIB DEFLATE ZSTD GLES CURL CUDA,$(LIBS_$(name))) \
        -lm -lpthread

# Faster versions of the stages have their instruction set in their file name. clang 14 crashes on the debug information
# of AVX-512 masks.
CLANG_14 := $(if $(findstring clang,$(CC_VERSION)),-g0)
# -fwrapv: unused lanes may overflow, and so may the bits of a .jpg in stb_image_write; this makes overflow defined.
# -O3: project takes 9 % less time, an import 10 %. -falign-functions: without it, project took up to 25 % longer,
# depending on its alignment in the cache line, which any earlier change shifts. -fno-math-errno, -fno-trapping-math:
# src/pack/coarsen and the packing stages do not read errno or traps, so their loops can be vectorised, with the same
# bytes.
isa = $(if $(filter src/image/image_encode,$(1)),-fwrapv) $(if $(filter kernels/%,$(1)),-fwrapv) $(if $(filter kernels/simd/x86/%,$(1)),-falign-functions=64) $(if $(filter kernels/% src/pack/%,$(1)),$(if $(filter -O2,$(CFLAGS)),-O3)) $(if $(findstring _sse41,$(1)),-msse4.1,$(if $(findstring _avx2,$(1)),-mavx2,$(if $(findstring _avx512,$(1)),\
      -mavx512f -mavx512bw -mavx512dq -mavx512vl -mavx512cd -mavx512vbmi $(CLANG_14)))) \
      $(if $(filter src/pack/coarsen src/pack/pack_c kernels/pack/%,$(1)),-O3 -fno-math-errno -fno-trapping-math) $(if $(filter src/fit/% kernels/fit/% kernels/pack/% src/camera/% src/pack/% src/scene/% src/gaussian/% src/image/photograph src/base/scene_start tests/gpu/test_fit% tests/test_fit_%,$(1)),$(SINGLES))

with = $(if $(filter $(1),$(FOUND)),$(wildcard $(2)))
FIT_KERNELS_x86 := sse41 avx2 avx512
FIT_KERNELS_arm := neon
PACK_KERNELS_x86 := avx2
KERNELS := $(if $(KERNEL_FOLDER),$(wildcard kernels/simd/$(KERNEL_FOLDER)/*.c))
CORE := $(wildcard src/core/*.c kernels/*.c) $(KERNELS)
# These files use POSIX threads, which mingw-w64 provides, and no other POSIX functions.
ON_WINDOWS_TOO := open.c pager.c pager_url.c pool.c
DEVICES := $(call with,GLES,kernels/gl/*.c kernels/gles/*.c kernels/compute/*.c) $(call with,CUDA,kernels/cuda/cuda.cu kernels/fit/cuda/cuda_fit.cu)
LIBRARY := $(wildcard $(patsubst %,src/%/*.c,base gaussian scene scene/read scene/write scene/edit pack camera image fit) \
                      $(patsubst %,port/%/*.c,$(SYSTEM) backend board)) \
           $(if $(filter win32,$(SYSTEM)),$(addprefix port/posix/,$(ON_WINDOWS_TOO))) \
           $(wildcard $(patsubst %,kernels/fit/fit_%.c,$(FIT_KERNELS_$(KERNEL_FOLDER)))) \
           $(wildcard $(patsubst %,kernels/pack/*_%.c,$(PACK_KERNELS_$(KERNEL_FOLDER))))
LIBRARY += $(if $(filter GLES,$(FOUND)),$(call with,EGL,port/gl/egl.c) $(call with,OSMESA,port/gl/osmesa.c))
LIBRARY += $(B)/declarations.c
WINDOW := $(if $(call with,SDL,port/window/*.c),$(wildcard port/window/*.c) \
                                             $(filter-out tools/viewer_main.c,$(wildcard tools/viewer*.c)))
LIBS_SOCKETS_win32 := -lws2_32 -liphlpapi
SERVER := $(call with,MICROHTTPD,port/http/*.c port/$(SYSTEM)/http/*.c)
TOOL := $(filter-out tools/viewer% tools/serve%,$(wildcard tools/*.c)) src/scene/make/procedural.c
TOOL_SHARED := tools/metrics.c src/scene/make/procedural.c
objects = $(patsubst %.cu,$(B)/%.o,$(patsubst %.c,$(B)/%.o,$(1)))

EXE := $(if $(filter win32,$(SYSTEM)),.exe)
PROGRAMS := $(patsubst %,$(B)/%$(EXE),fixsplat $(if $(WINDOW),fixsplat-view) $(if $(SERVER),fixsplat-web))
ARCHIVES := $(B)/libfixsplat-core.a $(B)/libfixsplat.a
SONAME := libfixsplat.so.$(MAJOR)
SHARED_posix := $(B)/libfixsplat.so.$(VERSION)
SHARED_win32 := $(B)/libfixsplat-$(MAJOR).dll
SHARED_LIBRARY := $(if $(SHARED),$(SHARED_$(SYSTEM)))


# ---- Rules ---------------------------------------------------------------------------------------------------------

# Prints one line per file; V=1 prints whole commands.
ifeq ($(V),)
say = @$(if $(findstring s,$(firstword -$(MAKEFLAGS))),,printf '  %-4s %s\n' $(1) $(2) &&)
endif

all: $(PROGRAMS) $(ARCHIVES) $(SHARED_LIBRARY)

$(B)/libfixsplat-core.a: $(call objects,$(CORE))
$(B)/libfixsplat.a: $(call objects,$(CORE) $(DEVICES) $(LIBRARY))
$(ARCHIVES): $(B)/commands/link
	$(call say,AR,$@)rm -f $@ && $(AR) rcs $@ $(filter %.o,$^)

link = $(call say,LD,$@)$(CC) $(FLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(1) $(LIBS)

SHARED_FLAGS_posix := -shared -Wl,-soname,$(SONAME) -Wl,--version-script=tools/package/libfixsplat.map
SHARED_FLAGS_win32 := -shared -Wl,--out-implib,$(B)/libfixsplat.dll.a
$(SHARED_LIBRARY): $(call objects,$(CORE) $(DEVICES) $(LIBRARY)) tools/package/libfixsplat.map $(B)/commands/link
	$(call link,$(SHARED_FLAGS_$(SYSTEM)))


$(B)/fixsplat$(EXE): $(call objects,$(TOOL)) $(B)/libfixsplat.a $(B)/commands/link
	$(call link)

$(B)/fixsplat-view$(EXE): $(call objects,tools/viewer_main.c $(WINDOW) $(filter-out tools/main.c,$(TOOL))) \
                    $(B)/libfixsplat.a $(B)/commands/link
	$(call link,$(LIBS_TTF) $(LIBS_SDL))

$(B)/fixsplat-web$(EXE): $(call objects,$(wildcard tools/serve*.c) $(SERVER) $(filter-out tools/main.c,$(TOOL))) $(B)/libfixsplat.a \
                   $(B)/commands/link
	$(call link,$(LIBS_MICROHTTPD) $(LIBS_QRENCODE) $(LIBS_SOCKETS_$(SYSTEM)))

# Records the commands and their options: a change rebuilds the files made by them.
$(B)/commands/compile: COMMAND := $(CC) $(CC_VERSION) $(filter-out -DFXS_WITH_%,$(FLAGS)) $(PIC)
$(B)/commands/nvcc: COMMAND := $(NVCC) $(NVCC_VERSION) $(NVCC_FLAGS)
$(B)/commands/link: COMMAND := $(CC) $(CC_VERSION) $(CFLAGS) $(LDFLAGS) $(LIBS) $(LIBS_TTF) $(LIBS_SDL) $(LIBS_MICROHTTPD) $(LIBS_QRENCODE) $(AR) \
                              $(CORE) $(DEVICES) $(LIBRARY)
$(B)/commands/%: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' $(call quoted,$(COMMAND)) | cmp -s - $@ || printf '%s\n' $(call quoted,$(COMMAND)) >$@

# An object depends on the optional libraries named in its source and headers; these dependencies are added to its .d.
features = grep -ohs 'FXS_WITH_[A-Z0-9]*' $$(sed 's/^[^ ]*://; s/[\\:]//g' $(@:.o=.d)) | sort -u | \
           sed 's|FXS_WITH_|$@: $(B)/with/|' >>$(@:.o=.d)

$(B)/%.o: %.c $(B)/commands/compile
	@mkdir -p $(@D)
	$(call say,CC,$<)$(CC) $(FLAGS) $(if $(filter tools/% tests/%,$*),,$(PIC)) $(if $(filter tests/%,$*),$(FOR_TESTS_$(SYSTEM))) $(call isa,$*) -MMD -MP -c -o $@ $<
	@$(features)

# nvcc puts a hash of the source's path into names. The relative path is used, so that the bytes do not depend on the
# folder.
$(B)/%.o: %.cu $(B)/commands/nvcc
	@mkdir -p $(@D)
	$(call say,NVCC,$<)$(NVCC) $(NVCC_FLAGS) -Xcudafe --orig_src_path_name,$< \
	    $(if $(findstring fit,$*),-fmad=false) -MMD -MP -c -o $@ $<

# These files are built only with their library and do not test FXS_WITH_*.
$(call objects,$(wildcard port/window/*.c)): $(B)/with/SDL
$(call objects,$(wildcard port/http/*.c port/*/http/*.c)): $(B)/with/MICROHTTPD
$(call objects,$(wildcard kernels/gl/*.c kernels/gles/*.c kernels/compute/*.c)): $(B)/with/GLES
$(call objects,$(wildcard port/gl/egl.c)): $(B)/with/EGL
$(call objects,$(wildcard port/gl/osmesa.c)): $(B)/with/OSMESA

# Shader sources as character arrays, without comments and indentation. The gles shaders are built around
# src/include/fixsplat/pixel.h.
GLES_SHADERS := src/include/fixsplat/pixel.h $(wildcard $(patsubst %,kernels/%/*.vert,gl gles) $(patsubst %,kernels/%/*.frag,gl gles))
COMPUTE_SHADERS := $(wildcard kernels/compute/generated/*.comp $(addprefix kernels/compute/*.,frag glsl) kernels/gl/*.vert kernels/gl/*.frag)
$(B)/kernels/gles/shaders.h: $(GLES_SHADERS)
$(B)/kernels/compute/shaders.h: $(COMPUTE_SHADERS)
$(B)/kernels/%/shaders.h: make/build.mk
	@mkdir -p $(@D)
	@for f in $(filter-out %.mk,$^); do echo "static const char $$(basename $$f | tr . _)[] = {"; \
	    sed -e ':more' -e '/\/\*/{/\*\//!{N' -e 'b more' -e '}' -e 's|/\*.*\*/||' -e '}' -e 's|//.*||' \
	        -e 's/^ *//' -e 's/ *$$//' -e '/^$$/d' $$f | od -An -v -tu1 | sed 's/[0-9][0-9]*/&,/g'; echo '0};'; done >$@
WITH_SHADERS := $(addprefix $(B)/kernels/,gles/gles.o compute/compute.o compute/framebuffer.o)
$(WITH_SHADERS): $(B)/kernels/gles/shaders.h $(B)/kernels/compute/shaders.h
$(WITH_SHADERS): INCLUDES += -I$(@D)

# The declarations of the headers, as a text inside the library.
$(B)/declarations.c: $(HEADERS) tools/declarations.sh make/build.mk $(B)/commands/compile
	@text=$$(CC=$(call quoted,$(CC) $(CPPFLAGS)) sh tools/declarations.sh $(HEADERS)) && \
	    { echo '#include <fixsplat/declarations.h>'; echo 'static const char text[] = {'; \
	    printf '%s\n' "$$text" | od -An -v -tu1 | sed 's/[0-9][0-9]*/&,/g'; echo '0};'; \
	    echo 'const char *fxs_declarations(void) { return text; }'; } >$@

$(B)/with/%: ;
FOLDERS := src/* src/*/* kernels kernels/* kernels/*/* port/* port/*/* tools tests tests/gpu
-include $(wildcard $(foreach place,. firmware/* web/*,$(FOLDERS:%=$(B)/$(place)/%/*.d)))
.SUFFIXES:
.DELETE_ON_ERROR:
.PRECIOUS: $(B)/%.o

demo: all ## make a procedural scene and render it to demo.png
	$(B)/fixsplat demo
