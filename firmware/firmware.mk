# Images for the boards: make firmware (all of them), flash and debug (BOARD=NAME).
#
# A board is a folder, firmware/boards/NAME, with a board.mk that says what it is:
#   BOARDS += NAME
#   CPU_NAME         its core: TOOLS_core and FLAGS_core, in a port's .mk (hal/port_cortex_m/cortex_m4f.mk)
#   PORTS_NAME       the folders of hal/ that it is made of
#   INTERRUPTS_NAME  its handlers (scripts/stack-depth)
#   LDFLAGS_NAME     of its own, if any
#   EXTRA_NAME       object files linked in besides, such as a program that runs before
#   SEAL_NAME        what is done with the linked image, if anything
#   FLASH_NAME, DEBUG_NAME   recipes, if it can be flashed
# Boards with one core share one set of object files: what walks on the emulator is what is flashed.
BOARDS :=
ARM_BUILD := $(BUILD)/arm
IMAGE = $(ARM_BUILD)/afo-$(subst _,-,$(1))
SETTINGS_BIN := $(ARM_BUILD)/settings.bin
include $(sort $(wildcard hal/port_*/*.mk)) $(sort $(wildcard firmware/boards/*/board.mk))
BOARD ?= nucleo_g474re

# Enumerations of 32 bits as on the host, so that snapshots mean the same on both.
IMAGE_CFLAGS := -std=c11 -g $(WARN) $(BITS) $(BUS_RATES) -fno-short-enums -ffunction-sections -fdata-sections -fno-common \
        $(if $(filter swo,$(TRACE)),-DTICK_TRACE) -fstack-usage -fcallgraph-info=su -DCO_WITHOUT_NAMES -DPARAMS_WITHOUT_TEXT -I.
IMAGE_LDFLAGS := -nostartfiles -Wl,--gc-sections -Wl,--no-enum-size-warning -Wl,--fatal-warnings -L.

# How much each room may take of the flash for its speed. What a tick runs through is worth some;
# what runs once a step, on request or at start-up is not. The measure is `make budgets`.
ROOMS_SMALL := model/% controller/laws/%
ROOMS_FAST := controller/estimator/% hal/bus/% hal/canopen/% hal/port_cortex_m/%
ROOMS_FASTEST := controller/% firmware/% hal/devices/% hal/storage/% hal/port_fdcan/%
IMAGE_OPT = $(if $(filter $(ROOMS_SMALL),$(1)),-Os,$(if $(filter $(ROOMS_FAST),$(1)),-O2,$(if $(filter $(ROOMS_FASTEST),$(1)),-O3,-Os)))

