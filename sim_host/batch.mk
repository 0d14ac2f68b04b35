# The kernels inline into functions so large that gcc gives up on tracking their variables, and says so.
$(BUILD)/f64/sim_host/batch/kernel_%.o: private CFLAGS_ALL += $(if $(findstring gcc,$(CC)),-fno-var-tracking-assignments)

# The speed measurements' comparisons use libraries where they are installed; without them they say so.
HAVE_HEADER = $(shell printf '\043include <$(1)>\n' | $(CC) -E -x c - >/dev/null 2>&1 && echo yes)
# A library that came since the last build is in the next one. The compiler is told of it by an option, because a
# compiler's cache sees the option, and not a header that has come.
PEERS := cvode gsl
cvode_HEADER := cvode/cvode.h
cvode_LIBRARIES := -lsundials_cvode -lsundials_nvecserial -lsundials_generic
gsl_HEADER := gsl/gsl_odeiv2.h
gsl_LIBRARIES := -lgsl -lgslcblas
$(BUILD)/stamp/peers: FORCE
	$(call STAMP,$(foreach peer,$(PEERS),$($(peer)_HEADER) $(or $(call HAVE_HEADER,$($(peer)_HEADER)),no)))
define PEER_RULES
$(call OBJ_F32,sim_host/programs/bench/afo_bench_$(1).c): $(BUILD)/stamp/peers
$(call OBJ_F32,sim_host/programs/bench/afo_bench_$(1).c): private CFLAGS_ALL += $$(if $$(call HAVE_HEADER,$$($(1)_HEADER)),-DHAVE_PEER)
$(BUILD)/afo-bench-$(1): private LDLIBS_SIM += $$(if $$(call HAVE_HEADER,$$($(1)_HEADER)),$$($(1)_LIBRARIES))
endef
$(foreach peer,$(PEERS),$(eval $(call PEER_RULES,$(peer))))

# Long work under mpirun, where MPI is installed: the same program with MPI in it, apart, so that afo itself needs
# no library of it.
MPI_INCLUDES := $(shell mpicc --showme:incdirs 2>/dev/null)
ifneq ($(MPI_INCLUDES),)
MPI_LIBS := $(shell mpicc --showme:libdirs 2>/dev/null | sed 's/[^ ]\+/-L&/g') \
        $(shell mpicc --showme:libs 2>/dev/null | sed 's/[^ ]\+/-l&/g')
CHUNKS_MPI := $(BUILD)/mpi/sim_host/batch/chunks_mpi.o
$(CHUNKS_MPI): sim_host/batch/chunks_mpi.c $(BUILD)/stamp/flags
	@mkdir -p $(@D)
	$(call SAY,CC64   $<)
	$(Q)$(CC) $(CFLAGS_ALL) -DREAL_IS_DOUBLE -DBATCH_HAVE_MPI $(MPI_INCLUDES:%=-isystem %) -MMD -MP -c $< -o $@
-include $(CHUNKS_MPI:.o=.d)
# Its object stands before the archives, and so in the place of theirs.
$(BUILD)/afo-mpi: private LDLIBS_SIM += $(MPI_LIBS)
$(BUILD)/afo-mpi: $(call OBJ_F32,$(SRC_AFO)) $(CHUNKS_MPI) $(LIBS)
	$(LINK_PROGRAM)
PROGRAMS += $(BUILD)/afo-mpi
programs: $(BUILD)/afo-mpi
endif

.PHONY: atlas
atlas: ## where a walker walks: the basin as a volume, the plane of push-off and stiffness (half an hour; resumes)
	$(Q)scripts/setup bench
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/bench-atlas $(BUILD)

.PHONY: soak-strides neon-check
soak-strides: ## 1e8 strides with different vectors and threads: no differing bit, no growth (some minutes)
	$(Q)scripts/setup bench
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/soak-strides $(BUILD)
neon-check: ## the batch engine for 64-bit ARM under an emulator: the same bits as here
	$(Q)scripts/setup neon
	$(Q)$(MAKE) --no-print-directory programs
	$(Q)scripts/neon-check $(BUILD)
