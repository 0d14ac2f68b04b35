#include "controller/laws/predictive_law.h"

/* Integration steps in units of sqrt(l/g): 40 ms and 30 ms on a leg of 1 m, an error of at most 3e-5 in the
 * next apex of the gaits up to 1 rad/s. Phases of at most 21, 19 and 11 steps; steady gaits take 12, 9
 * and 6. */
#define SINGLE_STEP_UNITS REAL(0.125)
#define PUSH_STEP_UNITS REAL(0.094)
#define STRIKE_LIMIT_STEPS REAL(20.5)
#define SWING_LIMIT_STEPS REAL(18.5)
#define PUSH_LIMIT_STEPS REAL(10.5)
/* A stride that ends slower than this, in 1/sqrt(l/g), or with the new stance leg closer to the vertical
 * at lift-off than this, is too close to falling to be chosen. */
#define SLOWEST_UNITS REAL(0.02)
#define LIFT_OFF_MARGIN_RAD REAL(0.005)
/* The motor's loop settles, and the node samples, behind its reference. */
#define MOTOR_MARGIN_S REAL(0.02)
/* Learning of the bias, and what counts as a wrong prediction: 1/sqrt(l/g), beyond the bias. */
#define BIAS_GAIN_STEADY \
    REAL(0.35) /* the error has the sign of the one before: a slope, a wrong mass */
#define BIAS_GAIN_RANDOM REAL(0.08) /* it has not: uneven ground, noise */
#define SURPRISE_UNITS REAL(0.1)
#define SURPRISES_MAX 30
/* Uneven ground: a foothold higher by h than foretold takes about 2 h / l from the next apex' v^2 l / g. Ground that has
 * lately done so calls for an apex fast enough to bear it again and worse: the gain is tuned on footholds drawn within 10 mm
 * (sim_host/study/laws/ground_study.c), 3.4 mm call for all there is, 0.8 rad/s on a leg of 1 m. What noise,
 * a wrong mass and great jumps of the command leave unforetold stays below the share that is let pass. */
#define TERRAIN_LET_PASS REAL(0.004)
#define TERRAIN_KEPT REAL(0.97) /* from step to step */
#define TERRAIN_GAIN REAL(24.0) /* v^2 l / g wanted, per what is kept */
#define TERRAIN_MOST REAL(0.065)

int predictive_law_init(struct predictive_law *law, const struct walker_params *params)
{
    *law = (struct predictive_law){.stage = PREDICTIVE_IDLE};
    if (walker_init(&law->walker, params) != WALKER_OK) {
        return -1;
    }
    return 0;
}

/* Not kept in *law: they hold a pointer, and the law's state must mean the same on every
 * machine. */
static struct stride_settings settings_of(const struct predictive_law *law, real step_units,
                                          real limit_steps)
{
    struct stride_settings settings =
        stride_settings_fixed(&law->walker, step_units * law->walker.time_unit_s);
    settings.phase_limit_s = limit_steps * settings.single_step_s;
    return settings;
}

bool predictive_law_trusts_itself(const struct predictive_law *law)
{
    return law->misprediction_count < PREDICTIVE_DISTRUST;
}

/* The energy at the apex that was not foretold. */
static void feel_ground(struct predictive_law *law, const struct apex *measured)
{
    const real now = measured->stance_rate_rad_s * law->walker.time_unit_s;
    const real foretold =
        (law->predicted.stance_rate_rad_s + law->bias[0]) * law->walker.time_unit_s;
    const real rough =
        TERRAIN_GAIN * (real_abs(now * now - foretold * foretold) - TERRAIN_LET_PASS);
    law->roughness *= TERRAIN_KEPT;
    if (rough > law->roughness) {
        law->roughness = rough < TERRAIN_MOST ? rough : TERRAIN_MOST;
    }
}

/* The measured apex against what was foretold for it. */
static void learn(struct predictive_law *law, const struct apex *measured)
{
    if (!law->has_prediction) {
        law->misprediction_count = law->misprediction_count > 0
                                       ? (uint8_t)(law->misprediction_count - 1)
                                       : law->misprediction_count;
        return;
    }
    const real error[3] = {
        measured->stance_rate_rad_s - law->predicted.stance_rate_rad_s - law->bias[0],
        measured->swing_angle_rad - law->predicted.swing_angle_rad - law->bias[1],
        measured->swing_rate_rad_s - law->predicted.swing_rate_rad_s - law->bias[2],
    };
    if (real_abs(error[0]) * law->walker.time_unit_s > SURPRISE_UNITS) {
        law->misprediction_count = law->misprediction_count > SURPRISES_MAX - 3
                                       ? (uint8_t)SURPRISES_MAX
                                       : (uint8_t)(law->misprediction_count + 3);
    } else if (law->misprediction_count > 0) {
        law->misprediction_count--;
    }
    feel_ground(law, measured);
    const bool steady = error[0] * law->last_error > REAL(0.0);
    const real gain = steady ? BIAS_GAIN_STEADY : BIAS_GAIN_RANDOM;
    for (int i = 0; i < 3; i++) {
        law->bias[i] += gain * error[i];
    }
    law->last_error = error[0];
}

