# The paper's tables and figures by `afo study`.
.PHONY: paper
paper: ## every table and figure of the paper, and one page, in build/paper (a minute or two)
	$(Q)scripts/setup paper
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/paper --afo $(BUILD)/afo --out $(BUILD)/paper

# What doses of push-off do to persons who walk by reflexes. Walks are kept: an interrupted study goes on.
DOSE_PERSONS ?= new used calf-left calf-both
DOSE_R0 ?= 0.01,0.02,0.03,0.035,0.04,0.05
DOSE_SEEDS ?= 3
.PHONY: dose
dose: ## doses of push-off for the persons of reflexes, beside no device (DOSE_SEEDS=3): tables and a picture in build/dose (15 min of processor time; goes on)
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(BUILD)/dose/$(BUILD_ID)
	$(Q)$(BUILD)/afo study dose $(DOSE_PERSONS:%=--person sim_host/persons/reflex-%.ini) \
	    --device sim_host/devices/virtual-adult.ini --r0 $(DOSE_R0) --seeds $(DOSE_SEEDS) --jobs $(JOBS) \
	    --out $(BUILD)/dose/$(BUILD_ID) --csv $(BUILD)/dose/dose.csv --plot $(BUILD)/dose/dose.svg --markdown >$(BUILD)/dose/table.md
	$(Q)cat $(BUILD)/dose/table.md
	$(Q)scripts/results-page --title 'What a dose of push-off does to persons who walk by reflexes' --made-by 'make dose' \
	    --out $(BUILD)/dose/index.html $(BUILD)/dose/table.md
