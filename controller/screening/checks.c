#include "controller/screening/checks.h"

/* A leg's angle cannot lie beyond this, whatever the wearer does. */
#define LEG_ANGLE_LIMIT_RAD REAL_PI
/* The ankle's range in leg lengths: beyond it the reading is wrong. */
#define EXTENSION_MIN_RATIO REAL(-0.02)
#define EXTENSION_MAX_RATIO REAL(0.5)
/* The motor's: its stops stand just outside 0 .. the largest precompression. */
#define MOTOR_MIN_RATIO REAL(-0.05)
#define MOTOR_OVER_RATIO REAL(0.1)

/* Fastest a leg swings, in sqrt(g/l), and an ankle extends, in sqrt(g l): several times
 * what the walker does at its fastest gait (1.1 and 0.57) or a person (about 2); a foot
 * that its spring no longer holds drops back in some ticks. */
#define LEG_RATE_RATIO REAL(6.0)
#define ANKLE_RATE_RATIO REAL(6.0)
/* A motor, in limits of its own reference. */
#define MOTOR_RATE_RATIO REAL(2.0)
/* Noise of a sample: rad, and share of the leg's length. */
#define ANGLE_NOISE_RAD REAL(0.02)
#define LENGTH_NOISE_RATIO REAL(0.005)

/* One value for so long while the other leg has moved so far: the sensor is stuck. A
 * 12-bit encoder's angle may stand still for 30 ms where a leg turns round. */
enum { STUCK_TICKS = TICKS_OF_MS(100) };
#define STUCK_OTHER_RAD REAL(0.06)

/* Standing: both legs within this of where they were half a second ago. */
enum { STANDSTILL_TICKS = TICKS_OF_MS(500) };
#define STANDSTILL_RAD REAL(0.02)

/* The motor off its reference, three ticks late on the bus: a share of the leg. The
 * drives overshoot by up to 0.06 of it while they load. */
enum {
    FOLLOW_CONTRADICTIONS = TICKS_OF_MS(25),
    OFF_CONTRADICTIONS = TICKS_OF_MS(250),
    COMMAND_DELAY = 3
};
#define FOLLOW_RATIO REAL(0.1)
#define OFF_RATIO REAL(0.01)

/* The spring's force is checked when its motor has stood for so long within a
 * share of the leg: then neither inertia nor damping takes part. Friction does
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

/* A drive that is not where it was sent: to be enabled takes six telegrams, and an
 * unload by itself 0.4 s at most. */
enum { ENABLE_TICKS = TICKS_OF_MS(500), DISABLE_TICKS = TICKS_OF_MS(1000) };

static uint16_t counted(uint16_t count)
{
    return count < UINT16_MAX - 1 ? (uint16_t)(count + 1) : count;
}

static uint16_t strike(uint16_t contradiction_count, bool contradicts)
{
    return contradicts ? counted(contradiction_count) : 0;
}

static real gait_speed(const struct control_params *params)
{
    return real_sqrt(params->gravity_m_s2 / params->leg_length_m);
}

void checks_init(struct checks *checks)
{
    *checks = (struct checks){0};
    for (int side = 0; side < SIDE_COUNT; side++) {
        /* From so long ago any first sample can be. */
        checks->leg[side].angle_rejected_ticks = UINT16_MAX - 1;
        checks->leg[side].extension_rejected_ticks = UINT16_MAX - 1;
        checks->leg[side].motor_rejected_ticks = UINT16_MAX - 1;
    }
}

/* ---- samples --------------------------------------------------------------- */

/* Whether a new value can follow from the believed one `ticks` ago. */
static bool is_believed(real value, real before, real rate_per_tick, real noise, uint16_t ticks)
{
    const real reach = rate_per_tick * (real)ticks + noise;
    return real_abs(value - before) <= reach; /* false when it is not finite */
}

/* Bridged at the last rate, so that a lost frame does not look like a leg that
 * stopped; not for ever, so that it does not run away either. */
enum { BRIDGE_TICKS = TICKS_OF_MS(50) };

