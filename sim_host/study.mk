# The paper's tables and figures from the study program.
.PHONY: paper
paper: ## every table and figure of the paper, and one page, in build/paper
	$(Q)scripts/setup paper
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/paper --study $(BUILD)/afo-study --out $(BUILD)/paper
