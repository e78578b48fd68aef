# Builds fixsplat. `make help` lists the targets.
CC ?= cc
CFLAGS ?= -O2 -g
NVCC ?= nvcc
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
SCENES ?= ../shared/scenes
PYTHON ?= python3
B := build
VERSION := $(shell sed -n 's/^.define FXS_VERSION "\(.*\)"$$/\1/p' src/include/fixsplat/fixsplat.h)
MAJOR := $(firstword $(subst ., ,$(VERSION)))

# Header files to install: CORE_HEADERS for the library libfixsplat-core.a (the renderer alone), HEADERS for libfixsplat
# (all features).
CORE_HEADERS := $(addprefix src/include/fixsplat/,fixsplat.h backend.h pace.h \
    $(addprefix internal/,packed.h stage.h pixel.h fixed.h kernels.h))
PUBLIC_HEADERS := $(wildcard src/include/fixsplat/*.h)
INTERNAL_HEADERS := $(wildcard src/include/fixsplat/internal/*.h)
HEADERS := $(PUBLIC_HEADERS) $(INTERNAL_HEADERS)

PACKAGES := libcjson-dev libexpat1-dev libstb-dev libpng-dev libjpeg62-turbo-dev libwebp-dev libexif-dev libheif-dev \
            libzip-dev zlib1g-dev libdeflate-dev libzstd-dev libegl-dev libgles-dev libvulkan-dev libopenxr-dev \
            libsdl2-dev libsdl2-ttf-dev fonts-dejavu-core libmicrohttpd-dev libqrencode-dev libcurl4-openssl-dev \
            help2man
TEST_PACKAGES := clang libclang-rt-14-dev cmake pkg-config glslang-tools qemu-user gcc-aarch64-linux-gnu \
                 libc6-dev-arm64-cross gcc-arm-none-eabi libnewlib-arm-none-eabi valgrind libosmesa6-dev libosmesa6 \
                 libegl1 libgles2 libegl-mesa0 libgl1-mesa-dri mesa-vulkan-drivers \
                 vulkan-validationlayers spirv-tools xvfb xdotool gcc-s390x-linux-gnu \
                 libc6-dev-s390x-cross gcc-powerpc-linux-gnu libc6-dev-powerpc-cross gcc-arm-linux-gnueabihf \
                 libc6-dev-armhf-cross gcc-riscv64-linux-gnu libc6-dev-riscv64-cross gcc-i686-linux-gnu \
                 libc6-dev-i386-cross g++ libglfw3-dev qemu-system-arm chromium curl openssl zbar-tools ffmpeg librsvg2-bin \
                 python3-numpy python3-cffi python3-setuptools python3-pip locales parallel
CROSS := mips-linux-gnu powerpc64-linux-gnu powerpc64le-linux-gnu m68k-linux-gnu sparc64-linux-gnu hppa-linux-gnu \
         arm-linux-gnueabi mips64el-linux-gnuabi64
TEST_ALL_PACKAGES := musl-tools $(CROSS:%=gcc-%) libc6-dev-mips-cross libc6-dev-ppc64-cross libc6-dev-ppc64el-cross \
                     libc6-dev-m68k-cross libc6-dev-sparc64-cross libc6-dev-hppa-cross libc6-dev-armel-cross \
                     libc6-dev-mips64el-cross slurm-wlm
DIST_PACKAGES := debhelper dh-python lintian fakeroot mmdebstrap cmake nasm g++ gcc-aarch64-linux-gnu \
                 libc6-dev-arm64-cross python3-numpy python3-cffi python3-pip python3-setuptools python3-wheel python3-venv \
                 zip
AAR_PACKAGES := openjdk-17-jdk-headless zip unzip
WINDOWS_PACKAGES := gcc-mingw-w64-x86-64 libz-mingw-w64-dev cmake nasm dpkg-dev librsvg2-bin
WEB_PACKAGES := clang lld wasi-libc libclang-rt-14-dev-wasm32 binaryen nodejs dpkg-dev esbuild
# Cache folder for library sources of the web port, filled by `make setup web`.
WEB_SOURCES ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/fixsplat
# Cache folder for Windows libraries, filled by `make setup windows`.
WINDOWS_LIBRARIES ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/fixsplat/windows
GOALS := $(or $(MAKECMDGOALS),all)
DIST_GOALS := dist dist-check

# make runs as many jobs as processors, unless -j is given.
PROCESSORS := $(shell nproc 2>/dev/null || getconf _NPROCESSORS_ONLN)
ifeq ($(MAKELEVEL)$(filter -j%,$(MAKEFLAGS)),0)
MAKEFLAGS += -j$(PROCESSORS)
endif

all: ## the command and the libraries (the default)

ifneq ($(filter setup,$(GOALS)),)

setup: ## install the Debian packages that are missing (and what goals behind it need: setup test, web, windows)
	@sh tools/scripts/setup.sh $(PACKAGES) $(if $(filter test test-all,$(GOALS)),$(TEST_PACKAGES)) \
	    $(if $(filter test test-all web web-package $(DIST_GOALS),$(GOALS)),$(WEB_PACKAGES)) \
	    $(if $(filter test-all $(DIST_GOALS),$(GOALS)),$(DIST_PACKAGES)) \
	    $(if $(filter test-all,$(GOALS)),$(TEST_ALL_PACKAGES) wine64) \
	    $(if $(filter test test-all aar,$(GOALS)),$(AAR_PACKAGES)) \
	    $(if $(filter test-all windows $(DIST_GOALS),$(GOALS)),$(WINDOWS_PACKAGES))
	@$(if $(filter test test-all web web-package $(DIST_GOALS),$(GOALS)),$(if $(WEB_SOURCES),sh tools/scripts/web_sources.sh $(WEB_SOURCES)))
	@$(if $(filter test-all windows,$(GOALS)),sh tools/scripts/libraries.sh $(WINDOWS_LIBRARIES) x86_64-w64-mingw32 || :)
	@$(if $(filter test test-all,$(GOALS)),sh tools/scripts/page_modules.sh $(B)/page; \
	    sh tools/scripts/page_modules.sh $(B)/bundlers tests/web/bundlers $(if $(filter test-all,$(GOALS)),,part); sh tools/scripts/arm_libraries.sh $(B)/aarch64)

# `make setup GOAL...` builds the other goals in a new make, which finds the packages that setup has installed.
REST := $(filter-out setup,$(GOALS))
$(REST): rest ;
rest: setup
	@$(if $(REST),$(MAKE) --no-print-directory $(REST),:)
.PHONY: setup rest $(REST)
else

# $(call needs,GOALS,PROGRAMS) ends make at once if a program is missing that one of the goals needs.
missing = $(strip $(foreach program,$(1),$(if $(shell command -v $(program)),,$(program))))
needs = $(foreach goal,$(firstword $(filter $(1),$(GOALS))),$(if $(call missing,$(2)),$(error \
    $(goal): not here: $(call missing,$(2)); they come by: make setup $(goal))))

include $(addprefix make/,build.mk firmware.mk web.mk windows.mk android.mk install.mk dist.mk test.mk measure.mk)

clean: ## remove what was built
	rm -rf $(B) dist demo.ply demo.png

.PHONY: all demo firmware windows web web-package install wheel uninstall headers core-headers check test test-all \
        test-programs cuda-tests golden-update seconds fuzz mutants bench plot size clean peers FORCE
endif

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1 /p' Makefile make/*.mk | \
	    awk '{ name = $$1; $$1 = ""; printf "  make %-14s%s\n", name, $$0 }'
	@echo 'V=1 prints whole commands. CC, AR, CFLAGS, CPPFLAGS, LDFLAGS, NVCC (none: without CUDA), LIBDIR: as usual.'
.PHONY: help
