# fixsplat. `make help` lists the targets.
CC ?= cc
CFLAGS ?= -O2 -g
NVCC ?= nvcc
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
SCENES ?= ../shared/scenes
B := build
VERSION := $(shell sed -n 's/^.define FXS_VERSION "\(.*\)"$$/\1/p' src/fixsplat.h)

# Public headers, by name below include/fixsplat: of libfixsplat-core.a, and of libfixsplat beside them.
CORE_HEADERS := $(addprefix src/,fixsplat.h packed.h backend.h stage.h pixel.h fixed.h) kernels/kernels.h
HEADERS := $(CORE_HEADERS) kernels/cuda/cuda.h kernels/gles/gles.h port/egl/egl.h port/osmesa/osmesa.h \
           $(addprefix port/posix/,clock.h map.h pool.h) $(addprefix port/files/,allocator.h message.h output.h) \
           $(addprefix port/scene/,scene_file.h scene_filter.h fxs_file.h ply_write.h splat_write.h spz_write.h \
             scene_write.h scene_decimate.h) \
           port/camera/camera.h port/camera/camera_file.h port/image/image_file.h port/image/film_file.h port/import/pack.h \
           port/world/world.h port/backend/backends.h port/backend/foveate.h port/board/strip.h \
           port/fit/fit.h port/fit/photos.h port/fit/blocks.h

PACKAGES := libcjson-dev libstb-dev libwebp-dev libzip-dev zlib1g-dev libdeflate-dev libzstd-dev libegl-dev \
            libgles-dev libsdl2-dev libsdl2-ttf-dev fonts-dejavu-core libmicrohttpd-dev
TEST_PACKAGES := clang libclang-rt-14-dev cmake pkg-config glslang-tools qemu-user gcc-aarch64-linux-gnu \
                 libc6-dev-arm64-cross gcc-arm-none-eabi libnewlib-arm-none-eabi valgrind libosmesa6-dev libosmesa6 \
                 libegl1 libgles2 libegl-mesa0 libgl1-mesa-dri xvfb xdotool gcc-s390x-linux-gnu \
                 libc6-dev-s390x-cross gcc-powerpc-linux-gnu libc6-dev-powerpc-cross gcc-arm-linux-gnueabihf \
                 libc6-dev-armhf-cross gcc-riscv64-linux-gnu libc6-dev-riscv64-cross gcc-i686-linux-gnu \
                 libc6-dev-i386-cross g++ qemu-system-arm chromium curl openssl ffmpeg librsvg2-bin \
                 python3-numpy python3-setuptools python3-pip
CROSS := mips-linux-gnu powerpc64-linux-gnu powerpc64le-linux-gnu m68k-linux-gnu sparc64-linux-gnu hppa-linux-gnu \
         arm-linux-gnueabi mips64el-linux-gnuabi64
TEST_ALL_PACKAGES := musl-tools $(CROSS:%=gcc-%) libc6-dev-mips-cross libc6-dev-ppc64-cross libc6-dev-ppc64el-cross \
                     libc6-dev-m68k-cross libc6-dev-sparc64-cross libc6-dev-hppa-cross libc6-dev-armel-cross \
                     libc6-dev-mips64el-cross
WEB_PACKAGES := clang lld wasi-libc libclang-rt-14-dev-wasm32 binaryen nodejs dpkg-dev
# Where "make setup web" puts the sources of libraries (tools/web_sources.sh), for every clone; WEB_SOURCES= : none.
WEB_SOURCES ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/fixsplat
GOALS := $(or $(MAKECMDGOALS),all)

# As many jobs as processors, unless told by -j.
PROCESSORS := $(shell nproc 2>/dev/null || getconf _NPROCESSORS_ONLN)
ifeq ($(MAKELEVEL)$(filter -j%,$(MAKEFLAGS)),0)
MAKEFLAGS += -j$(PROCESSORS)
endif

all: ## the command and the libraries (the default)

ifneq ($(filter setup,$(GOALS)),)
# ---- Setup ---------------------------------------------------------------------------------------------------------

setup: ## install the Debian packages that are missing (and what the goals behind it need: setup test, setup web)
	@sh tools/setup.sh $(PACKAGES) $(if $(filter test test-all,$(GOALS)),$(TEST_PACKAGES)) \
	    $(if $(filter test test-all web,$(GOALS)),$(WEB_PACKAGES)) \
	    $(if $(filter test-all,$(GOALS)),$(TEST_ALL_PACKAGES))
	@$(if $(filter test test-all web,$(GOALS)),$(if $(WEB_SOURCES),sh tools/web_sources.sh $(WEB_SOURCES)))
	@$(if $(filter test test-all,$(GOALS)),sh tools/page_modules.sh $(B)/page)

# What else is asked for, by a make that finds what was installed.
REST := $(filter-out setup,$(GOALS))
$(REST): rest ;
rest: setup
	@$(if $(REST),$(MAKE) --no-print-directory $(REST),:)
.PHONY: setup rest $(REST)
else
# ---- What is here ----------------------------------------------------------------------------------------------------

# Compiler, kernels for its processors and optional libraries, as of the last change of any (tools/probe.sh). Without a
# library, its feature answers with a clear message.
ifneq ($(filter-out clean help headers core-headers uninstall,$(GOALS)),)
quoted = '$(subst ','\'',$(1))'
$(shell CC=$(call quoted,$(CC)) CPPFLAGS=$(call quoted,$(CPPFLAGS)) CFLAGS=$(call quoted,$(CFLAGS)) \
    LDFLAGS=$(call quoted,$(LDFLAGS)) NVCC=$(call quoted,$(NVCC)) sh tools/probe.sh $(B) >&2)
