# fixsplat. `make help` lists the targets.
VERSION := 0.1.0
CC ?= cc
CFLAGS ?= -O2 -g
PREFIX ?= /usr/local
SCENES ?= ../shared/scenes
B := build

# No contraction of a * b + c: procedural scenes and imports are the same everywhere.
FLAGS = -std=c99 -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -ffp-contract=off \
        -Wall -Wextra -Wpedantic -Wshadow -Wconversion $(FEATURES) $(CFLAGS) $(CPPFLAGS)
LIBS = -lm -lpthread

# Optional libraries: without one, its feature answers with a clear message.
# optional(header, feature, libraries, variable that they go to)
hash := \#
optional = $(if $(shell printf '$(hash)include <$(1)>\n' | $(CC) $(CPPFLAGS) -E -x c - >/dev/null 2>&1 && echo yes),\
           $(eval FEATURES += -DFXS_WITH_$(2))$(eval $(or $(4),LIBS) += $(3)))
$(call optional,cjson/cJSON.h,CJSON,-lcjson)
$(call optional,zlib.h,ZLIB,-lz)
$(call optional,zstd.h,ZSTD,-lzstd)
$(call optional,webp/decode.h,WEBP,-lwebp)
$(call optional,zip.h,ZIP,-lzip)
$(call optional,stb/stb_image_write.h,STB,)
$(call optional,SDL2/SDL.h,SDL,-lSDL2,WINDOW_LIBS)

# Faster versions of the stages, by processor; src/ alone is complete.
MACHINE := $(shell $(CC) -dumpmachine)
KERNELS := $(wildcard kernels/*.c)
KERNELS += $(if $(filter x86_64-% i386-% i486-% i586-% i686-%,$(MACHINE)),$(wildcard kernels/x86/*.c))
KERNELS += $(if $(filter aarch64-% arm64-%,$(MACHINE)),$(wildcard kernels/arm/*.c))
# clang 14 crashes on the debug information of AVX-512 masks.
CC_VERSION := $(shell $(CC) --version 2>&1)
CLANG_14 := $(if $(findstring clang,$(CC_VERSION)),-g0)
isa = $(if $(findstring _sse41,$(1)),-msse4.1,$(if $(findstring _avx2,$(1)),-mavx2,$(if $(findstring _avx512,$(1)),\
      -mavx512f -mavx512bw -mavx512dq -mavx512vl -mavx512cd -mavx512vbmi $(CLANG_14))))
FEATURES += $(if $(KERNELS),-DFXS_WITH_KERNELS)
# The OpenGL ES back end wants headers only; the libraries are found at run time.
$(call optional,GLES3/gl3.h,GLES,-ldl)
KERNELS += $(if $(findstring WITH_GLES,$(FEATURES)),$(wildcard kernels/gles/*.c))
$(if $(findstring WITH_GLES,$(FEATURES)),$(call optional,EGL/egl.h,EGL,)$(call optional,GL/osmesa.h,OSMESA,))

# The CUDA back end, where there is a compiler for it: machine code for sm_90, PTX for other GPUs from sm_80 on.
NVCC ?= nvcc
NVCC_PATH := $(shell command -v $(NVCC) 2>/dev/null)
NVCC_FLAGS = -O3 -std=c++17 -diag-suppress 177 -gencode arch=compute_90,code=sm_90 \
             -gencode arch=compute_80,code=compute_80 -Xcompiler -fno-exceptions,-fno-rtti,-fno-threadsafe-statics
ifneq ($(NVCC_PATH),)
CUDA := kernels/cuda/cuda.cu
FEATURES += -DFXS_WITH_CUDA
NVCC_VERSION := $(shell $(NVCC) --version)
LIBS += $(shell $(NVCC) --dryrun -x cu /dev/null 2>&1 | sed -n 's/.*LIBRARIES=//p') -lcudart_static -ldl -lrt
else ifneq ($(filter-out clean help,$(or $(MAKECMDGOALS),all)),)
$(info no $(NVCC): built without the CUDA back end)
endif

CORE := $(wildcard src/*.c) $(KERNELS)
PORT := $(wildcard port/files/*.c port/scene/*.c port/camera/*.c port/image/*.c port/import/*.c port/posix/*.c \
                   port/backend/*.c)
PORT += $(if $(findstring WITH_EGL,$(FEATURES)),$(wildcard port/egl/*.c))
PORT += $(if $(findstring WITH_OSMESA,$(FEATURES)),$(wildcard port/osmesa/*.c))
WINDOW := $(if $(WINDOW_LIBS),$(wildcard port/window/*.c) tools/viewer.c)
TOOL := $(filter-out tools/viewer%,$(wildcard tools/*.c))
PROGRAMS := $(B)/fixsplat $(if $(WINDOW),$(B)/fixsplat-view)
TOOL_SHARED := tools/backend.c tools/metrics.c tools/procedural.c
objects = $(patsubst %.cu,$(B)/%.o,$(patsubst %.c,$(B)/%.o,$(1)))

all: $(PROGRAMS) $(B)/libfixsplat.a

$(B)/libfixsplat.a: $(call objects,$(CORE) $(PORT) $(CUDA))
	@rm -f $@
	$(AR) rcs $@ $^

$(B)/fixsplat: $(call objects,$(TOOL)) $(B)/libfixsplat.a
	$(CC) $(FLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

$(B)/fixsplat-view: $(call objects,tools/viewer_main.c $(WINDOW) $(filter-out tools/main.c,$(TOOL))) $(B)/libfixsplat.a
	$(CC) $(FLAGS) $(LDFLAGS) -o $@ $^ $(LIBS) $(WINDOW_LIBS)

# Compilers, flags and libraries found: what is built with others is built again.
STATE := $(CC) $(CC_VERSION) $(FLAGS) $(LDFLAGS) $(LIBS) $(WINDOW_LIBS) $(NVCC_PATH) $(NVCC_VERSION) $(NVCC_FLAGS)
quote := '
$(B)/state: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' '$(subst $(quote),$(quote)\$(quote)$(quote),$(STATE))' >$@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(B)/%.o: %.c $(B)/state
	@mkdir -p $(@D)
	$(CC) $(FLAGS) $(call isa,$*) -MMD -MP -c -o $@ $<

# The shaders' texts, and src/pixel.h that they are built around, as arrays of characters.
SHADERS := src/pixel.h $(wildcard kernels/gles/*.vert kernels/gles/*.frag)
$(B)/kernels/gles/shaders.h: $(SHADERS)
	@mkdir -p $(@D)
	@for f in $^; do echo "static const char $$(basename $$f | tr . _)[] = {"; \
	    od -An -v -tu1 $$f | sed 's/[0-9][0-9]*/&,/g'; echo '0};'; done >$@
