# Builds, runs and proves the ankle-foot orthosis controller: `make help`.
#
# Sources are found by wildcard. A room that needs rules of its own (an image for
# a board, a fuzzer) puts them in a fragment beside its sources, ROOM/NAME.mk.
# Other compilers and options build side by side: make BUILD=build/clang CC=clang
CC := $(if $(filter default,$(origin CC)),gcc,$(CC))
BUILD ?= build
OPT ?= -O2
SANITIZE ?=
# The tick and the bit rate of the whole tree; empty: 1000 us, 1000000 bit/s.
TICK_US ?=
BITRATE ?=
JOBS ?= $(shell nproc 2>/dev/null || echo 1)
PYTHON ?= $(firstword $(wildcard build/venv/bin/python) /usr/bin/python3)

ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif
.DELETE_ON_ERROR:
.SECONDARY:
.SUFFIXES:
.DEFAULT_GOAL := all

WARN := -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wstrict-prototypes \
        -Wmissing-prototypes -Wundef -Wvla -Werror
# Same bits on every machine: no contraction to fused multiply-add, no errno paths in sqrt.
BITS := -ffp-contract=off -fno-math-errno -fno-strict-aliasing
NOT_A_NUMBER = $(if $(2),$(if $(shell printf '%s' '$(2)' | tr -d 0-9),$(error $(1) must be a whole number of $(3), not "$(2)")))
$(call NOT_A_NUMBER,TICK_US,$(TICK_US),microseconds)$(call NOT_A_NUMBER,BITRATE,$(BITRATE),bit/s)
BUS_RATES := $(strip $(if $(TICK_US),-DTICK_PERIOD_US=$(TICK_US)) $(if $(BITRATE),-DBUS_BITRATE=$(BITRATE)))
# One object code for the programs and for the Python package's shared library, which shows its own functions only.
SHARABLE := -fPIC -fvisibility=hidden
CFLAGS_ALL = -std=c11 -D_GNU_SOURCE $(OPT) -g $(WARN) $(BITS) $(SHARABLE) $(BUS_RATES) $(SANITIZE) -I. $(CFLAGS)
LDFLAGS_ALL = $(SANITIZE) $(LDFLAGS)
LDLIBS_SIM := -lm -lpthread

