# Proofs by abstract interpretation: no input makes the code fail (scripts/prove, tests/proof).
.PHONY: prove prove-mutants
prove: ## prove that no input makes controller and decoders fail (some minutes of processor time)
	$(Q)scripts/setup prove
	$(Q)scripts/prove

prove-mutants: ## injected faults, each of which a proof must notice (half an hour)
	$(Q)scripts/setup prove
	$(Q)scripts/prove --mutants
