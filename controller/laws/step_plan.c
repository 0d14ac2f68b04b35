#include "controller/laws/step_plan.h"

void step_plan_begin(struct step_plan *plan, const struct control_params *params)
{
    step_law_init(&plan->law, params);
    plan->change_max_m = params->r0_change_max_m;
    plan->assist_level = control_params_test_mode(params) ? REAL(1.0) : REAL(0.0);
    plan->assist_most = REAL(1.0);
    plan->step_pending = false;
}

void step_plan_raise_assist(struct step_plan *plan, const struct control_params *params)
{
    if (!control_params_test_mode(params)) {
        const real assist_level = plan->assist_level + REAL(1.0) / params->engage_ramp_steps;
        plan->assist_level = assist_level < plan->assist_most ? assist_level : plan->assist_most;
    }
}

void step_plan_lower_assist(struct step_plan *plan, const struct control_params *params)
{
    if (!control_params_test_mode(params)) {
        plan->assist_level *= REAL(0.75);
        plan->assist_most = plan->assist_level;
    }
}

void step_plan_fade(struct step_plan *plan, real share)
{
    plan->assist_level *= share;
    plan->assist_most = plan->assist_level;
}

void step_plan_bear(struct step_plan *plan, real share)
{
    plan->device_share = share;
}

/* Of the law's answer: what is given. */
static real level_of(const struct step_plan *plan)
{
    return plan->assist_level * plan->device_share;
}

static void begin_step(struct step_plan *plan, const struct control_params *params,
                       const struct gait_state *gait, real desired_speed_rad_s)
{
    const struct gait_event *apex = &gait->event[GAIT_APEX];
    step_law_finish(&plan->law, params); /* an apex without a push-off in between */
    (void)step_law_update(&plan->law, params, &gait->apex, desired_speed_rad_s);
    plan->pending_step = (struct step_record){.number = plan->law.steps,
                                              .tick = apex->tick,
                                              .side = apex->side,
                                              .measured_speed_rad_s = apex->speed_rad_s};
    plan->step_pending = true;
}

/* The step's precompression is decided. The law keeps its limits; like the guard, this bounds the
 * change without the parameters. */
static void finish_step(struct step_plan *plan, struct step_record *step)
{
    const real before_m = step->r0_m, limit_m = plan->change_max_m;
    real r0_m = level_of(plan) * plan->law.r0_m;
    if (step->number > 0 && plan->pending_step.number > step->number) { /* of the same walk */
        r0_m = real_clamp(r0_m, before_m - limit_m, before_m + limit_m);
    }
    plan->step_pending = false;
    *step = plan->pending_step;
    step->r0_m = r0_m;
    step->commanded_speed_rad_s = plan->law.target_speed_rad_s;
    step->used_fallback = plan->law.used_fallback;
}

struct step_decision step_plan_update(struct step_plan *plan, const struct control_params *params,
                                      const struct gait_state *gait, real desired_speed_rad_s,
                                      struct step_record *step)
{
    struct step_decision decision = {.assists = level_of(plan) > REAL(0.0)};
    if (gait->event[GAIT_APEX].happened) {
        begin_step(plan, params, gait, desired_speed_rad_s);
    } else if (!plan->law.is_final) {
        if (gait->event[GAIT_HEEL_STRIKE].happened) {
            step_law_finish(&plan->law, params);
        } else {
            decision.improved = step_law_work(&plan->law, params);
        }
    }
    if (plan->step_pending && plan->law.is_final) {
        finish_step(plan, step);
        decision.new_step = true;
    }
    const bool given = plan->law.steps > 0 && plan->law.is_final;
    decision.load_m = given ? step->r0_m : level_of(plan) * plan->law.r0_m;
    decision.side = plan->pending_step.side;
    return decision;
}
