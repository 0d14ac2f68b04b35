/* Steady gaits, their branches and basins, for Python. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/batch/parallel_for.h"
#include "sim_host/gait/branch.h"
#include "sim_host/python/library.h"
#include "sim_host/study/paper/basin_walks.h"
#include "sim_host/study/paper/periodic.h"

static struct walker_params params_of(const struct afo_walker *walker)
{
    return (struct walker_params){walker->M, walker->m, walker->l, walker->k, walker->g};
}

static const char *branch_name(int branch)
{
    return branch == AFO_BRANCH_LONG ? "long" : "short";
}

static void explain(enum orbit_status status, const struct orbit *orbit, const char *what,
                    char *text)
{
    if (status == ORBIT_FAULT) {
        snprintf(text, AFO_TEXT, "%s: %s, stride %d", what, stride_fault_name(orbit->fault),
                 orbit->fault_step + 1);
    } else {
        snprintf(text, AFO_TEXT, "%s: %s", what, orbit_status_name(status));
    }
}

static int check(const struct afo_walker *walker, double r0_m, char *text)
{
    if (afo_walker_check(walker, text) != 0) {
        return -1;
    }
    if (!(r0_m > 0.0 && r0_m < walker->l)) {
        snprintf(text, AFO_TEXT, "r0 = %g m must be above 0 and below the leg length of %g m", r0_m,
                 walker->l);
        return -1;
    }
    return 0;
}

static void write_gait(const struct problem *problem, const struct orbit *orbit,
                       struct afo_gait *gait)
{
    struct eigenvalue values[3];
    linear_eigenvalues3((const double(*)[3])orbit->by_x, values);
    *gait =
        (struct afo_gait){.r0_m = problem->r0_m,
                          .kp = problem->kp,
                          .residual = orbit->residual,
                          .times_s = {orbit->first.apex_to_strike_s, orbit->first.double_support_s,
                                      orbit->first.lift_off_to_apex_s},
                          .step_length_m = orbit->first.step_length_m,
                          .inter_leg_rad = orbit->first.inter_leg_rad,
                          .distance_m = orbit->distance_m,
                          .duration_s = orbit->duration_s,
                          .spring_energy_J = orbit->spring_energy_J,
                          .period = problem->period,
                          .clamped_strides = orbit->clamped_strides};
    memcpy(gait->x, orbit->x, sizeof gait->x);
    memcpy(gait->by_x, orbit->by_x, sizeof gait->by_x);
    for (int i = 0; i < 3; i++) {
        gait->eigenvalues[2 * i] = values[i].re;
        gait->eigenvalues[2 * i + 1] = values[i].im;
        gait->by_r0[i] = orbit->by_parameter[i][PARAMETER_R0];
    }
}

/* The problem at r0 with the gait of the branch in x. */
static int prepare(const struct afo_walker *walker, double r0_m, int branch, double kp,
                   struct problem *problem, double x[3], char *text)
{
    double lost_m;
    struct orbit scratch;
    if (check(walker, r0_m, text) != 0) {
        return -1;
    }
    *problem = (struct problem){.params = params_of(walker), .r0_m = r0_m, .kp = kp, .period = 1};
    if (!branch_find((enum branch)branch, &problem->params, r0_m, x, &lost_m)) {
        snprintf(
            text, AFO_TEXT,
            "no period-1 gait of the %s branch found at r0 = %g m: followed from the paper's walker, the branch "
            "is lost near r0 = %g m; try an r0 on this side of it, or a walker nearer to the paper's",
            branch_name(branch), r0_m, lost_m);
        return -1;
    }
    if (kp != 0.0 &&
        !branch_find(BRANCH_LONG, &problem->params, r0_m, problem->reference_x, &lost_m)) {
        snprintf(text, AFO_TEXT,
                 "the law has no reference speed: the long branch is lost near r0 = %g m", lost_m);
        return -1;
    }
    const enum orbit_status prepared = problem_prepare(problem, &scratch);
    if (prepared != ORBIT_OK) {
        explain(prepared, &scratch, "cannot start", text);
        return -1;
    }
    return 0;
}

int afo_fixed_point(const struct afo_walker *walker, double r0_m, int branch, int period, double kp,
                    const double *guess, struct afo_gait *gait, char *text)
{
    struct problem problem;
    struct orbit orbit;
    double x[3];
    memset(&orbit, 0, sizeof orbit);
    if (period < 1 || period > ORBIT_MAX_PERIOD) {
        snprintf(text, AFO_TEXT, "period must be 1 to %d strides, not %d", ORBIT_MAX_PERIOD,
                 period);
        return -1;
    }
    if (prepare(walker, r0_m, branch, kp, &problem, x, text) != 0) {
        return -1;
    }
    if (guess != NULL) {
        problem.period = period;
        memcpy(orbit.x, guess, sizeof orbit.x);
        const enum orbit_status found = orbit_find(&problem, &orbit);
        if (found != ORBIT_OK) {
            explain(found, &orbit, "no fixed point from this guess", text);
            return -1;
        }
    } else if (period == 1 && branch == AFO_BRANCH_SHORT && kp != 0.0) {
        snprintf(
            text, AFO_TEXT,
            "under the law the short branch's gaits are not where they are without it; give a guess");
        return -1;
    } else if (!periodic_find(&problem, x, period, &orbit)) {
        snprintf(
            text, AFO_TEXT,
            "no walk of period %d found at r0 = %g m; try another r0, or a guess for Newton to start from",
            period, r0_m);
        return -1;
    }
    write_gait(&problem, &orbit, gait);
    return 0;
}

