/* Steps that a person's hands take part in: zero, sensors, emergency stop, foot switches. No motor moves. */
#include <math.h>

#include "controller/screening/zeroing.h"
#include "sim_host/commission/commission_internal.h"

enum { LOOK_MS = 20, PATIENCE_MS = 30000, SETTLE_MS = 200, UNLOAD_MS = 1000 };
/* What is a swing of a leg, and how little the other one may do meanwhile. */
#define SWING_RAD 0.10
#define OTHER_PART 0.5

static void instruct(struct commission *commission, enum commission_hand hand, enum side leg,
                     const char *words)
{
    commission->person.instruct(commission->person.context, hand, leg, words);
}

/* What a leg's sensor reads upright, into the device file for the next set-up. Until then the controller's
 * parameters hold it: what was declared is what it counts from, also when the step is repeated. */
static void put_zeros_into_file(struct commission *commission, enum side leg, double angle_rad,
                                double ankle_m)
{
    const struct device_file *declared = &commission->declared;
    struct device_file *device = &commission->device;
    const struct device_leg *own = &declared->description.leg[leg];
    const double zero_rad = device_file_number(declared, leg, DEVICE_LEG_leg_zero_rad);
    const double zero_m = device_file_number(declared, leg, DEVICE_LEG_ankle_zero_m);
    device_file_set(device, leg, DEVICE_LEG_leg_zero_rad,
                    zero_rad + (own->leg_direction < 0 ? -angle_rad : angle_rad));
    if (own->ankle == DEVICE_ANKLE_LINEAR) {
        device_file_set(device, leg, DEVICE_LEG_ankle_zero_m,
                        zero_m + (own->ankle_direction < 0 ? -ankle_m : ankle_m));
    }
}

/* ---- zero ------------------------------------------------------------------------------ */

int commission_zero(struct commission *commission, struct commission_result *result)
{
    static const char *const names[] = {
        "parameters.angle_zero_left_rad", "parameters.angle_zero_right_rad",
        "parameters.ankle_zero_left_m", "parameters.ankle_zero_right_m"};
    double zeroing = ZEROING_RUNNING, found[4] = {0.0};
    if (commission_reach_standby(commission, result) != 0) {
        return -1;
    }
    instruct(commission, COMMISSION_HAND_STAND, SIDE_LEFT,
             "stand upright and still for 4 s, feet side by side");
    if (commission_set(commission, result, "commands.zero_the_leg_sensors", 1.0) != 0) {
        return -1;
    }
    for (unsigned waited = 0; zeroing == ZEROING_RUNNING && waited < PATIENCE_MS;
         waited += LOOK_MS) {
        if (!commission_wait(commission, LOOK_MS)) {
            return commission_break(result, "interrupted");
        }
        if (commission_get(commission, result, "state.zeroing", &zeroing) != 0) {
            return -1;
        }
    }
    instruct(commission, COMMISSION_HAND_NOTHING, SIDE_LEFT, "");
    if (zeroing == ZEROING_MOVED) {
        commission_find(result, "the legs moved: repeat the step and stand still");
    } else if (zeroing == ZEROING_TOO_FAR) {
        commission_find(result,
                        "a sensor is further off than a mounting can be; look at leg_zero_rad, "
                        "leg_direction, ankle_zero_m, and whether left and right are exchanged");
    } else if (zeroing != ZEROING_DONE) {
        commission_find(result, "no zero was found (%.0f)", zeroing);
    }
    if (zeroing != ZEROING_DONE) {
        return 0;
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (commission_get(commission, result, names[i], &found[i]) != 0) {
            return -1;
        }
    }
    put_zeros_into_file(commission, SIDE_LEFT, found[0], found[2]);
    put_zeros_into_file(commission, SIDE_RIGHT, found[1], found[3]);
    commission_note(
        result,
        "Offsets: leg %.4f and %.4f rad, ankle %.5f and %.5f m. The controller has them "
        "in its parameters; the device file has them for its next start.",
        found[0], found[1], found[2], found[3]);
    return 0;
}

/* ---- sensors ---------------------------------------------------------------------------- */

static int read_angles(struct commission *commission, struct commission_result *result,
                       double angle[SIDE_COUNT])
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (commission_get_leg(commission, result, "measured", (enum side)leg, "leg_angle",
                               &angle[leg]) != 0) {
            return -1;
        }
    }
    return 0;
}

/* One leg is swung forward: whose sensor follows, and which way? */
static int swing(struct commission *commission, struct commission_result *result, enum side leg)
{
    double before[SIDE_COUNT], now[SIDE_COUNT], most[SIDE_COUNT] = {0.0};
    const int other = 1 - (int)leg;
    if (read_angles(commission, result, before) != 0) {
        return -1;
    }
    instruct(commission, COMMISSION_HAND_SWING, leg,
             leg == SIDE_LEFT ? "swing the LEFT leg slowly forward, and back"
                              : "swing the RIGHT leg slowly forward, and back");
    for (unsigned waited = 0;
         waited < PATIENCE_MS && fabs(most[0]) < SWING_RAD && fabs(most[1]) < SWING_RAD;
         waited += LOOK_MS) {
        if (!commission_wait(commission, LOOK_MS)) {
            return commission_break(result, "interrupted");
        }
        if (read_angles(commission, result, now) != 0) {
            return -1;
        }
        for (int i = 0; i < SIDE_COUNT; i++) {
            most[i] = fabs(now[i] - before[i]) > fabs(most[i]) ? now[i] - before[i] : most[i];
        }
    }
    instruct(commission, COMMISSION_HAND_NOTHING, leg, "");
    (void)commission_wait(commission, SETTLE_MS);
    commission_note(result, "The %s leg forward: left sensor %+.2f rad, right %+.2f rad.",
                    commission_leg((int)leg), most[SIDE_LEFT], most[SIDE_RIGHT]);
    if (fabs(most[leg]) < SWING_RAD && fabs(most[other]) < SWING_RAD) {
        commission_find(result, "%s leg: no sensor followed its swing", commission_leg((int)leg));
    } else if (fabs(most[other]) > OTHER_PART * fabs(most[leg])) {
        commission_find(result,
                        "%s leg: the sensor of the other leg followed; the sensors' sides are "
                        "exchanged (leg_sensor_node)",
                        commission_leg((int)leg));
    } else if (most[leg] < 0.0) {
        commission_find(result,
                        "%s leg: its angle fell while the foot went ahead; leg_direction is "
                        "the other one",
                        commission_leg((int)leg));
    }
    return 0;
}

int commission_sensors(struct commission *commission, struct commission_result *result)
{
    return swing(commission, result, SIDE_LEFT) != 0 ? -1 : swing(commission, result, SIDE_RIGHT);
}

/* ---- the emergency stop -------------------------------------------------------------------- */

static int wait_for_stop(struct commission *commission, struct commission_result *result,
                         bool pressed, bool *seen)
{
    double state;
    *seen = false;
    for (unsigned waited = 0; !*seen && waited < PATIENCE_MS; waited += LOOK_MS) {
        if (!commission_wait(commission, LOOK_MS)) {
            return commission_break(result, "interrupted");
        }
        if (commission_get(commission, result, "state.supervisor_state_and_emergency_stop",
                           &state) != 0) {
            return -1;
        }
        *seen = (((unsigned)state & 0x80u) != 0) == pressed;
    }
    return 0;
}

int commission_stop(struct commission *commission, struct commission_result *result)
{
    double state, fault;
    bool seen;
    instruct(commission, COMMISSION_HAND_PRESS, SIDE_LEFT, "press the emergency stop");
    if (wait_for_stop(commission, result, true, &seen) != 0) {
        return -1;
    }
    if (!seen) {
        commission_find(result, "the controller does not see the emergency stop; look at its wire");
        instruct(commission, COMMISSION_HAND_NOTHING, SIDE_LEFT, "");
        return 0;
    }
    (void)commission_wait(commission, UNLOAD_MS);
    if (commission_get(commission, result, "state.supervisor_state_and_emergency_stop", &state) !=
            0 ||
        commission_get(commission, result, "state.latched_fault", &fault) != 0) {
        return -1;
    }
    if (((unsigned)state & 0x3Fu) != SUPERVISOR_FAULT ||
        (unsigned)fault != SUPERVISOR_FAULT_EMERGENCY_STOP) {
        commission_find(result, "pressed, and the controller latched no emergency stop");
    }
    int confirmed;
    if (commission_confirm(commission, result, SIDE_LEFT,
                           "Has the power of both drives gone (contactor, lamps)?",
                           &confirmed) != 0) {
        return -1;
    }
    if (confirmed != 1) {
        commission_find(result, confirmed == 0
                                    ? "the power of the drives stays with the stop pressed"
                                    : "nobody confirmed that the power goes");
    }
    instruct(commission, COMMISSION_HAND_RELEASE, SIDE_LEFT, "release the emergency stop");
    if (wait_for_stop(commission, result, false, &seen) != 0) {
        return -1;
    }
    if (!seen) {
        commission_find(result, "the stop stays pressed for the controller after its release");
        return 0;
    }
    commission_note(result, "Pressed and released; both were seen, and it latched.");
    return commission_reach_standby(commission, result);
}

/* ---- foot switches --------------------------------------------------------------------------- */

static int read_feet(struct commission *commission, struct commission_result *result,
                     double foot[SIDE_COUNT])
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (commission_get_leg(commission, result, "measured", (enum side)leg, "foot_switch",
                               &foot[leg]) != 0) {
            return -1;
        }
    }
    return 0;
}

static bool has_switch(const struct commission *commission, int leg)
{
    return commission->device.description.leg[leg].foot_switches != DEVICE_SWITCHES_NONE;
}

/* Waits until the legs' switches read so: `down` is the leg that is pressed, -1 none of them. A switch that
 * the device does not have is not asked. What they read at the end is in foot. */
static int wait_for_feet(struct commission *commission, struct commission_result *result, int down,
                         double foot[SIDE_COUNT])
{
    for (unsigned waited = 0; waited < PATIENCE_MS; waited += LOOK_MS) {
        bool reached = true;
        if (!commission_wait(commission, LOOK_MS)) {
            return commission_break(result, "interrupted");
        }
        if (read_feet(commission, result, foot) != 0) {
            return -1;
        }
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            const double wanted = leg == down ? FOOT_DOWN : FOOT_UP;
            reached = reached && (!has_switch(commission, leg) || foot[leg] == wanted);
        }
        if (reached) {
            return 0;
        }
    }
    return 0;
}

static void judge_free(const struct commission *commission, struct commission_result *result,
                       const double foot[SIDE_COUNT])
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (!has_switch(commission, leg) || foot[leg] == FOOT_UP) {
            continue;
        }
        commission_find(
            result,
            foot[leg] == FOOT_UNKNOWN
                ? "%s leg: its sensor tells nothing of a foot switch; look at foot_switches and "
                  "its wires"
                : "%s leg: its foot switch reads pressed with the foot in the air; it is stuck, or "
                  "wired the other way round",
            commission_leg(leg));
    }
}

/* This foot's switches are pressed: do they follow, and do the other's stay? */
static int press_one(struct commission *commission, struct commission_result *result, enum side leg)
{
    const int other = 1 - (int)leg;
    double foot[SIDE_COUNT];
    instruct(commission, COMMISSION_HAND_SWITCH, leg,
             leg == SIDE_LEFT ? "press the LEFT foot's switches, and hold them"
                              : "press the RIGHT foot's switches, and hold them");
    if (wait_for_feet(commission, result, (int)leg, foot) != 0) {
        return -1;
    }
    if (has_switch(commission, other) && foot[other] == FOOT_DOWN) {
        commission_find(result,
                        "%s foot: the other leg's switch followed; the sensors' sides or the "
                        "switches' wires are exchanged",
                        commission_leg((int)leg));
    } else if (foot[leg] != FOOT_DOWN) {
        commission_find(result, "%s foot: its switches were pressed, and nothing followed",
                        commission_leg((int)leg));
    } else {
        commission_note(result, "%s foot: followed.", commission_leg((int)leg));
    }
    instruct(commission, COMMISSION_HAND_FREE, leg, "let go");
    return result->finding_count > 0 ? 0 : wait_for_feet(commission, result, -1, foot);
}

int commission_switches(struct commission *commission, struct commission_result *result)
{
    double foot[SIDE_COUNT];
    if (!has_switch(commission, SIDE_LEFT) && !has_switch(commission, SIDE_RIGHT)) {
        result->verdict = COMMISSION_NO_PART;
        return commission_break(result, "foot_switches = none on both legs");
    }
    instruct(commission, COMMISSION_HAND_FREE, SIDE_LEFT,
             "lift both feet, so that no foot switch is pressed");
    if (wait_for_feet(commission, result, -1, foot) != 0) {
        return -1;
    }
    judge_free(commission, result, foot);
    for (int leg = 0; leg < SIDE_COUNT && result->finding_count == 0; leg++) {
        if (has_switch(commission, leg) && press_one(commission, result, (enum side)leg) != 0) {
            return -1;
        }
    }
    instruct(commission, COMMISSION_HAND_NOTHING, SIDE_LEFT, "");
    return 0;
}
