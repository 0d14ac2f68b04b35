# Fuzzers (clang's libFuzzer): log parsing, SDO, frame dispatch, slcan.
FUZZ_SECONDS ?= 300
FUZZ_FLAGS := -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
FUZZERS := $(patsubst tests/fuzz/%.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))

$(BUILD)/fuzz_%: $(BUILD)/f32/tests/fuzz/fuzz_%.o $(LIBS)
	$(call SAY,LD     $@)
	$(Q)$(CC) $(LDFLAGS_ALL) -fsanitize=fuzzer $(filter %.o,$^) $(LIBS) $(LDLIBS_SIM) -o $@

.PHONY: fuzz fuzzers fuzz-programs
fuzzers: $(FUZZERS)
fuzz-programs:
	$(Q)$(MAKE) --no-print-directory BUILD=build/fuzz CC=clang OPT=-O1 SANITIZE="$(FUZZ_FLAGS)" fuzzers

fuzz: ## fuzz frame dispatch, SDO, slcan and log parsing, FUZZ_SECONDS (300) each
	$(Q)scripts/setup fuzz
	$(Q)$(MAKE) --no-print-directory fuzz-programs
	$(Q)scripts/fuzz $(FUZZ_SECONDS)

TEST_NEEDS += fuzz-programs
-include $(wildcard $(BUILD)/f32/tests/fuzz/*.d)
