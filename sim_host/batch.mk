# The speed measurements' comparisons use libraries where they are installed; without them they say so.
HAVE_HEADER = $(shell printf '\#include <$(1)>\n' | $(CC) -E -x c - >/dev/null 2>&1 && echo yes)
$(BUILD)/afo-bench-cvode: private LDLIBS_SIM += $(if $(call HAVE_HEADER,cvode/cvode.h),\
        -lsundials_cvode -lsundials_nvecserial -lsundials_generic)
$(BUILD)/afo-bench-gsl: private LDLIBS_SIM += $(if $(call HAVE_HEADER,gsl/gsl_odeiv2.h),-lgsl -lgslcblas)
