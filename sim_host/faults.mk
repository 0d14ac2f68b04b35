# The fault campaign. Results stay in build/faults: an interrupted one goes on.
FAULT_RUNS ?= 10000
FAULT_SEED ?= 1
PEOPLE_RUNS ?= 10200
.PHONY: faults faults-short faults-people faults-reflex soak
faults: ## fault campaign (FAULT_RUNS=10000 FAULT_SEED=1): the table of all classes in build/faults (4 min of processor time; goes on)
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(BUILD)/faults/$(BUILD_ID)
	$(Q)$(BUILD)/afo faults --runs $(FAULT_RUNS) --seed $(FAULT_SEED) --jobs $(JOBS) --out $(BUILD)/faults/$(BUILD_ID) \
	    --markdown >$(BUILD)/faults/table.md.new; status=$$?; \
	mv $(BUILD)/faults/table.md.new $(BUILD)/faults/table.md; cat $(BUILD)/faults/table.md; \
	scripts/results-page --title 'What faults do' --made-by 'make faults' --out $(BUILD)/faults/index.html \
	    $(BUILD)/faults/table.md; exit $$status

faults-short: ## four hundred runs of it (10 s of processor time)
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)$(BUILD)/afo faults --runs 400 --seed $(FAULT_SEED) --jobs $(JOBS)

faults-people: ## fault campaign with people, made ones and those of AFO_DATA (PEOPLE_RUNS=10200 FAULT_SEED=1): the table in build/faults-people (4 min of processor time; goes on)
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(BUILD)/faults-people/$(BUILD_ID)
	$(Q)$(BUILD)/afo faults --people --runs $(PEOPLE_RUNS) --seed $(FAULT_SEED) --jobs $(JOBS) \
	    --out $(BUILD)/faults-people/$(BUILD_ID) --markdown >$(BUILD)/faults-people/table.md.new; status=$$?; \
	mv $(BUILD)/faults-people/table.md.new $(BUILD)/faults-people/table.md; cat $(BUILD)/faults-people/table.md; \
	scripts/results-page --title 'What faults do to people' --made-by 'make faults-people' --out $(BUILD)/faults-people/index.html \
	    $(BUILD)/faults-people/table.md; exit $$status

REFLEX_RUNS ?= 1020
faults-reflex: ## fault campaign with a person who walks by reflexes (REFLEX_RUNS=1020 FAULT_SEED=1): the table in build/faults-reflex (15 min of processor time; goes on)
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(BUILD)/faults-reflex/$(BUILD_ID)
	$(Q)$(BUILD)/afo faults --plant reflex --runs $(REFLEX_RUNS) --seed $(FAULT_SEED) --jobs $(JOBS) \
	    --out $(BUILD)/faults-reflex/$(BUILD_ID) --markdown >$(BUILD)/faults-reflex/table.md.new; status=$$?; \
	mv $(BUILD)/faults-reflex/table.md.new $(BUILD)/faults-reflex/table.md; cat $(BUILD)/faults-reflex/table.md; \
	scripts/results-page --title 'What faults do to a person who walks by reflexes' --made-by 'make faults-reflex' \
	    --out $(BUILD)/faults-reflex/index.html $(BUILD)/faults-reflex/table.md; exit $$status

SOAK_TICKS ?= 100000000
soak: ## walks 100 million control ticks (28 hours simulated) with disturbances; watches counters and memory (9 min)
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)$(BUILD)/afo soak --ticks $(SOAK_TICKS)
