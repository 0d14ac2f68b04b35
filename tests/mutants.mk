# Mutation testing: how many small faults in the code the C tests notice (scripts/mutation-score).
MUTANTS_BUILD = $(Q)$(MAKE) --no-print-directory CC=gcc
.PHONY: mutants
mutants: ## 300 small faults in the code, one at a time: how many the C tests notice (two hours on two idle cores)
	$(Q)scripts/setup test coverage
	$(MUTANTS_BUILD) BUILD=build/mutants/plain CFLAGS=-g0 tests
	$(MUTANTS_BUILD) BUILD=build/mutants/asan $(variant_asan) CFLAGS=-g0 tests
	$(MUTANTS_BUILD) BUILD=build/coverage $(variant_coverage) tests
	$(Q)scripts/mutation-score $(if $(SEED),--seed $(SEED))
