#include "controller/laws/step_law.h"

static real approach(real from, real to, real largest_change)
{
    return from + real_clamp(to - from, -largest_change, largest_change);
}

void step_law_init(struct step_law *law, const struct control_params *params)
{
    law->command_rad_s = speed_table_speed(&params->table, params->start_r0_m);
    law->target_speed_rad_s = law->command_rad_s;
    law->r0_m = params->start_r0_m;
    law->mean_rad_s = REAL(0.0);
    law->steps = 0;
    law->is_final = true;
    law->used_fallback = false;
    const struct walker_params walker = {params->torso_mass_kg, params->leg_mass_kg,
                                         params->leg_length_m, params->spring_stiffness_n_m,
                                         params->gravity_m_s2};
    /* Each parameter's range lies inside the model's, but their ratios need not: then there is no search, and eq. (16)
     * answers. */
    law->searchable = predictive_law_init(&law->predictive, &walker) == 0;
}

static real proportional(struct step_law *law, const struct control_params *params,
                         real measured_rad_s, real desired_rad_s)
{
    law->command_rad_s = approach(law->command_rad_s, desired_rad_s, params->speed_ramp_rad_s);
    const real feed_forward_m = speed_table_inverse(&params->table, law->command_rad_s);
    return feed_forward_m - params->kp_m_s_rad * (law->command_rad_s - measured_rad_s);
}

static real open_loop(struct step_law *law, const struct control_params *params)
{
    const real r0_m = approach(law->r0_m, params->open_loop_r0_m, params->open_loop_ramp_m);
    law->command_rad_s = speed_table_speed(&params->table, r0_m);
    return r0_m;
}

/* The mean over all steps so far, then over about the last PERSON_MEAN_STEPS; this
 * step is compared with the mean before it. */
static real person(struct step_law *law, const struct control_params *params, real measured_rad_s)
{
    if (law->mean_rad_s == REAL(0.0)) { /* the first apex that was a number */
        law->mean_rad_s = measured_rad_s;
    }
    law->command_rad_s = law->mean_rad_s;
    const uint32_t over = law->steps < PERSON_MEAN_STEPS ? law->steps : PERSON_MEAN_STEPS;
    law->mean_rad_s += (measured_rad_s - law->mean_rad_s) / (real)over;
    return params->start_r0_m - params->kp_m_s_rad * (law->command_rad_s - measured_rad_s);
}

/* Feedback of the whole apex state with gains scheduled over the branch. */
static real state_feedback(struct step_law *law, const struct control_params *params,
                           const struct apex *apex, real desired_rad_s)
{
    struct gait_branch_point gait;
    real departure[3];
    law->command_rad_s = approach(law->command_rad_s, desired_rad_s, params->speed_ramp_rad_s);
    const real speed_rad_s = gait_branch_at(params->branch, law->command_rad_s, &gait);
    gait_branch_departure(&gait, speed_rad_s, apex, departure);
    const real *gain = params->law == (real)LAW_DLQR ? gait.lqr_gain : gait.deadbeat_gain;
    return gait.r0_m - (gain[0] * departure[0] + gain[1] * departure[1] + gain[2] * departure[2]);
}

/* Sets the search up; returns the answer to begin with, eq. (16)'s, whose command is kept near the
 * speed walked, so that it is fit to take over. */
static real begin_search(struct step_law *law, const struct control_params *params,
                         const struct apex *apex, real desired_rad_s)
{
    const real measured_rad_s = -apex->stance_rate_rad_s;
    law->command_rad_s = real_clamp(law->command_rad_s, measured_rad_s - params->speed_ramp_rad_s,
                                    measured_rad_s + params->speed_ramp_rad_s);
    const real first_m = proportional(law, params, measured_rad_s, desired_rad_s);
    if (!law->searchable) {
        law->used_fallback = true;
        return first_m;
    }
    const real low_m = law->r0_m - params->r0_change_max_m;
    const real high_m = law->r0_m + params->r0_change_max_m;
    const struct predictive_request request = {
        .apex = *apex,
        .target_speed_rad_s = desired_rad_s,
        .terrain_speed_rad_s = params->terrain_speed_rad_s,
        .r0_first_m = real_clamp(approach(law->r0_m, first_m, params->r0_change_max_m),
                                 params->r0_min_m, params->r0_max_m),
        .r0_low_m = low_m > params->r0_min_m ? low_m : params->r0_min_m,
        .r0_high_m = high_m < params->r0_max_m ? high_m : params->r0_max_m,
        .r0_from_m = law->r0_m,
        .motor_speed_m_s = params->sea_speed_max_m_s,
        .motor_acceleration_m_s2 = params->sea_acceleration_m_s2,
        .report_delay_s =
            params->apex_window_s + params->sensor_latency_s + REAL(2.0) * CONTROL_PERIOD_S,
        .tick_s = CONTROL_PERIOD_S,
    };
    predictive_law_begin(&law->predictive, params->branch, &request);
    law->is_final = false;
    law->used_fallback = true; /* until the search has an answer */
    return first_m;
}

static real limited(const struct step_law *law, const struct control_params *params, real wanted_m)
{
    return real_clamp(approach(law->r0_m, wanted_m, params->r0_change_max_m), params->r0_min_m,
                      params->r0_max_m);
}

real step_law_update(struct step_law *law, const struct control_params *params,
                     const struct apex_estimate *estimate, real desired_rad_s)
{
    const struct apex apex = {estimate->stance_rate_rad_s, estimate->swing_angle_rad,
                              estimate->swing_rate_rad_s};
    const real measured_rad_s = -apex.stance_rate_rad_s;
    const bool whole_state = params->law == (real)LAW_DLQR || params->law == (real)LAW_DEADBEAT ||
                             params->law == (real)LAW_PREDICTIVE;
    if (law->steps < UINT32_MAX) {
        law->steps++;
    }
    law->is_final = true;
    if (!real_is_finite(measured_rad_s) || !real_is_finite(desired_rad_s) ||
        (whole_state && !real_is_finite(apex.swing_angle_rad + apex.swing_rate_rad_s))) {
        return law->r0_m;
    }
    real wanted_m;
    if (params->law == (real)LAW_OPEN_LOOP) {
        wanted_m = open_loop(law, params);
    } else if (params->law == (real)LAW_PERSON) {
        wanted_m = person(law, params, measured_rad_s);
    } else if (params->law == (real)LAW_PREDICTIVE) {
        wanted_m = begin_search(law, params, &apex, desired_rad_s);
    } else if (whole_state) {
        wanted_m = state_feedback(law, params, &apex, desired_rad_s);
    } else {
        wanted_m = proportional(law, params, measured_rad_s, desired_rad_s);
    }
    law->target_speed_rad_s = law->command_rad_s;
    law->r0_m = limited(law, params, wanted_m);
    return law->r0_m;
}

static void take_answer(struct step_law *law)
{
    law->r0_m = law->predictive.r0_m;
    law->is_final = law->predictive.stage == PREDICTIVE_IDLE;
    law->used_fallback = !law->predictive.answered;
    law->target_speed_rad_s =
        law->used_fallback ? law->command_rad_s : law->predictive.target_speed_rad_s;
}

bool step_law_work(struct step_law *law, const struct control_params *params)
{
    if (law->is_final) {
        return false;
    }
    const bool news = predictive_law_work(&law->predictive, params->branch);
    if (news) {
        take_answer(law);
    }
    return news;
}

void step_law_finish(struct step_law *law)
{
    if (!law->is_final) {
        predictive_law_finish(&law->predictive);
        take_answer(law);
    }
}