$(B)/kernels/gles/gles.o: $(B)/kernels/gles/shaders.h
$(B)/kernels/gles/gles.o: CPPFLAGS += -I$(B)/kernels/gles

$(B)/%.o: %.cu $(B)/state
	@mkdir -p $(@D)
	$(NVCC) $(NVCC_FLAGS) -MMD -MP -c -o $@ $<

-include $(shell find $(B) -name '*.d' 2>/dev/null)

# ---- Setup, demo, install ------------------------------------------------------------------------------------------

PACKAGES := libcjson-dev libstb-dev libwebp-dev libzip-dev zlib1g-dev libzstd-dev libegl-dev libgles-dev \
            libsdl2-dev
TEST_PACKAGES := clang libclang-rt-14-dev glslang-tools qemu-user gcc-aarch64-linux-gnu libc6-dev-arm64-cross \
                 gcc-arm-none-eabi libnewlib-arm-none-eabi valgrind libosmesa6-dev libosmesa6 libegl1 libgles2 \
                 libegl-mesa0 libgl1-mesa-dri xvfb xdotool gcc-s390x-linux-gnu libc6-dev-s390x-cross \
                 gcc-powerpc-linux-gnu libc6-dev-powerpc-cross gcc-arm-linux-gnueabihf libc6-dev-armhf-cross \
                 gcc-riscv64-linux-gnu libc6-dev-riscv64-cross gcc-i686-linux-gnu libc6-dev-i386-cross
WANTED = $(PACKAGES) $(if $(filter test,$(MAKECMDGOALS)),$(TEST_PACKAGES))

setup: ## install the Debian packages that are missing (those for the tests too, before `test`)
	@sh tools/setup.sh $(WANTED)

