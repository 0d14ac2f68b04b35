# The laws beside each other, at full size: every study, in numbers (CSV) and pictures.
LAWS_OUT ?= $(BUILD)/laws
LAWS_STUDIES := jumps jumps_--chain limits basin_--samples_100000 ground ground_--chain ground-limit sensitivity slope mismatch \
        energy push timing

.PHONY: laws
laws: ## all studies of the laws, map and whole chain, numbers and pictures into build/laws (an hour)
	$(Q)scripts/setup run
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(LAWS_OUT)
	$(Q)for study in $(LAWS_STUDIES); do \
	        $(BUILD)/afo-study laws $$(echo $$study | tr _ ' ') --out $(LAWS_OUT) >$(LAWS_OUT)/$$study.txt || exit 1; \
	        cat $(LAWS_OUT)/$$study.txt; done
	$(Q)scripts/plot-laws $(LAWS_OUT)
