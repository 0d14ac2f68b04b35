/* One motion: ordered, kept alive, watched, and taken back. */
#include <math.h>
#include <string.h>

#include "sim_host/cli/host_report.h"
#include "sim_host/commission/commission_internal.h"

enum { LOOKS_MAX = 20000, LOOK_MS = 1, TRIALS = 5 };
/* Samples below this part of the way are friction's. */
#define FIT_FROM 0.15

/* Sums of the fit of F = k x + c d, d = 1 loading, -1 unloading. */
struct fit {
    double xx, xd, dd, xF, dF;
    unsigned count;
    double last_number;
    double limit_m;
};

static int look_at_force(struct commission *commission, struct commission_result *result,
                         const struct commission_motion *motion, unsigned phase, struct fit *fit)
{
    double number, force_N, motor_m;
    if (commission_get_leg(commission, result, "force_samples", motion->leg, "sample_number",
                           &number) != 0) {
        return -1;
    }
    if (number == fit->last_number) {
        return 0;
    }
    fit->last_number = number;
    if (commission_get_leg(commission, result, "force_samples", motion->leg, "force", &force_N) !=
            0 ||
        commission_get_leg(commission, result, "force_samples", motion->leg, "motor_then",
                           &motor_m) != 0) {
        return -1;
    }
    if (motor_m > fit->limit_m && (phase == MOTION_LOADS || phase == MOTION_RETURNS)) {
        const double d = phase == MOTION_LOADS ? 1.0 : -1.0;
        fit->xx += motor_m * motor_m;
        fit->xd += motor_m * d;
        fit->dd += 1.0;
        fit->xF += motor_m * force_N;
        fit->dF += d * force_N;
        fit->count++;
    }
    return 0;
}

static void solve(const struct fit *fit, struct commission_motion_report *report)
{
    const double determinant = fit->xx * fit->dd - fit->xd * fit->xd;
    report->samples = fit->count;
    if (fit->count >= 4 && determinant > 1e-12 * fit->xx * fit->dd) {
        report->stiffness_N_m = (fit->xF * fit->dd - fit->dF * fit->xd) / determinant;
        report->friction_N = (fit->xx * fit->dF - fit->xd * fit->xF) / determinant;
    }
}

/* Motors and ankles: where they are while it is held, and how far they went. */
static int look_at_legs(struct commission *commission, struct commission_result *result,
                        const struct commission_motion *motion, unsigned phase, double other_m,
                        struct commission_motion_report *report)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        double motor_m, ankle_m;
        if (commission_get_leg(commission, result, "measured", (enum side)leg, "motor", &motor_m) !=
                0 ||
            commission_get_leg(commission, result, "measured", (enum side)leg, "ankle", &ankle_m) !=
                0) {
            return -1;
        }
        report->least_ankle_m[leg] = fmin(report->least_ankle_m[leg], ankle_m);
        report->greatest_ankle_m[leg] = fmax(report->greatest_ankle_m[leg], ankle_m);
        if (leg != (int)motion->leg) {
            report->largest_other_m = fmax(report->largest_other_m, fabs(motor_m - other_m));
        }
        if (phase == MOTION_HOLDS) {
            report->motor_m[leg] = motor_m;
            report->ankle_m[leg] = ankle_m;
            report->held = true;
        }
    }
    return 0;
}

static int look_at_latch(struct commission *commission, struct commission_result *result,
                         const struct commission_motion *motion, unsigned phase,
                         struct commission_motion_report *report)
{
    double latch;
    if (commission_get_leg(commission, result, "measured", motion->leg, "latch", &latch) != 0) {
        return -1;
    }
    if (phase == MOTION_LOADS) {
        report->latch_closed_before = latch == (double)LATCH_CLOSED;
    }
    report->latch_opened = report->latch_opened || latch == (double)LATCH_OPEN;
    return 0;
}

static int read_end(struct commission *commission, struct commission_result *result,
                    struct commission_motion_report *report)
{
    double outcome, release_s, unload_s, fault;
    if (commission_get(commission, result, "commissioning.outcome", &outcome) != 0 ||
        commission_get(commission, result, "commissioning.bandwidth", &report->bandwidth_Hz) != 0 ||
        commission_get(commission, result, "commissioning.frequency_reached",
                       &report->last_frequency_Hz) != 0 ||
        commission_get(commission, result, "commissioning.time_to_the_release", &release_s) != 0 ||
        commission_get(commission, result, "commissioning.time_to_unload_by_itself", &unload_s) !=
            0 ||
        commission_get(commission, result, "state.latched_fault", &fault) != 0) {
        return -1;
    }
    report->outcome = (enum motion_outcome)(unsigned)outcome;
    report->fault = (enum supervisor_fault)(unsigned)fault;
    report->release_ms = (unsigned)lround(1000.0 * release_s);
    report->unload_ms = (unsigned)lround(1000.0 * unload_s);
    return 0;
}

static int give_order(struct commission *commission, struct commission_result *result,
                      const struct commission_motion *motion, double *order)
{
    if (commission_get(commission, result, "commissioning.order", order) != 0 ||
        commission_get(commission, result, "commissioning.renewal", &commission->renewal) != 0) {
        return -1;
    }
    *order = fmod(*order + 1.0, 256.0);
    const double frequency_Hz = motion->frequency_Hz > 0.0 ? motion->frequency_Hz : 1.0;
    return commission_set(commission, result, "commissioning.leg", motion->leg) != 0 ||
                   commission_set(commission, result, "commissioning.share_of_the_largest_load",
                                  motion->share) != 0 ||
                   commission_set(commission, result, "commissioning.time", motion->seconds) != 0 ||
                   commission_set(commission, result, "commissioning.highest_frequency",
                                  frequency_Hz) != 0 ||
                   commission_set(commission, result, "commissioning.kind", motion->kind) != 0 ||
                   commission_set(commission, result, "commissioning.order", *order) != 0
               ? -1
               : 0;
}