static void screen_angle(struct leg_checks *leg, struct leg_measurement *sample, real rate_per_tick)
{
    const uint16_t ticks = counted(leg->angle_rejected_ticks);
    const real angle = sample->leg_angle_rad;
    if (sample->age_ticks == 0 &&
        is_believed(angle, leg->angle_rad, rate_per_tick, ANGLE_NOISE_RAD, ticks)) {
        const real change = angle - leg->angle_rad;
        leg->rate_rad = (change + (real)(ticks - 1) * leg->rate_rad) / (real)ticks;
        leg->angle_rad = angle;
        leg->angle_rejected_ticks = 0;
        return;
    }
    leg->angle_rejected_ticks = ticks;
    leg->rate_rad = ticks > BRIDGE_TICKS ? REAL(0.0) : leg->rate_rad;
    leg->angle_rad += leg->rate_rad;
    sample->leg_angle_rad = leg->angle_rad;
}

static void screen_length(real *believed, uint16_t *rejected_ticks, real *value, bool fresh,
                          real rate_per_tick, real noise)
{
    const uint16_t ticks = counted(*rejected_ticks);
    if (fresh && is_believed(*value, *believed, rate_per_tick, noise, ticks)) {
        *believed = *value;
        *rejected_ticks = 0;
        return;
    }
    *rejected_ticks = ticks;
    *value = *believed;
}

void checks_screen(struct checks *checks, const struct control_params *params,
                   struct controller_input *input)
{
    const real length = params->leg_length_m;
    const real unit = gait_speed(params) * CONTROL_PERIOD_S;
    const real noise = LENGTH_NOISE_RATIO * length;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_checks *leg = &checks->leg[side];
        struct leg_measurement *sample = &input->leg[side];
        struct sea_measurement *sea = &input->sea[side];
        screen_angle(leg, sample, LEG_RATE_RATIO * unit);
        screen_length(&leg->extension_m, &leg->extension_rejected_ticks, &sample->ankle_extension_m,
                      sample->age_ticks == 0, ANKLE_RATE_RATIO * unit * length, noise);
        screen_length(&leg->motor_m, &leg->motor_rejected_ticks, &sea->precompression_m,
                      sea->age_ticks == 0,
                      MOTOR_RATE_RATIO * params->sea_speed_max_m_s * CONTROL_PERIOD_S, noise);
    }
}

/* ---- what lasts too long ----------------------------------------------------- */

static void watch_stillness(struct checks *checks, const struct controller_input *raw)
{
    bool still = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_checks *leg = &checks->leg[side];
        const real angle = raw->leg[side].leg_angle_rad;
        if (!(real_abs(leg->angle_rad - leg->standstill_ref_rad) <= STANDSTILL_RAD)) {
            leg->standstill_ref_rad = leg->angle_rad;
            still = false;
        }
        const bool known = raw->leg[1 - side].age_ticks == 0;
        if (angle != leg->angle_rad || leg->rate_rad != REAL(0.0)) {
            leg->still_ticks = 0;
        } else if (known) {
            if (leg->still_ticks == 0) {
                leg->other_angle_rad = raw->leg[1 - side].leg_angle_rad;
            }
            leg->still_ticks = counted(leg->still_ticks);
        }
    }
    checks->standstill_ticks = strike(checks->standstill_ticks, still);
}

static bool is_stuck(const struct checks *checks, const struct controller_input *input, int side)
{
    const struct leg_checks *leg = &checks->leg[side];
    return leg->still_ticks >= STUCK_TICKS &&
           real_abs(input->leg[1 - side].leg_angle_rad - leg->other_angle_rad) >= STUCK_OTHER_RAD;
}

/* Motor force against motor position, with the latch closed and the motor at rest where
 * it was sent (a drive that has overshot leans against its stop, not on the spring). */
