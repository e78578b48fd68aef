# Builds the npm packages fixsplat and fixsplat-viewer (docs/web.md).

# WebAssembly modules of the npm package. Three contain the renderer: core (without simd128), simd, and threads (simd128
# and threads). Four read and pack scene files: import (all formats except .sog), import_threads (import with threads),
# import_sog (the .sog reader), and import_core (all formats, without simd128).
WASM_CC ?= clang
ESBUILD ?= esbuild
WASM_OPT ?= wasm-opt
$(call needs,web,$(lastword $(WASM_CC)) wasm-ld $(WASM_OPT) node)
$(call needs,web-package,$(lastword $(WASM_CC)) wasm-ld $(WASM_OPT) node npm $(ESBUILD))
WEB := $(B)/web/package
VIEWER := $(B)/web/viewer
IMPORTS := import import_threads import_sog import_core
MODULES := core simd threads $(IMPORTS)
WASM_FLAGS := --target=wasm32-wasi -std=gnu99 $(INCLUDES) -fwrapv -ffp-contract=off -ffunction-sections \
              -Wall -Wextra -Wpedantic -Wshadow -Wconversion
# wasm-opt would inline large functions with one caller, such as memmove, which clang has kept apart for size.
# Two rounds make modules as small as --converge does, in 40 % of its time.
WASM_OPT_ROUND := --flatten --rereloop -O3 -O3
WASM_OPT_FLAGS := $(WASM_OPT_ROUND) $(WASM_OPT_ROUND) -ocimfs=200 -fimfs=0 --low-memory-unused
WASM_LINK := --target=wasm32-wasi -nostartfiles -Wl,--no-entry,--strip-all,--stack-first,-z,stack-size=524288
WEB_C := $(addprefix port/web/web_,text.c heap.c files.c) src/base/message.c src/base/allocator.c
WEB_CORE := $(wildcard src/core/*.c) kernels/kernels.c port/web/web_core.c port/web/web_edit.c port/web/web_paged.c src/scene/edit/editor.c $(wildcard src/select/*.c) src/gaussian/nearest.c src/base/crc32.c src/gaussian/scene_start.c src/scene/fxs_file.c \
            $(addprefix src/camera/,camera.c first_view.c ground.c sample.c start_view.c within.c) src/scene/world.c $(WEB_C)
sources_of_core := $(WEB_CORE)
WEB_GLES := $(wildcard kernels/gl/*.c kernels/gles/*.c) port/web/webgl.c
sources_of_simd := $(WEB_CORE) $(wildcard kernels/simd/wasm/*.c) $(WEB_GLES) kernels/compute/plan.c port/web/webgpu.c
sources_of_threads := $(sources_of_simd) port/web/web_pool.c
WEB_IMPORT := $(filter-out %/fxs.c %/numbered.c,$(wildcard $(patsubst %,src/%/*.c,gaussian scene/read pack))) src/scene/scene_file.c src/scene/sound.c src/scene/formats.c \
              src/scene/fxs_file.c $(addprefix port/web/web_,import.c crc.c) port/backend/pack_stages.c \
              $(addprefix src/base/,crc32.c byte_reader.c foreign.c inflate.c opened.c options.c source.c text.c zip.c) \
              $(addprefix src/core/,scene.c fixsplat.c chunk.c sized.c animate.c) $(WEB_C)
sources_of_import := $(WEB_IMPORT)
sources_of_import_sog := $(WEB_IMPORT)
sources_of_import_core := $(WEB_IMPORT)
sources_of_import_threads := $(WEB_IMPORT) port/web/web_pool.c
# A WebAssembly module compiles the file readers that it leaves out without their libraries. These readers recognise
# their files and report an error.
not_in_import_core := %/splat4d.c %/fourdgs.c
not_in_import := %/sog.c %/zip.c $(not_in_import_core)
not_in_import_sog := %/gltf.c %/tileset.c %/lcc.c %/rad.c %/spz.c %/inflate.c $(not_in_import_core)
# Code that takes little of the run time is compiled for size. Flag --low-memory-unused: the lowest 1024 bytes of memory
# are the end of the stack, and no pointer refers to them. Header <GLES3/gl3.h> is the build machine's.
wasm_flags_of = $(if $(filter $(IMPORTS),$(1)),-DFXS_TO_PACK $(if $(filter $(not_in_$(1)),$(2)),,$(WEB_READERS_FLAGS))) \
                $(if $(filter simd import import_sog,$(1)),-msimd128) $(if $(filter %/web_pool.c,$(2)),-matomics -mbulk-memory) \
                $(if $(filter $(WEB_GLES),$(2)),-idirafter /usr/include -I$(B)/kernels/gles) \
                $(if $(filter src/pack/%,$(2)),-fno-math-errno) \
                $(if $(filter $(WEB_FAST),$(2)),-O3,$(if $(filter $(WEB_SMALL),$(subst import_sog,import,$(1))/$(2)),-Oz,$(if \
                  $(filter-out %/pack_c.c,$(filter import%,$(1)/$(2))),-Os,-O2)))
WEB_FAST := $(addprefix kernels/simd/wasm/,bin% project% shade%) src/core/weigh.c src/gaussian/nearest.c src/select/min_cut.c
WEB_SMALL := simd/src/% $(addprefix core/src/core/,animate.c bands.c pace.c setup.c sized.c targets.c) core/port/% core/src/base/% core/src/gaussian/% core/src/camera/% core/src/scene/% core/src/select/% simd/port/% simd/kernels/gles/% %/kernels/gl/gl_functions.c %/gl/state.c %/compute/plan.c \
             import/src/scene/formats.c import/src/scene/scene_file.c import/src/scene/sound.c import/src/gaussian/stream.c \
             import/src/base/foreign.c import/src/gaussian/scene_start.c import/src/base/source.c import/src/base/text.c import/src/base/zip.c \
             $(addprefix import/src/pack/,framing.c palette.c) $(addprefix import/src/scene/read/,gltf.c lcc.c ply_header.c ply_motion.c rad.c splatv.c tileset.c) import/src/pack/lives.c import/src/gaussian/moment.c import/src/gaussian/gaussian_source.c \
             import/src/core/% import/src/scene/fxs_file.c import/src/gaussian/transform.c import/port/web/%
# Modules with threads link only thread-safe functions of wasi-libc. fixsplat.js creates their shared memory.
wasm_link_of_threads := -Wl,--shared-memory,--import-memory,--initial-memory=1048576,--max-memory=4294967296 \
                        -Wl,--no-check-features,--export=__stack_pointer
wasm_opt_of_threads := --enable-threads --enable-bulk-memory --enable-mutable-globals
wasm_link_of_import_threads := $(wasm_link_of_threads)
wasm_opt_of_import_threads := $(wasm_opt_of_threads)
# A module takes another module's object files, but for its own_in, the sources that it compiles with other flags.
objects_for_threads := simd
objects_for_import_threads := import
objects_for_import_sog := import
own_in_import_sog := $(not_in_import) $(not_in_import_sog)
web_objects_of = $(foreach source,$(sources_of_$(1)),$(B)/web/$(if $(filter $(own_in_$(1)),$(source)),$(1),$(or \
                     $(objects_for_$(1)),$(1)))/$(source:.c=.o))
# Libraries of the file readers, with sources from `make setup web`.
not_of_libzip := $(addprefix zip_,crypto_% winzip_aes% source_winzip_aes% pkware.c source_pkware% source_file_% random_% \
                   get_encryption_implementation.c mkstempm.c libzip_version.c algorithm_bzip2.c algorithm_xz.c)
WEB_LIBS_C := cjson/cJSON.c $(patsubst %,zlib/%.c,adler32 inflate inftrees inffast zutil) \
              $(patsubst %,libzstd/lib/common/%.c,entropy_common error_private fse_decompress xxhash zstd_common) \
              $(patsubst %,libzstd/lib/decompress/%.c,huf_decompress zstd_ddict zstd_decompress \
                                                      zstd_decompress_block) \
              $(patsubst %,libwebp/src/dec/%_dec.c,buffer vp8l webp) \
              $(patsubst %,libwebp/src/dsp/%.c,alpha_processing cpu lossless rescaler yuv) libwebp/src/utils/utils.c \
              $(patsubst %,libwebp/src/utils/%_utils.c,bit_reader color_cache huffman rescaler) \
              $(addprefix libzip/lib/,$(filter-out $(not_of_libzip),$(notdir $(wildcard $(WEB_SOURCES)/libzip/lib/*.c))))
WEB_NONE := none.c no_lossy.c
WEB_VERSIONS := $(if $(WEB_SOURCES),$(if $(wildcard $(WEB_SOURCES)/versions),$(shell cat $(WEB_SOURCES)/versions)))
WEB_LIBS := $(if $(WEB_VERSIONS),$(patsubst %.c,$(B)/web/libs/%.o,$(WEB_LIBS_C) $(WEB_NONE)))
WEB_LIBS_FLAGS := --target=wasm32-wasi -Oz -w -fwrapv -ffunction-sections -DNDEBUG \
                  -DHUF_FORCE_DECOMPRESS_X1 -DZSTD_FORCE_DECOMPRESS_SEQUENCES_SHORT -DZSTD_STRIP_ERROR_STRINGS \
                  -DZSTD_LEGACY_SUPPORT=0 -DZSTD_DISABLE_ASM -DWEBP_REDUCE_SIZE \
                  $(addprefix -I,port/web/libs $(addprefix $(WEB_SOURCES)/,zlib libzip/lib libwebp))
WEB_READERS_FLAGS := $(if $(WEB_LIBS),$(patsubst %,-DFXS_WITH_%,CJSON WEBP ZIP ZLIB ZSTD) -isystem port/web/libs \
                       $(patsubst %,-isystem $(WEB_SOURCES)/%,. zlib libzip/lib libzstd/lib libwebp/src))
ifneq ($(filter web,$(GOALS)),)
ifeq ($(WEB_LIBS),)
$(info built without .sog, glTF, 3D Tiles and gzip and zstd of .spz for the web: no sources of libraries in $(WEB_SOURCES))
endif
endif

WASM := $(MODULES:%=$(WEB)/%.wasm)

HAS_ESBUILD := $(shell command -v $(ESBUILD))
WEB_INLINE := $(if $(HAS_ESBUILD),$(addprefix $(WEB)/inline/,with_files.js files.js package.json))
WEB_SCRIPTS := $(addprefix $(WEB)/,fixsplat.js fixsplat_assets.js webgl.js webgpu.js stages.js read.js paged.js editor.js store.js thread.js node.js \
                                   system.js thread_node.js)
# The viewer's page consists of scripts, styles and HTML files, in the folder viewer of the npm package fixsplat. They
# import fixsplat by relative paths, so a browser needs no bundler. The npm package fixsplat-viewer has the same files
# in its folder `page`.
VIEWER_JS := $(notdir $(wildcard port/web/viewer/*.js)) style.js
VIEWER_TYPES := $(notdir $(wildcard port/web/viewer/*.d.ts))
OF_PAGES := fit.js list.js page.js published.js served.js single.js
OF_BUNDLERS := element.js inline.js placed.js playcanvas.js react.js server.js starts.js three.js worker_whole.js
PAGE_PARTS := $(filter-out $(OF_BUNDLERS),$(VIEWER_JS)) \
              $(notdir $(filter-out %/viewer.css,$(wildcard port/web/viewer/*.css port/web/viewer/*.html)))
# The folder of the page also has TypeScript types and a README, because the installed documentation links to them.
WEB_PAGE := $(addprefix $(WEB)/viewer/,$(PAGE_PARTS) $(VIEWER_TYPES) README.md)
PACKAGE := $(WASM) $(WEB_SCRIPTS) $(addprefix $(WEB)/,fixsplat.d.ts package.json README.md CHANGELOG.md LICENSE) $(WEB_INLINE) $(WEB_PAGE)
# Modules of the npm package fixsplat that the viewer's page imports. In the package fixsplat-viewer they are stubs,
# which import fixsplat of the same version from the page's server, as on a CDN.
VIEWER_STUBS := fixsplat.js fixsplat_assets.js read.js
VIEWER_SCRIPTS := $(filter-out $(OF_PAGES) $(if $(HAS_ESBUILD),,inline.js),$(VIEWER_JS))
VIEWER_PACKAGE := $(addprefix $(VIEWER)/,$(VIEWER_SCRIPTS) $(VIEWER_TYPES) $(VIEWER_STUBS) $(addprefix page/,$(PAGE_PARTS)) \
                                         $(if $(HAS_ESBUILD),inline_worker.js) package.json README.md CHANGELOG.md LICENSE)

web: $(PACKAGE) $(VIEWER_PACKAGE) ## the npm packages (docs/web.md), in build/web/package and build/web/viewer

ifneq ($(filter web web-package,$(GOALS)),)
ifeq ($(HAS_ESBUILD),)
$(info built without fixsplat/inline and fixsplat-viewer/inline: no esbuild)
endif
endif

web-package: web ## the same as files for `npm publish`: build/web/fixsplat-VERSION.tgz and fixsplat-viewer-VERSION.tgz
	@rm -f $(B)/web/fixsplat-*.tgz
	$(call say,PACK,$(B)/web/fixsplat-*$(VERSION).tgz)for package in $(WEB) $(VIEWER); do \
	    npm pack --silent --ignore-scripts --pack-destination $(B)/web ./$$package >/dev/null || exit 1; done

define web_rules
$(B)/web/$(1)/%.o: %.c $(B)/commands/web
	@mkdir -p $$(@D)
	$$(call say,CC,'$$< ($(1))')$(WASM_CC) $(WASM_FLAGS) $$(call wasm_flags_of,$(1),$$<) -MMD -MP -c -o $$@ $$<
$(WEB)/$(1).wasm: $(call web_objects_of,$(1))
	@mkdir -p $$(@D)
	$$(call say,LD,$$@)$(WASM_CC) $(WASM_LINK) $(wasm_link_of_$(1)) -o $(B)/web/$(1).linked $$(filter %.o,$$^) && \
	    $(WASM_OPT) --enable-simd $(wasm_opt_of_$(1)) $(WASM_OPT_FLAGS) -o $$@ $(B)/web/$(1).linked
endef
$(foreach module,$(MODULES),$(eval $(call web_rules,$(module))))
$(B)/web/simd/kernels/gles/gles.o: $(B)/kernels/gles/shaders.h
$(B)/web/libs/%.o: $(WEB_SOURCES)/%.c $(B)/commands/web
	@mkdir -p $(@D)
	$(call say,CC,'$* (import)')$(WASM_CC) $(WEB_LIBS_FLAGS) -c -o $@ $<
$(WEB_NONE:%.c=$(B)/web/libs/%.o): $(B)/web/libs/%.o: port/web/libs/%.c $(B)/commands/web
	@mkdir -p $(@D)
	$(call say,CC,'$< (import)')$(WASM_CC) $(WEB_LIBS_FLAGS) -c -o $@ $<
$(WEB_LIBS): $(wildcard port/web/libs/*.h)
$(IMPORTS:%=$(WEB)/%.wasm): $(WEB_LIBS)
$(B)/commands/web: COMMAND = $(WASM_CC) $(WASM_FLAGS) $(WEB_LIBS_FLAGS) $(WEB_VERSIONS) $(WASM_LINK) $(wasm_link_of_threads) $(WASM_OPT) $(WASM_OPT_FLAGS) \
    $(wasm_opt_of_threads) \
    $(sort $(foreach module,$(MODULES),$(foreach file,$(sources_of_$(module)),$(call wasm_flags_of,$(module),$(file)))))

$(WEB)/package.json $(VIEWER)/package.json: src/include/fixsplat/fixsplat.h
	@mkdir -p $(@D)
	@sed 's/@VERSION@/$(VERSION)/' $(filter %.json,$^) >$@
$(WEB)/package.json: port/web/package.json
$(VIEWER)/package.json: port/web/viewer/package.json
WEB_LICENSES := $(if $(WEB_LIBS),$(addprefix $(WEB_SOURCES)/,cjson/LICENSE libwebp/COPYING libwebp/PATENTS \
                                                             libzip/LICENSE libzstd/LICENSE zlib/LICENSE))
$(WEB)/LICENSE: LICENSE $(wildcard /usr/share/doc/wasi-libc/copyright) $(WEB_LICENSES)
	@mkdir -p $(@D)
	@for f in $^; do [ $$f = LICENSE ] || printf '\n---- %s ----\n\n' $$(basename $$(dirname $$f)); cat $$f; done >$@
# Lists the file endings of readable scene formats from the table in src/scene/formats.c. There, a row of numbers that
# begins with 1 marks a readable format.
FORMATS := $(shell awk '/^    \{\{"/ { split($$0, quoted, "\""); endings = quoted[4] } \
    /^      1, / { n = split(endings, ending, " "); \
        for (i = 1; i <= n; i++) if (!seen[ending[i]]++) list = list (list ? ", " : "") ending[i] } \
    /^      [01], / { endings = "" } END { print list }' src/scene/formats.c)
$(PACKAGE) $(VIEWER_PACKAGE): src/scene/formats.c
$(WEB)/stages.js: tools/scripts/stages.mjs src/include/fixsplat/internal/pixel.h $(wildcard kernels/compute/*.wgsl)
	@mkdir -p $(@D)
	$(call say,NODE,$@)node $< $@
$(WEB)/viewer/style.js $(VIEWER)/style.js: port/web/viewer/viewer.css tools/scripts/inline.mjs
	@mkdir -p $(@D)
	@node tools/scripts/inline.mjs style $< >$@
$(WEB)/inline/files.js: tools/scripts/inline.mjs $(filter-out %core.wasm %import_threads.wasm,$(WASM)) $(WEB)/thread.js
	@mkdir -p $(@D)
	$(call say,NODE,$@)node $< files ../fixsplat_assets.js $(foreach file,$(filter-out $<,$^),$(notdir $(file))=$(file)) >$@
$(VIEWER)/inline_worker.js: tools/scripts/inline.mjs $(WEB_SCRIPTS) $(WEB)/package.json $(addprefix $(VIEWER)/,package.json worker_whole.js worker.js pace.js sky.js motion.js)
	@mkdir -p $(@D)
	$(call say,NODE,$@)$(ESBUILD) --log-level=warning --bundle --minify --format=esm --alias:fixsplat=$(abspath $(WEB)) \
	    --outfile=$(B)/web/worker.js $(VIEWER)/worker_whole.js && \
	    node $< files fixsplat/fixsplat_assets.js viewer/worker.js=$(B)/web/worker.js >$@
# Adds a package.json for bundlers that resolve a folder by its name, without "exports" of the package.
$(WEB)/inline/package.json: make/web.mk
	@mkdir -p $(@D) && echo '{ "type": "module", "main": "./with_files.js", "types": "../fixsplat.d.ts" }' >$@
$(WEB)/CHANGELOG.md $(VIEWER)/CHANGELOG.md: NEWS.md
	@mkdir -p $(@D) && cp $< $@
$(VIEWER)/LICENSE: LICENSE
	@mkdir -p $(@D) && cp $< $@
$(addprefix $(VIEWER)/,$(VIEWER_STUBS)): make/web.mk src/include/fixsplat/fixsplat.h
	@mkdir -p $(@D) && echo "export * from '../fixsplat@$(VERSION)/$(@F)'" >$@
strip_js = sed -e 's/@FORMATS@/$(FORMATS)/' -e 's/^ *//' -e '/^\/\//d' -e '/^\/\*\*.*\*\/$$/d' -e '/^\/\*\*/,/\*\/$$/d' -e "s| *// [^'\"\`]*\$$||" -e '/^$$/d'
$(WEB)/%.js: port/web/%.js
	@mkdir -p $(@D)
	@$(strip_js) $< >$@
$(WEB)/viewer/%.js: port/web/viewer/%.js make/web.mk
	@mkdir -p $(@D)
	@$(strip_js) -e "s|^\(.*from \)'fixsplat'|\1'../fixsplat.js'|" -e "s|^\(.*from \)'fixsplat/|\1'../|" $< >$@
$(VIEWER)/page/%: $(WEB)/viewer/%
	@mkdir -p $(@D) && cp $< $@
$(VIEWER)/%.js: port/web/viewer/%.js
	@mkdir -p $(@D)
	@$(strip_js) $< >$@
$(VIEWER)/%: port/web/viewer/%
	@mkdir -p $(@D) && sed 's/@FORMATS@/$(FORMATS)/' $< >$@
$(WEB)/%: port/web/%
	@mkdir -p $(@D) && sed 's/@FORMATS@/$(FORMATS)/' $< >$@

# Builds the unit test of the kernels (vectorised inner loops) as a WASI program, which tests/web/wasi.mjs runs.
$(B)/web/test_kernels.wasm: $(patsubst %.c,$(B)/web/simd/%.o,$(wildcard src/core/*.c kernels/simd/wasm/*.c) kernels/kernels.c \
                                                            tests/test_kernels.c)
	$(call say,LD,$@)$(WASM_CC) --target=wasm32-wasi -Wl,-z,stack-size=1048576 -o $@ $^
