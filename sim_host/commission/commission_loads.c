/* Steps that move a motor. Loads: at most 4 % of the largest in `moves`, 3 % in `latch`, 15 % in `spring`. */
#include <math.h>

#include "sim_host/commission/commission_internal.h"

/* Shares of the largest load (spring_stiffness_n_m times r0_max_m), and times. */
#define FIRST_MOVE_M 0.002
#define FIRST_SHARE_MOST 0.02
#define SMALL_SHARE 0.04
#define LATCH_SHARE 0.03
#define SPRING_SHARE 0.15
#define CHIRP_SHARE 0.02
/* None of them beyond this part of the drive's rated force, where that is declared: with a spring that is a tenth
 * stronger than declared it stays below 0.2. */
#define RATED_PART 0.17
/* What is still right: of a way, of the other motor's, of the spring constant coarse and fine. */
#define WAY_PART 0.1
#define OTHER_WAY_PART 0.2
#define COARSE_PART 0.4
#define FINE_PART 0.15
/* More force over way is more energy: 8 % is what a person's push may have above its prescription, in loads that
 * go both ways, so that friction cancels. A motor's scale of 0.9 reads 1.11. */
#define FINE_PART_ABOVE 0.08
/* A drive must follow at least this: a push-off's reference has its power below. */
#define BANDWIDTH_LEAST_HZ 5.0
#define UNLOAD_MOST_MS 400u
#define ARMED_S 10.0

/* ---- rest ------------------------------------------------------------------------------- */

int commission_rest(struct commission *commission, struct commission_result *result)
{
    double motor_m;
    /* A motor that is not at zero keeps the controller in its self test: that is the finding, too. */
    const int standby = commission_reach_standby(commission, result);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (!commission_is_driven(commission, leg)) {
            commission_note(result, "%s leg: no drive.", commission_leg(leg));
            continue;
        }
        if (commission_get_leg(commission, result, "measured", (enum side)leg, "motor", &motor_m) !=
            0) {
            return -1;
        }
        commission_note(result, "%s motor at %.2f mm.", commission_leg(leg), 1000.0 * motor_m);
        if (!(fabs(motor_m) <= commission->tolerance_m)) {
            commission_find(result,
                            "%s motor: %.2f mm where the unloaded spring is 0; the encoder has "
                            "slipped, or zero_counts is wrong",
                            commission_leg(leg), 1000.0 * motor_m);
        }
    }
    return result->finding_count > 0 ? 0 : standby;
}

/* ---- moves -------------------------------------------------------------------------------- */

static void judge_way(struct commission_result *result, const struct commission_motion *motion,
                      const struct commission_motion_report *report, double way_m)
{
    const char *leg = commission_leg((int)motion->leg);
    const double moved_m = report->motor_m[motion->leg];
    if (!report->held) {
        commission_find(result, "%s motor: it was not seen where it was sent", leg);
        return;
    }
    commission_note(result, "%s motor: sent to %.2f mm, read %.2f mm.", leg, 1000.0 * way_m,
                    1000.0 * moved_m);
    if (!(fabs(moved_m - way_m) <= WAY_PART * way_m)) {
        commission_find(result, "%s motor: %.2f mm where it was sent to %.2f mm", leg,
                        1000.0 * moved_m, 1000.0 * way_m);
    }
    if (report->largest_other_m > OTHER_WAY_PART * way_m) {
        commission_find(result,
                        "%s motor: the other leg's encoder followed by %.2f mm; wires are "
                        "crossed",
                        leg, 1000.0 * report->largest_other_m);
    }
}

/* The declared spring decides what the force must be: twice of it is a torque constant or a gear. */
static void judge_stiffness(const struct commission *commission, struct commission_result *result,
                            int leg, const struct commission_motion_report *report, double part)
{
    const struct device_leg *declared = &commission->device.description.leg[leg];
    const bool tells = declared->protocol == DEVICE_CIA402 && declared->rated_force_N != 0.0f &&
                       !device_leg_lacks(declared, DEVICE_LACKS_TORQUE);
    if (!tells) {
        commission_note(result,
                        "%s leg: the drive tells no force: torque constant, gear and spring are "
                        "not shown.",
                        commission_leg(leg));
        return;
    }
    if (report->samples < 4) {
        commission_find(result, "%s leg: the drive tells its force too seldom (%u samples)",
                        commission_leg(leg), report->samples);
        return;
    }
    commission_note(result, "%s leg: %.4g N/m, friction %.2g N.", commission_leg(leg),
                    report->stiffness_N_m, report->friction_N);
    const double off_N_m = report->stiffness_N_m - commission->stiffness_N_m;
    const double above = part < COARSE_PART ? FINE_PART_ABOVE : part;
    if (!(off_N_m >= -part * commission->stiffness_N_m &&
          off_N_m <= above * commission->stiffness_N_m)) {
        commission_find(result,
                        "%s leg: force over way is %.4g N/m where the spring has %.4g; look at the "
                        "torque constant (rated_force_N), the gear (counts_per_m), and the spring",
                        commission_leg(leg), report->stiffness_N_m, commission->stiffness_N_m);
    }
}

