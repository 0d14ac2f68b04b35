# The paper's tables and figures by `afo study`.
.PHONY: paper
paper: ## every table and figure of the paper, and one page, in build/paper (a minute or two)
	$(Q)scripts/setup paper
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/paper --afo $(BUILD)/afo --out $(BUILD)/paper
