# Builds the command and the libraries for Windows with Debian's mingw-w64 (docs/install.md).

WINDOWS_CC ?= x86_64-w64-mingw32-gcc
WINDOWS_GOALS ?= all
WINDOWS := $(B)/windows
$(call needs,windows,$(lastword $(WINDOWS_CC)))
# Linker options for SDL2 and the Windows libraries that SDL2 needs. Without -lmingw32 and -mwindows, the program is a
# console program.
SDL_PC = $(wildcard $(WINDOWS_LIBRARIES)/lib/pkgconfig/sdl2.pc)
WINDOWS_SDL = $(filter-out -L% -lmingw32 -mwindows,$(if $(SDL_PC),$(shell sed -n 's/^Libs: *//p' $(SDL_PC))))

windows: ## the command and the libraries for Windows, x86-64, in build/windows (after make setup windows)
	@$(MAKE) --no-print-directory $(WINDOWS_GOALS) B=$(WINDOWS) CC='$(WINDOWS_CC)' NVCC=none \
	    CPPFLAGS='-I$(WINDOWS_LIBRARIES)/include -DXML_STATIC -DSDL_MAIN_HANDLED $(CPPFLAGS)' \
	    WINDRES='$(patsubst %-gcc,%-windres,$(lastword $(WINDOWS_CC)))' \
	    LIBS_SDL='$(WINDOWS_SDL)' LIBS_TTF='-lSDL2_ttf -lfreetype' \
	    LDFLAGS='-L$(WINDOWS_LIBRARIES)/lib -static -s $(LDFLAGS)'

ifneq ($(and $(filter win32,$(SYSTEM)),$(shell command -v rsvg-convert)),)
$(B)/fixsplat-view$(EXE): $(B)/icon.o
endif
$(B)/icon.o: tools/package/fixsplat.svg tools/scripts/icon.sh
	$(call say,ICON,$<)sh tools/scripts/icon.sh $< $(@:.o=.ico) && echo '1 ICON "$(@:.o=.ico)"' | $(WINDRES) -O coff -o $@
