# Builds the command and the libraries.

include make/sources.mk

# The script probe.sh finds the compiler's target and the optional libraries. It runs again when they change.
quoted = '$(subst ','\'',$(1))'
ifneq ($(filter-out $(DIST_GOALS) aar clean help headers core-headers uninstall windows,$(GOALS)),)
$(shell CC=$(call quoted,$(CC)) CPPFLAGS=$(call quoted,$(CPPFLAGS)) CFLAGS=$(call quoted,$(CFLAGS)) \
    LDFLAGS=$(call quoted,$(LDFLAGS)) NVCC=$(call quoted,$(NVCC)) sh tools/scripts/probe.sh $(B) >&2)
include $(B)/probe.mk
ifeq ($(filter CUDA,$(FOUND))$(filter none,$(NVCC)),)
$(info built without the CUDA back end: no $(NVCC) for this compiler's machine)
endif
endif
ifeq ($(origin AR),default)
AR := $(or $(AR_OF_CC),ar)
endif

INCLUDES := -Isrc/include -I.
FLAGS = $(STANDARD) $(INCLUDES) $(WARNINGS) $(FLAGS_$(SYSTEM)) $(FOUND:%=-DFXS_WITH_%) $(CFLAGS) $(CPPFLAGS)
FOR_TESTS_win32 := -include tests/on_windows.h
PIC_win32 := '-DFXS_API=__declspec(dllexport)'
PIC := $(if $(SHARED),$(PIC_$(SYSTEM)))
NVCC_FLAGS = -O3 -std=c++17 $(INCLUDES) $(CUDA_FLAGS)
LIBS := $(foreach name,$(LINKED) CUDA,$(LIBS_$(name))) -lm -lpthread

# -g0: clang 14 crashes on debug information of AVX-512 masks.
CLANG_14 := $(if $(findstring clang,$(CC_VERSION)),-g0)
FLAGS_AVX512 += $(CLANG_14)
FLAGS_FAST := $(if $(filter -O2,$(CFLAGS)),$(FLAGS_FAST))
FLAGS_SINGLES := $(SINGLES)
flags_of = $(foreach kind,$(KINDS),$(if $(filter $(FILES_$(kind)),$(1)),$(FLAGS_$(kind))))

with = $(if $(filter $(1),$(FOUND)),$(wildcard $(2)))
CORE := $(wildcard $(SOURCES_CORE) $(KERNELS_$(KERNEL_FOLDER)))
DEVICES := $(call with,GLES,$(SOURCES_GLES)) $(call with,VULKAN,$(SOURCES_VULKAN)) $(call with,CUDA,$(SOURCES_CUDA))
LIBRARY := $(wildcard $(SOURCES_LIBRARY) $(SOURCES_$(SYSTEM)) $(SOURCES_PORT) $(THREADED_$(SYSTEM)) \
                      $(STAGES_$(KERNEL_FOLDER)))
LIBRARY += $(if $(filter GLES,$(FOUND)),$(call with,EGL,$(SOURCES_EGL)) $(call with,OSMESA,$(SOURCES_OSMESA)))
LIBRARY += $(B)/declarations.c
WINDOW := $(filter-out tools/view/viewer_main.c,$(call with,SDL,$(SOURCES_VIEW)))
SERVER := $(call with,MICROHTTPD,$(SOURCES_WEB) $(SOURCES_WEB_$(SYSTEM)))
TOOL := $(filter-out $(NOT_TOOL),$(wildcard $(SOURCES_TOOL)))
TOOL_SHARED := tools/command/metrics.c tools/command/procedural.c tools/command/samples.c tools/command/trial.c
objects = $(patsubst %.cu,$(B)/%.o,$(patsubst %.c,$(B)/%.o,$(1)))

EXE := $(if $(filter win32,$(SYSTEM)),.exe)
PROGRAMS := $(patsubst %,$(B)/%$(EXE),fixsplat $(if $(WINDOW),fixsplat-view) $(if $(SERVER),fixsplat-web))
ARCHIVES := $(B)/libfixsplat-core.a $(B)/libfixsplat.a
SONAME := libfixsplat.so.$(MAJOR)
SHARED_posix := $(B)/libfixsplat.so.$(VERSION)
SHARED_win32 := $(B)/libfixsplat-$(MAJOR).dll
SHARED_LIBRARY := $(if $(SHARED),$(SHARED_$(SYSTEM)))


# Prints a line per compiled file; V=1 prints whole commands.
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

$(B)/fixsplat-view$(EXE): $(call objects,tools/view/viewer_main.c $(WINDOW) $(filter-out tools/command/main.c,$(TOOL))) \
                    $(B)/libfixsplat.a $(B)/commands/link
	$(call link,$(foreach name,$(LINKED_VIEW),$(LIBS_$(name))))

$(B)/fixsplat-web$(EXE): $(call objects,$(SERVER) $(filter-out tools/command/main.c,$(TOOL))) $(B)/libfixsplat.a \
                   $(B)/commands/link
	$(call link,$(foreach name,$(LINKED_WEB),$(LIBS_$(name))) $(SOCKETS_$(SYSTEM)))

# Each file in commands/ holds a compiler command. When the command changes, all files that it makes are rebuilt.
$(B)/commands/compile: COMMAND := $(CC) $(CC_VERSION) $(filter-out -DFXS_WITH_%,$(FLAGS)) $(PIC)
$(B)/commands/nvcc: COMMAND := $(NVCC) $(NVCC_VERSION) $(NVCC_FLAGS)
$(B)/commands/link: COMMAND := $(CC) $(CC_VERSION) $(CFLAGS) $(LDFLAGS) $(LIBS) $(foreach name,$(LINKED_VIEW) $(LINKED_WEB),$(LIBS_$(name))) $(AR) \
                              $(CORE) $(DEVICES) $(LIBRARY)
$(B)/commands/%: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' $(call quoted,$(COMMAND)) | cmp -s - $@ || printf '%s\n' $(call quoted,$(COMMAND)) >$@

# Makes an object file depend on each optional library that its sources name by a macro FXS_WITH_NAME.
features = grep -ohs 'FXS_WITH_[A-Z0-9]*' $$(sed 's/^[^ ]*://; s/[\\:]//g' $(@:.o=.d)) | sort -u | \
           sed 's|FXS_WITH_|$@: $(B)/with/|' >>$(@:.o=.d)

$(B)/%.o: %.c $(B)/commands/compile
	@mkdir -p $(@D)
	$(call say,CC,$<)$(CC) $(FLAGS) $(if $(filter tools/% tests/%,$*),,$(PIC)) $(if $(filter tests/%,$*),$(FOR_TESTS_$(SYSTEM))) $(call flags_of,$*) -MMD -MP -c -o $@ $<
	@$(features)

# nvcc puts a hash of the source file's path into symbol names. With a relative path, object files are equal in all
# folders.
$(B)/%.o: %.cu $(B)/commands/nvcc
	@mkdir -p $(@D)
	$(call say,NVCC,$<)$(NVCC) $(NVCC_FLAGS) -Xcudafe --orig_src_path_name,$< \
	    $(if $(findstring fit,$*),$(CUDA_FIT_FLAGS)) -MMD -MP -c -o $@ $<

# These object files use an optional library, so they are rebuilt when the library appears or disappears.
$(call objects,$(wildcard port/window/*.c)): $(B)/with/SDL
$(call objects,$(wildcard port/http/*.c port/*/http/*.c)): $(B)/with/MICROHTTPD
$(call objects,$(wildcard $(SOURCES_GLES))): $(B)/with/GLES
$(call objects,$(wildcard $(SOURCES_VULKAN))): $(B)/with/VULKAN
$(call objects,$(SOURCES_EGL)): $(B)/with/EGL
$(call objects,$(SOURCES_OSMESA)): $(B)/with/OSMESA

$(B)/kernels/gles/shaders.h: $(wildcard $(SHADERS_gles))
$(B)/kernels/compute/shaders.h: $(wildcard $(SHADERS_compute))
$(B)/kernels/%/shaders.h: tools/scripts/shaders.sh
	@mkdir -p $(@D)
	@sh $< $(filter-out $<,$^) >$@
$(B)/kernels/vulkan/shaders.h: $(wildcard $(SHADERS_vulkan))
$(B)/kernels/fit/vulkan/shaders.h: $(wildcard $(SHADERS_fit_vulkan))
$(B)/kernels/vulkan/shaders.h $(B)/kernels/fit/vulkan/shaders.h: tools/scripts/vulkan_shaders.sh
	@mkdir -p $(@D)
	@sh $< -c $(filter-out $<,$^) >$@
$(B)/kernels/vulkan/vk_device.o: $(B)/kernels/vulkan/shaders.h
$(B)/kernels/fit/vulkan/vf_device.o: $(B)/kernels/fit/vulkan/shaders.h
$(B)/kernels/vulkan/vk_device.o $(B)/kernels/fit/vulkan/vf_device.o: INCLUDES += -I$(@D)
WITH_SHADERS := $(addprefix $(B)/kernels/,gles/gles.o compute/compute.o compute/framebuffer.o)
$(WITH_SHADERS): $(B)/kernels/gles/shaders.h $(B)/kernels/compute/shaders.h
$(WITH_SHADERS): INCLUDES += -I$(@D)

# vulkan.h is left out, because a build may lack the headers of Vulkan.
DECLARED := $(filter-out %/vulkan.h,$(HEADERS))
$(B)/declarations.c: $(DECLARED) tools/scripts/declarations.sh $(B)/commands/compile
	@CC=$(call quoted,$(CC) $(CPPFLAGS)) sh tools/scripts/declarations.sh -c $(DECLARED) >$@

$(B)/with/%: ;
FOLDERS := src/* src/*/* kernels kernels/* kernels/*/* port/* port/*/* tools/* tests tests/gpu
-include $(wildcard $(foreach place,. firmware/* web/*,$(FOLDERS:%=$(B)/$(place)/%/*.d)))
.SUFFIXES:
.DELETE_ON_ERROR:
.PRECIOUS: $(B)/%.o

demo: all ## make a procedural scene and render it to demo.png
	$(B)/fixsplat demo
