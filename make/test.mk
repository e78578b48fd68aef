# Rules that run the tests.

TESTS := $(patsubst tests/%.c,%,$(wildcard tests/test_*.c))
# These tests are left out on Windows, because they fork, limit resources, create links or FIFOs, or use a shell.
NOT_ON_WINDOWS := allocation bombs camera_file fit_model fxs_file image_file pager procedural scene_input scribble sog streamed_sog tileset
TESTS_HERE := $(if $(EXE),$(filter-out $(NOT_ON_WINDOWS:%=test_%),$(TESTS)),$(TESTS))

SCRIPTS := $(notdir $(wildcard tests/scripts/*.sh))
GATES := $(notdir $(wildcard tests/gates/*.sh))

# LONG lists the tests that take 10 seconds or more. They start first, and `make check` omits them. tests/seconds has
# the processor time of each test in seconds. Tests in a browser wait most of their time, so they start before the rest:
# in this way they end while others use the processors.
LONG := $(filter $(TESTS) $(SCRIPTS) $(GATES),$(shell awk '$$2 >= 10 { print $$1 }' tests/seconds))
IN_BROWSER := page.sh web.sh webgpu.sh webgl.sh xr.sh preview.sh bundlers.sh publish.sh
# Tests that need a window, or that measure time, run one at a time after all others.
ALONE := window.sh web_speed.sh
CHECKED := $(filter-out $(LONG),$(TESTS) $(GATES))

# T=name selects the test of that name, or all tests with names that contain it.
EVERY := $(TESTS) $(SCRIPTS) $(GATES)
containing = $(strip $(foreach name,$(EVERY),$(if $(findstring $(1),$(name)),$(name))))
called = $(or $(filter $(1) test_$(1) $(1).sh,$(EVERY)),$(call containing,$(1)),$(error no test is called $(1)))
RUN := $(if $(T),$(sort $(foreach name,$(T),$(call called,$(name)))),$(EVERY))
# Browser tests wait most of the time, so one more test runs at once than there are processors. With two more, tests of
# frame clocks and previews failed.
AT_ONCE = $(shell expr $(PROCESSORS) + 1)
run = @FXS_SCENES=$(SCENES) B=$(B) JOBS=$(or $(FXS_JOBS),$(JOBS),$(AT_ONCE)) ALONE='$(ALONE)' \
    LONG='$(LONG)' sh tests/run.sh $(strip $(call among,$(IN_BROWSER),$(1)) \
        $(call among,$(filter-out $(IN_BROWSER),$(LONG)),$(1)) $(filter-out $(IN_BROWSER) $(LONG),$(1)))
# $(call among,ORDERED,NAMES): the NAMES that are ORDERED, in that order.
among = $(foreach name,$(1),$(filter $(name),$(2)))
JDK := $(patsubst %/bin/javac,%,$(realpath $(shell command -v javac)))
# $(call needed,SCRIPTS,FILES): files that the tests of these scripts run.
needed = $(if $(filter $(1),$(RUN)),$(2))
NEEDED := $(filter $(TESTS),$(RUN)) $(call needed,bombs.sh web.sh,test_bombs) \
          $(call needed,boards.sh,test_strip test_panel) $(call needed,convert.sh,test_lcc) \
          $(call needed,web.sh,test_scene_input) $(call needed,openxr.sh,test_openxr xr/example) \
          $(if $(and $(JDK),$(filter EGL,$(FOUND)),$(filter VULKAN,$(FOUND))),$(call needed,android.sh,android/libfixsplat.so android/stand_in/libEGL.so)) \
          $(if $(shell command -v $(CXX)),$(call needed,cuda_emulated.sh,gpu/emulated_cuda))

$(B)/tests/test_%$(EXE): $(B)/tests/test_%.o $(B)/tests/reference.o $(call objects,$(TOOL_SHARED)) $(B)/libfixsplat.a \
                   $(B)/commands/link
	$(call link)

# A layer of Vulkan with its manifest, for test_vulkan, vulkan_fails.sh and fit_vulkan.sh.
LAYER := $(B)/tests/layer/libfailing_layer.so
$(B)/tests/test_vulkan: $(if $(filter VULKAN,$(FOUND)),$(LAYER))
$(LAYER): tests/failing_layer.c tests/failing_layer.h kernels/vulkan/vk.h $(B)/commands/compile
	@mkdir -p $(@D)
	$(call say,LD,$@)$(CC) $(FLAGS) $(LDFLAGS) -shared -fPIC -o $@ $<
	@printf '{"file_format_version": "1.1.2", "layer": {"name": "VK_LAYER_FIXSPLAT_failing", "type": "GLOBAL",\n%s}}\n' \
	    '"library_path": "./$(@F)", "api_version": "1.1.0", "implementation_version": "1", "description": "for tests"' \
	    >$(@D)/failing_layer.json

# A runtime of OpenXR with its manifest, for test_openxr and openxr.sh. The headers of all three libraries make it.
RUNTIME := $(B)/tests/xr/libxr_runtime.so
$(B)/tests/test_openxr: $(if $(filter 4,$(words $(filter OPENXR VULKAN GLES EGL,$(FOUND)))),$(RUNTIME))
$(RUNTIME): tests/xr_runtime.c tests/xr_runtime.h $(B)/commands/compile
	@mkdir -p $(@D)
	$(call say,LD,$@)$(CC) $(FLAGS) $(LDFLAGS) -shared -fPIC -fvisibility=hidden -o $@ $< -lm
	@printf '{"file_format_version": "1.0.0", "runtime": {"library_path": "./%s"}}\n' $(@F) >$(@D)/runtime.json

# The program of docs/openxr.md.
$(B)/tests/xr/example: docs/openxr.md port/xr/xr.h $(B)/libfixsplat.a
	@mkdir -p $(@D)
	@sed -n '/^```c/,/^```$$/{/^```/!p}' $< >$@.c
	$(call say,LD,$@)$(CC) $(FLAGS) -Werror $(LDFLAGS) -o $@ $@.c $(filter %.a,$^) $(LIBS)

# The window's test defines an SDL function itself. On Windows, SDL is linked statically, so the linker must allow a
# second definition.
FOR_WINDOW_win32 := -Wl,--allow-multiple-definition
$(B)/tests/test_window$(EXE): $(call objects,tests/test_window.c port/window/motion.c port/window/overlay.c \
                        port/window/words.c $(WINDOW) \
                        $(filter-out tools/command/main.c,$(TOOL))) $(B)/libfixsplat.a $(B)/commands/link
	$(call link,$(FOR_WINDOW_$(SYSTEM)) $(LIBS_TTF) $(LIBS_SDL))

test: all $(addprefix $(B)/tests/,$(NEEDED)) ## run all tests, JOBS at once; T=name: those with that in their names
	$(call run,$(RUN))

check: all $(addprefix $(B)/tests/,$(filter $(TESTS),$(CHECKED))) ## run the test programs and gates that take a moment
	$(call run,$(CHECKED))

seconds: ## write tests/seconds, by which tests are long, from the last `make test`
	@awk 'NR == FNR { seconds[$$1] = $$2; next } $$1 > 0 { seconds[$$6] = $$5 } \
	    END { for (name in seconds) printf "%s %.0f\n", name, seconds[name] }' tests/seconds $(B)/tests/results/all | \
	    sort -k 2,2rn -k 1,1 >tests/seconds.new && mv tests/seconds.new tests/seconds

test-all: ## the same, with every compiler, processor, board and sanitizer at hand
	FXS_PROCESSORS=all $(MAKE) test

test-programs: $(patsubst %,$(B)/tests/%$(EXE),$(TESTS_HERE)) ## build the test programs

# Test programs that need a GPU.
$(B)/tests/gpu/test_cuda $(B)/tests/gpu/bench_cuda: $(B)/tests/gpu/peek.o
$(B)/tests/gpu/test_fit: $(B)/tests/gpu/peek_fit.o
$(B)/tests/gpu/%: $(B)/tests/gpu/%.o $(B)/libfixsplat.a $(B)/commands/link
	$(call link)

# Test program of the CUDA kernels that needs no GPU: compiled as C++ with an emulation of CUDA.
EMULATED := tests/gpu/emulated
$(B)/tests/gpu/emulated_cuda: $(B)/tests/gpu/test_cuda.o $(B)/tests/gpu/emulated_peek.o $(B)/tests/gpu/emulated_runtime.o \
                              $(B)/libfixsplat.a $(B)/commands/link
	$(call link,-lstdc++)
$(B)/tests/gpu/emulated_peek.o: tests/gpu/peek.cu
	$(emulate)
$(B)/tests/gpu/emulated_runtime.o: $(EMULATED)/runtime.cu
	$(emulate)
define emulate
	@mkdir -p $(@D)
	$(call say,CXX,$<)$(CXX) -std=c++17 -O2 -w -I$(EMULATED) -include $(EMULATED)/ptx.h -D__CUDACC__ -Isrc/include -I. \
	    -MMD -MP -x c++ -c -o $@ $<
endef

cuda-tests: $(addprefix $(B)/tests/gpu/,test_cuda bench_cuda test_fit flight) $(B)/tests/test_fit_steps ## build what tests/gpu/*.sh run on a GPU

golden-update: all $(B)/tests/test_golden ## write the golden images anew (and say why in the commit)
	$(B)/tests/test_golden --update

fuzz: all ## fuzz readers and renderer, SECONDS=60 each, JOBS at once
	B=$(B) sh tests/fuzz.sh $(or $(SECONDS),60)

mutants: ## change the code in COUNT small ways, drawn by SEED, and see that a test notices each (long)
	sh tests/mutants.sh $(or $(SEED),1) $(or $(COUNT),30) $(FILES)

# The library of port/android for Java on this machine, and stand-ins for the libraries of Android (tests/android).
ON_DESKTOP := $(B)/tests/android
COUNTED := malloc calloc realloc strdup posix_memalign free
$(B)/port/android/%.o $(ON_DESKTOP)/%.o: INCLUDES += -fPIC -I$(JDK)/include -I$(JDK)/include/linux
$(ON_DESKTOP)/libfixsplat.so: $(call objects,$(wildcard port/android/*.c) tests/android/counted.c) $(B)/libfixsplat.a \
                              $(B)/commands/link
	$(call link,-shared $(COUNTED:%=-Wl$(comma)--wrap=%))
$(ON_DESKTOP)/stand_in/libEGL.so: $(call objects,$(wildcard tests/android/stand_in*.c)) $(B)/commands/link
	@mkdir -p $(@D)
	$(call link,-shared)
	@for name in android vulkan; do ln -sf $(@F) $(@D)/lib$$name.so; done
comma := ,
