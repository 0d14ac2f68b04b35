#include "controller/laws/predictive_search.h"

/* Integration steps in units of sqrt(l/g): 40 ms and 30 ms on a leg of 1 m. The error in the next
 * apex is at most 3e-5 in gaits up to 1 rad/s. Phases have at most 21, 19 and 11 steps; steady
 * gaits take 12, 9 and 6. */
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
#define MISPREDICTION_UNITS REAL(0.1)
#define MISPREDICTIONS_MOST 30
/* Uneven ground: a foothold higher by h than predicted takes about 2 h / l from the next apex'
 * v^2 l / g. After that the law wants an apex fast enough for as much again and more. The gain is
 * tuned on footholds drawn within 10 mm (sim_host/study/laws/ground_study.c): 3.4 mm lead to the
 * largest speed, 0.8 rad/s on a leg of 1 m. Prediction errors from noise, a wrong mass and great
 * jumps of the command stay below the first limit: they count as even ground. */
#define TERRAIN_IGNORED REAL(0.004)
#define TERRAIN_KEPT REAL(0.97) /* of the roughness, from step to step */
#define TERRAIN_GAIN REAL(24.0) /* v^2 l / g wanted, per prediction error */
#define TERRAIN_MOST REAL(0.065)

int predictive_search_init(struct predictive_search *search, const struct walker_params *params)
{
    *search = (struct predictive_search){.stage = PREDICTIVE_IDLE};
    if (walker_init(&search->walker, params) != WALKER_OK) {
        return -1;
    }
    return 0;
}

/* Not kept in *search: they contain a pointer, and the state must mean the same on every
 * machine. */
static struct stride_settings settings_of(const struct predictive_search *search, real step_units,
                                          real limit_steps)
{
    struct stride_settings settings =
        stride_settings_fixed(&search->walker, step_units * search->walker.time_unit_s);
    settings.phase_limit_s = limit_steps * settings.single_step_s;
    return settings;
}

bool predictive_search_is_reliable(const struct predictive_search *search)
{
    return search->misprediction_count < PREDICTIVE_UNRELIABLE;
}

/* Roughness from the energy at the apex that was not predicted. */
static void follow_ground(struct predictive_search *search, const struct apex *measured)
{
    const real now = measured->stance_rate_rad_s * search->walker.time_unit_s;
    const real predicted =
        (search->predicted.stance_rate_rad_s + search->bias[0]) * search->walker.time_unit_s;
    const real rough =
        TERRAIN_GAIN * (real_abs(now * now - predicted * predicted) - TERRAIN_IGNORED);
    search->roughness *= TERRAIN_KEPT;
    if (rough > search->roughness) {
        search->roughness = rough < TERRAIN_MOST ? rough : TERRAIN_MOST;
    }
}

/* The measured apex against its prediction. */
static void learn(struct predictive_search *search, const struct apex *measured)
{
    if (!search->has_prediction) {
        search->misprediction_count = search->misprediction_count > 0
                                          ? (uint8_t)(search->misprediction_count - 1)
                                          : search->misprediction_count;
        return;
    }
    const real error[3] = {
        measured->stance_rate_rad_s - search->predicted.stance_rate_rad_s - search->bias[0],
        measured->swing_angle_rad - search->predicted.swing_angle_rad - search->bias[1],
        measured->swing_rate_rad_s - search->predicted.swing_rate_rad_s - search->bias[2],
    };
    if (real_abs(error[0]) * search->walker.time_unit_s > MISPREDICTION_UNITS) {
        search->misprediction_count = search->misprediction_count > MISPREDICTIONS_MOST - 3
                                          ? (uint8_t)MISPREDICTIONS_MOST
                                          : (uint8_t)(search->misprediction_count + 3);
    } else if (search->misprediction_count > 0) {
        search->misprediction_count--;
    }
    follow_ground(search, measured);
    const bool steady = error[0] * search->last_error > REAL(0.0);
    const real gain = steady ? BIAS_GAIN_STEADY : BIAS_GAIN_RANDOM;
    for (int i = 0; i < 3; i++) {
        search->bias[i] += gain * error[i];
    }
    search->last_error = error[0];
}

