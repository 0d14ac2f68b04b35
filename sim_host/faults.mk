# The fault campaign. Results stay in build/faults: an interrupted one goes on.
FAULT_RUNS ?= 10000
FAULT_SEED ?= 1
.PHONY: faults faults-short soak
faults: ## fault campaign (FAULT_RUNS=10000 FAULT_SEED=1): the table of all classes in build/faults, resumable
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(BUILD)/faults/$(BUILD_ID)
	$(Q)scripts/with-progress --name faults --total $(FAULT_RUNS) --log $(BUILD)/faults/progress.log \
	    --files '$(BUILD)/faults/$(BUILD_ID)/seed$(FAULT_SEED)-job*.txt' -- \
	    $(BUILD)/afo-faults --runs $(FAULT_RUNS) --seed $(FAULT_SEED) --jobs $(JOBS) --out $(BUILD)/faults/$(BUILD_ID) \
	    --markdown >$(BUILD)/faults/table.md.new; status=$$?; \
	mv $(BUILD)/faults/table.md.new $(BUILD)/faults/table.md; cat $(BUILD)/faults/table.md; \
	scripts/results-page --title 'What faults do' --made-by 'make faults' --out $(BUILD)/faults/index.html \
	    $(BUILD)/faults/table.md; exit $$status

faults-short: ## some hundred runs of it
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)$(BUILD)/afo-faults --runs 400 --seed $(FAULT_SEED) --jobs $(JOBS)

SOAK_TICKS ?= 100000000
soak: ## walks 100 million control ticks (28 hours simulated) with disturbances; watches counters and memory
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)$(BUILD)/afo-soak --ticks $(SOAK_TICKS)
