#include "controller/laws/law_table.h"
#include "controller/laws/proportional.h"
#include "controller/laws/step_law.h"

static void init(struct step_law *law, const struct control_params *params)
{
    const struct walker_params walker = {params->torso_mass_kg, params->leg_mass_kg,
                                         params->leg_length_m, params->spring_stiffness_n_m,
                                         params->gravity_m_s2};
    /* Each parameter's range lies inside the model's, but their ratios need not: then there is no
     * search, and eq. (16) answers. */
    law->searchable = predictive_search_init(&law->predictive, &walker) == 0;
}

/* Sets the search up. Returns the answer to begin with, eq. (16)'s: its command stays near the
 * speed walked, so that eq. (16) can take over at any step. */
static real step(struct step_law *law, const struct control_params *params, const struct apex *apex,
                 real desired_rad_s)
{
    const real measured_rad_s = -apex->stance_rate_rad_s;
    law->command_rad_s = real_clamp(law->command_rad_s, measured_rad_s - params->speed_ramp_rad_s,
                                    measured_rad_s + params->speed_ramp_rad_s);
    const real first_m = proportional_step(law, params, apex, desired_rad_s);
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
        .r0_first_m = real_clamp(step_law_approach(law->r0_m, first_m, params->r0_change_max_m),
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
    predictive_search_begin(&law->predictive, params->branch, &request);
    law->is_final = false;
    law->used_fallback = true; /* until the search has an answer */
    return first_m;
}

static void copy_answer(struct step_law *law)
{
    law->r0_m = law->predictive.r0_m;
    law->is_final = law->predictive.stage == PREDICTIVE_IDLE;
    law->used_fallback = !law->predictive.answered;
    law->target_speed_rad_s =
        law->used_fallback ? law->command_rad_s : law->predictive.target_speed_rad_s;
}

static bool work(struct step_law *law, const struct control_params *params)
{
    const bool news = predictive_search_work(&law->predictive, params->branch);
    if (news) {
        copy_answer(law);
    }
    return news;
}

static void finish(struct step_law *law)
{
    predictive_search_finish(&law->predictive);
    copy_answer(law);
}

const struct law LAW_ROW(predictive) = {
    .init = init,
    .step = step,
    .work = work,
    .finish = finish,
    .needs_branch = true,
    .keeps_within_reach = true,
};