void predictive_law_begin(struct predictive_law *law, const struct gait_branch *branch,
                          const struct predictive_request *request)
{
    learn(law, &request->apex);
    law->has_prediction = false;
    law->request = *request;
    law->r0_m = request->r0_first_m;
    law->best_cost = REAL(-1.0);
    law->answered = false;
    law->index = 0;
    const real terrain_rad_s = real_sqrt(law->roughness) / law->walker.time_unit_s;
    const real least_rad_s =
        terrain_rad_s < request->terrain_speed_rad_s ? terrain_rad_s : request->terrain_speed_rad_s;
    const real wanted_rad_s = request->target_speed_rad_s;
    law->target_speed_rad_s = gait_branch_at(
        branch, wanted_rad_s > least_rad_s ? wanted_rad_s : least_rad_s, &law->target);
    law->stage = PREDICTIVE_STRIKE;
    law->steps++;
}

void predictive_law_finish(struct predictive_law *law)
{
    if (law->stage != PREDICTIVE_IDLE) {
        law->stage = PREDICTIVE_IDLE;
        law->has_prediction = law->best_cost >= REAL(0.0);
        law->fallbacks += law->answered ? 0u : 1u;
    }
}

/* The rest of the stride for one r0. Returns 0 when it ends in a fault or too close to one. */
static int foretell(const struct predictive_law *law, real r0_m, struct apex *next)
{
    struct stride_result rest = law->strike;
    const struct stride_settings swing = settings_of(law, SINGLE_STEP_UNITS, SWING_LIMIT_STEPS);
    const struct stride_settings push = settings_of(law, PUSH_STEP_UNITS, PUSH_LIMIT_STEPS);
    if (stride_push_off(&law->walker, &push, r0_m, &rest) != STRIDE_OK ||
        rest.lift_off[STANCE_ANGLE] < LIFT_OFF_MARGIN_RAD ||
        stride_from_lift_off(&law->walker, &swing, &rest) != STRIDE_OK) {
        return 0;
    }
    *next = rest.next;
    return -next->stance_rate_rad_s * law->walker.time_unit_s >= SLOWEST_UNITS;
}

/* Tries one candidate and keeps it if it is the best so far. Returns its cost, negative for none. */
static real try_candidate(struct predictive_law *law, const struct gait_branch *branch, real r0_m)
{
    struct apex next;
    if (!foretell(law, r0_m, &next)) {
        return REAL(-1.0);
    }
    const struct apex expected = {next.stance_rate_rad_s + law->bias[0],
                                  next.swing_angle_rad + law->bias[1],
                                  next.swing_rate_rad_s + law->bias[2]};
    const real cost =
        gait_branch_distance(branch, &law->target, law->target_speed_rad_s, &expected, r0_m);
    if (law->best_cost < REAL(0.0) || cost < law->best_cost) {
        law->best_cost = cost;
        law->r0_m = r0_m;
        law->predicted = next;
    }
    return cost;
}

/* Candidates over the range, spaced by the square: the faster the gait the more r0 it bears. */
static real spread_candidate(const struct predictive_law *law, int index)
{
    const real share = (real)index / (real)(PREDICTIVE_COARSE - 1);
    return law->request.r0_low_m + (law->request.r0_high_m - law->request.r0_low_m) * share * share;
}

static real spread_gap(const struct predictive_law *law, real r0_m)
{
    const real range = law->request.r0_high_m - law->request.r0_low_m;
    const real n = (real)(PREDICTIVE_COARSE - 1);
    const real share = range > REAL(0.0) ? real_sqrt((r0_m - law->request.r0_low_m) / range) : n;
    return range * (REAL(2.0) * share + REAL(1.0) / n) / n;
}

/* How far the motor gets, from rest to rest, in the time that is left. */
static real motor_reach_m(const struct predictive_law *law)
{
    const struct predictive_request *r = &law->request;
    const real left = law->strike.apex_to_strike_s - r->report_delay_s -
                      (real)(PREDICTIVE_COARSE + 2) * r->tick_s - MOTOR_MARGIN_S;
    const real ramp_s = r->motor_speed_m_s / r->motor_acceleration_m_s2;
    if (left <= REAL(0.0)) {
        return REAL(0.0);
    }
    return left < REAL(2.0) * ramp_s ? REAL(0.25) * r->motor_acceleration_m_s2 * left * left
                                     : r->motor_speed_m_s * (left - ramp_s);
}

