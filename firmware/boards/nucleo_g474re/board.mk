# NUCLEO-G474RE: STM32G474RE, FDCAN1, programmed by the ST-Link on it.
BOARDS += nucleo_g474re
CPU_nucleo_g474re := cortex_m4f
PORTS_nucleo_g474re := port_cortex_m port_fdcan port_stm32g474
INTERRUPTS_nucleo_g474re := tim2_handler fdcan1_handler pvd_handler

# What runs first: a program of its own, with object files of its own, in the first pages of flash.
STARTER := $(ARM_BUILD)/starter/starter
STARTER_SRC := $(addprefix firmware/boards/nucleo_g474re/starter/,starter.c) hal/storage/crc.c hal/storage/program_image.c \
        hal/storage/program_slots.c hal/port_stm32g474/flash_store.c hal/port_stm32g474/option_bytes.c hal/port_stm32g474/signs.c
STARTER_OBJ := $(STARTER_SRC:%.c=$(ARM_BUILD)/starter/%.o)
STARTER_FLAGS := -mcpu=cortex-m4 -mthumb -O2 -std=c11 $(WARN) -fno-short-enums -ffunction-sections -fdata-sections -fno-common -I.
$(ARM_BUILD)/starter/%.o: %.c firmware/boards/nucleo_g474re/board.mk
	@mkdir -p $(@D)
	$(call SAY,ARM    $<)
	$(Q)CCACHE_DISABLE=1 arm-none-eabi-gcc $(STARTER_FLAGS) -MMD -MP -c $< -o $@
$(STARTER).elf: $(STARTER_OBJ) firmware/boards/nucleo_g474re/starter/starter.ld
	$(call SAY,LINK   $@)
	$(Q)arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -nostartfiles -Wl,--gc-sections -Wl,--no-enum-size-warning -Wl,--fatal-warnings \
	        -T firmware/boards/nucleo_g474re/starter/starter.ld -Wl,-Map=$(STARTER).map $(STARTER_OBJ) -o $@
$(STARTER).o: $(STARTER).elf
	$(Q)arm-none-eabi-objcopy -O binary --pad-to 0x08002000 --gap-fill 0xFF $< $(STARTER).bin
	$(Q)arm-none-eabi-ld -r -b binary $(STARTER).bin -o $@
	$(Q)arm-none-eabi-objcopy --rename-section .data=.starter,alloc,load,readonly,data,contents $@
-include $(STARTER_OBJ:.o=.d)
EXTRA_nucleo_g474re := $(STARTER).o
SEAL_nucleo_g474re := scripts/seal-image --version '$(VERSION)' --build-id $(BUILD_ID)

OPENOCD ?= openocd
OPENOCD_nucleo_g474re := -f firmware/boards/nucleo_g474re/openocd.cfg
SETTINGS_AT_nucleo_g474re := 0x0807E000
define FLASH_nucleo_g474re
$(Q)if command -v $(OPENOCD) >/dev/null; then \
        $(OPENOCD) $(OPENOCD_nucleo_g474re) \
                $(if $(PERSON)$(DEVICE),-c 'program $(SETTINGS_BIN) $(SETTINGS_AT_nucleo_g474re) verify') \
                -c 'program $(call IMAGE,nucleo_g474re).elf verify reset exit' || \
        { echo 'flash: not written; is the board plugged in at its ST-Link?' >&2; exit 1; }; \
elif command -v st-flash >/dev/null; then \
        $(if $(PERSON)$(DEVICE),st-flash write $(SETTINGS_BIN) $(SETTINGS_AT_nucleo_g474re) &&) \
        st-flash --reset write $(call IMAGE,nucleo_g474re).bin 0x08000000; \
else echo 'flash: neither openocd nor st-flash is here (scripts/setup flash)' >&2; exit 1; fi
endef

# DBGMCU_APB1FZR1, bits DBG_IWDG_STOP and DBG_TIM2_STOP (CMSIS stm32g474xx.h; stm32-data
# dbgmcu_g4.yaml): neither the watchdog nor the clock, whose compare a halt would leave
# behind, goes on while it is halted.
FREEZE_nucleo_g474re := set {unsigned}0xE0042008 = 0x1001
define DEBUG_nucleo_g474re
$(Q)for tool in gdb-multiarch $(OPENOCD); do command -v $$tool >/dev/null || \
        { echo "debug: $$tool is not here (scripts/setup flash)" >&2; exit 1; }; done
$(Q)gdb-multiarch $(call IMAGE,nucleo_g474re).elf -ex 'target extended-remote | $(OPENOCD) $(OPENOCD_nucleo_g474re) \
        -c "gdb_port pipe; log_output /dev/null"' -ex 'monitor reset halt' \
        -ex '$(FREEZE_nucleo_g474re)'
endef

.PHONY: g474
g474: firmware programs ## the very image that is flashed, in an emulated STM32G474: a walk, its replay, faults, broken drivers (4 min)
	$(Q)scripts/setup test
	$(Q)scripts/chip-in-the-loop --build $(BUILD)
