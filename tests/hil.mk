# The walk over a real CAN stack (scripts/vcan-guest).
.PHONY: hil hil-long restarts
hil: ## walk 200 steps over vcan, controller and walker as two processes; compare every tick with the in-process bus (some minutes)
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/hil --steps 200 --build $(BUILD)

hil-long: ## the same for 1,000 steps: no tick lost, every frame equal (some ten minutes)
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/hil --steps 1000 --build $(BUILD) --out $(BUILD)/hil-long

RESTARTS ?= 10
restarts: ## kill and restart controller and walker in turn, RESTARTS=10 times each, while they walk over vcan (some 4 min a time)
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/vcan-guest --timeout $$((300 + 240 * $(RESTARTS))) -- \
	    scripts/restart-campaign --times $(RESTARTS) --build $(BUILD)
