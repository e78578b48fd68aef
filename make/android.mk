# Builds the package for Android (docs/android.md). tools/scripts/aar.sh calls make again, with the NDK's compiler and a
# build folder of its own, for the library.

aar: ## dist/*.aar: the package for Android, by the NDK in ANDROID_NDK_HOME, and android.jar of ANDROID_HOME if it is there
	@ZIP_TIME=$(or $(SOURCE_DATE_EPOCH),315532800) sh tools/scripts/aar.sh $(B)/android dist/fixsplat-$(VERSION).aar
.PHONY: aar

# -lpthread is left out, since Android has threads in libc.
$(B)/jni/libfixsplat.so: $(call objects,$(CORE) $(DEVICES) $(LIBRARY) $(wildcard port/android/*.c)) \
                         tools/package/libfixsplat.map $(B)/commands/link
	@mkdir -p $(@D)
	$(call say,LD,$@)$(CC) $(FLAGS) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,-z,defs -Wl,-z,max-page-size=16384 -Wl,-s \
	    -Wl,--version-script=tools/package/libfixsplat.map -o $@ $(filter %.o,$^) \
	    $(foreach name,$(LINKED),$(LIBS_$(name))) -lm
