# Builds programs for microcontroller boards (docs/boards.md).

# For each board: compiler options, memory map and source files. BOARD_HZ is the processor's clock in Hz.
memory = $(foreach pair,$(1),-Wl,--defsym=$(pair))
in_flash := -T port/board/cortexm/firmware.ld
cpu_of_mps2-an385 := -mthumb -mcpu=cortex-m3 -DBOARD_HZ=25000000
cpu_of_mps2-an500 := -mthumb -mcpu=cortex-m7 -DBOARD_HZ=25000000
cpu_of_mps3-an547 := -mthumb -mcpu=cortex-m55 -mfloat-abi=hard -DBOARD_HZ=32000000
cpu_of_vexpress-a9 := -marm -mcpu=cortex-a9 -mno-unaligned-access
of_mps2 = $(in_flash) $(call memory,FLASH=0 FLASH_BYTES=4M SCENE_AT=$(1) SCENE_BYTES=16M RAM=0x20000000 RAM_BYTES=4M)
link_of_mps2-an385 := $(call of_mps2,0x21000000)
link_of_mps2-an500 := $(call of_mps2,0x60000000)
link_of_mps3-an547 := $(in_flash) $(call memory,FLASH=0 FLASH_BYTES=512K SCENE_AT=0x60000000 SCENE_BYTES=16M \
                                                RAM=0x21000000 RAM_BYTES=4M)
link_of_vexpress-a9 := -T port/board/vexpress/screen.ld
own_of_vexpress-a9 := port/board/vexpress/screen.c port/board/vexpress/start.S port/board/cortexm/console.c port/board/cortexm/scene.S
own_of_cortexm := $(wildcard port/board/cortexm/*.[cS])
kernels_of_mps2-an385 := kernels/kernels.c $(wildcard kernels/simd/cortexm/*_cortexm.c)
kernels_of_mps2-an500 := $(kernels_of_mps2-an385)
kernels_of_mps3-an547 := kernels/kernels.c $(wildcard kernels/simd/cortexm/*_mve.c)
BOARDS := mps2-an385 mps2-an500 mps3-an547 vexpress-a9
FIRMWARE := $(BOARDS:%=$(B)/firmware/%.elf)
FIRMWARE_SCENE ?= $(B)/firmware/knot.fxs
ARM_CC ?= arm-none-eabi-gcc
ARM_CFLAGS ?= -O2 -g
ARM_FLAGS = -std=gnu99 $(INCLUDES) -Wall -Wextra -Wpedantic -Wshadow -Wconversion -ffreestanding -fbuiltin \
            -ffunction-sections -fdata-sections -fwrapv -DFXS_SMALL_STACK $(ARM_CFLAGS) -DSCENE='"$(FIRMWARE_SCENE)"'

firmware: $(FIRMWARE) ## for boards (docs/boards.md): FIRMWARE_SCENE=x.fxs turns on a display, rendered from flash

$(B)/firmware/knot.fxs: $(B)/fixsplat
	@mkdir -p $(@D)
	$(B)/fixsplat make-scene knot --count 20000 -o $(@:.fxs=.ply)
	$(B)/fixsplat convert $(@:.fxs=.ply) $@

# Compiler flags of hot code on the boards. Without its instruction scheduler, GCC 12 does not spill vector registers.
# With a frame pointer, its code addresses memory faster.
arm_flags_of = $(if $(filter -O2,$(ARM_CFLAGS)),$(if $(filter src/core/project.c src/core/shade.c %project_mve.c,$(1)),-O3)) \
               $(if $(findstring _mve,$(1)),-fno-schedule-insns -fno-omit-frame-pointer)
objects_of = $(addprefix $(B)/firmware/$(1)/,$(addsuffix .o,$(basename $(2))))

define firmware_rules
$(B)/firmware/$(1)/%.o: %.c $(B)/commands/firmware
	@mkdir -p $$(@D)
	$$(call say,CC,'$$< ($(1))')$(ARM_CC) $(cpu_of_$(1)) $(if $(kernels_of_$(1)),-DFXS_WITH_KERNELS) $$(ARM_FLAGS) \
	    $$(call arm_flags_of,$$<) $$(TEST_FLAGS) -MMD -MP -c -o $$@ $$<
$(B)/firmware/$(1)/%.o: %.S $(B)/commands/firmware
	@mkdir -p $$(@D)
	$$(call say,AS,'$$< ($(1))')$(ARM_CC) $(cpu_of_$(1)) $$(ARM_FLAGS) -c -o $$@ $$<
$(B)/firmware/$(1)/port/board/cortexm/scene.o: $(FIRMWARE_SCENE) $(B)/commands/firmware-scene
$(B)/firmware/$(1).elf: $(call objects_of,$(1),$(wildcard src/core/*.c port/board/*.c) $(kernels_of_$(1)) \
                                               $(or $(own_of_$(1)),$(own_of_cortexm))) $(filter %.ld,$(link_of_$(1)))
	$$(call say,LD,$$@)$(ARM_CC) $(cpu_of_$(1)) -nostartfiles --specs=nano.specs -Wl,--gc-sections $(link_of_$(1)) \
	    -Wl,-Map=$$(@:.elf=.map) -o $$@ $$(filter %.o,$$^)

# Builds the unit test of the kernels (vectorised inner loops) as a program for the board. It has fewer cases there,
# because emulators are slow.
$(B)/firmware/$(1)/tests/test_kernels.o: TEST_FLAGS := -Dmain=test_main -DCASES=200
$(B)/firmware/$(1)/test_kernels.elf: $(call objects_of,$(1),$(wildcard src/core/*.c) $(kernels_of_$(1)) tests/test_kernels.c \
                                       tests/on_board.c port/board/cortexm/start.c port/board/cortexm/console.c)
	$$(call say,LD,$$@)$(ARM_CC) $(cpu_of_$(1)) -nostartfiles -Wl,--gc-sections $(link_of_$(1)) \
	    $(call memory,STACK_BYTES=128K) -o $$@ $$(filter %.o,$$^) -lm
endef
$(foreach board,$(BOARDS),$(eval $(call firmware_rules,$(board))))
$(B)/commands/firmware: COMMAND = $(ARM_CC) $(ARM_CFLAGS) $(foreach board,$(BOARDS),$(cpu_of_$(board)) $(link_of_$(board)))
$(B)/commands/firmware-scene: COMMAND := $(ARM_CC) $(FIRMWARE_SCENE)
