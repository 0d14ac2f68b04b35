# The drivers of the STM32G474 on the host, under models of their peripherals.
HOSTED_STM32 := $(call OBJ_F32,$(wildcard hal/port_stm32g474/*.c) \
        $(filter-out tests/hal/port_stm32g474/test_%,$(wildcard tests/hal/port_stm32g474/*.c)))
$(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/hal/port_stm32g474/test_*.c)): $(HOSTED_STM32)
-include $(HOSTED_STM32:.o=.d)