/* First 2 mm, and a person says which leg it was; then a little more, for the force. */
static int move_one(struct commission *commission, struct commission_result *result, enum side leg)
{
    struct commission_motion_report report;
    const double first = fmin(FIRST_MOVE_M / commission->largest_m, FIRST_SHARE_MOST);
    struct commission_motion motion = {MOTION_KIND_MOVE, leg, first, 1.0, 0.0};
    if (commission_perform(commission, result, &motion, &report) != 0) {
        return -1;
    }
    if (!commission_was_done(result, &motion, &report)) {
        return 0;
    }
    judge_way(result, &motion, &report, first * commission->largest_m);
    int confirmed;
    if (commission_confirm(commission, result, leg,
                           leg == SIDE_LEFT
                               ? "Was it the LEFT motor that moved, towards more load, and back?"
                               : "Was it the RIGHT motor that moved, towards more load, and back?",
                           &confirmed) != 0) {
        return -1;
    }
    if (confirmed != 1) {
        commission_find(result,
                        confirmed == 0
                            ? "%s leg: another motor moved, or the wrong way; the drives' sides "
                              "are exchanged (drive_node), or direction is the other one"
                            : "%s leg: nobody confirmed which motor moved",
                        commission_leg((int)leg));
        return 0;
    }
    motion.share = SMALL_SHARE;
    motion.seconds = 2.0;
    if (commission_perform(commission, result, &motion, &report) != 0) {
        return -1;
    }
    if (commission_was_done(result, &motion, &report)) {
        judge_way(result, &motion, &report, motion.share * commission->largest_m);
        judge_stiffness(commission, result, (int)leg, &report, COARSE_PART);
    }
    return 0;
}

int commission_moves(struct commission *commission, struct commission_result *result)
{
    for (int leg = 0; leg < SIDE_COUNT && result->finding_count == 0; leg++) {
        if (commission_is_driven(commission, leg) &&
            move_one(commission, result, (enum side)leg) != 0) {
            return -1;
        }
    }
    return 0;
}

/* ---- latch ---------------------------------------------------------------------------------- */

static int release_one(struct commission *commission, struct commission_result *result,
                       enum side leg)
{
    const struct commission_motion motion = {MOTION_KIND_RELEASE, leg, LATCH_SHARE, ARMED_S, 0.0};
    struct commission_motion_report report;
    const enum side other = leg == SIDE_LEFT ? SIDE_RIGHT : SIDE_LEFT;
    const char *name = commission_leg((int)leg);
    commission->person.instruct(commission->person.context, COMMISSION_HAND_TAP, other,
                                other == SIDE_LEFT ? "tap the LEFT foot switch again and again"
                                                   : "tap the RIGHT foot switch again and again");
    const int done = commission_perform(commission, result, &motion, &report);
    commission->person.instruct(commission->person.context, COMMISSION_HAND_NOTHING, other, "");
    if (done != 0) {
        return -1;
    }
    if (!commission_was_done(result, &motion, &report)) {
        return 0;
    }
    if (!report.latch_closed_before) {
        commission_find(result, "%s latch: it does not report that it holds under load", name);
    }
    if (report.release_ms == 65535) {
        commission_find(result,
                        "%s latch: armed for %.0f s, the other foot was tapped, and its bit never "
                        "changed; it is stuck, or latch_bit or latch_object is another one",
                        name, ARMED_S);
        return 0;
    }
    commission_note(result, "%s latch: holds, opened %u ms after it was armed.", name,
                    report.release_ms);
    double latch;
    if (!commission_wait(commission, 500)) {
        return commission_break(result, "interrupted");
    }
    if (commission_get_leg(commission, result, "measured", leg, "latch", &latch) != 0) {
        return -1;
    }
    if (latch != (double)LATCH_CLOSED) {
        commission_find(result, "%s latch: it did not close again at the unloaded spring", name);
    }
    return 0;
}

int commission_latch(struct commission *commission, struct commission_result *result)
{
    unsigned latches = 0;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (!commission_is_driven(commission, leg)) {
            continue;
        }
        if (!device_leg_reports_latch(&commission->device.description.leg[leg])) {
            commission_note(result, "%s leg: no latch that reports; for the bench only.",
                            commission_leg(leg));
            continue;
        }
        latches++;
        if (release_one(commission, result, (enum side)leg) != 0) {
            return -1;
        }
    }
    if (latches == 0) {
        result->verdict = COMMISSION_NO_PART;
        return commission_break(result, "no latch that reports that it is closed");
    }
    return 0;
}

/* ---- spring, bandwidth ------------------------------------------------------------------------ */

static double spring_share(const struct commission *commission, int leg)
{
    const double rated_N = (double)commission->device.description.leg[leg].rated_force_N;
    const double most = RATED_PART * rated_N / (commission->stiffness_N_m * commission->largest_m);
    return rated_N > 0.0 ? fmin(SPRING_SHARE, most) : SPRING_SHARE;
}