IMAGE_SRC := $(SRC_MODEL) $(SRC_CONTROLLER) $(filter-out hal/port_%,$(SRC_HAL)) $(SRC_FIRMWARE)
BOARD_SRC = $(IMAGE_SRC) $(wildcard $(PORTS_$(1):%=hal/%/*.c) firmware/boards/$(1)/*.c)
BOARD_OBJ = $(patsubst %.c,$(ARM_BUILD)/obj/$(CPU_$(1))/%.o,$(call BOARD_SRC,$(1)))
CPUS := $(sort $(foreach b,$(BOARDS),$(CPU_$(b))))

# A compiler cache would bring the objects back without their call graphs.
define CPU_RULES
$(ARM_BUILD)/stamp/$(1): FORCE
	$$(call STAMP,$$(shell $(TOOLS_$(1))gcc --version 2>&1 | head -1) $(FLAGS_$(1)) $$(IMAGE_CFLAGS) $$(IMAGE_LDFLAGS) $$(value IMAGE_OPT) $$(ROOMS_SMALL) : $$(ROOMS_FAST) : $$(ROOMS_FASTEST) $$(IMAGE_SRC))
$(ARM_BUILD)/obj/$(1)/firmware/version.o: private IMAGE_CFLAGS += $$(IDENTITY)
$(ARM_BUILD)/obj/$(1)/firmware/version.o: $$(BUILD)/stamp/identity
$(ARM_BUILD)/obj/$(1)/%.o: %.c $(ARM_BUILD)/stamp/$(1)
	@mkdir -p $$(@D)
	$$(call SAY,ARM    $$<)
	$$(Q)CCACHE_DISABLE=1 $(TOOLS_$(1))gcc $(FLAGS_$(1)) $$(IMAGE_CFLAGS) $$(call IMAGE_OPT,$$<) -MMD -MP -c $$< -o $$@
endef
$(foreach c,$(CPUS),$(eval $(call CPU_RULES,$(c))))

# A bit rate that does not carry the tick gives no image.
RATES_FIT := $(if $(BUS_RATES),$(Q)scripts/bus-budget --bitrate $(or $(BITRATE),1000000) --tick-us $(or $(TICK_US),1000) >$(ARM_BUILD)/bus-budget.txt || { tail -3 $(ARM_BUILD)/bus-budget.txt >&2; exit 1; })

define BOARD_RULES
$(call IMAGE,$(1)).elf: $(call BOARD_OBJ,$(1)) $(EXTRA_$(1)) firmware/boards/$(1)/link.ld firmware/boards/sections.ld $(if $(SEAL_$(1)),scripts/seal-image)
	$$(call SAY,LINK   $$@)
	$(RATES_FIT)
	$$(Q)$(TOOLS_$(CPU_$(1)))gcc $(FLAGS_$(CPU_$(1))) $$(IMAGE_LDFLAGS) $(LDFLAGS_$(1)) -T firmware/boards/$(1)/link.ld \
	        -Wl,-Map=$$(basename $$@).map $$(filter %.o,$$^) -o $$@
	$(if $(SEAL_$(1)),$$(Q)$(SEAL_$(1)) $$@)
$(call IMAGE,$(1)).bin: $(call IMAGE,$(1)).elf
	$$(Q)$(TOOLS_$(CPU_$(1)))objcopy -O binary $$< $$@
$(call IMAGE,$(1)).hex: $(call IMAGE,$(1)).elf
	$$(Q)$(TOOLS_$(CPU_$(1)))objcopy -O ihex $$< $$@
endef
$(foreach b,$(BOARDS),$(eval $(call BOARD_RULES,$(b))))
-include $(sort $(foreach b,$(BOARDS),$(patsubst %.o,%.d,$(call BOARD_OBJ,$(b)))))

ifeq ($(filter $(BOARD),$(BOARDS)),)
$(error no board "$(BOARD)"; there are: $(BOARDS))
endif
ELFS := $(foreach b,$(BOARDS),$(call IMAGE,$(b)).elf)
.PHONY: firmware flash debug budgets
firmware: $(ELFS) $(ELFS:.elf=.bin) $(ELFS:.elf=.hex) ## images for all boards: the NUCLEO-G474RE and the emulator
	$(Q)$(foreach b,$(BOARDS),$(TOOLS_$(CPU_$(b)))size $(call IMAGE,$(b)).elf;)

# With PERSON and DEVICE (.ini files) their settings go along, into the parameter memory: a device
# without any does not walk. SPEED is the apex speed to begin with.
flash: $(call IMAGE,$(BOARD)).elf $(call IMAGE,$(BOARD)).bin $(if $(PERSON)$(DEVICE),programs) ## write the image (PERSON=FILE DEVICE=FILE: and settings) to a NUCLEO-G474RE (openocd, else st-flash)
	$(Q)$(if $(PERSON)$(DEVICE),$(BUILD)/afo settings $(if $(PERSON),--person '$(PERSON)') $(if $(DEVICE),--device '$(DEVICE)') $(if $(SPEED),--speed $(SPEED)) $(SETTINGS_BIN))
	$(or $(FLASH_$(BOARD)),$(Q)echo 'flash: $(BOARD) cannot be flashed; BOARD is one of: $(foreach b,$(BOARDS),$(if $(value FLASH_$(b)),$(b)))' >&2; exit 1)

debug: $(call IMAGE,$(BOARD)).elf ## gdb on a NUCLEO-G474RE; watchdog and clock stand still while it is halted
	$(or $(DEBUG_$(BOARD)),$(Q)echo 'debug: $(BOARD) has no debugger; BOARD is one of: $(foreach b,$(BOARDS),$(if $(value DEBUG_$(b)),$(b)))' >&2; exit 1)

# The second build shares nothing with the first but sources and compiler.
.PHONY: release
release: firmware ## images, hashes and bill of materials in one folder, built twice with the same bytes
	$(Q)rm -rf $(BUILD)/again
	$(Q)$(MAKE) --no-print-directory BUILD=$(BUILD)/again firmware >/dev/null
	$(Q)scripts/release --build $(BUILD) --version '$(VERSION)' --build-id $(BUILD_ID) --again $(BUILD)/again

TEST_NEEDS += firmware

budgets: firmware programs ## what the image takes of flash, RAM, stack and instructions
	$(Q)scripts/budgets $(BUILD)