static void keep_within_reach(struct predictive_law *law)
{
    struct predictive_request *r = &law->request;
    const real command_limit_m = motor_reach_m(law);
    r->r0_low_m = real_clamp(r->r0_from_m - command_limit_m, r->r0_low_m, r->r0_high_m);
    r->r0_high_m = real_clamp(r->r0_from_m + command_limit_m, r->r0_low_m, r->r0_high_m);
}

static void to_strike(struct predictive_law *law)
{
    const struct stride_settings settings = settings_of(law, SINGLE_STEP_UNITS, STRIKE_LIMIT_STEPS);
    law->strike = (struct stride_result){.fault = STRIDE_OK};
    if (stride_to_strike(&law->walker, &settings, &law->request.apex, &law->strike) == STRIDE_OK) {
        keep_within_reach(law);
        law->stage = PREDICTIVE_FIRST;
    } else {
        predictive_law_finish(law);
    }
}

/* A round of refinement about the best so far. */
static void begin_round(struct predictive_law *law)
{
    law->middle_m = law->r0_m;
    law->cost_at[1] = law->best_cost;
}

/* The whole range, one candidate a call; true when it is done. */
static bool spread(struct predictive_law *law, const struct gait_branch *branch)
{
    (void)try_candidate(law, branch, spread_candidate(law, law->index));
    law->index++;
    if (law->index < PREDICTIVE_COARSE) {
        return false;
    }
    if (law->best_cost < REAL(0.0)) {
        predictive_law_finish(law); /* no push-off survives the next stride */
        return true;
    }
    law->answered = true;
    law->index = 0;
    law->grid_m = REAL(0.5) * spread_gap(law, law->r0_m);
    law->stage = PREDICTIVE_REFINE;
    begin_round(law);
    return true;
}

static real try_inside(struct predictive_law *law, const struct gait_branch *branch, real r0_m)
{
    const bool inside = r0_m >= law->request.r0_low_m && r0_m <= law->request.r0_high_m;
    return inside ? try_candidate(law, branch, r0_m) : REAL(-1.0);
}

/* The vertex of the parabola through the round's three costs; costs near the least are one. */
static void try_vertex(struct predictive_law *law, const struct gait_branch *branch)
{
    const real *c = law->cost_at;
    const real bend = c[0] - REAL(2.0) * c[1] + c[2];
    if (c[0] < REAL(0.0) || c[2] < REAL(0.0) || !(bend > REAL(0.0))) {
        return;
    }
    const real shift = real_clamp(REAL(0.5) * (c[0] - c[2]) / bend, REAL(-2.0), REAL(2.0));
    (void)try_inside(law, branch, law->middle_m + shift * law->grid_m);
}

/* Above the best, below it, at the vertex; then closer. */
static bool refine(struct predictive_law *law, const struct gait_branch *branch)
{
    const real before_m = law->r0_m;
    switch (law->index % 3) {
    case 0:
        law->cost_at[2] = try_inside(law, branch, law->middle_m + law->grid_m);
        break;
    case 1:
        law->cost_at[0] = try_inside(law, branch, law->middle_m - law->grid_m);
        break;
    default:
        try_vertex(law, branch);
        law->grid_m *= REAL(0.25);
        begin_round(law);
        break;
    }
    law->index++;
    if (law->index >= 3 * PREDICTIVE_ROUNDS) {
        predictive_law_finish(law);
        return true;
    }
    return law->r0_m != before_m;
}

/* The caller's answer knows nothing of the motor: the search may choose it only within reach. Where
 * it is the answer anyway it is foretold anyway. */
static bool first(struct predictive_law *law, const struct gait_branch *branch)
{
    law->stage = PREDICTIVE_SPREAD;
    if (predictive_law_trusts_itself(law)) {
        (void)try_inside(law, branch, law->request.r0_first_m);
        return false;
    }
    (void)try_candidate(law, branch, law->request.r0_first_m);
    predictive_law_finish(law);
    return true;
}

bool predictive_law_work(struct predictive_law *law, const struct gait_branch *branch)
{
    switch (law->stage) {
    case PREDICTIVE_STRIKE:
        to_strike(law);
        return law->stage == PREDICTIVE_IDLE;
    case PREDICTIVE_FIRST:
        return first(law, branch);
    case PREDICTIVE_SPREAD:
        return spread(law, branch);
    case PREDICTIVE_REFINE:
        return refine(law, branch);
    default:
        return false;
    }
}
