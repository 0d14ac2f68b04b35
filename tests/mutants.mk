# Mutation testing: how many small faults in the code the C tests notice (scripts/mutation-score).
MUTANTS_BUILD = $(Q)$(MAKE) --no-print-directory CC=gcc
.PHONY: mutants
mutants: ## 300 small faults in the code, one at a time: how many the C tests notice (an hour on two idle cores)
	$(Q)scripts/setup test coverage
	$(MUTANTS_BUILD) BUILD=build/mutants/plain CFLAGS=-g0 programs tests
	$(MUTANTS_BUILD) BUILD=build/coverage $(variant_coverage) tests
	$(Q)scripts/mutation-score $(if $(SEED),--seed $(SEED)) $(if $(MINUTES),--minutes $(MINUTES))

# ThreadSanitizer on whatever runs in threads.
THREADED := $(addprefix build/tsan/tests/sim_host/,batch/test_chunks batch/test_batch_f64 batch/test_ground_f64 \
        study/laws/test_laws_walks study/paper/test_walks_f64)
.PHONY: threads
threads: ## ThreadSanitizer on the batch engine and the studies that run in threads (some minutes)
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory BUILD=build/tsan $(variant_tsan) $(THREADED) build/tsan/afo
	$(Q)scripts/check-threads build/tsan