demo: ## make a procedural scene and render it to demo.png
	@$(MAKE) --no-print-directory all
	$(B)/fixsplat make-scene knot --count 200000 -o demo.ply
	$(B)/fixsplat render demo.ply --eye 0.9,-2.6,-12.8 --look 0,0.42,0 --fov 36 --bg 11131b -o demo.png --stats
	@echo "demo.png: 200,000 Gaussians with view-dependent colour of degree 3, from demo.ply"

PUBLIC := src/fixsplat.h src/packed.h kernels/kernels.h kernels/cuda/cuda.h kernels/gles/gles.h port/egl/egl.h \
          port/osmesa/osmesa.h $(wildcard port/posix/*.h) port/files/allocator.h port/files/message.h port/files/output.h \
          $(addprefix port/scene/,scene_file.h scene_filter.h fxs_file.h ply_write.h splat_write.h spz_write.h) \
          port/camera/camera.h port/camera/camera_file.h port/image/image_file.h port/import/pack.h

install: all ## install to $(DESTDIR)$(PREFIX): command, library, headers, pkg-config file
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/pkgconfig
	install $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin/
	install -m 644 $(B)/libfixsplat.a $(DESTDIR)$(PREFIX)/lib/
	for f in $(PUBLIC); do \
	    install -D -m 644 $$f $(DESTDIR)$(PREFIX)/include/fixsplat/$$f || exit 1; done
	printf 'prefix=%s\nName: fixsplat\nDescription: 3D Gaussian splatting in fixed point\nVersion: %s\nCflags: %s\nLibs: %s\n' \
	    '$(PREFIX)' '$(VERSION)' '-I$${prefix}/include/fixsplat' '-L$${prefix}/lib -lfixsplat $(LIBS)' \
	    > $(DESTDIR)$(PREFIX)/lib/pkgconfig/fixsplat.pc

# ---- Tests ---------------------------------------------------------------------------------------------------------

TESTS := $(patsubst tests/%.c,$(B)/tests/%,$(wildcard tests/test_*.c))

$(B)/tests/test_%: $(B)/tests/test_%.o $(B)/tests/reference.o $(call objects,$(TOOL_SHARED)) $(B)/libfixsplat.a
	$(CC) $(FLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

$(B)/tests/test_window: $(call objects,tests/test_window.c port/window/motion.c port/window/overlay.c $(WINDOW) \
                        $(filter-out tools/main.c,$(TOOL))) $(B)/libfixsplat.a
	$(CC) $(FLAGS) $(LDFLAGS) -o $@ $^ $(LIBS) $(WINDOW_LIBS)

.PRECIOUS: $(B)/tests/%.o

test: ## run every test
	@$(MAKE) --no-print-directory all $(TESTS)
	@FXS_SCENES=$(SCENES) B=$(B) sh tests/run.sh

# What setup installs is found by the makes that these run.
demo test: $(filter setup,$(MAKECMDGOALS))

test-programs: $(TESTS)

# Needs a GPU: see tests/gpu/cuda.sh.
$(B)/tests/gpu/%: $(B)/tests/gpu/%.o $(B)/tests/gpu/peek.o $(B)/libfixsplat.a
	$(CC) $(FLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

cuda-tests: $(B)/tests/gpu/test_cuda $(B)/tests/gpu/bench_cuda

golden-update: all $(B)/tests/test_golden ## write the golden images anew (and say why in the commit)
	$(B)/tests/test_golden --update

fuzz: all ## fuzz readers and renderer, SECONDS=60 each, JOBS at once
	B=$(B) sh tests/fuzz.sh $(or $(SECONDS),60)

mutants: ## change the code in small ways and see that a test notices each (long)
	sh tests/mutants.sh

# ---- Measurements --------------------------------------------------------------------------------------------------

bench: all $(B)/tests/test_quality ## measure and write the tables of docs/performance.md
	SCENES=$(SCENES) B=$(B) sh tools/bench.sh

size: all ## code size of each part
	@sh tools/size.sh $(B)

clean: ## remove what was built
	rm -rf $(B) demo.ply demo.png

help: ## this list
	@awk -F ': |## ' '/^[a-z-]+:.*## / {printf "  make %-14s %s\n", $$1, $$NF}' Makefile

.PHONY: all setup demo install test test-programs golden-update fuzz mutants bench size clean help FORCE
