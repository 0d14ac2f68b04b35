/* A stride as three initial value problems with an event each, for general-purpose solvers.
 *
 * The equations are model/'s; the solver brings method and event location. Compiled in double; a program that
 * includes this defines REAL_IS_DOUBLE first.
 */
#ifndef SIM_HOST_BATCH_BENCHMARK_PHASES_H
#define SIM_HOST_BATCH_BENCHMARK_PHASES_H

#include "model/double_support.h"
#include "model/stride.h"
#include "sim_host/batch/benchmark.h"

enum benchmark_phase { PHASE_TO_STRIKE, PHASE_PUSH_OFF, PHASE_TO_APEX };

/* Moves state to the phase's event: to strike ts + tn falls through zero; push-off r reaches r0 (rising);
 * to the apex ts falls through zero. context: the solver's. Returns 0 when it could not. */
typedef int benchmark_phase_fn(void *solver, enum benchmark_phase phase, double tolerance,
                               double *state);

struct benchmark_solver {
    benchmark_phase_fn *run;
    void *solver;
    struct walker *walker;          /* of the stride in work: context of single_support_rates */
    struct double_support *support; /* context of double_support_rates */
};

/* Value of the phase's event function; it falls through zero at the event. */
double benchmark_event(enum benchmark_phase phase, const struct double_support *support,
                       const double *state);

/* All rows with a benchmark_solver as context: a benchmark_method_fn, setting: the tolerance. */
int benchmark_solve(void *solver, const struct benchmark_rows *rows, double tolerance,
                    double (*next)[3]);

#endif
