# What the controller knows of the gait, against the truth: numbers and a picture.
OBSERVE_OUT ?= $(BUILD)/observe
.PHONY: observe
observe: ## what the observer knows by sensor, noise and delay, and with wrong parameters; a page in build/observe (2 min of processor time)
	$(Q)scripts/setup run
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)mkdir -p $(OBSERVE_OUT)
	@echo '  OBSERVE two studies, about two minutes of processor time; numbers in $(OBSERVE_OUT)/*.txt'
	$(Q)$(BUILD)/afo study observe --csv $(OBSERVE_OUT)/observe.csv >$(OBSERVE_OUT)/observe.txt
	$(Q)$(BUILD)/afo study observe --mismatch >$(OBSERVE_OUT)/mismatch.txt
	$(Q)scripts/plot-observe $(OBSERVE_OUT)/observe.csv --out $(OBSERVE_OUT)
	$(Q)scripts/results-page --title 'What the controller knows' --made-by 'make observe' --out $(OBSERVE_OUT)/index.html \
	    $(OBSERVE_OUT)/observe.png $(OBSERVE_OUT)/observe.txt $(OBSERVE_OUT)/mismatch.txt