include $(B)/probe.mk
ifeq ($(filter CUDA,$(FOUND)),)
$(info built without the CUDA back end: no $(NVCC) for this compiler's machine)
endif
endif
ifeq ($(origin AR),default)
AR := $(or $(AR_OF_CC),ar)
endif

# No contraction of a * b + c: procedural scenes and imports are the same everywhere.
FLAGS = -std=c99 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off \
        -Wall -Wextra -Wpedantic -Wshadow -Wconversion $(FOUND:%=-DFXS_WITH_%) $(CFLAGS) $(CPPFLAGS)
# One set of objects for the static and the shared libraries.
PIC := $(if $(SHARED),-fPIC -fno-semantic-interposition)
NVCC_FLAGS = -O3 -std=c++17 -diag-suppress 177 -gencode arch=compute_90,code=sm_90 \
             -gencode arch=compute_80,code=compute_80 \
             -Xcompiler -fno-exceptions,-fno-rtti,-fno-threadsafe-statics,-fPIC
LIBS := $(foreach name,CJSON ZIP WEBP ZLIB DEFLATE ZSTD GLES CUDA,$(LIBS_$(name))) -lm -lpthread

# Faster versions of the stages carry their instruction set in their name. clang 14 crashes on the debug information of
# AVX-512 masks.
CLANG_14 := $(if $(findstring clang,$(CC_VERSION)),-g0)
# Lanes that are not wanted may overflow, as may stb_image with a damaged .jpg: -fwrapv says that this is no fault. -O3:
# project takes 9 % less.
isa = $(if $(filter port/image/image_%,$(1)),-fwrapv) $(if $(filter kernels/%,$(1)),-fwrapv $(if $(filter -O2,$(CFLAGS)),-O3)) $(if $(findstring _sse41,$(1)),-msse4.1,$(if $(findstring _avx2,$(1)),-mavx2,$(if $(findstring _avx512,$(1)),\
      -mavx512f -mavx512bw -mavx512dq -mavx512vl -mavx512cd -mavx512vbmi $(CLANG_14)))) \
      $(if $(filter port/fit/% kernels/x86/fit_% tests/gpu/test_fit% port/camera/% port/import/% port/scene/% tests/test_fit_%,$(1)),$(SINGLES))

with = $(if $(filter $(1),$(FOUND)),$(wildcard $(2)))
KERNELS := $(if $(KERNEL_FOLDER),$(wildcard kernels/$(KERNEL_FOLDER)/*.c))
FIT_KERNELS := $(wildcard $(if $(KERNEL_FOLDER),kernels/$(KERNEL_FOLDER)/fit_*.c))
CORE := $(wildcard src/*.c kernels/*.c) $(filter-out $(FIT_KERNELS),$(KERNELS))
DEVICES := $(call with,GLES,kernels/gles/*.c) $(call with,CUDA,kernels/cuda/cuda.cu kernels/cuda/fit/fit.cu)
PORT := $(wildcard $(addprefix port/,$(addsuffix /*.c,files scene camera image import posix world backend board fit))) \
        $(FIT_KERNELS)
PORT += $(if $(filter GLES,$(FOUND)),$(call with,EGL,port/egl/*.c) $(call with,OSMESA,port/osmesa/*.c))
WINDOW := $(if $(call with,SDL,port/window/*.c),$(wildcard port/window/*.c) \
                                             $(filter-out tools/viewer_main.c,$(wildcard tools/viewer*.c)))
SERVER := $(call with,MICROHTTPD,port/http/*.c)
TOOL := $(filter-out tools/viewer% tools/serve%,$(wildcard tools/*.c))
TOOL_SHARED := tools/metrics.c tools/procedural.c
objects = $(patsubst %.cu,$(B)/%.o,$(patsubst %.c,$(B)/%.o,$(1)))

PROGRAMS := $(B)/fixsplat $(if $(WINDOW),$(B)/fixsplat-view) $(if $(SERVER),$(B)/fixsplat-web)
ARCHIVES := $(B)/libfixsplat-core.a $(B)/libfixsplat.a
SONAME := libfixsplat.so.$(basename $(VERSION))
SHARED_LIBRARY := $(if $(SHARED),$(B)/libfixsplat.so.$(VERSION))
FLAT_HEADERS := $(addprefix $(B)/include/fixsplat/,$(notdir $(HEADERS)))

# ---- Build -----------------------------------------------------------------------------------------------------------

# One line a file; V=1: the whole command.
ifeq ($(V),)
say = @$(if $(findstring s,$(firstword -$(MAKEFLAGS))),,printf '  %-4s %s\n' $(1) $(2) &&)
endif

all: $(PROGRAMS) $(ARCHIVES) $(SHARED_LIBRARY) $(FLAT_HEADERS)

$(B)/libfixsplat-core.a: $(call objects,$(CORE))
$(B)/libfixsplat.a: $(call objects,$(CORE) $(DEVICES) $(PORT))
$(ARCHIVES): $(B)/commands/link
	$(call say,AR,$@)rm -f $@ && $(AR) rcs $@ $(filter %.o,$^)

link = $(call say,LD,$@)$(CC) $(FLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(1) $(LIBS)

# It shows the functions that public headers declare, and nothing else.
SHARED_FLAGS := -shared -Wl,-soname,$(SONAME) -Wl,--version-script=$(B)/exports
$(SHARED_LIBRARY): $(call objects,$(CORE) $(DEVICES) $(PORT)) $(B)/exports $(B)/commands/link
	$(call link,$(SHARED_FLAGS))
$(B)/exports: $(HEADERS) Makefile
	@{ echo '{ global:'; grep -oh 'fxs_[a-z0-9_]*[(;,]' $(HEADERS) | tr '(,' ';;' | sort -u; echo 'local: *; };'; } >$@

$(B)/fixsplat: $(call objects,$(TOOL)) $(B)/libfixsplat.a $(B)/commands/link
	$(call link)

$(B)/fixsplat-view: $(call objects,tools/viewer_main.c $(WINDOW) $(filter-out tools/main.c,$(TOOL))) \
                    $(B)/libfixsplat.a $(B)/commands/link
	$(call link,$(LIBS_TTF) $(LIBS_SDL))

$(B)/fixsplat-web: $(call objects,tools/serve.c $(SERVER) $(filter-out tools/main.c,$(TOOL))) $(B)/libfixsplat.a \
                   $(B)/commands/link
	$(call link,$(LIBS_MICROHTTPD))

# What commands are made of: what was built by another is built again.
$(B)/commands/compile: COMMAND := $(CC) $(CC_VERSION) $(filter-out -DFXS_WITH_%,$(FLAGS)) $(PIC)
$(B)/commands/nvcc: COMMAND := $(NVCC) $(NVCC_VERSION) $(NVCC_FLAGS)
$(B)/commands/link: COMMAND := $(CC) $(CC_VERSION) $(CFLAGS) $(LDFLAGS) $(LIBS) $(LIBS_TTF) $(LIBS_SDL) $(LIBS_MICROHTTPD) $(AR) \
                              $(CORE) $(DEVICES) $(PORT)
$(B)/commands/%: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' $(call quoted,$(COMMAND)) | cmp -s - $@ || printf '%s\n' $(call quoted,$(COMMAND)) >$@

# An object depends on the optional libraries that its source and headers ask for: those are added to its .d.
features = grep -ohs 'FXS_WITH_[A-Z0-9]*' $$(sed 's/^[^ ]*://; s/[\\:]//g' $(@:.o=.d)) | sort -u | \
           sed 's|FXS_WITH_|$@: $(B)/with/|' >>$(@:.o=.d)

$(B)/%.o: %.c $(B)/commands/compile
	@mkdir -p $(@D)
	$(call say,CC,$<)$(CC) $(FLAGS) $(if $(filter tools/% tests/%,$*),,$(PIC)) $(call isa,$*) -MMD -MP -c -o $@ $<
	@$(features)

$(B)/%.o: %.cu $(B)/commands/nvcc
	@mkdir -p $(@D)
	$(call say,NVCC,$<)$(NVCC) $(NVCC_FLAGS) $(if $(findstring fit,$*),-fmad=false) -MMD -MP -c -o $@ $<

# These are there only with their library, and do not ask.
$(call objects,$(wildcard port/window/*.c)): $(B)/with/SDL
$(call objects,$(wildcard port/http/*.c)): $(B)/with/MICROHTTPD
$(call objects,$(wildcard kernels/gles/*.c)): $(B)/with/GLES
$(call objects,$(wildcard port/egl/*.c)): $(B)/with/EGL
$(call objects,$(wildcard port/osmesa/*.c)): $(B)/with/OSMESA

# The shaders' texts, and src/pixel.h that they are built around, as arrays of characters, without comments and spaces
# about a line.
SHADERS := src/pixel.h $(wildcard kernels/gles/*.vert kernels/gles/*.frag)
$(B)/kernels/gles/shaders.h: $(SHADERS) Makefile
	@mkdir -p $(@D)
	@for f in $(SHADERS); do echo "static const char $$(basename $$f | tr . _)[] = {"; \
	    sed -e ':more' -e '/\/\*/{/\*\//!{N' -e 'b more' -e '}' -e 's|/\*.*\*/||' -e '}' -e 's|//.*||' \
	        -e 's/^ *//' -e 's/ *$$//' -e '/^$$/d' $$f | od -An -v -tu1 | sed 's/[0-9][0-9]*/&,/g'; echo '0};'; done >$@
$(B)/kernels/gles/gles.o: $(B)/kernels/gles/shaders.h
$(B)/kernels/gles/gles.o: CPPFLAGS += -I$(B)/kernels/gles

# Side by side in one folder: "../../src/fixsplat.h" is "fixsplat.h" there.
$(FLAT_HEADERS): $(HEADERS)
	@mkdir -p $(@D)
	@sed 's|^\(#include "\).*/|\1|' $(filter %/$(@F),$(HEADERS)) >$@

$(B)/with/%: ;
-include $(wildcard $(addprefix $(B)/,$(addsuffix /*.d,src kernels kernels/* kernels/*/* port/* tools tests tests/gpu)) \
           $(B)/firmware/*/*/*.d $(B)/firmware/*/*/*/*.d $(B)/web/*/*/*.d $(B)/web/*/*/*/*.d)
.SUFFIXES:
.DELETE_ON_ERROR:
.PRECIOUS: $(B)/%.o

demo: all ## make a procedural scene and render it to demo.png
	$(B)/fixsplat make-scene knot --count 200000 -o demo.ply
	$(B)/fixsplat render demo.ply --eye 0.9,-2.6,-12.8 --look 0,0.42,0 --fov 36 --bg 11131b -o demo.png --stats
	@echo "demo.png: 200,000 Gaussians with view-dependent colour of degree 3, from demo.ply"

# ---- Firmware --------------------------------------------------------------------------------------------------------

# For each board what it is compiled with, where it is linked, and its own folder of port/. BOARD_HZ: the clock.
memory = $(foreach pair,$(1),-Wl,--defsym=$(pair))
in_flash := -T port/cortexm/firmware.ld
cpu_of_mps2-an385 := -mthumb -mcpu=cortex-m3 -DBOARD_HZ=25000000
cpu_of_mps2-an500 := -mthumb -mcpu=cortex-m7 -DBOARD_HZ=25000000
cpu_of_mps3-an547 := -mthumb -mcpu=cortex-m55 -mfloat-abi=hard -DBOARD_HZ=32000000
cpu_of_vexpress-a9 := -marm -mcpu=cortex-a9 -mno-unaligned-access
link_of_mps2-an385 := $(in_flash) $(call memory,FLASH=0 FLASH_BYTES=256K SCENE_AT=0x40000 SCENE_BYTES=3840K \
                                                RAM=0x20000000 RAM_BYTES=4M)
link_of_mps2-an500 := $(link_of_mps2-an385)
link_of_mps3-an547 := $(in_flash) $(call memory,FLASH=0 FLASH_BYTES=512K SCENE_AT=0x1000000 SCENE_BYTES=2M \
                                                RAM=0x21000000 RAM_BYTES=4M)
link_of_vexpress-a9 := -T port/vexpress/screen.ld
own_of_vexpress-a9 := port/vexpress/screen.c port/vexpress/start.S port/cortexm/console.c port/cortexm/scene.S
own_of_cortexm := $(wildcard port/cortexm/*.[cS])
kernels_of_mps2-an385 := kernels/kernels.c $(wildcard kernels/cortexm/*_cortexm.c)
kernels_of_mps2-an500 := $(kernels_of_mps2-an385)
kernels_of_mps3-an547 := kernels/kernels.c $(wildcard kernels/cortexm/*_mve.c)
BOARDS := mps2-an385 mps2-an500 mps3-an547 vexpress-a9
FIRMWARE := $(BOARDS:%=$(B)/firmware/%.elf)
FIRMWARE_SCENE ?= $(B)/firmware/knot.fxs
ARM_CC ?= arm-none-eabi-gcc
ARM_CFLAGS ?= -O2 -g
ARM_FLAGS = -std=gnu99 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -ffreestanding -fbuiltin \
            -ffunction-sections -fdata-sections -fwrapv -DFXS_SMALL_STACK $(ARM_CFLAGS) -DSCENE='"$(FIRMWARE_SCENE)"'

firmware: $(FIRMWARE) ## for boards (docs/boards.md): FIRMWARE_SCENE=x.fxs turns on a display, rendered from flash

$(B)/firmware/knot.fxs: $(B)/fixsplat
	@mkdir -p $(@D)
	$(B)/fixsplat make-scene knot --count 20000 -o $(@:.fxs=.ply)
	$(B)/fixsplat convert $(@:.fxs=.ply) $@

# What each Gaussian passes: a tenth to a fifth fewer instructions for 4 KB of flash. And GCC 12 schedules vectors out of
# the registers, and finds what is in memory faster by r7 than by the stack pointer.
arm_flags_of = $(if $(filter -O2,$(ARM_CFLAGS)),$(if $(filter src/project.c src/shade.c %project_mve.c,$(1)),-O3)) \
               $(if $(findstring _mve,$(1)),-fno-schedule-insns -fno-omit-frame-pointer)
objects_of = $(addprefix $(B)/firmware/$(1)/,$(addsuffix .o,$(basename $(2))))

define firmware_rules
$(B)/firmware/$(1)/%.o: %.c $(B)/commands/firmware
	@mkdir -p $$(@D)
	$$(call say,CC,'$$< ($(1))')$(ARM_CC) $(cpu_of_$(1)) $(if $(kernels_of_$(1)),-DFXS_WITH_KERNELS) $$(ARM_FLAGS) \
	    $$(call arm_flags_of,$$<) $$(TEST_FLAGS) -MMD -MP -c -o $$@ $$<
$(B)/firmware/$(1)/%.o: %.S $(B)/commands/firmware
	@mkdir -p $$(@D)
	$$(call say,AS,'$$< ($(1))')$(ARM_CC) $(cpu_of_$(1)) $$(ARM_FLAGS) -c -o $$@ $$<
$(B)/firmware/$(1)/port/cortexm/scene.o: $(FIRMWARE_SCENE) $(B)/commands/firmware-scene
$(B)/firmware/$(1).elf: $(call objects_of,$(1),$(wildcard src/*.c port/board/*.c) $(kernels_of_$(1)) \
                                               $(or $(own_of_$(1)),$(own_of_cortexm))) $(filter %.ld,$(link_of_$(1)))
	$$(call say,LD,$$@)$(ARM_CC) $(cpu_of_$(1)) -nostartfiles --specs=nano.specs -Wl,--gc-sections $(link_of_$(1)) \
	    -Wl,-Map=$$(@:.elf=.map) -o $$@ $$(filter %.o,$$^)

# tests/test_kernels.c as a program of the board, with as many of its cases as an emulator has time for.
$(B)/firmware/$(1)/tests/test_kernels.o: TEST_FLAGS := -Dmain=test_main -DCASES=200
$(B)/firmware/$(1)/test_kernels.elf: $(call objects_of,$(1),$(wildcard src/*.c) $(kernels_of_$(1)) tests/test_kernels.c \
                                       tests/on_board.c port/cortexm/start.c port/cortexm/console.c)
	$$(call say,LD,$$@)$(ARM_CC) $(cpu_of_$(1)) -nostartfiles -Wl,--gc-sections $(link_of_$(1)) \
	    $(call memory,STACK_BYTES=128K) -o $$@ $$(filter %.o,$$^) -lm
endef
$(foreach board,$(BOARDS),$(eval $(call firmware_rules,$(board))))
$(B)/commands/firmware: COMMAND = $(ARM_CC) $(ARM_CFLAGS) $(foreach board,$(BOARDS),$(cpu_of_$(board)) $(link_of_$(board)))
$(B)/commands/firmware-scene: COMMAND := $(ARM_CC) $(FIRMWARE_SCENE)

# ---- Web -------------------------------------------------------------------------------------------------------------

# Modules of WebAssembly: the renderer without simd128, with it, with it and threads; the readers with the packing.
WASM_CC ?= clang
WASM_OPT ?= wasm-opt
WEB := $(B)/web/package
MODULES := core simd threads import
WASM_FLAGS := --target=wasm32-wasi -std=gnu99 -fwrapv -ffp-contract=off -ffunction-sections \
              -Wall -Wextra -Wpedantic -Wshadow -Wconversion -include port/web/files.h
WASM_LINK := --target=wasm32-wasi -nostartfiles -Wl,--no-entry,--strip-all,--stack-first,-z,stack-size=524288
WEB_C := $(addprefix port/web/,text.c heap.c files.c) port/files/message.c port/files/allocator.c
WEB_CORE := $(wildcard src/*.c) kernels/kernels.c port/web/core.c port/files/crc32.c port/scene/fxs_file.c \
            port/camera/camera.c port/world/world.c $(WEB_C)
sources_of_core := $(WEB_CORE)
WEB_GLES := $(wildcard kernels/gles/*.c) port/web/webgl.c
sources_of_simd := $(WEB_CORE) $(wildcard kernels/wasm/*.c) $(WEB_GLES)
sources_of_threads := $(sources_of_simd) port/web/pool.c
sources_of_import := $(filter-out %_write.c %/scene_filter.c %/floaters.c %/scene_decimate.c,$(wildcard port/scene/*.c port/import/*.c)) \
                     port/web/import.c port/web/crc.c port/web/sort.c \
                     $(addprefix port/files/,crc32.c byte_reader.c opened.c text.c zip.c) src/scene.c \
                     src/fixsplat.c src/chunk.c $(WEB_C)
# What takes little of a frame is to be small; kernels take a seventh less of it by -O3, for 2 KB. The lowest 1024 bytes are
# the end of the stack, which no pointer is to (--low-memory-unused).
# <GLES3/gl3.h> is the host's.
wasm_flags_of = $(if $(filter import,$(1)),$(WEB_READERS_FLAGS)) \
                $(if $(filter simd,$(1)),-msimd128) $(if $(filter %/pool.c,$(2)),-matomics -mbulk-memory) \
                $(if $(filter $(WEB_GLES),$(2)),-idirafter /usr/include -I$(B)/kernels/gles) \
                $(if $(filter kernels/wasm/%,$(2)),-O3,$(if $(filter $(WEB_SMALL),$(1)/$(2)),-Oz,-O2))
WEB_SMALL := simd/src/% core/port/% simd/port/% %/gles/gles.c %/gles/fetch.c %/gles/state.c
# The objects are those of simd; nothing of them but pool.c knows of threads, and nothing of wasi-libc that is linked
# (memcpy, qsort, exp) cares. Its memory is made by fixsplat.js, of 16 pages at first.
wasm_link_of_threads := -Wl,--shared-memory,--import-memory,--initial-memory=1048576,--max-memory=4294967296 \
                        -Wl,--no-check-features,--export=__stack_pointer
wasm_opt_of_threads := --enable-threads --enable-bulk-memory --enable-mutable-globals
web_objects_of = $(patsubst %.c,$(B)/web/$(if $(filter threads,$(1)),simd,$(1))/%.o,$(sources_of_$(1)))
# Libraries that readers need, where `make setup web` has put their sources: what decompresses, and cJSON.
not_of_libzip := $(addprefix zip_,crypto_% winzip_aes% source_winzip_aes% pkware.c source_pkware% source_file_% random_% \
                   get_encryption_implementation.c mkstempm.c libzip_version.c algorithm_bzip2.c algorithm_xz.c)
WEB_LIBS_C := cjson/cJSON.c $(patsubst %,zlib/%.c,adler32 inflate inftrees inffast zutil) \
              $(patsubst %,libzstd/lib/common/%.c,entropy_common error_private fse_decompress xxhash zstd_common) \
              $(patsubst %,libzstd/lib/decompress/%.c,huf_decompress zstd_ddict zstd_decompress \
                                                      zstd_decompress_block) \
              $(patsubst %,libwebp/src/dec/%_dec.c,alpha buffer frame idec io quant tree vp8 vp8l webp) \
              $(patsubst %,libwebp/src/dsp/%.c,alpha_processing cpu dec dec_clip_tables filters lossless rescaler \
                                               upsampling yuv) libwebp/src/utils/utils.c \
              $(patsubst %,libwebp/src/utils/%_utils.c,bit_reader color_cache huffman quant_levels_dec random \
                                                       rescaler thread) \
              $(addprefix libzip/lib/,$(filter-out $(not_of_libzip),$(notdir $(wildcard $(WEB_SOURCES)/libzip/lib/*.c))))
WEB_VERSIONS := $(if $(WEB_SOURCES),$(if $(wildcard $(WEB_SOURCES)/versions),$(shell cat $(WEB_SOURCES)/versions)))
WEB_LIBS := $(if $(WEB_VERSIONS),$(patsubst %.c,$(B)/web/libs/%.o,$(WEB_LIBS_C) none.c))
WEB_LIBS_FLAGS := --target=wasm32-wasi -Oz -w -fwrapv -ffunction-sections -DNDEBUG \
                  -DHUF_FORCE_DECOMPRESS_X1 -DZSTD_FORCE_DECOMPRESS_SEQUENCES_SHORT -DZSTD_STRIP_ERROR_STRINGS \
                  -DZSTD_LEGACY_SUPPORT=0 -DZSTD_DISABLE_ASM \
                  $(addprefix -I,port/web/libs $(addprefix $(WEB_SOURCES)/,zlib libzip/lib libwebp))
WEB_READERS_FLAGS := $(if $(WEB_LIBS),$(patsubst %,-DFXS_WITH_%,CJSON WEBP ZIP ZLIB ZSTD) -isystem port/web/libs \
                       $(patsubst %,-isystem $(WEB_SOURCES)/%,. zlib libzip/lib libzstd/lib libwebp/src))
ifneq ($(filter web,$(GOALS)),)
ifeq ($(WEB_LIBS),)
$(info built without .sog, glTF, 3D Tiles and gzip and zstd of .spz for the web: no sources of libraries in $(WEB_SOURCES))
endif
endif

WASM := $(MODULES:%=$(WEB)/%.wasm)

PACKAGE := $(WASM) $(addprefix $(WEB)/,fixsplat.js webgl.js read.js thread.js fixsplat.d.ts package.json README.md LICENSE) \
           $(patsubst port/web/%,$(WEB)/%,$(wildcard port/web/viewer/*))

web: $(PACKAGE) ## the npm package (docs/web.md), in build/web/package

define web_rules
$(B)/web/$(1)/%.o: %.c $(B)/commands/web
	@mkdir -p $$(@D)
	$$(call say,CC,'$$< ($(1))')$(WASM_CC) $(WASM_FLAGS) $$(call wasm_flags_of,$(1),$$<) -MMD -MP -c -o $$@ $$<
$(WEB)/$(1).wasm: $(call web_objects_of,$(1))
	@mkdir -p $$(@D)
	$$(call say,LD,$$@)$(WASM_CC) $(WASM_LINK) $(wasm_link_of_$(1)) -o $(B)/web/$(1).linked $$(filter %.o,$$^) && \
	    $(WASM_OPT) --enable-simd $(wasm_opt_of_$(1)) -O3 --low-memory-unused -o $$@ $(B)/web/$(1).linked
endef
$(foreach module,$(MODULES),$(eval $(call web_rules,$(module))))
$(B)/web/simd/kernels/gles/gles.o: $(B)/kernels/gles/shaders.h
$(B)/web/libs/%.o: $(WEB_SOURCES)/%.c $(B)/commands/web
	@mkdir -p $(@D)
	$(call say,CC,'$* (import)')$(WASM_CC) $(WEB_LIBS_FLAGS) -c -o $@ $<
$(B)/web/libs/none.o: port/web/libs/none.c $(B)/commands/web
	@mkdir -p $(@D)
	$(call say,CC,'$< (import)')$(WASM_CC) $(WEB_LIBS_FLAGS) -c -o $@ $<
$(WEB_LIBS): $(wildcard port/web/libs/*.h)
$(WEB)/import.wasm: $(WEB_LIBS)
$(B)/commands/web: COMMAND = $(WASM_CC) $(WASM_FLAGS) $(WEB_LIBS_FLAGS) $(WEB_VERSIONS) $(WASM_LINK) $(wasm_link_of_threads) $(WASM_OPT) \
    $(foreach module,$(MODULES),$(foreach file,$(sources_of_$(module)),$(strip $(call wasm_flags_of,$(module),$(file)))))

$(WEB)/package.json: port/web/package.json src/fixsplat.h
	@mkdir -p $(@D)
	@sed 's/@VERSION@/$(VERSION)/' $< >$@
# With those of what is compiled in.
WEB_LICENSES := $(if $(WEB_LIBS),$(addprefix $(WEB_SOURCES)/,cjson/LICENSE libwebp/COPYING libwebp/PATENTS \
                                                             libzip/LICENSE libzstd/LICENSE zlib/LICENSE))
$(WEB)/LICENSE: LICENSE $(wildcard /usr/share/doc/wasi-libc/copyright) $(WEB_LICENSES)
	@mkdir -p $(@D)
	@for f in $^; do [ $$f = LICENSE ] || printf '\n---- %s ----\n\n' $$(basename $$(dirname $$f)); cat $$f; done >$@
# Without comments, but for those of several lines, and indentation: a sixth less to download.
$(WEB)/%.js: port/web/%.js
	@mkdir -p $(@D)
	@sed -e 's/^ *//' -e '/^\/\//d' -e '/^\/\*\*.*\*\/$$/d' -e "s| *// [^'\"\`]*\$$||" -e '/^$$/d' $< >$@
$(WEB)/%: port/web/%
	@mkdir -p $(@D) && cp $< $@

# tests/test_kernels.c as a program of WASI: node tests/web/wasi.mjs runs it.
$(B)/web/test_kernels.wasm: $(patsubst %.c,$(B)/web/simd/%.o,$(wildcard src/*.c kernels/wasm/*.c) kernels/kernels.c \
                                                            tests/test_kernels.c)
	$(call say,LD,$@)$(WASM_CC) --target=wasm32-wasi -Wl,-z,stack-size=1048576 -o $@ $^

# ---- Install ---------------------------------------------------------------------------------------------------------

SONAME_LINKS := $(SONAME) libfixsplat.so
PAGE := $(PREFIX)/share/fixsplat/web
PAGE_FILES := $(PACKAGE:$(WEB)/%=%)
PAGE_FOLDERS := $(sort $(patsubst %/,%,$(dir $(PAGE_FILES))))
HAS_PAGE := $(if $(filter-out $(wildcard $(WASM)),$(WASM)),,yes)
PC_FILES := fixsplat.pc fixsplat-core.pc
CMAKE_FILES := fixsplat-config.cmake fixsplat-config-version.cmake
ICONS := $(PREFIX)/share/icons/hicolor/scalable/apps
APPLICATIONS := $(PREFIX)/share/applications
INCLUDE := $(PREFIX)/include/fixsplat
CMAKE := $(LIBDIR)/cmake/fixsplat
fill = sed -e 's|@PREFIX@|$(PREFIX)|g' -e 's|@LIBDIR@|$(LIBDIR)|g' -e 's|@SONAME_VERSION@|$(basename $(VERSION))|g' \
           -e 's|@VERSION@|$(VERSION)|g' -e 's|@LIBS@|$(LIBS)|g' tools/package/$$f.in >$(DESTDIR)$(1)/$$f && \
       chmod 644 $(DESTDIR)$(1)/$$f || exit 1

# Pages for man, and completions: what the program says of itself, where it runs.
$(B)/share/made: $(B)/fixsplat tools/man.sh tools/completions.sh
	@rm -rf $(@D) && mkdir -p $(@D)
	$(call say,MAN,$(@D))if $(B)/fixsplat --version >/dev/null 2>&1; then \
	    sh tools/man.sh $(B)/fixsplat $(@D)/man/man1 && sh tools/completions.sh $(B)/fixsplat $(@D); fi
	@touch $@

install: all $(B)/share/made $(if $(HAS_PAGE),web) ## install command, libraries, headers, the page where it is built: DESTDIR, PREFIX (/usr/local)
	install -d $(addprefix $(DESTDIR),$(PREFIX)/bin $(LIBDIR)/pkgconfig $(CMAKE) $(INCLUDE))
	install $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin/
	install -m 644 $(ARCHIVES) $(SHARED_LIBRARY) $(DESTDIR)$(LIBDIR)/
	$(if $(SHARED),for f in $(SONAME_LINKS); do ln -sf libfixsplat.so.$(VERSION) $(DESTDIR)$(LIBDIR)/$$f || exit 1; done)
	install -m 644 $(FLAT_HEADERS) $(DESTDIR)$(INCLUDE)/
	@for f in $(PC_FILES); do $(call fill,$(LIBDIR)/pkgconfig); done
	@for f in $(CMAKE_FILES); do $(call fill,$(CMAKE)); done
	$(if $(WINDOW),install -d $(DESTDIR)$(ICONS) $(DESTDIR)$(APPLICATIONS))
	$(if $(WINDOW),install -m 644 tools/package/fixsplat.svg $(DESTDIR)$(ICONS)/)
	$(if $(WINDOW),install -m 644 tools/package/fixsplat-view.desktop $(DESTDIR)$(APPLICATIONS)/)
	for f in $$(cd $(B)/share && find * -type f ! -name made); do \
	    install -D -m 644 $(B)/share/$$f $(DESTDIR)$(PREFIX)/share/$$f || exit 1; done
	$(if $(HAS_PAGE),install -d $(addprefix $(DESTDIR)$(PAGE)/,$(PAGE_FOLDERS)))
	$(if $(HAS_PAGE),for f in $(PAGE_FILES); do install -m 644 $(WEB)/$$f $(DESTDIR)$(PAGE)/$$f || exit 1; done)

uninstall: ## remove what install put there
	rm -f $(addprefix $(DESTDIR)$(PREFIX)/bin/,fixsplat fixsplat-view fixsplat-web) \
	    $(DESTDIR)$(ICONS)/fixsplat.svg $(DESTDIR)$(APPLICATIONS)/fixsplat-view.desktop \
	    $(addprefix $(DESTDIR)$(PREFIX)/share/,man/man1/fixsplat.1 man/man1/fixsplat-*.1 zsh/site-functions/_fixsplat \
	        bash-completion/completions/fixsplat fish/vendor_completions.d/fixsplat.fish) \
	    $(addprefix $(DESTDIR)$(PAGE)/,$(PAGE_FILES)) \
	    $(addprefix $(DESTDIR)$(LIBDIR)/,libfixsplat-core.a libfixsplat.a libfixsplat.so.$(VERSION) $(SONAME_LINKS)) \
	    $(addprefix $(DESTDIR)$(LIBDIR)/pkgconfig/,$(PC_FILES)) $(addprefix $(DESTDIR)$(CMAKE)/,$(CMAKE_FILES)) \
	    $(addprefix $(DESTDIR)$(INCLUDE)/,$(notdir $(HEADERS)))
	for f in $(DESTDIR)$(CMAKE) $(DESTDIR)$(INCLUDE) \
	    $(addprefix $(DESTDIR),$(addprefix $(PAGE)/,$(filter-out .,$(PAGE_FOLDERS))) $(PAGE) $(PREFIX)/share/fixsplat); do \
	    [ ! -d $$f ] || rmdir $$f || exit 1; done

headers: ## list the public headers
	@printf '%s\n' $(HEADERS)

core-headers: ## list those that libfixsplat-core.a comes with
	@printf '%s\n' $(CORE_HEADERS)

# ---- Tests ---------------------------------------------------------------------------------------------------------

TESTS := $(patsubst tests/%.c,%,$(wildcard tests/test_*.c))
SCRIPTS := $(notdir $(wildcard tests/scripts/*.sh))
GATES := $(notdir $(wildcard tests/gates/*.sh))

# T=name: what is called so, with test_ before or .sh behind or not; else what has that in its name.
EVERY := $(TESTS) $(SCRIPTS) $(GATES)
containing = $(strip $(foreach name,$(EVERY),$(if $(findstring $(1),$(name)),$(name))))
called = $(or $(filter $(1) test_$(1) $(1).sh,$(EVERY)),$(call containing,$(1)),$(error no test is called $(1)))
RUN := $(if $(T),$(sort $(foreach name,$(T),$(call called,$(name)))),$(EVERY))
NEEDED := $(filter $(TESTS),$(RUN)) $(if $(filter bombs.sh web.sh,$(RUN)),test_bombs) $(if $(filter convert.sh,$(RUN)),test_lcc) $(if $(filter web.sh,$(RUN)),test_scene_input)

$(B)/tests/test_%: $(B)/tests/test_%.o $(B)/tests/reference.o $(call objects,$(TOOL_SHARED)) $(B)/libfixsplat.a \
                   $(B)/commands/link
	$(call link)

$(B)/tests/test_window: $(call objects,tests/test_window.c port/window/motion.c port/window/overlay.c \
                        port/window/words.c $(WINDOW) \
                        $(filter-out tools/main.c,$(TOOL))) $(B)/libfixsplat.a $(B)/commands/link
	$(call link,$(LIBS_TTF) $(LIBS_SDL))

test: all $(addprefix $(B)/tests/,$(NEEDED)) ## run all tests, JOBS at once; T=name: those with that in their names
	@FXS_SCENES=$(SCENES) B=$(B) JOBS=$(or $(FXS_JOBS),$(JOBS),$(PROCESSORS)) sh tests/run.sh $(RUN)

test-all: ## the same, on a dozen kinds of processor more
	FXS_PROCESSORS=all $(MAKE) test

test-programs: $(addprefix $(B)/tests/,$(TESTS)) ## build the test programs

# Need a GPU: see tests/gpu/cuda.sh and tests/gpu/fit.sh.
$(B)/tests/gpu/test_cuda $(B)/tests/gpu/bench_cuda: $(B)/tests/gpu/peek.o
$(B)/tests/gpu/test_fit: $(B)/tests/gpu/peek_fit.o
$(B)/tests/gpu/%: $(B)/tests/gpu/%.o $(B)/libfixsplat.a $(B)/commands/link
	$(call link)

cuda-tests: $(addprefix $(B)/tests/gpu/,test_cuda bench_cuda test_fit) $(B)/tests/test_fit_steps ## build what tests/gpu/*.sh run on a GPU

golden-update: all $(B)/tests/test_golden ## write the golden images anew (and say why in the commit)
	$(B)/tests/test_golden --update

fuzz: all ## fuzz readers and renderer, SECONDS=60 each, JOBS at once
	B=$(B) sh tests/fuzz.sh $(or $(SECONDS),60)

mutants: ## change the code in small ways and see that a test notices each (long)
	sh tests/mutants.sh

# ---- Measurements --------------------------------------------------------------------------------------------------

peers: web ## measure the page beside other viewers in Chromium (npm, some minutes); ROUNDS=3
	B=$(B) SCENES=$(SCENES) sh tools/peers.sh $(or $(ROUNDS),3)

bench: all $(B)/tests/test_quality ## measure and write the tables of docs/performance.md
	SCENES=$(SCENES) B=$(B) sh tools/bench.sh

plot: ## draw docs/*.svg from the tables of docs/performance.md
	@for plot in sizes growth levels; do \
	    awk -v plot=$$plot -f tools/plot.awk docs/performance.md >docs/$$plot.svg.new && \
	        mv docs/$$plot.svg.new docs/$$plot.svg || { rm -f docs/$$plot.svg.new; exit 1; }; done

size: all ## code size of each part
	@sh tools/size.sh $(B)

clean: ## remove what was built
	rm -rf $(B) demo.ply demo.png

.PHONY: all demo firmware web install uninstall headers core-headers test test-programs cuda-tests golden-update fuzz mutants bench plot test-all
.PHONY: size clean peers FORCE
endif

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1 /p' Makefile | \
	    awk '{ name = $$1; $$1 = ""; printf "  make %-14s%s\n", name, $$0 }'
	@echo 'V=1 prints whole commands. CC, AR, CFLAGS, CPPFLAGS, LDFLAGS, NVCC (none: without CUDA), LIBDIR: as usual.'
.PHONY: help