static void watch_force(struct leg_checks *leg, const struct control_params *params,
                        const struct sea_measurement *sea)
{
    const real moved = real_abs(sea->precompression_m - leg->motor_before_m);
    const real off = real_abs(sea->precompression_m - leg->command_m[COMMAND_DELAY]);
    leg->motor_before_m = sea->precompression_m;
    leg->motor_still_ticks =
        strike(leg->motor_still_ticks, moved <= MOTOR_STILL_RATIO * params->leg_length_m &&
                                           off <= MOTOR_THERE_RATIO * params->leg_length_m);
    if (sea->force_age_ticks != 0 || sea->state != DRIVE_ENABLED || sea->latch != LATCH_CLOSED ||
        leg->motor_still_ticks < MOTOR_STILL_TICKS) {
        return;
    }
    const real stiffness = params->spring_stiffness_n_m;
    const real expected_N = stiffness * sea->precompression_m;
    const real tolerance_N = FORCE_TOLERANCE_RATIO * real_abs(expected_N) +
                             FORCE_FRICTION_LENGTH_RATIO * stiffness * params->leg_length_m;
    const bool explained = real_abs(sea->force_N - expected_N) <= tolerance_N;
    leg->force_contradiction_count = explained
                                         ? 0
                                         : (uint8_t)(leg->force_contradiction_count < UINT8_MAX
                                                         ? leg->force_contradiction_count + 1
                                                         : leg->force_contradiction_count);
}

