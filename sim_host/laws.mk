# The laws beside each other, at full size: every study, in numbers (CSV) and pictures. What one program has done is
# not done again: a run that was broken off goes on where it was.
LAWS_OUT ?= $(BUILD)/laws
LAWS_STUDIES := jumps jumps_--chain limits basin_--samples_100000 ground ground_--chain ground-limit \
        sensitivity slope mismatch energy push timing
LAWS_DONE := $(LAWS_STUDIES:%=$(LAWS_OUT)/%.txt)

LAWS_PICTURES := jumps jumps-chain basin ground ground-chain push-chain slope timing

.PHONY: laws
laws: ## all studies of the laws, map and whole chain, numbers and pictures into build/laws (18 min of processor time; goes on)
	$(Q)scripts/setup run
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(LAWS_OUT)
	@echo '  LAWS   $(words $(LAWS_STUDIES)) studies, 18 min of processor time in all; numbers in $(LAWS_OUT)/*.txt'
	$(Q)$(MAKE) --no-print-directory $(LAWS_DONE)
	$(Q)cat $(LAWS_DONE)
	$(Q)scripts/laws-table $(LAWS_OUT) >$(LAWS_OUT)/table.md.new
	$(Q)mv $(LAWS_OUT)/table.md.new $(LAWS_OUT)/table.md
	$(Q)cat $(LAWS_OUT)/table.md
	$(Q)scripts/plot-laws $(LAWS_OUT)
	$(Q)scripts/results-page --title 'The laws beside each other' --made-by 'make laws' --out $(LAWS_OUT)/index.html \
	    $(LAWS_OUT)/table.md $(addprefix $(LAWS_OUT)/laws-,$(addsuffix .png,$(LAWS_PICTURES))) $(LAWS_DONE)

$(LAWS_DONE): $(LAWS_OUT)/%.txt: $(BUILD)/afo
	@echo '  LAWS   $(subst _, ,$*)'
	$(Q)$< study laws $(subst _, ,$*) --out $(LAWS_OUT) >$@.new
	$(Q)mv $@.new $@