# ---- Sources -----------------------------------------------------------------
SRC_MODEL := $(wildcard model/*.c model/*/*.c)
SRC_CONTROLLER := $(wildcard controller/*.c controller/*/*.c)
# Of the ports only those that a Linux host can build; a board's fragment names its own.
SRC_HAL := $(filter-out hal/port_%,$(wildcard hal/*.c hal/*/*.c)) $(wildcard hal/port_socketcan/*.c)
SRC_FIRMWARE := $(wildcard firmware/*.c)
SRC_SIM := $(filter-out sim_host/programs/% sim_host/python/%,$(wildcard sim_host/*/*.c sim_host/*/*/*.c))
# What computes with the model computes in double; what holds a controller, in float as it does.
SRC_SIM_F32_STUDIES := $(wildcard $(foreach room,laws observer size person dose,sim_host/study/$(room)/*.c))
SRC_SIM_F64 := $(filter-out $(SRC_SIM_F32_STUDIES),$(filter sim_host/plant/% sim_host/reflex/% sim_host/gait/% sim_host/study/% sim_host/batch/%,$(SRC_SIM)))
SRC_SIM_F32 := $(filter-out $(SRC_SIM_F64),$(SRC_SIM))
# One program with a sub-command a file, and the benchmarks, which stay programs of their own.
SRC_AFO := $(wildcard sim_host/programs/*.c)
SRC_BENCH := $(wildcard sim_host/programs/bench/*.c)
SRC_TESTS := $(wildcard tests/*/test_*.c tests/*/*/test_*.c tests/*/*/*/test_*.c tests/*/*/*/*/test_*.c)
SRC_SUPPORT := $(filter-out tests/support/test_%,$(wildcard tests/support/*.c))

OBJ_F32 = $(patsubst %.c,$(BUILD)/f32/%.o,$(1))
OBJ_F64 = $(patsubst %.c,$(BUILD)/f64/%.o,$(1))
PROGRAM_OF = $(BUILD)/$(subst _,-,$(basename $(notdir $(1))))

LIBS := $(addprefix $(BUILD)/lib/,libsim.a libfirmware.a libhal.a libcontroller_f32.a libcontroller_f64.a \
        libmodel_f32.a libmodel_f64.a)
PROGRAMS := $(if $(SRC_AFO),$(BUILD)/afo) $(foreach p,$(SRC_BENCH),$(call PROGRAM_OF,$(p)))
TESTS := $(patsubst tests/%.c,$(BUILD)/tests/%,$(SRC_TESTS))

.PHONY: all programs tests FORCE
all: programs ## build everything that runs on this machine (the default)
programs: $(LIBS) $(PROGRAMS)
tests: $(TESTS)

# ---- What was built with what ------------------------------------------------
# The version is git's word on the commit; the build id depends on the sources
# alone, so that every compiler and machine gives the same one.
VERSION_BASE := 0.3.0
GIT_COMMIT := $(shell git rev-parse --short=10 HEAD 2>/dev/null)
GIT_DIRTY := $(if $(GIT_COMMIT),$(shell git status --porcelain -uno 2>/dev/null | head -1))
VERSION := $(VERSION_BASE)$(if $(GIT_COMMIT),+g$(GIT_COMMIT))$(if $(GIT_DIRTY),.dirty)
BUILD_ID := 0x$(shell { find model controller hal firmware sim_host -name '*.[chS]' 2>/dev/null | LC_ALL=C sort | \
        xargs -r sha256sum; printf '%s' '$(BUS_RATES)'; } | sha256sum | cut -c1-8)
IDENTITY := -DAFO_VERSION='"$(VERSION)"' -DAFO_BUILD_ID=$(BUILD_ID)u

# Stamps that change only when their text does: objects follow the flags, archives
# the list of sources (a removed file leaves its archive), version.o the identity.
define STAMP
@mkdir -p $(@D)
@printf '%s\n' '$(subst ','\'',$(1))' >$@.new; if cmp -s $@.new $@; then rm -f $@.new; else mv -f $@.new $@; fi
endef
$(BUILD)/stamp/flags: FORCE
	$(call STAMP,$(shell $(CC) --version 2>&1 | head -1) $(CC) $(CFLAGS_ALL) $(LDFLAGS_ALL))
$(BUILD)/stamp/sources: FORCE
	$(call STAMP,$(SRC_MODEL) $(SRC_CONTROLLER) $(SRC_HAL) $(SRC_FIRMWARE) $(SRC_SIM))
$(BUILD)/stamp/identity: FORCE
	$(call STAMP,$(IDENTITY))

# ---- Rules -------------------------------------------------------------------
Q := $(if $(V),,@)
SAY = @echo '  $(1)'
ifneq ($(V),)
SAY = @:
endif

$(BUILD)/f32/firmware/version.o: private CFLAGS_ALL += $(IDENTITY)
$(BUILD)/f32/firmware/version.o: $(BUILD)/stamp/identity

$(BUILD)/f32/%.o: %.c $(BUILD)/stamp/flags
	@mkdir -p $(@D)
	$(call SAY,CC     $<)
	$(Q)$(CC) $(CFLAGS_ALL) -MMD -MP -c $< -o $@
$(BUILD)/f64/%.o: %.c $(BUILD)/stamp/flags
	@mkdir -p $(@D)
	$(call SAY,CC64   $<)
	$(Q)$(CC) $(CFLAGS_ALL) -DREAL_IS_DOUBLE -MMD -MP -c $< -o $@

$(BUILD)/lib/libmodel_f32.a: $(call OBJ_F32,$(SRC_MODEL))
$(BUILD)/lib/libmodel_f64.a: $(call OBJ_F64,$(SRC_MODEL))
$(BUILD)/lib/libcontroller_f32.a: $(call OBJ_F32,$(SRC_CONTROLLER))
$(BUILD)/lib/libcontroller_f64.a: $(call OBJ_F64,$(SRC_CONTROLLER))
$(BUILD)/lib/libhal.a: $(call OBJ_F32,$(SRC_HAL))
$(BUILD)/lib/libfirmware.a: $(call OBJ_F32,$(SRC_FIRMWARE))
$(BUILD)/lib/libsim.a: $(call OBJ_F32,$(SRC_SIM_F32)) $(call OBJ_F64,$(SRC_SIM_F64))
$(BUILD)/lib/%.a: $(BUILD)/stamp/sources
	@mkdir -p $(@D)
	$(call SAY,AR     $@)
	$(Q)rm -f $@ $@.new && ar rcsD $@.new $(filter %.o,$^) && mv $@.new $@

define LINK_PROGRAM
$(call SAY,LD     $@)
$(Q)$(CC) $(LDFLAGS_ALL) $(filter %.o,$^) $(LIBS) $(LDLIBS_SIM) -o $@
endef
$(BUILD)/afo: $(call OBJ_F32,$(SRC_AFO)) $(LIBS)
	$(LINK_PROGRAM)
define BENCH_RULE
$(call PROGRAM_OF,$(1)): $(call OBJ_F32,$(1)) $(LIBS)
	$$(LINK_PROGRAM)
endef
$(foreach p,$(SRC_BENCH),$(eval $(call BENCH_RULE,$(p))))

# Tests named *_f64 see the double-precision model, all others the float one.
define LINK_TEST
@mkdir -p $(@D)
$(call SAY,LD     $@)
$(Q)$(CC) $(LDFLAGS_ALL) $(filter %.o,$^) $(LIBS) $$(pkg-config --libs check) $(LDLIBS_SIM) -o $@
endef
$(BUILD)/tests/%_f64: $(BUILD)/f64/tests/%_f64.o $(call OBJ_F64,$(SRC_SUPPORT)) $(LIBS)
	$(LINK_TEST)
$(BUILD)/tests/%: $(BUILD)/f32/tests/%.o $(call OBJ_F32,$(SRC_SUPPORT)) $(LIBS)
	$(LINK_TEST)

SRC_ALL := $(SRC_MODEL) $(SRC_CONTROLLER) $(SRC_HAL) $(SRC_FIRMWARE) $(SRC_SIM) $(SRC_AFO) $(SRC_BENCH) $(SRC_TESTS) \
        $(SRC_SUPPORT)
-include $(wildcard $(patsubst %.o,%.d,$(call OBJ_F32,$(SRC_ALL)) $(call OBJ_F64,$(SRC_ALL))))

# ---- The same tree under other compilers and checkers --------------------------
# make VARIANT builds it in build/VARIANT; make VARIANT-check runs its C tests.
VARIANTS := gcc-O1 gcc-O3 clang clang-O1 clang-O3 asan tsan coverage
ASAN := -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
variant_gcc-O1 := CC=gcc OPT=-O1
variant_gcc-O3 := CC=gcc OPT=-O3
variant_clang := CC=clang
variant_clang-O1 := CC=clang OPT=-O1
variant_clang-O3 := CC=clang OPT=-O3
variant_asan := CC=gcc OPT=-O1 SANITIZE="$(ASAN)"
# gcc warns of derivatives that a kernel without derivatives returns, and nobody looks at.
variant_tsan := CC=gcc OPT=-O1 SANITIZE=-fsanitize=thread CFLAGS=-Wno-maybe-uninitialized
variant_coverage := CC=gcc OPT=-O0 SANITIZE="--coverage -fprofile-abs-path -fprofile-update=atomic" \
        CFLAGS="-include tests/support/coverage_contract.h"
BITS_VARIANTS := gcc-O1 gcc-O3 clang-O1 clang-O3

.PHONY: $(VARIANTS) $(VARIANTS:%=%-programs) $(VARIANTS:%=%-check) ubsan
$(VARIANTS): ## (asan, tsan, coverage, clang, gcc-O3, ...) build the same tree that way in build/NAME (a minute or two each)
	$(Q)$(MAKE) --no-print-directory BUILD=build/$@ $(variant_$@) programs tests
$(VARIANTS:%=%-programs):
	$(Q)$(MAKE) --no-print-directory BUILD=build/$(@:%-programs=%) $(variant_$(@:%-programs=%)) programs
$(VARIANTS:%=%-check): %-check: % ## (asan-check, ...) build that way and run the C tests
	$(Q)scripts/run-tests --build build/$*
ubsan: asan

.PHONY: coverage-report
coverage-report: coverage ## lines and branches that the C tests reach; fails on any neither reached nor excused (some minutes)
	$(Q)find build/coverage -name '*.gcda' -delete
	$(Q)CK_TIMEOUT_MULTIPLIER=5 scripts/run-tests --build build/coverage
	$(Q)scripts/coverage-report build/coverage

# ---- What one asks for ---------------------------------------------------------
.PHONY: run test test-long bench format lint clean help setup-% check-static
setup-%:
	$(Q)scripts/setup $*

run: ## the main job: a walk in closed loop on the in-process bus, its report and pictures (some seconds)
	$(Q)scripts/setup run
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/demo-walk $(BUILD)

test: ## everything that must hold (some minutes on two cores)
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory programs tests $(TEST_NEEDS)
	$(Q)$(MAKE) --no-print-directory clang asan $(BITS_VARIANTS:%=%-programs)
	$(Q)scripts/run-tests --build build --build build/clang --build build/asan --python --scripts

test-long: ## what takes longer than `make test` may: tests marked long (some tens of minutes)
	$(Q)scripts/setup test
	$(Q)$(MAKE) --no-print-directory programs tests $(TEST_NEEDS)
	$(Q)scripts/run-tests --build build --python --long

bench: ## how fast it is, as ratios measured side by side; ten minutes of afo view in a browser (some minutes more)
	$(Q)scripts/setup bench
	$(Q)$(MAKE) --no-print-directory programs python-package
	$(Q)scripts/bench $(BUILD)
	$(Q)scripts/bench-strides $(BUILD)
	$(Q)scripts/setup view && scripts/bench-view $(BUILD)

FORMATTED := $(shell find model controller hal firmware sim_host tests -name '*.[ch]' 2>/dev/null)
format: ## lay out all C sources as .clang-format says
	$(Q)clang-format -i $(FORMATTED)

lint: ## layout, layering, symbols, cppcheck with MISRA, clang-tidy, gcc -fanalyzer (many minutes)
	$(Q)scripts/setup lint
	$(Q)scripts/lint

clean: ## remove everything that was built
	rm -rf build $(BUILD)

help: ## this list
	@echo 'make TARGET [BUILD=dir] [CC=gcc|clang] [OPT=-O2] [JOBS=n] [V=1]'; \
	echo '     [TICK_US=us BITRATE=bit/s]   another tick, another bit rate, in a BUILD of their own:'; \
	echo '                                  make programs TICK_US=2000 BITRATE=500000 BUILD=build/slow'; \
	grep -hE '^[a-zA-Z0-9$$()%: _-]+:.*## ' $(MAKEFILE_LIST) | \
	sed -E 's/^\$$\(VARIANTS:[^#]*## \(([^)]*)\)/\1 : ##/; s/^\$$\(VARIANTS\)[^#]*## \(([^)]*)\)/\1 : ##/' | \
	awk -F ':.*## ' '{ printf "  %-18s %s\n", $$1, $$2 }'

# Last, so that a fragment can use everything above and add to TEST_NEEDS, which
# `make test` builds before it starts.
include $(sort $(wildcard firmware/*.mk hal/*.mk sim_host/*.mk tests/*.mk tests/*/*.mk))
