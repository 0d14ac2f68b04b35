/* What a plant is set up with: defaults for a body, and the limits of every field. */
#include <stdio.h>
#include <string.h>

#include "model/tick.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/plant/plant_internal.h"
#include "sim_host/plant/range.h"

static const struct walker3_params PAPER_BODY = {
    .hip_mass_kg = 1.0, .leg_mass_kg = 0.01, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};
static const double PAPER_SPRING_N_PER_M = 100.0;
static const double START_PUSH_OFF = 0.05; /* of the leg's length */

/* Just after lift-off of the gait at START_PUSH_OFF, for this body and spring. A body
 * that has no such gait gets the paper's angles, its rates scaled by sqrt(g/l). */
static void start_pose(const struct walker3_params *body, double spring_N_per_m,
                       struct walk_pose *pose)
{
    static const double PAPER_LIFT_OFF[4] = {0.175299021, -0.354600794, -0.691599930, -0.568335556};
    const struct gait_walker subject = {body->hip_mass_kg, body->leg_mass_kg, body->leg_length_m,
                                        spring_N_per_m, body->gravity_m_s2};
    const double rate = __builtin_sqrt(body->gravity_m_s2 / body->leg_length_m / 9.80665);
    struct gait_point gait;
    *pose = (struct walk_pose){SIDE_LEFT, PAPER_LIFT_OFF[0], PAPER_LIFT_OFF[1],
                               PAPER_LIFT_OFF[2] * rate, PAPER_LIFT_OFF[3] * rate};
    if (gait_curve(&subject, START_PUSH_OFF * body->leg_length_m, 0.0, 1, &gait, NULL) ==
        GAIT_CURVE_OK) {
        *pose = (struct walk_pose){SIDE_LEFT, gait.lift_off[0], gait.lift_off[1], gait.lift_off[2],
                                   gait.lift_off[3]};
    }
}

void plant_config_for(const struct walker3_params *body, double spring_N_per_m,
                      enum sea_preset_kind sea, enum sensor_preset_kind sensors,
                      struct plant_config *config)
{
    const struct sea_subject subject = {
        .total_mass_kg = body->hip_mass_kg + 2.0 * body->leg_mass_kg,
        .leg_length_m = body->leg_length_m,
        .gravity_m_s2 = body->gravity_m_s2,
        .spring_N_per_m = spring_N_per_m,
    };
    memset(config, 0, sizeof *config);
    config->kind = PLANT_WALKER;
    config->tick_s = TICK_PERIOD_US / 1e6;
    config->seed = 1;
    walk_params_default(body, &config->walk);
    start_pose(body, spring_N_per_m, &config->start);
    start_hold_params_default(body->leg_length_m, &config->start_hold);
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_preset(sea, &subject, &config->sea[side]);
        sensor_preset(sensors, &config->sensors[side]);
    }
    recording_format_default(&config->recording_format);
    config->recording_start_tick = config->start_hold.release_tick;
}

void plant_config_default(struct plant_config *config)
{
    plant_config_for(&PAPER_BODY, PAPER_SPRING_N_PER_M, SEA_REAL, SENSORS_17BIT, config);
}

static enum plant_error complain(enum plant_error error, char *message, const char *part,
                                 const char *field)
{
    (void)snprintf(message, PLANT_ERROR_MAX, "%s: %s is out of range", part, field);
    return error;
}

static const char *check_pose(const struct walk_pose *pose)
{
    const struct range ranges[] = {
        {"theta_s_rad", pose->theta_s_rad, -1.5, 1.5},
        {"theta_n_rad", pose->theta_n_rad, -1.5, 1.5},
        {"theta_s_rate_rad_s", pose->theta_s_rate_rad_s, -100.0, 100.0},
        {"theta_n_rate_rad_s", pose->theta_n_rate_rad_s, -100.0, 100.0},
    };
    if (pose->stance != SIDE_LEFT && pose->stance != SIDE_RIGHT) {
        return "stance";
    }
    return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
}

/* The tick and both drives' periods must fit into each other. */
static bool periods_fit(const struct plant_config *config)
{
    const double period_s = config->sea[SIDE_LEFT].drive_period_s;
    const double periods = config->tick_s / period_s;
    const double off = periods - (double)(int)(periods + 0.5);
    return config->tick_s >= 1e-4 && config->tick_s <= 1e-2 && periods >= 0.5 && off < 1e-6 &&
           off > -1e-6 && config->sea[SIDE_RIGHT].drive_period_s == period_s;
}

enum plant_error plant_config_check(const struct plant_config *config, char *message)
{
    static const char *const SIDES[SIDE_COUNT] = {"left", "right"};
    char part[32];
    const char *bad = walk_params_check(&config->walk);
    if (bad != NULL) {
        const bool body = walker3_params_check(&config->walk.body) != WALKER3_PARAMS_OK;
        return complain(body ? PLANT_BAD_BODY : PLANT_BAD_WALK, message, body ? "body" : "walk",
                        bad);
    }
    if ((bad = check_pose(&config->start)) != NULL) {
        return complain(PLANT_BAD_START, message, "start", bad);
    }
    if ((bad = start_hold_params_check(&config->start_hold)) != NULL) {
        return complain(PLANT_BAD_START_HOLD, message, "start hold", bad);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        if ((bad = sea_params_check(&config->sea[side])) != NULL) {
            (void)snprintf(part, sizeof part, "sea %s", SIDES[side]);
            return complain(PLANT_BAD_SEA, message, part, bad);
        }
        if ((bad = sensor_params_check(&config->sensors[side])) != NULL) {
            (void)snprintf(part, sizeof part, "sensor %s", SIDES[side]);
            return complain(PLANT_BAD_SENSOR, message, part, bad);
        }
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        if ((bad = foot_switch_params_check(&config->foot_switch[side])) != NULL) {
            (void)snprintf(part, sizeof part, "foot switch %s", SIDES[side]);
            return complain(PLANT_BAD_FOOT_SWITCH, message, part, bad);
        }
    }
    if (config->kind == PLANT_REFLEX_PERSON) {
        struct reflex_person_params reflex = config->reflex;
        reflex.step_s = config->sea[SIDE_LEFT].drive_period_s;
        if ((bad = reflex_person_check(&reflex)) != NULL) {
            return complain(PLANT_BAD_PERSON, message, "reflex person", bad);
        }
    }
    if (!periods_fit(config)) {
        return complain(PLANT_BAD_TICK, message, "tick", "tick_s or drive_period_s");
    }
    if (!(config->roughness_m >= 0.0 && config->roughness_m <= 1.0) ||
        (config->heights_m == NULL && config->heights_count > 0)) {
        return complain(PLANT_BAD_GROUND, message, "ground", "roughness_m or heights_m");
    }
    return PLANT_OK;
}