void predictive_search_begin(struct predictive_search *search, const struct gait_branch *branch,
                             const struct predictive_request *request)
{
    learn(search, &request->apex);
    search->has_prediction = false;
    search->request = *request;
    search->r0_m = request->r0_first_m;
    search->best_cost = REAL(-1.0);
    search->answered = false;
    search->index = 0;
    const real terrain_rad_s = real_sqrt(search->roughness) / search->walker.time_unit_s;
    const real least_rad_s =
        terrain_rad_s < request->terrain_speed_rad_s ? terrain_rad_s : request->terrain_speed_rad_s;
    const real wanted_rad_s = request->target_speed_rad_s;
    search->target_speed_rad_s = gait_branch_at(
        branch, wanted_rad_s > least_rad_s ? wanted_rad_s : least_rad_s, &search->target);
    search->stage = PREDICTIVE_STRIKE;
    search->steps++;
}

void predictive_search_finish(struct predictive_search *search)
{
    if (search->stage != PREDICTIVE_IDLE) {
        search->stage = PREDICTIVE_IDLE;
        search->has_prediction = search->best_cost >= REAL(0.0);
        search->fallbacks += search->answered ? 0u : 1u;
    }
}

/* The rest of the stride for one r0. Returns 0 when it ends in a fault or too close to one. */
static int predict(const struct predictive_search *search, real r0_m, struct apex *next)
{
    struct stride_result rest = search->strike;
    const struct stride_settings swing = settings_of(search, SINGLE_STEP_UNITS, SWING_LIMIT_STEPS);
    const struct stride_settings push = settings_of(search, PUSH_STEP_UNITS, PUSH_LIMIT_STEPS);
    if (stride_push_off(&search->walker, &push, r0_m, &rest) != STRIDE_OK ||
        rest.lift_off[STANCE_ANGLE] < LIFT_OFF_MARGIN_RAD ||
        stride_from_lift_off(&search->walker, &swing, &rest) != STRIDE_OK) {
        return 0;
    }
    *next = rest.next;
    return -next->stance_rate_rad_s * search->walker.time_unit_s >= SLOWEST_UNITS;
}

/* Tries one candidate and keeps it if it is the best so far. Returns its cost, negative for none. */
static real try_candidate(struct predictive_search *search, const struct gait_branch *branch,
                          real r0_m)
{
    struct apex next;
    if (!predict(search, r0_m, &next)) {
        return REAL(-1.0);
    }
    const struct apex expected = {next.stance_rate_rad_s + search->bias[0],
                                  next.swing_angle_rad + search->bias[1],
                                  next.swing_rate_rad_s + search->bias[2]};
    const real cost =
        gait_branch_distance(branch, &search->target, search->target_speed_rad_s, &expected, r0_m);
    if (search->best_cost < REAL(0.0) || cost < search->best_cost) {
        search->best_cost = cost;
        search->r0_m = r0_m;
        search->predicted = next;
    }
    return cost;
}

/* Candidates over the range, spaced by the square: the faster the gait the more r0 it bears. */
static real spread_candidate(const struct predictive_search *search, int index)
{
    const real part = (real)index / (real)(PREDICTIVE_COARSE - 1);
    return search->request.r0_low_m +
           (search->request.r0_high_m - search->request.r0_low_m) * part * part;
}

static real spread_gap(const struct predictive_search *search, real r0_m)
{
    const real range = search->request.r0_high_m - search->request.r0_low_m;
    const real n = (real)(PREDICTIVE_COARSE - 1);
    const real part = range > REAL(0.0) ? real_sqrt((r0_m - search->request.r0_low_m) / range) : n;
    return range * (REAL(2.0) * part + REAL(1.0) / n) / n;
}

/* How far the motor gets, from rest to rest, in the time that is left. */
static real motor_reach_m(const struct predictive_search *search)
{
    const struct predictive_request *r = &search->request;
    const real left = search->strike.apex_to_strike_s - r->report_delay_s -
                      (real)(PREDICTIVE_COARSE + 2) * r->tick_s - MOTOR_MARGIN_S;
    const real ramp_s = r->motor_speed_m_s / r->motor_acceleration_m_s2;
    if (left <= REAL(0.0)) {
        return REAL(0.0);
    }
    return left < REAL(2.0) * ramp_s ? REAL(0.25) * r->motor_acceleration_m_s2 * left * left
                                     : r->motor_speed_m_s * (left - ramp_s);
}

