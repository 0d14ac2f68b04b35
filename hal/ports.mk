# The drivers of the STM32G474 on the host, under models of their peripherals.
HOSTED_STM32_DIRS := hal/port_stm32g474 hal/port_fdcan hal/port_cortex_m
HOSTED_STM32 := $(call OBJ_F32,$(wildcard hal/port_stm32g474/*.c hal/port_fdcan/*.c) \
        $(foreach d,$(HOSTED_STM32_DIRS),$(filter-out tests/$(d)/test_%,$(wildcard tests/$(d)/*.c))))
$(patsubst tests/%.c,$(BUILD)/tests/%,$(foreach d,$(HOSTED_STM32_DIRS),$(wildcard tests/$(d)/test_*.c))): $(HOSTED_STM32)
-include $(HOSTED_STM32:.o=.d)
