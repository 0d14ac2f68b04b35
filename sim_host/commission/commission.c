#include "sim_host/commission/commission.h"

#include <string.h>

#include "sim_host/commission/commission_internal.h"
#include "sim_host/text/nearest.h"

struct step_row {
    const char *name;
    unsigned needs;
    const char *shows;
    commission_run_step run;
};

#define STEP_RUN_IDENTIFY commission_identify
#define STEP_RUN_REST commission_rest
#define STEP_RUN_MOVES commission_moves
#define STEP_RUN_ZERO commission_zero
#define STEP_RUN_SENSORS commission_sensors
#define STEP_RUN_LATCH commission_latch
#define STEP_RUN_SPRING commission_spring
#define STEP_RUN_BANDWIDTH commission_bandwidth
#define STEP_RUN_LINK commission_link
#define STEP_RUN_STOP commission_stop
#define STEP_RUN_SWITCHES commission_switches
#define STEP_ROW(id, name, needs, shows) {name, needs, shows, STEP_RUN_##id},
static const struct step_row steps[COMMISSION_STEPS] = {COMMISSION_STEPS_TABLE(STEP_ROW)};
#undef STEP_ROW

void commission_declare(struct commission *commission, const struct device_file *device)
{
    commission->declared = commission->device = *device;
    memset(commission->result, 0, sizeof commission->result);
}

const char *commission_step_name(enum commission_step step)
{
    return steps[step].name;
}

const char *commission_step_shows(enum commission_step step)
{
    return steps[step].shows;
}

const char *commission_verdict_name(enum commission_verdict verdict)
{
    static const char *const names[] = {"not done", "passed",      "failed",
                                        "skipped",  "interrupted", "no such part"};
    return (unsigned)verdict < sizeof names / sizeof names[0] ? names[verdict] : "unknown";
}

int commission_step_named(const char *name, char *message)
{
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        if (strcmp(steps[step].name, name) == 0) {
            return step;
        }
    }
    nearest_refuse(name, steps, COMMISSION_STEPS, sizeof steps[0], message, OBJECT_MESSAGE_MAX);
    return -1;
}

static bool is_settled(const struct commission *commission, int step)
{
    const enum commission_verdict verdict = commission->result[step].verdict;
    return verdict == COMMISSION_PASSED || verdict == COMMISSION_SKIPPED ||
           verdict == COMMISSION_NO_PART;
}

int commission_missing(const struct commission *commission, enum commission_step step)
{
    for (int other = 0; other < COMMISSION_STEPS; other++) {
        if ((steps[step].needs >> other & 1u) != 0 && !is_settled(commission, other)) {
            return other;
        }
    }
    return -1;
}

static void tell(const struct commission *commission, enum commission_step step)
{
    const struct commission_result *result = &commission->result[step];
    FILE *out = commission->ctl.out;
    fprintf(out, "%-10s %s\n", steps[step].name, commission_verdict_name(result->verdict));
    if (result->done[0] != '\0') {
        fprintf(out, "           %s\n", result->done);
    }
    for (unsigned i = 0; i < result->finding_count; i++) {
        fprintf(out, "           FOUND: %s\n", result->finding[i]);
    }
    if (result->reason[0] != '\0') {
        fprintf(out, "           %s\n", result->reason);
    }
    fflush(out);
}

/* Motions are for a device that nobody walks with. */
static int refuse_walk(struct commission *commission, struct commission_result *result)
{
    double walk;
    if (commission_get(commission, result, "commands.walk_requested", &walk) != 0) {
        return -1;
    }
    return walk == 0.0 ? 0 : commission_break(result, "a walk is requested: `afo ctl stop' first");
}

/* What the loads are shares of. */
static int read_limits(struct commission *commission, struct commission_result *result)
{
    return commission_get(commission, result, "parameters.spring_stiffness_n_m",
                          &commission->stiffness_N_m) != 0 ||
                   commission_get(commission, result, "parameters.r0_max_m",
                                  &commission->largest_m) != 0 ||
                   commission_get(commission, result, "parameters.sea_tolerance_m",
                                  &commission->tolerance_m) != 0
               ? -1
               : 0;
}

enum commission_verdict commission_run(struct commission *commission, enum commission_step step)
{
    struct commission_result *result = &commission->result[step];
    const int missing = commission_missing(commission, step);
    *result = (struct commission_result){.verdict = COMMISSION_NOT_DONE};
    (void)snprintf(result->when, sizeof result->when, "%s", commission->now);
    int ended = -1;
    if (missing >= 0) {
        (void)commission_break(result, "the step \"%s\" comes first", steps[missing].name);
    } else if (refuse_walk(commission, result) == 0 && read_limits(commission, result) == 0) {
        ended = steps[step].run(commission, result);
    }
    if (result->finding_count > 0) {
        result->verdict = COMMISSION_FAILED;
    } else if (result->verdict == COMMISSION_NOT_DONE) {
        result->verdict = ended == 0 ? COMMISSION_PASSED : COMMISSION_INTERRUPTED;
    }
    tell(commission, step);
    return result->verdict;
}

void commission_skip(struct commission *commission, enum commission_step step, const char *reason)
{
    struct commission_result *result = &commission->result[step];
    *result = (struct commission_result){.verdict = COMMISSION_SKIPPED};
    (void)snprintf(result->when, sizeof result->when, "%s", commission->now);
    (void)snprintf(result->reason, sizeof result->reason, "%s", reason);
    tell(commission, step);
}

bool commission_is_complete(const struct commission *commission)
{
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        if (!is_settled(commission, step)) {
            return false;
        }
    }
    return true;
}
