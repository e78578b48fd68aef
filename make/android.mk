# Builds the package for Android (docs/android.md). tools/scripts/aar.sh calls make again, with the NDK's compiler and a
# build folder of its own, for the library.

AAR ?= dist/fixsplat-$(VERSION).aar

aar: ## dist/*.aar: the package for Android, by the NDK in ANDROID_NDK_HOME, and android.jar of ANDROID_HOME if it is there
	@ZIP_TIME=$(or $(SOURCE_DATE_EPOCH),315532800) sh tools/scripts/aar.sh $(B)/android $(AAR)
.PHONY: aar

# Host code that few frames wait for is compiled for size.
ifneq ($(filter %/jni/libfixsplat.so,$(GOALS)),)
KINDS += SMALL
FILES_SMALL := src/scene/% src/camera/% src/image/% src/base/% port/% kernels/gl/% kernels/gles/% kernels/compute/% \
               kernels/vulkan/%
FLAGS_SMALL := -Os
endif

# The package has no fits and meshes, nor the declarations for Python. Android has threads in libc, so -lpthread is left out.
NOT_ON_ANDROID := src/fit/% src/surface/% kernels/fit/% port/backend/fit_engines.c $(B)/declarations.c
ON_ANDROID := $(filter-out $(NOT_ON_ANDROID),$(CORE) $(DEVICES) $(LIBRARY)) $(wildcard port/android/*.c)
$(B)/jni/libfixsplat.so: $(call objects,$(ON_ANDROID)) tools/package/libfixsplat.map $(B)/commands/link
	@mkdir -p $(@D)
	$(call say,LD,$@)$(CC) $(FLAGS) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,-z,defs -Wl,-z,max-page-size=16384 -Wl,-s \
	    -Wl,--version-script=tools/package/libfixsplat.map -o $@ $(filter %.o,$^) \
	    $(foreach name,$(LINKED),$(LIBS_$(name))) -lm