int commission_spring(struct commission *commission, struct commission_result *result)
{
    for (int leg = 0; leg < SIDE_COUNT && result->finding_count == 0; leg++) {
        const struct commission_motion motion = {MOTION_KIND_MOVE, (enum side)leg,
                                                 spring_share(commission, leg), 3.0, 0.0};
        struct commission_motion_report report;
        if (!commission_is_driven(commission, leg)) {
            continue;
        }
        if (commission_perform(commission, result, &motion, &report) != 0) {
            return -1;
        }
        if (commission_was_done(result, &motion, &report)) {
            judge_way(result, &motion, &report, motion.share * commission->largest_m);
            judge_stiffness(commission, result, leg, &report, FINE_PART);
        }
    }
    return 0;
}

int commission_bandwidth(struct commission *commission, struct commission_result *result)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct commission_motion motion = {MOTION_KIND_CHIRP, (enum side)leg, CHIRP_SHARE,
                                                 5.0, 30.0};
        struct commission_motion_report report;
        if (!commission_is_driven(commission, leg)) {
            continue;
        }
        if (commission_perform(commission, result, &motion, &report) != 0) {
            return -1;
        }
        if (!commission_was_done(result, &motion, &report)) {
            continue;
        }
        const bool is_found = report.bandwidth_Hz > 0.0;
        const double follows_Hz = is_found ? report.bandwidth_Hz : report.last_frequency_Hz;
        commission_note(result, "%s motor: %s%.1f Hz.", commission_leg(leg),
                        is_found ? "bandwidth " : "follows beyond ", follows_Hz);
        if (!(follows_Hz >= BANDWIDTH_LEAST_HZ)) {
            commission_find(result, "%s motor: it follows %.1f Hz only, and needs %.0f Hz",
                            commission_leg(leg), follows_Hz, BANDWIDTH_LEAST_HZ);
        }
    }
    return 0;
}

/* ---- the lost link --------------------------------------------------------------------------- */

/* At 10, 50 and 100 % of what is prescribed; no further where the drive has failed. */
static int cut_one(struct commission *commission, struct commission_result *result, enum side leg,
                   double prescribed_m)
{
    static const double parts[] = {0.1, 0.5, 1.0};
    const char *name = commission_leg((int)leg);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const struct commission_motion motion = {
            MOTION_KIND_CUT, leg, parts[i] * prescribed_m / commission->largest_m, 0.5, 0.0};
        struct commission_motion_report report;
        if (commission_perform(commission, result, &motion, &report) != 0) {
            return -1;
        }
        if (!commission_was_done(result, &motion, &report)) {
            return 0;
        }
        if (report.unload_ms > UNLOAD_MOST_MS) {
            commission_find(result,
                            "%s drive: at %.0f %% of the prescribed load it did not unload within "
                            "%u ms of the lost link; unload = drive does not hold for it",
                            name, 100.0 * parts[i], UNLOAD_MOST_MS);
            device_file_set(&commission->device, leg, DEVICE_LEG_unload, DEVICE_UNLOAD_NONE);
            return 0;
        }
        commission_note(result, "%s drive: at %.0f %% unloaded in %u ms.", name, 100.0 * parts[i],
                        report.unload_ms);
    }
    device_file_set(&commission->device, leg, DEVICE_LEG_unload, DEVICE_UNLOAD_DRIVE);
    return 0;
}

/* Whose only answer to a lost link is no torque: that is no unload, and without a target nothing tells of it. */
static void judge_without_cut(struct commission *commission, struct commission_result *result,
                              enum side leg)
{
    const char *name = commission_leg((int)leg);
    if (commission->declared.description.leg[leg].unload == DEVICE_UNLOAD_DRIVE) {
        commission_find(result,
                        "%s drive: its protocol ends a lost link with no torque, which lets a "
                        "loaded spring go; unload = drive does not hold for it",
                        name);
    }
    commission_note(result, "%s drive: nothing unloads its spring when the link is lost.", name);
    device_file_set(&commission->device, leg, DEVICE_LEG_unload, DEVICE_UNLOAD_NONE);
}

int commission_link(struct commission *commission, struct commission_result *result)
{
    double prescribed_m;
    if (commission_get(commission, result, "parameters.start_r0_m", &prescribed_m) != 0) {
        return -1;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const int declared = commission->declared.description.leg[leg].unload;
        if (!commission_is_driven(commission, leg)) {
            continue;
        }
        if (declared == DEVICE_UNLOAD_LATCH || declared == DEVICE_UNLOAD_HARDWARE) {
            commission_note(result, "%s leg: declared to be safe by %s; not shown here.",
                            commission_leg(leg),
                            declared == DEVICE_UNLOAD_LATCH ? "its latch" : "hardware");
        } else if (commission->device.description.leg[leg].protocol != DEVICE_CIA402) {
            judge_without_cut(commission, result, (enum side)leg);
        } else if (cut_one(commission, result, (enum side)leg, prescribed_m) != 0) {
            return -1;
        }
    }
    return commission_reach_standby(commission, result);
}
