# Fuzzers (clang's libFuzzer): log parsing and replay, files of a user, the black box, SDO, frame dispatch, slcan, a
# stranger on a walk's bus.
FUZZ_SECONDS ?= 300
FUZZ_FLAGS := -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
FUZZERS := $(patsubst tests/fuzz/%.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))

$(BUILD)/fuzz_%: $(BUILD)/f32/tests/fuzz/fuzz_%.o $(LIBS)
	$(call SAY,LD     $@)
	$(Q)$(CC) $(LDFLAGS_ALL) -fsanitize=fuzzer $(filter %.o,$^) $(LIBS) $(LDLIBS_SIM) -o $@

.PHONY: fuzz fuzzers fuzz-programs fuzz-coverage
fuzzers: $(FUZZERS)
fuzz-programs:
	$(Q)$(MAKE) --no-print-directory BUILD=build/fuzz CC=clang OPT=-O1 SANITIZE="$(FUZZ_FLAGS)" fuzzers

fuzz: ## fuzz frames, SDO, slcan, logs, files, the black box and a walk, FUZZ_SECONDS (300) each, two at a time (20 min)
	$(Q)scripts/setup fuzz
	$(Q)$(MAKE) --no-print-directory fuzz-programs
	$(Q)scripts/fuzz $(FUZZ_SECONDS)

fuzz-coverage: ## which code the inputs that the fuzzers kept reach
	$(Q)scripts/setup fuzz
	$(Q)$(MAKE) --no-print-directory BUILD=build/fuzz-coverage CC=clang OPT=-O1 \
	    SANITIZE="-fsanitize=fuzzer-no-link -fprofile-instr-generate -fcoverage-mapping" fuzzers
	$(Q)scripts/fuzz --coverage

TEST_NEEDS += fuzz-programs
-include $(wildcard $(BUILD)/f32/tests/fuzz/*.d)