/* Ankle against latch and motor; only where the body leaves the ankle no freedom. */
static void watch_ankle(struct leg_checks *leg, const struct control_params *params,
                        const struct leg_measurement *sample, const struct sea_measurement *sea)
{
    const real slack = ANKLE_SLACK_RATIO * params->leg_length_m;
    const real extension = sample->ankle_extension_m;
    if (sea->latch != leg->latch) {
        leg->latch = sea->latch;
        leg->latch_ticks = 0;
        leg->motor_at_release_m = sea->precompression_m;
    } else {
        leg->latch_ticks = counted(leg->latch_ticks);
    }
    /* A walker without a push-off of its own leaves its ankles to the springs. */
    const bool alone = params->engage_steps == REAL(0.0);
    bool contradicts = false;
    if (params->body != (real)BODY_COMPASS) {
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
    leg->ankle_contradiction_count = strike(leg->ankle_contradiction_count, contradicts);
}

static void watch_following(struct leg_checks *leg, const struct control_params *params,
                            const struct sea_measurement *sea, const struct sea_request *command)
{
    const bool follows = command->enable && sea->state == DRIVE_ENABLED;
    const real behind = real_abs(leg->command_m[COMMAND_DELAY] - sea->precompression_m);
    leg->follow_contradiction_count = strike(
        leg->follow_contradiction_count, follows && behind > FOLLOW_RATIO * params->leg_length_m);
    leg->off_contradiction_count =
        strike(leg->off_contradiction_count, follows && behind > OFF_RATIO * params->leg_length_m);
    for (int i = COMMAND_DELAY; i > 0; i--) {
        leg->command_m[i] = follows ? leg->command_m[i - 1] : sea->precompression_m;
    }
    leg->command_m[0] = follows ? command->precompression_m : sea->precompression_m;
}

/* Drive states against the commanded one. */
static bool drives_disobey(struct checks *checks, const struct controller_input *input,
                           const struct checks_context *context)
{
    const bool left = input->sea[SIDE_LEFT].state == DRIVE_ENABLED;
    const bool right = input->sea[SIDE_RIGHT].state == DRIVE_ENABLED;
    const bool wanted = supervisor_may_enable(context->state);
    const bool reached = wanted ? left && right : !left && !right;
    if (!wanted) {
        checks->was_enabled = false;
    } else if (reached) {
        checks->was_enabled = true;
    } else if (checks->was_enabled) {
        return true; /* it left the state by itself */
    }
    checks->state_contradiction_count = strike(checks->state_contradiction_count, !reached);
    return checks->state_contradiction_count > (wanted ? ENABLE_TICKS : DISABLE_TICKS);
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

static enum supervisor_fault find_of_samples(const struct leg_checks *leg,
                                             const struct control_params *params,
                                             const struct controller_input *raw,
                                             enum supervisor_state state, int side)
{
    const uint32_t age_max = ticks_from_seconds(params->sensor_age_max_s);
    const struct sea_measurement *sea = &raw->sea[side];
    if (raw->leg[side].age_ticks > age_max) {
        return SUPERVISOR_FAULT_SENSOR_STALE;
    }
    if (sea->age_ticks > age_max ||
        (sea->force_age_ticks != AGE_NEVER && sea->force_age_ticks > FORCE_AGE_MAX_TICKS)) {
        return SUPERVISOR_FAULT_DRIVE_STALE;
    }
    if (!real_is_finite(raw->leg[side].leg_angle_rad) ||
        !real_is_finite(raw->leg[side].ankle_extension_m) ||
        !real_is_finite(sea->precompression_m) || !real_is_finite(sea->force_N)) {
        return SUPERVISOR_FAULT_NOT_FINITE;
    }
    /* Where nothing can be released a jump is no danger: somebody puts it on, or lifts
     * the one who fell. */
    const bool moves = state == SUPERVISOR_WALKING || state == SUPERVISOR_UNLOADING;
    if (moves && (leg->angle_rejected_ticks > age_max || leg->extension_rejected_ticks > age_max ||
                  leg->motor_rejected_ticks > age_max)) {
        return SUPERVISOR_FAULT_SENSOR_RATE;
    }
    return SUPERVISOR_FAULT_NONE;
}

static enum supervisor_fault find_of_leg(const struct checks *checks,
                                         const struct control_params *params,
                                         const struct controller_input *raw,
                                         const struct controller_input *input,
                                         const struct checks_context *context, int side)
{
    const struct leg_checks *leg = &checks->leg[side];
    const bool powered = supervisor_may_enable(context->state);
    const enum supervisor_fault samples = find_of_samples(leg, params, raw, context->state, side);
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
    if (leg->force_contradiction_count >= FORCE_CONTRADICTIONS ||
        leg->ankle_contradiction_count > ANKLE_CONTRADICTIONS) {
        return SUPERVISOR_FAULT_SPRING;
    }
    return leg->follow_contradiction_count > FOLLOW_CONTRADICTIONS ||
                   leg->off_contradiction_count > OFF_CONTRADICTIONS
               ? SUPERVISOR_FAULT_FOLLOWING
               : SUPERVISOR_FAULT_NONE;
}

enum supervisor_fault checks_find(struct checks *checks, const struct control_params *params,
                                  const struct controller_input *raw,
                                  const struct controller_input *input,
                                  const struct checks_context *context)
{
    watch_stillness(checks, raw);
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_checks *leg = &checks->leg[side];
        const struct sea_measurement *sea = &input->sea[side];
        watch_force(leg, params, sea);
        watch_ankle(leg, params, &input->leg[side], sea);
        watch_following(leg, params, sea, &context->command[side]);
    }
    const bool disobeyed = drives_disobey(checks, input, context);
    if (input->emergency_stop) {
        return SUPERVISOR_FAULT_EMERGENCY_STOP;
    }
    if (!input->nodes_operational) {
        return SUPERVISOR_FAULT_NODE_LOST;
    }
    if (input->foreign_node) {
        return SUPERVISOR_FAULT_FOREIGN;
    }
    if (input->parameters_corrupt) {
        return SUPERVISOR_FAULT_PARAMETERS;
    }
    if (!real_is_finite(input->desired_speed_rad_s)) {
        return SUPERVISOR_FAULT_NOT_FINITE;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const enum supervisor_fault fault = find_of_leg(checks, params, raw, input, context, side);
        if (fault != SUPERVISOR_FAULT_NONE) {
            return fault;
        }
    }
    return disobeyed ? SUPERVISOR_FAULT_DRIVE : SUPERVISOR_FAULT_NONE;
}

bool checks_standstill(const struct checks *checks)
{
    return checks->standstill_ticks >= STANDSTILL_TICKS;
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
