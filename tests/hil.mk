# The walk over a real CAN stack (scripts/vcan-guest).
.PHONY: hil
hil: ## walk 200 steps over vcan, controller and walker as two processes; compare every tick with the in-process bus
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/hil --steps 200 --build $(BUILD)
