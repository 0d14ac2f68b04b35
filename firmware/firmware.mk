# Images for the boards: make firmware (both), flash and debug (NUCLEO-G474RE).
# One set of object files for both boards: what walks on the emulator is what is flashed.
ARM := arm-none-eabi-
# A compiler cache would bring the objects back without their call graphs.
ARM_CC := CCACHE_DISABLE=1 $(ARM)gcc
ARM_BUILD = $(BUILD)/arm
ARM_CPU := -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16
# Enumerations of 32 bits as on the host, so that snapshots mean the same on both.
ARM_CFLAGS := $(ARM_CPU) -std=c11 -g $(WARN) $(BITS) -fno-short-enums -ffunction-sections \
        -fdata-sections -fno-common -fstack-usage -fcallgraph-info=su -DCO_WITHOUT_NAMES -DPARAMS_WITHOUT_TEXT -I.
ARM_LDFLAGS := $(ARM_CPU) -nostartfiles -Wl,--gc-sections -Wl,--no-enum-size-warning -Wl,--fatal-warnings -L.

ARM_SRC := $(SRC_MODEL) $(SRC_CONTROLLER) $(filter-out hal/port_%,$(SRC_HAL)) $(SRC_FIRMWARE) \
        $(wildcard hal/port_cortex_m/*.c)
ARM_SRC_nucleo_g474re := $(wildcard hal/port_stm32g474/*.c hal/port_fdcan/*.c firmware/boards/nucleo_g474re/*.c)
ARM_SRC_mps2_an386 := $(wildcard hal/port_mps2/*.c firmware/boards/mps2_an386/*.c)
ARM_BOARDS := nucleo_g474re mps2_an386
ARM_OBJ = $(patsubst %.c,$(ARM_BUILD)/obj/%.o,$(1))
ARM_ALL := $(call ARM_OBJ,$(ARM_SRC) $(foreach b,$(ARM_BOARDS),$(ARM_SRC_$(b))))

$(ARM_BUILD)/stamp/flags: FORCE
	$(call STAMP,$(shell $(ARM)gcc --version 2>&1 | head -1) $(ARM_CC) $(ARM_CFLAGS) $(value ARM_OPT) $(ARM_WARM) $(ARM_HOT) $(ARM_LDFLAGS) $(ARM_SRC))
$(ARM_BUILD)/obj/firmware/version.o: private ARM_CFLAGS += $(IDENTITY)
$(ARM_BUILD)/obj/firmware/version.o: $(BUILD)/stamp/identity
# What runs in every tick is worth some flash; what runs at start-up, on request or at
# standstill is not; between them, what runs once a step or gains little by more.
ARM_COLD := controller/laws/% controller/control_params% controller/estimator/observer_gains% \
        controller/estimator/person_events% controller/screening/zeroing% model/stride% model/walker% \
        model/ground%
ARM_WARM := hal/storage/crc.c firmware/snapshot.c firmware/bus_recorder.c controller/estimator/apex_fusion.c controller/estimator/apex_fit.c controller/estimator/model_observer.c model/integrator% \
        model/timed_stride.c
ARM_HOT := $(filter-out $(ARM_COLD),$(SRC_MODEL) $(SRC_CONTROLLER)) controller/laws/step_plan.c firmware/control_task.c \
        firmware/bus_recorder.c firmware/snapshot.c hal/storage/black_box.c hal/devices/leg_sensors.c \
        hal/devices/sea_drive_cia402.c hal/port_mps2/pil_bus.c hal/port_cortex_m/memory.c
ARM_OPT = $(if $(filter $(ARM_WARM),$<),-O2,$(if $(filter $(ARM_HOT),$<),-O3,-Os))
$(ARM_BUILD)/obj/%.o: %.c $(ARM_BUILD)/stamp/flags
	@mkdir -p $(@D)
	$(call SAY,ARM    $<)
	$(Q)$(ARM_CC) $(ARM_CFLAGS) $(ARM_OPT) -MMD -MP -c $< -o $@

ARM_LDFLAGS_mps2_an386 := -Wl,--wrap=supervisor_update_f32
define BOARD_RULE
$(ARM_BUILD)/afo-$(subst _,-,$(1)).elf: $(call ARM_OBJ,$(ARM_SRC) $(ARM_SRC_$(1))) \
                firmware/boards/$(1)/link.ld firmware/boards/sections.ld
	$$(call SAY,LINK   $$@)
	$$(Q)$(ARM)gcc $$(ARM_LDFLAGS) $(ARM_LDFLAGS_$(1)) -T firmware/boards/$(1)/link.ld -Wl,-Map=$$(basename $$@).map \
	        $$(filter %.o,$$^) -o $$@
endef
$(foreach b,$(ARM_BOARDS),$(eval $(call BOARD_RULE,$(b))))
$(ARM_BUILD)/%.bin: $(ARM_BUILD)/%.elf
	$(Q)$(ARM)objcopy -O binary $< $@
$(ARM_BUILD)/%.hex: $(ARM_BUILD)/%.elf
	$(Q)$(ARM)objcopy -O ihex $< $@
-include $(ARM_ALL:.o=.d)

NUCLEO := $(ARM_BUILD)/afo-nucleo-g474re
MPS2 := $(ARM_BUILD)/afo-mps2-an386

.PHONY: firmware flash debug
firmware: $(NUCLEO).elf $(NUCLEO).bin $(NUCLEO).hex $(MPS2).elf ## images for the NUCLEO-G474RE and the emulator
	$(Q)$(ARM)size $(NUCLEO).elf $(MPS2).elf

OPENOCD ?= openocd
OPENOCD_BOARD := -f interface/stlink.cfg -f target/stm32g4x.cfg
# With SUBJECT (an .ini file) its settings go along, into the parameter memory: a device
# without any does not walk. SPEED is the apex speed to begin with.
SETTINGS_AT := 0x0807E000
SETTINGS_BIN := $(ARM_BUILD)/settings.bin
flash: $(NUCLEO).elf $(NUCLEO).bin $(if $(SUBJECT),programs) ## write the image (SUBJECT=FILE: and settings) to a NUCLEO-G474RE (openocd, else st-flash)
	$(Q)$(if $(SUBJECT),$(BUILD)/afo-settings --subject '$(SUBJECT)' $(if $(SPEED),--speed $(SPEED)) $(SETTINGS_BIN))
	$(Q)if command -v $(OPENOCD) >/dev/null; then \
	        $(OPENOCD) $(OPENOCD_BOARD) \
	                $(if $(SUBJECT),-c 'program $(SETTINGS_BIN) $(SETTINGS_AT) verify') \
	                -c 'program $< verify reset exit' || \
	        { echo 'flash: not written; is the board plugged in at its ST-Link?' >&2; exit 1; }; \
	elif command -v st-flash >/dev/null; then \
	        $(if $(SUBJECT),st-flash write $(SETTINGS_BIN) $(SETTINGS_AT) &&) \
	        st-flash --reset write $(NUCLEO).bin 0x08000000; \
	else echo 'flash: neither openocd nor st-flash is here (scripts/setup flash)' >&2; exit 1; fi

# DBGMCU_APB1FZR1, bits DBG_IWDG_STOP and DBG_TIM2_STOP (CMSIS stm32g474xx.h; stm32-data
# dbgmcu_g4.yaml): neither the watchdog nor the clock, whose compare a halt would leave
# behind, goes on while it is halted.
DEBUG_FREEZE := set {unsigned}0xE0042008 = 0x1001
debug: $(NUCLEO).elf ## gdb on a NUCLEO-G474RE; watchdog and clock stand still while it is halted
	$(Q)for tool in gdb-multiarch $(OPENOCD); do command -v $$tool >/dev/null || \
	        { echo "debug: $$tool is not here (scripts/setup flash)" >&2; exit 1; }; done
	$(Q)gdb-multiarch $< -ex 'target extended-remote | $(OPENOCD) $(OPENOCD_BOARD) \
	        -c "gdb_port pipe; log_output /dev/null"' -ex 'monitor reset halt' \
	        -ex '$(DEBUG_FREEZE)'

TEST_NEEDS += firmware

.PHONY: pil
pil: firmware programs ## 200 steps with the flashed object code on an emulated Cortex-M4F, frame by frame like the host's
	$(Q)$(BUILD)/afo-pil --steps 200 --speed 0.8 --image $(MPS2).elf

.PHONY: budgets
budgets: firmware programs ## what the image takes of flash, RAM, stack and instructions
	$(Q)scripts/budgets $(BUILD)
