# NUCLEO-G474RE: STM32G474RE, FDCAN1, programmed by the ST-Link on it.
BOARDS += nucleo_g474re
CPU_nucleo_g474re := cortex_m4f
PORTS_nucleo_g474re := port_cortex_m port_fdcan port_stm32g474
INTERRUPTS_nucleo_g474re := tim2_handler fdcan1_handler

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
        echo 'flash: st-flash loads its helper over the black box, whose record is lost' >&2; \
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
g474: firmware programs ## the very image that is flashed, in an emulated STM32G474: a walk, its replay, faults, broken drivers (10 min)
	$(Q)scripts/setup test
	$(Q)scripts/chip-in-the-loop --build $(BUILD)
