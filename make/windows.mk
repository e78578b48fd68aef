# The command and the libraries for Windows, by Debian's mingw-w64 (docs/windows.md), as those for here are made.

WINDOWS_CC ?= x86_64-w64-mingw32-gcc
WINDOWS_GOALS ?= all
WINDOWS := $(B)/windows

windows: ## the command and the libraries for Windows, x86-64, in build/windows (after make setup windows)
	@command -v $(WINDOWS_CC) >/dev/null || { echo "windows: no $(WINDOWS_CC): make setup windows" >&2; exit 1; }
	@$(MAKE) --no-print-directory $(WINDOWS_GOALS) B=$(WINDOWS) CC='$(WINDOWS_CC)' NVCC=none \
	    CPPFLAGS='-I$(WINDOWS_LIBRARIES)/include -DXML_STATIC $(CPPFLAGS)' \
	    LDFLAGS='-L$(WINDOWS_LIBRARIES)/lib -static -s $(LDFLAGS)'