static void keep_within_reach(struct predictive_search *search)
{
    struct predictive_request *r = &search->request;
    const real command_limit_m = motor_reach_m(search);
    r->r0_low_m = real_clamp(r->r0_from_m - command_limit_m, r->r0_low_m, r->r0_high_m);
    r->r0_high_m = real_clamp(r->r0_from_m + command_limit_m, r->r0_low_m, r->r0_high_m);
}

static void to_strike(struct predictive_search *search)
{
    const struct stride_settings settings =
        settings_of(search, SINGLE_STEP_UNITS, STRIKE_LIMIT_STEPS);
    search->strike = (struct stride_result){.fault = STRIDE_OK};
    if (stride_to_strike(&search->walker, &settings, &search->request.apex, &search->strike) ==
        STRIDE_OK) {
        keep_within_reach(search);
        search->stage = PREDICTIVE_FIRST;
    } else {
        predictive_search_finish(search);
    }
}

/* A round of refinement about the best so far. */
static void begin_round(struct predictive_search *search)
{
    search->middle_m = search->r0_m;
    search->cost_at[1] = search->best_cost;
}

/* The whole range, one candidate a call; true when it is done. */
static bool spread(struct predictive_search *search, const struct gait_branch *branch)
{
    (void)try_candidate(search, branch, spread_candidate(search, search->index));
    search->index++;
    if (search->index < PREDICTIVE_COARSE) {
        return false;
    }
    if (search->best_cost < REAL(0.0)) {
        predictive_search_finish(search); /* no push-off survives the next stride */
        return true;
    }
    search->answered = true;
    search->index = 0;
    search->grid_m = REAL(0.5) * spread_gap(search, search->r0_m);
    search->stage = PREDICTIVE_REFINE;
    begin_round(search);
    return true;
}

static real try_inside(struct predictive_search *search, const struct gait_branch *branch,
                       real r0_m)
{
    const bool inside = r0_m >= search->request.r0_low_m && r0_m <= search->request.r0_high_m;
    return inside ? try_candidate(search, branch, r0_m) : REAL(-1.0);
}

/* The vertex of the parabola through the round's three costs; costs near the least are one. */
static void try_vertex(struct predictive_search *search, const struct gait_branch *branch)
{
    const real *c = search->cost_at;
    const real bend = c[0] - REAL(2.0) * c[1] + c[2];
    if (c[0] < REAL(0.0) || c[2] < REAL(0.0) || !(bend > REAL(0.0))) {
        return;
    }
    const real shift = real_clamp(REAL(0.5) * (c[0] - c[2]) / bend, REAL(-2.0), REAL(2.0));
    (void)try_inside(search, branch, search->middle_m + shift * search->grid_m);
}

/* Above the best, below it, at the vertex; then closer. */
static bool refine(struct predictive_search *search, const struct gait_branch *branch)
{
    const real before_m = search->r0_m;
    switch (search->index % 3) {
    case 0:
        search->cost_at[2] = try_inside(search, branch, search->middle_m + search->grid_m);
        break;
    case 1:
        search->cost_at[0] = try_inside(search, branch, search->middle_m - search->grid_m);
        break;
    default:
        try_vertex(search, branch);
        search->grid_m *= REAL(0.25);
        begin_round(search);
        break;
    }
    search->index++;
    if (search->index >= 3 * PREDICTIVE_ROUNDS) {
        predictive_search_finish(search);
        return true;
    }
    return search->r0_m != before_m;
}

/* The caller's answer ignores the motor's limits: the search may choose it only within reach. If it
 * is the answer in any case (the search is not reliable now), its prediction is made in any case. */
static bool first(struct predictive_search *search, const struct gait_branch *branch)
{
    search->stage = PREDICTIVE_SPREAD;
    if (predictive_search_is_reliable(search)) {
        (void)try_inside(search, branch, search->request.r0_first_m);
        return false;
    }
    (void)try_candidate(search, branch, search->request.r0_first_m);
    predictive_search_finish(search);
    return true;
}

bool predictive_search_work(struct predictive_search *search, const struct gait_branch *branch)
{
    switch (search->stage) {
    case PREDICTIVE_STRIKE:
        to_strike(search);
        return search->stage == PREDICTIVE_IDLE;
    case PREDICTIVE_FIRST:
        return first(search, branch);
    case PREDICTIVE_SPREAD:
        return spread(search, branch);
    case PREDICTIVE_REFINE:
        return refine(search, branch);
    default:
        return false;
    }
}
