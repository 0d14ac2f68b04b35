#include "controller/screening/checks.h"

#include "controller/estimator/body_table.h"
#include "controller/screening/tick_count.h"

/* A leg's angle cannot lie beyond this, whatever the person does. */
#define LEG_ANGLE_LIMIT_RAD REAL_PI
/* The ankle's range in leg lengths: beyond it the reading is wrong. */
#define EXTENSION_MIN_RATIO REAL(-0.02)
#define EXTENSION_MAX_RATIO REAL(0.5)
/* The motor's: its stops stand just outside 0 .. the largest precompression. */
#define MOTOR_MIN_RATIO REAL(-0.05)
#define MOTOR_OVER_RATIO REAL(0.1)

/* One value for so long while the other leg has moved so far: the sensor is stuck. A
 * 12-bit encoder's angle may stand still for 30 ms where a leg turns round. */
enum { STUCK_TICKS = TICKS_OF_MS(100) };
#define STUCK_OTHER_RAD REAL(0.06)

/* Standing: both legs within this of where they were half a second ago. */
enum { STANDSTILL_TICKS = TICKS_OF_MS(500) };
#define STANDSTILL_RAD REAL(0.02)

/* Both legs leaning so far to one side: the hip is 0.4 m ahead of or behind the ankles of a 0.9 m leg, and no foot
 * reaches so far. Whoever sits has both legs at 0.8 rad. In walking it is below 0.26, in running 0.37. */
#define TILT_RAD REAL(0.45)
enum { TILTED_TICKS = TICKS_OF_MS(200), LIFTED_TICKS = TICKS_OF_MS(500) };

/* The motor off its reference, three ticks late on the bus, in leg lengths. The
 * drives overshoot by up to 0.06 of it while they load. */
enum {
    FOLLOW_CONTRADICTIONS = TICKS_OF_MS(25),
    OFF_CONTRADICTIONS = TICKS_OF_MS(250),
    COMMAND_DELAY = 3
};
#define FOLLOW_RATIO REAL(0.1)
#define OFF_RATIO REAL(0.01)

/* The spring's force is checked when its motor has moved less than this (in leg lengths) for so
 * long: then neither inertia nor damping takes part. Friction does
 * (1 to 2 % of the force at full stroke), and a spring has its tolerance. Two samples of
 * the slow PDO in a row must contradict. */
enum {
    MOTOR_STILL_TICKS = TICKS_OF_MS(20),
    FORCE_CONTRADICTIONS = 2,
    FORCE_AGE_MAX_TICKS = TICKS_OF_MS(350)
};
#define MOTOR_STILL_RATIO REAL(0.00002)
#define MOTOR_THERE_RATIO REAL(0.002)
#define FORCE_TOLERANCE_RATIO REAL(0.25)
#define FORCE_FRICTION_LENGTH_RATIO REAL(0.012) /* as metres of spring, of the leg's length */
/* More force than that at a person's ankle is more energy than was prescribed, so there is less room above. What a
 * motor at rest says of its load is known to its friction: a ball screw of 0.9 and 0.8 efficiency holds a load by 0.80
 * to 1.11 of it, and its spring has a hysteresis of 3 % (devices/exo50.ini). */
#define FORCE_ABOVE_RATIO REAL(0.15)
#define FORCE_ABOVE_LENGTH_RATIO REAL(0.004)

/* A compass walker's ankle can extend only while its latch is open, follows the spring
 * then, and never beyond its motor. */
enum {
    ANKLE_CONTRADICTIONS = TICKS_OF_MS(20),
    RELEASE_TICKS = TICKS_OF_MS(80),
    RECLOSE_TICKS = TICKS_OF_MS(20)
};
#define ANKLE_SLACK_RATIO REAL(0.02)
#define RELEASE_LEAST_RATIO REAL(0.05)
#define RELEASE_FROM_RATIO REAL(0.01)

