# Builds, runs and proves the ankle-foot orthosis controller: `make help`.
CC ?= gcc
BUILD ?= build
OPT ?= -O2
SANITIZE ?=

WARN := -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wstrict-prototypes \
        -Wmissing-prototypes -Wundef -Wvla -Werror
# Same bits on every machine: no contraction to fused multiply-add, no errno paths in sqrt.
BITS := -ffp-contract=off -fno-math-errno -fno-strict-aliasing
CFLAGS_ALL := -std=c11 -D_GNU_SOURCE $(OPT) -g $(WARN) $(BITS) $(SANITIZE) -I. $(CFLAGS)
LDLIBS_SIM := -lm -lpthread

SRC_MODEL := $(wildcard model/*.c)
SRC_CONTROLLER := $(wildcard controller/*.c controller/*/*.c)
SRC_HAL := $(wildcard hal/*.c hal/canopen/*.c hal/port_socketcan/*.c)
SRC_FIRMWARE := $(wildcard firmware/*.c)
SRC_SIM_F64 := $(wildcard sim_host/plant/*.c sim_host/study/*.c sim_host/batch/*.c)
SRC_SIM_F32 := $(wildcard sim_host/*.c sim_host/bus/*.c sim_host/nodes/*.c sim_host/host/*.c)
SRC_PROGRAMS := $(wildcard sim_host/programs/*.c)
SRC_TESTS := $(wildcard tests/*/test_*.c tests/*/*/test_*.c)
SRC_SUPPORT := $(wildcard tests/support/*.c)

OBJ_F32 = $(patsubst %.c,$(BUILD)/f32/%.o,$(1))
OBJ_F64 = $(patsubst %.c,$(BUILD)/f64/%.o,$(1))

LIBS := $(addprefix $(BUILD)/lib/,libsim.a libfirmware.a libhal.a libcontroller_f32.a libcontroller_f64.a \
        libmodel_f32.a libmodel_f64.a)
PROGRAMS := $(foreach p,$(SRC_PROGRAMS),$(BUILD)/$(subst _,-,$(basename $(notdir $(p)))))
TESTS := $(patsubst tests/%.c,$(BUILD)/tests/%,$(SRC_TESTS))

.PHONY: all tests clean
all: $(LIBS) $(PROGRAMS)
tests: $(TESTS)

$(BUILD)/f32/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_ALL) -MMD -MP -c $< -o $@
$(BUILD)/f64/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_ALL) -DREAL_IS_DOUBLE -MMD -MP -c $< -o $@

$(BUILD)/lib/libmodel_f32.a: $(call OBJ_F32,$(SRC_MODEL))
$(BUILD)/lib/libmodel_f64.a: $(call OBJ_F64,$(SRC_MODEL))
$(BUILD)/lib/libcontroller_f32.a: $(call OBJ_F32,$(SRC_CONTROLLER))
$(BUILD)/lib/libcontroller_f64.a: $(call OBJ_F64,$(SRC_CONTROLLER))
$(BUILD)/lib/libhal.a: $(call OBJ_F32,$(SRC_HAL))
$(BUILD)/lib/libfirmware.a: $(call OBJ_F32,$(SRC_FIRMWARE))
$(BUILD)/lib/libsim.a: $(call OBJ_F32,$(SRC_SIM_F32)) $(call OBJ_F64,$(SRC_SIM_F64))
$(BUILD)/lib/%.a:
	@mkdir -p $(@D)
	@rm -f $@
	ar rcs $@ $^

define PROGRAM_RULE
$(BUILD)/$(subst _,-,$(basename $(notdir $(1)))): $(call OBJ_F32,$(1)) $(LIBS)
	$$(CC) $$(SANITIZE) $$< $(LIBS) $$(LDLIBS_SIM) -o $$@
endef
$(foreach p,$(SRC_PROGRAMS),$(eval $(call PROGRAM_RULE,$(p))))

# Tests named *_f64 see the double-precision model, all others the float one.
$(BUILD)/tests/%_f64: $(BUILD)/f64/tests/%_f64.o $(call OBJ_F64,$(SRC_SUPPORT)) $(LIBS)
	@mkdir -p $(@D)
	$(CC) $(SANITIZE) $(filter %.o,$^) $(LIBS) $(LDLIBS_SIM) $$(pkg-config --libs check) -o $@
$(BUILD)/tests/%: $(BUILD)/f32/tests/%.o $(call OBJ_F32,$(SRC_SUPPORT)) $(LIBS)
	@mkdir -p $(@D)
	$(CC) $(SANITIZE) $(filter %.o,$^) $(LIBS) $(LDLIBS_SIM) $$(pkg-config --libs check) -o $@

clean:
	rm -rf $(BUILD)

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
.SECONDARY:
