# Makes packages for installation (docs/install.md).

DIST := dist
$(call needs,$(DIST_GOALS),git cc cmake nasm zip npm esbuild clang wasm-ld wasm-opt dpkg-buildpackage dh dh_python3 \
    $(if $(filter aarch64,$(shell uname -m)),,aarch64-linux-gnu-gcc))

dist: ## dist/: all of it, and SHA256SUMS, from the last commit
	@NVCC=$(call quoted,$(NVCC)) PYTHON=$(call quoted,$(PYTHON)) WEB_SOURCES=$(call quoted,$(WEB_SOURCES)) \
	    sh tools/scripts/dist.sh $(DIST) $(B)/dist

dist-check: dist ## the same a second time in another folder, and that both are the same bytes
	@NVCC=$(call quoted,$(NVCC)) PYTHON=$(call quoted,$(PYTHON)) WEB_SOURCES=$(call quoted,$(WEB_SOURCES)) \
	    sh tools/scripts/dist.sh $(B)/dist-again/dist $(B)/dist-again/build
	@cd $(B)/dist-again/dist && sha256sum -c $(abspath $(DIST))/SHA256SUMS
.PHONY: dist dist-check