/* The latch by its own report. A command to arm takes three ticks to the latch and back; a release that
 * was under way as it was disarmed, some more. An empty spring's latch closes by itself. */
enum { ARMED_TICKS = TICKS_OF_MS(10), UNLATCHED_TICKS = TICKS_OF_MS(10) };
#define EMPTY_RATIO REAL(0.0002)

/* A drive that is not where it was sent: to be enabled takes six telegrams, and an
 * unload by itself 0.4 s at most. */
enum { ENABLE_TICKS = TICKS_OF_MS(500), DISABLE_TICKS = TICKS_OF_MS(1000) };

void checks_init(struct checks *checks)
{
    *checks = (struct checks){0};
}

/* ---- what lasts too long ----------------------------------------------------- */

static void watch_stillness(struct checks *checks, const struct checks_view *view)
{
    bool still = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_checks *leg = &checks->leg[side];
        const struct leg_samples *accepted = &view->samples->leg[side];
        const uint16_t other_age_ticks = view->input->leg[1 - side].age_ticks;
        const real angle = accepted->received_rad;
        if (!(real_abs(accepted->angle_rad - leg->standstill_ref_rad) <= STANDSTILL_RAD)) {
            leg->standstill_ref_rad = accepted->angle_rad;
            still = false;
        }
        if (angle != accepted->angle_rad || accepted->rate_rad != REAL(0.0)) {
            leg->still_ticks = 0;
        } else if (other_age_ticks == 0) {
            if (leg->still_ticks == 0) {
                leg->other_angle_rad = view->samples->leg[1 - side].received_rad;
            }
            leg->still_ticks = count_up(leg->still_ticks);
        }
    }
    checks->standstill_ticks = count_while(checks->standstill_ticks, still);
}

/* Of a person only: a compass walker falls at once. */
static void watch_posture(struct checks *checks, const struct controller_input *input)
{
    const struct leg_measurement *left = &input->leg[SIDE_LEFT], *right = &input->leg[SIDE_RIGHT];
    const real lean_rad = REAL(0.5) * (left->leg_angle_rad + right->leg_angle_rad);
    checks->tilted_ticks = count_while(checks->tilted_ticks, real_abs(lean_rad) > TILT_RAD);
    checks->lifted_ticks =
        count_while(checks->lifted_ticks, left->foot == FOOT_UP && right->foot == FOOT_UP);
}

static bool is_stuck(const struct checks *checks, const struct controller_input *input, int side)
{
    const struct leg_checks *leg = &checks->leg[side];
    return leg->still_ticks >= STUCK_TICKS &&
           real_abs(input->leg[1 - side].leg_angle_rad - leg->other_angle_rad) >= STUCK_OTHER_RAD;
}

/* Motor force against motor position, with the latch closed and the motor at rest where
 * it was sent (a drive that has overshot leans against its stop, not on the spring). */
static void watch_force(struct leg_checks *leg, const struct control_params *params, bool is_held,
                        const struct sea_measurement *sea, enum supervisor_state state)
{
    const real moved = real_abs(sea->precompression_m - leg->motor_before_m);
    const real off = real_abs(sea->precompression_m - leg->command_m[COMMAND_DELAY]);
    leg->motor_before_m = sea->precompression_m;
    leg->motor_still_ticks =
        count_while(leg->motor_still_ticks, moved <= MOTOR_STILL_RATIO * params->leg_length_m &&
                                                off <= MOTOR_THERE_RATIO * params->leg_length_m);
    if (state ==
        SUPERVISOR_COMMISSIONING) { /* slow motions look like rest; they have a bound of their own */
        leg->force_contradiction_count = 0;
        return;
    }
    if (sea->force_age_ticks != 0 || sea->state != DRIVE_ENABLED || sea->latch != LATCH_CLOSED ||
        leg->motor_still_ticks < MOTOR_STILL_TICKS) {
        return;
    }
    const real stiffness = params->spring_stiffness_n_m;
    const real expected_N = stiffness * sea->precompression_m;
    const real tolerance_N = FORCE_TOLERANCE_RATIO * real_abs(expected_N) +
                             FORCE_FRICTION_LENGTH_RATIO * stiffness * params->leg_length_m;
    const real above_N = is_held ? tolerance_N
                                 : FORCE_ABOVE_RATIO * real_abs(expected_N) +
                                       FORCE_ABOVE_LENGTH_RATIO * stiffness * params->leg_length_m;
    const real off_N = sea->force_N - expected_N;
    const bool explained = off_N >= -tolerance_N && off_N <= above_N;
    leg->force_contradiction_count = explained
                                         ? 0
                                         : (uint8_t)(leg->force_contradiction_count < UINT8_MAX
                                                         ? leg->force_contradiction_count + 1
                                                         : leg->force_contradiction_count);
}

/* Ankle against latch and motor; only where the body leaves the ankle no freedom. */
static void watch_ankle(struct leg_checks *leg, const struct control_params *params, bool is_held,
                        const struct leg_measurement *sample, const struct sea_measurement *sea)
{
    const real slack = ANKLE_SLACK_RATIO * params->leg_length_m;
    const real extension = sample->ankle_extension_m;
    if (sea->latch != leg->latch) {
        leg->latch = sea->latch;
        leg->latch_ticks = 0;
        leg->motor_at_release_m = sea->precompression_m;
    } else {
        leg->latch_ticks = count_up(leg->latch_ticks);
    }
    /* A walker without a push-off of its own leaves its ankles to the springs. */
    const bool alone = control_params_test_mode(params);
    bool contradicts = false;
    if (!is_held) {
        leg->ankle_contradiction_count = 0;
        return;
    }
    if (sea->latch == LATCH_CLOSED) {
        contradicts = alone && leg->latch_ticks > RECLOSE_TICKS && extension > slack;
    } else if (sea->latch == LATCH_OPEN) {
        const bool held = leg->motor_at_release_m > RELEASE_FROM_RATIO * params->leg_length_m &&
                          leg->latch_ticks > RELEASE_TICKS &&
                          sea->precompression_m > REAL(0.5) * leg->motor_at_release_m &&
                          extension < RELEASE_LEAST_RATIO * leg->motor_at_release_m;
        contradicts = held || (alone && extension > sea->precompression_m + slack);
    }
    leg->ankle_contradiction_count = count_while(leg->ankle_contradiction_count, contradicts);
}

/* Opened without being armed; or, on a person, not closed again behind an empty spring. */
static void watch_latch(struct leg_checks *leg, const struct control_params *params, bool is_held,
                        const struct sea_measurement *sea, const struct sea_request *command)
{
    const bool opens = sea->latch == LATCH_OPEN && leg->latch == LATCH_CLOSED;
    leg->unarmed_ticks = command->latch_armed ? 0 : count_up(leg->unarmed_ticks);
    leg->opened_unarmed = sea->latch == LATCH_OPEN &&
                          (leg->opened_unarmed || (opens && leg->unarmed_ticks > ARMED_TICKS));
    const bool empty = sea->latch == LATCH_OPEN && command->precompression_m == REAL(0.0) &&
                       real_abs(sea->precompression_m) <= EMPTY_RATIO * params->leg_length_m;
    leg->unlatched_ticks = count_while(leg->unlatched_ticks, empty && !is_held);
}

static bool latch_contradicts(const struct leg_checks *leg)
{
    return leg->opened_unarmed || leg->unlatched_ticks > UNLATCHED_TICKS;
}

static void watch_following(struct leg_checks *leg, const struct control_params *params,
                            const struct sea_measurement *sea, const struct sea_request *command)
{
    const bool follows = command->enable && sea->state == DRIVE_ENABLED;
    const real behind = real_abs(leg->command_m[COMMAND_DELAY] - sea->precompression_m);
    leg->follow_contradiction_count = count_while(
        leg->follow_contradiction_count, follows && behind > FOLLOW_RATIO * params->leg_length_m);
    leg->off_contradiction_count = count_while(
        leg->off_contradiction_count, follows && behind > OFF_RATIO * params->leg_length_m);
    for (int i = COMMAND_DELAY; i > 0; i--) {
        leg->command_m[i] = follows ? leg->command_m[i - 1] : sea->precompression_m;
    }
    leg->command_m[0] = follows ? command->precompression_m : sea->precompression_m;
}

/* Drive states against the commanded one. */
static void watch_drives(struct checks *checks, const struct controller_input *input,
                         enum supervisor_state state)
{
    const bool left = input->sea[SIDE_LEFT].state == DRIVE_ENABLED;
    const bool right = input->sea[SIDE_RIGHT].state == DRIVE_ENABLED;
    const bool wanted = supervisor_may_enable(state);
    const bool reached = wanted ? left && right : !left && !right;
    checks->has_left = wanted && !reached && checks->was_enabled;
    checks->was_enabled = wanted && (reached || checks->was_enabled);
    if (!checks->has_left) {
        checks->state_contradiction_count =
            count_while(checks->state_contradiction_count, !reached);
    }
}

static bool drives_disobey(const struct checks *checks, enum supervisor_state state)
{
    const int limit = supervisor_may_enable(state) ? ENABLE_TICKS : DISABLE_TICKS;
    return checks->has_left || checks->state_contradiction_count > limit;
}

/* ---- verdict ----------------------------------------------------------------- */

static bool is_in_range(const struct control_params *params, const struct controller_input *input,
                        int side)
{
    const struct leg_measurement *leg = &input->leg[side];
    const real length = params->leg_length_m;
    const real extension = leg->ankle_extension_m;
    const real motor = input->sea[side].precompression_m;
    return real_abs(leg->leg_angle_rad) <= LEG_ANGLE_LIMIT_RAD &&
           extension >= EXTENSION_MIN_RATIO * length && extension <= EXTENSION_MAX_RATIO * length &&
           motor >= MOTOR_MIN_RATIO * length &&
           motor <= params->r0_max_m + MOTOR_OVER_RATIO * length;
}

static enum supervisor_fault sample_fault(const struct control_params *params,
                                          const struct checks_view *view, int side)
{
    const struct controller_input *input = view->input;
    const struct leg_samples *leg = &view->samples->leg[side];
    const enum supervisor_state state = view->state;
    const uint32_t age_max = ticks_from_seconds(params->sensor_age_max_s);
    const struct sea_measurement *sea = &input->sea[side];
    if (input->leg[side].age_ticks > age_max) {
        return SUPERVISOR_FAULT_SENSOR_STALE;
    }
    if (sea->age_ticks > age_max ||
        (sea->force_age_ticks != AGE_NEVER && sea->force_age_ticks > FORCE_AGE_MAX_TICKS)) {
        return SUPERVISOR_FAULT_DRIVE_STALE;
    }
    if (!leg->received_finite || !real_is_finite(sea->force_N)) {
        return SUPERVISOR_FAULT_NOT_FINITE;
    }
    /* Where no step is walked a leg's jump is no danger: somebody puts it on, or lifts the one who fell.
     * A motor's is one wherever its drive may load a spring. */
    const bool moves = state == SUPERVISOR_WALKING || state == SUPERVISOR_UNLOADING;
    if ((moves &&
         (leg->angle_rejected_ticks > age_max || leg->extension_rejected_ticks > age_max)) ||
        (supervisor_may_enable(state) && leg->motor_rejected_ticks > age_max)) {
        return SUPERVISOR_FAULT_SENSOR_RATE;
    }
    return SUPERVISOR_FAULT_NONE;
}

static enum supervisor_fault leg_fault(const struct checks *checks,
                                       const struct control_params *params,
                                       const struct checks_view *view, int side)
{
    const struct controller_input *input = view->input;
    const struct leg_checks *leg = &checks->leg[side];
    const bool powered = supervisor_may_enable(view->state);
    const enum supervisor_fault samples = sample_fault(params, view, side);
    if (samples != SUPERVISOR_FAULT_NONE) {
        return samples;
    }
    if (!is_in_range(params, input, side)) {
        return SUPERVISOR_FAULT_SENSOR_RANGE;
    }
    if (input->sea[side].state == DRIVE_FAULT) {
        return SUPERVISOR_FAULT_DRIVE;
    }
    if (!powered) {
        return SUPERVISOR_FAULT_NONE;
    }
    if (real_abs(input->leg[side].leg_angle_rad) > params->fall_angle_rad) {
        return SUPERVISOR_FAULT_FALL;
    }
    if (is_stuck(checks, input, side)) {
        return SUPERVISOR_FAULT_SENSOR_STUCK;
    }
    if (latch_contradicts(leg) || leg->force_contradiction_count >= FORCE_CONTRADICTIONS ||
        leg->ankle_contradiction_count > ANKLE_CONTRADICTIONS) {
        return SUPERVISOR_FAULT_SPRING;
    }
    return leg->follow_contradiction_count > FOLLOW_CONTRADICTIONS ||
                   leg->off_contradiction_count > OFF_CONTRADICTIONS
               ? SUPERVISOR_FAULT_FOLLOWING
               : SUPERVISOR_FAULT_NONE;
}

void checks_update(struct checks *checks, const struct control_params *params,
                   const struct checks_view *view)
{
    const bool ankle_is_held = body_of(params->body)->ankle_is_held;
    watch_stillness(checks, view);
    if (!ankle_is_held) {
        watch_posture(checks, view->input);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_checks *leg = &checks->leg[side];
        const struct sea_measurement *sea = &view->input->sea[side];
        watch_force(leg, params, ankle_is_held, sea, view->state);
        watch_latch(leg, params, ankle_is_held, sea, &view->command[side]);
        watch_ankle(leg, params, ankle_is_held, &view->input->leg[side], sea);
        watch_following(leg, params, sea, &view->command[side]);
    }
    watch_drives(checks, view->input, view->state);
}

enum supervisor_fault checks_find(const struct checks *checks, const struct control_params *params,
                                  const struct checks_view *view)
{
    const struct controller_input *input = view->input;
    if (input->emergency_stop) {
        return SUPERVISOR_FAULT_EMERGENCY_STOP;
    }
    if (!input->nodes_operational) {
        return SUPERVISOR_FAULT_NODE_LOST;
    }
    if (input->foreign_node) {
        return SUPERVISOR_FAULT_FOREIGN;
    }
    if (input->node_written) {
        return SUPERVISOR_FAULT_NODE_WRITTEN;
    }
    if (input->node_changed) {
        return SUPERVISOR_FAULT_NODE_CHANGED;
    }
    if (input->parameters_corrupt) {
        return SUPERVISOR_FAULT_PARAMETERS;
    }
    if (!real_is_finite(input->desired_speed_rad_s)) {
        return SUPERVISOR_FAULT_NOT_FINITE;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const enum supervisor_fault fault = leg_fault(checks, params, view, side);
        if (fault != SUPERVISOR_FAULT_NONE) {
            return fault;
        }
    }
    return drives_disobey(checks, view->state) ? SUPERVISOR_FAULT_DRIVE : SUPERVISOR_FAULT_NONE;
}

bool checks_standstill(const struct checks *checks)
{
    return checks->standstill_ticks >= STANDSTILL_TICKS;
}

bool checks_upright(const struct checks *checks)
{
    return checks->tilted_ticks < TILTED_TICKS && checks->lifted_ticks < LIFTED_TICKS;
}

bool checks_springs_slack(const struct control_params *params, const struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (input->sea[side].age_ticks != 0 ||
            !(real_abs(input->sea[side].precompression_m) <= params->sea_tolerance_m)) {
            return false;
        }
    }
    return true;
}