/* A sign of life: whatever else is asked meanwhile, two of them are never half a second apart. */
static int renew(struct commission *commission, struct commission_result *result)
{
    commission->renewal = fmod(commission->renewal + 1.0, 256.0);
    return commission_set(commission, result, "commissioning.renewal", commission->renewal);
}

/* One look. Returns 1 when the motion is over, 0 when it goes on, -1 when that cannot be told. */
static int look(struct commission *commission, struct commission_result *result,
                const struct commission_motion *motion, double order, double other_m,
                struct fit *fit, struct commission_motion_report *report)
{
    double phase, of_order, outcome, state;
    if (commission_get(commission, result, "commissioning.phase", &phase) != 0 ||
        commission_get(commission, result, "commissioning.outcome_of_this_order", &of_order) != 0 ||
        commission_get(commission, result, "commissioning.outcome", &outcome) != 0 ||
        commission_get(commission, result, "state.supervisor_state_and_emergency_stop", &state) !=
            0) {
        return -1;
    }
    if (renew(commission, result) != 0 ||
        look_at_force(commission, result, motion, (unsigned)phase, fit) != 0 ||
        look_at_legs(commission, result, motion, (unsigned)phase, other_m, report) != 0 ||
        look_at_latch(commission, result, motion, (unsigned)phase, report) != 0) {
        return -1;
    }
    if (renew(commission, result) != 0) {
        return -1;
    }
    const bool ended = of_order == order && phase == (double)MOTION_IDLE && outcome != 0.0;
    return ended || ((unsigned)state & 0x3Fu) == SUPERVISOR_FAULT ? 1 : 0;
}

static int perform_once(struct commission *commission, struct commission_result *result,
                        const struct commission_motion *motion,
                        struct commission_motion_report *report)
{
    struct fit fit = {.last_number = -1.0,
                      .limit_m = FIT_FROM * motion->share * commission->largest_m};
    double order, other_m;
    int over = 0;
    memset(report, 0, sizeof *report);
    report->release_ms = report->unload_ms = 65535;
    if (commission_reach_standby(commission, result) != 0 ||
        commission_get_leg(commission, result, "measured", (enum side)(1 - (int)motion->leg),
                           "motor", &other_m) != 0 ||
        give_order(commission, result, motion, &order) != 0) {
        return -1;
    }
    for (int n = 0; over == 0 && n < LOOKS_MAX; n++) {
        /* Where the line breaks off, the controller unloads by itself. */
        over = renew(commission, result) != 0
                   ? -1
                   : look(commission, result, motion, order, other_m, &fit, report);
        if (over == 0 && !commission_wait(commission, LOOK_MS)) {
            over = commission_break(result, "interrupted; the controller unloads");
        }
    }
    solve(&fit, report);
    /* However it ended: nothing is asked for any more. */
    const int taken_back = commission_set(commission, result, "commissioning.kind", 0.0);
    if (over < 0 || taken_back != 0) {
        return -1;
    }
    return read_end(commission, result, report);
}

/* A computer that was busy was too late with its signs of life, or did not look while the motor was there:
 * that says nothing of the device, and the springs are slack. */
static bool was_too_slow(const struct commission_motion *motion,
                         const struct commission_motion_report *report)
{
    return (report->outcome == MOTION_INTERRUPTED && report->fault == SUPERVISOR_FAULT_NONE) ||
           (report->outcome == MOTION_DONE && motion->kind == MOTION_KIND_MOVE && !report->held);
}

int commission_perform(struct commission *commission, struct commission_result *result,
                       const struct commission_motion *motion,
                       struct commission_motion_report *report)
{
    for (int trial = 0; trial < TRIALS; trial++) {
        if (perform_once(commission, result, motion, report) != 0) {
            return -1;
        }
        if (!was_too_slow(motion, report)) {
            break;
        }
    }
    return 0;
}

bool commission_was_done(struct commission_result *result, const struct commission_motion *motion,
                         const struct commission_motion_report *report)
{
    const char *leg = commission_leg((int)motion->leg);
    switch (report->outcome) {
    case MOTION_DONE:
        if (report->fault != SUPERVISOR_FAULT_NONE && motion->kind != MOTION_KIND_CUT) {
            commission_find(result, "%s leg: the controller stopped with \"%s\"", leg,
                            supervisor_fault_name(report->fault));
            return false;
        }
        return true;
    case MOTION_BEYOND:
        commission_find(result,
                        "%s leg: more force or more way than %.0f %% of the largest load should "
                        "take; look at torque constant, gear and counts_per_m",
                        leg, 100.0 * motion->share);
        return false;
    case MOTION_NOT_REACHED:
        commission_find(
            result,
            "%s leg: the motor did not come to where it was sent (%.1f %% of the largest "
            "load); look at direction, mode, limits, and whether it is blocked",
            leg, 100.0 * motion->share);
        return false;
    case MOTION_REFUSED:
        commission_find(
            result,
            "%s leg: the controller allows no such load yet (%.0f %%); the smaller ones "
            "come first",
            leg, 100.0 * motion->share);
        return false;
    default:
        if (report->fault == SUPERVISOR_FAULT_NONE) {
            commission_find(result,
                            "%s leg: the controller lost this program and unloaded; its "
                            "requests must come twice a second of the controller's time",
                            leg);
            return false;
        }
        commission_find(result, "%s leg: interrupted by \"%s\"", leg,
                        supervisor_fault_name(report->fault));
        return false;
    }
}
