# Rules of `make install`.

SONAME_LINKS := $(SONAME) libfixsplat.so
PAGE := $(PREFIX)/share/fixsplat/web
PAGE_FILES := $(PACKAGE:$(WEB)/%=%)
PAGE_FOLDERS := $(sort $(patsubst %/,%,$(dir $(PAGE_FILES))))
HAS_PAGE := $(if $(filter-out $(wildcard $(WASM)),$(WASM)),,yes)
PC_FILES := fixsplat.pc fixsplat-core.pc
CMAKE_FILES := fixsplat-config.cmake fixsplat-config-version.cmake
ICONS := $(PREFIX)/share/icons/hicolor/scalable/apps
APPLICATIONS := $(PREFIX)/share/applications
MIME := $(PREFIX)/share/mime/packages
INCLUDE := $(PREFIX)/include/fixsplat
CMAKE := $(LIBDIR)/cmake/fixsplat
fill = sed -e 's|@PREFIX@|$(PREFIX)|g' -e 's|@LIBDIR@|$(LIBDIR)|g' -e 's|@SONAME_VERSION@|$(MAJOR)|g' \
           -e 's|@VERSION@|$(VERSION)|g' -e 's|@LIBS@|$(LIBS)|g' tools/package/$$f.in >$(DESTDIR)$(1)/$$f && \
       chmod 644 $(DESTDIR)$(1)/$$f || exit 1

# Generates man pages and shell completions from the program's help, if the program can run on this machine.
$(B)/share/made: $(B)/fixsplat tools/scripts/man.sh tools/scripts/completions.sh
	@rm -rf $(@D) && mkdir -p $(@D)
	$(call say,MAN,$(@D))if $(B)/fixsplat --version >/dev/null 2>&1; then \
	    sh tools/scripts/man.sh $(B)/fixsplat $(@D)/man/man1 && sh tools/scripts/completions.sh $(B)/fixsplat $(@D); fi
	@touch $@

install: all $(B)/share/made $(if $(HAS_PAGE),web) ## install command, libraries, headers, the page where it is built: DESTDIR, PREFIX (/usr/local)
	install -d $(addprefix $(DESTDIR),$(PREFIX)/bin $(LIBDIR)/pkgconfig $(CMAKE) $(INCLUDE)/internal)
	install $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin/
	install -m 644 $(ARCHIVES) $(SHARED_LIBRARY) $(DESTDIR)$(LIBDIR)/
	$(if $(SHARED),for f in $(SONAME_LINKS); do ln -sf libfixsplat.so.$(VERSION) $(DESTDIR)$(LIBDIR)/$$f || exit 1; done)
	install -m 644 $(PUBLIC_HEADERS) $(DESTDIR)$(INCLUDE)/
	install -m 644 $(INTERNAL_HEADERS) $(DESTDIR)$(INCLUDE)/internal/
	@for f in $(PC_FILES); do $(call fill,$(LIBDIR)/pkgconfig); done
	@for f in $(CMAKE_FILES); do $(call fill,$(CMAKE)); done
	$(if $(WINDOW),install -d $(DESTDIR)$(ICONS) $(DESTDIR)$(APPLICATIONS) $(DESTDIR)$(MIME))
	$(if $(WINDOW),install -m 644 tools/package/fixsplat.svg $(DESTDIR)$(ICONS)/)
	$(if $(WINDOW),install -m 644 tools/package/fixsplat-view.desktop $(DESTDIR)$(APPLICATIONS)/)
	$(if $(WINDOW),install -m 644 tools/package/fixsplat.xml $(DESTDIR)$(MIME)/)
	for f in $$(cd $(B)/share && find * -type f ! -name made); do \
	    install -D -m 644 $(B)/share/$$f $(DESTDIR)$(PREFIX)/share/$$f || exit 1; done
	$(if $(HAS_PAGE),install -d $(addprefix $(DESTDIR)$(PAGE)/,$(PAGE_FOLDERS)))
	$(if $(HAS_PAGE),for f in $(PAGE_FILES); do install -m 644 $(WEB)/$$f $(DESTDIR)$(PAGE)/$$f || exit 1; done)

# Builds the wheel in a copy of the sources, so that the source folder stays clean.
wheel: $(SHARED_LIBRARY) ## build/wheel/*.whl: the Python package with the library, for pip install; PYTHON (python3)
	@rm -rf $(B)/wheel && mkdir -p $(B)/wheel/source
	@cp -r port/python/pyproject.toml port/python/setup.py port/python/fixsplat $(B)/wheel/source
	$(call say,WHEEL,$(B)/wheel)FIXSPLAT_LIBRARY=$(abspath $(SHARED_LIBRARY)) $(PYTHON) -m pip wheel --quiet --no-deps \
	    --no-build-isolation --disable-pip-version-check --wheel-dir $(B)/wheel $(B)/wheel/source

uninstall: ## remove what install put there
	rm -f $(addprefix $(DESTDIR)$(PREFIX)/bin/,fixsplat fixsplat-view fixsplat-web) \
	    $(DESTDIR)$(ICONS)/fixsplat.svg $(DESTDIR)$(APPLICATIONS)/fixsplat-view.desktop $(DESTDIR)$(MIME)/fixsplat.xml \
	    $(addprefix $(DESTDIR)$(PREFIX)/share/,man/man1/fixsplat.1 man/man1/fixsplat-*.1 zsh/site-functions/_fixsplat \
	        bash-completion/completions/fixsplat fish/vendor_completions.d/fixsplat.fish) \
	    $(addprefix $(DESTDIR)$(PAGE)/,$(PAGE_FILES)) \
	    $(addprefix $(DESTDIR)$(LIBDIR)/,libfixsplat-core.a libfixsplat.a libfixsplat.so.$(VERSION) $(SONAME_LINKS)) \
	    $(addprefix $(DESTDIR)$(LIBDIR)/pkgconfig/,$(PC_FILES)) $(addprefix $(DESTDIR)$(CMAKE)/,$(CMAKE_FILES)) \
	    $(HEADERS:src/include/fixsplat/%=$(DESTDIR)$(INCLUDE)/%)
	for f in $(DESTDIR)$(CMAKE) $(DESTDIR)$(INCLUDE)/internal $(DESTDIR)$(INCLUDE) \
	    $(addprefix $(DESTDIR),$(addprefix $(PAGE)/,$(shell printf '%s\n' $(filter-out .,$(PAGE_FOLDERS)) | sort -r)) $(PAGE) $(PREFIX)/share/fixsplat); do \
	    [ ! -d $$f ] || rmdir $$f || exit 1; done

headers: ## list the public headers
	@printf '%s\n' $(HEADERS)

core-headers: ## list those that libfixsplat-core.a comes with
	@printf '%s\n' $(CORE_HEADERS)