/* Follows the branch to one more r0. 0, or -1 when it is lost. */
static int follow(const struct walker_params *p, double r0_m, double kp, struct branch_gait *at,
                  struct afo_gait *gait)
{
    const double l = p->leg_length_m, unit_s = real_sqrt(l / p->gravity_m_s2);
    struct problem problem = {.params = *p, .r0_m = r0_m, .kp = kp, .period = 1};
    struct orbit orbit;
    memset(&orbit, 0, sizeof orbit);
    if (!branch_follow(at, at->mass_ratio, at->stiffness, r0_m / l)) {
        return -1;
    }
    for (int k = 0; k < 3; k++) {
        orbit.x[k] = problem.reference_x[k] = at->x[k] / (k == 1 ? 1.0 : unit_s);
    }
    if (problem_prepare(&problem, &orbit) != ORBIT_OK) {
        return -1;
    }
    for (int k = 0; k < 3; k++) {
        orbit.x[k] = at->x[k] / (k == 1 ? 1.0 : unit_s);
    }
    if (orbit_find(&problem, &orbit) != ORBIT_OK) {
        return -1;
    }
    write_gait(&problem, &orbit, gait);
    return 0;
}

size_t afo_branch(const struct afo_walker *walker, int branch, const double *r0_m, size_t count,
                  double kp, struct afo_gait *gaits, char *text)
{
    if (afo_walker_check(walker, text) != 0) {
        return 0;
    }
    if (branch == AFO_BRANCH_SHORT && kp != 0.0) {
        snprintf(text, AFO_TEXT,
                 "eq. (16) keeps the long branch's gaits where they are; take kp = 0 "
                 "for the short one");
        return 0;
    }
    const struct walker_params params = params_of(walker);
    struct branch_gait at = branch_start((enum branch)branch);
    const double stiffness = walker->k * walker->l / (walker->M * walker->g);
    if (!branch_follow(&at, walker->m / walker->M, stiffness, at.r0)) {
        snprintf(
            text, AFO_TEXT,
            "the %s branch could not be followed from the paper's walker to this one: it is lost at "
            "m/M = %g, k l/(M g) = %g",
            branch_name(branch), at.mass_ratio, at.stiffness);
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        if (check(walker, r0_m[i], text) != 0) {
            return i;
        }
        if (follow(&params, r0_m[i], kp, &at, &gaits[i]) != 0) {
            snprintf(text, AFO_TEXT, "the %s branch is lost before r0 = %g m, near %g m",
                     branch_name(branch), r0_m[i], at.r0 * walker->l);
            return i;
        }
    }
    return count;
}

/* ---- basins -------------------------------------------------------------------------- */

enum { PORTION = 256 };

struct basin {
    const struct problem *problem;
    const double *gait, *x;
    size_t count;
    int strides;
    int8_t *outcome;
    int32_t *taken;
};

struct portion {
    struct basin_start start[PORTION];
    struct basin_end end[PORTION];
};

static int try_portion(void *context, size_t number)
{
    const struct basin *basin = context;
    const size_t first = number * PORTION;
    const size_t end = first + PORTION < basin->count ? first + PORTION : basin->count;
    const size_t count = end - first;
    struct portion *portion = calloc(1, sizeof *portion);
    if (portion == NULL) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        portion->start[i].problem = basin->problem;
        portion->start[i].gait = basin->gait;
        memcpy(portion->start[i].x, &basin->x[3 * (first + i)], sizeof portion->start[i].x);
    }
    const int status = basin_walks(portion->start, count, basin->strides, portion->end);
    for (size_t i = 0; status == 0 && i < count; i++) {
        basin->outcome[first + i] = (int8_t)portion->end[i].outcome;
        basin->taken[first + i] = portion->end[i].strides;
    }
    free(portion);
    return status;
}

int afo_basin(const struct afo_walker *walker, double r0_m, double kp, size_t count,
              const double *x, int strides, int threads, int8_t *outcome, int32_t *strides_taken,
              char *text)
{
    struct problem problem;
    double gait[3];
    if (prepare(walker, r0_m, AFO_BRANCH_LONG, kp, &problem, gait, text) != 0) {
        return -1;
    }
    struct basin basin = {&problem, gait, x, count, strides, outcome, strides_taken};
    if (parallel_for(threads, (count + PORTION - 1) / PORTION, try_portion, &basin) != 0) {
        snprintf(text, AFO_TEXT, "out of memory: try fewer starts at a time");
        return -1;
    }
    return 0;
}
