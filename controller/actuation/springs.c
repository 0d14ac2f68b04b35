#include "controller/actuation/springs.h"

void springs_begin(struct springs *springs, const struct control_params *params,
                   const struct controller_input *input)
{
    springs->stop = sea_reference_stop_limits(params);
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_reference_init(&springs->sea[side], input->sea[side].precompression_m);
    }
}

void springs_stop(struct springs *springs, const struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_reference_stop(&springs->sea[side], &springs->stop, input->sea[side].precompression_m);
    }
}

static void begin_loading(struct springs *springs, const struct step_decision *decision,
                          const struct controller_input *input, enum side side)
{
    if (decision->assists && !input->sea[side].absent) {
        sea_reference_begin_loading(&springs->sea[side], decision->load_m);
    }
}

void springs_follow(struct springs *springs, const struct step_decision *decision,
                    const struct controller_input *input, const struct gait_state *gait,
                    bool first_stance)
{
    const struct gait_event *strike = &gait->event[GAIT_HEEL_STRIKE];
    const struct gait_event *lift_off = &gait->event[GAIT_LIFT_OFF];
    if (decision->improved) { /* not final yet: on the way there already, but not armed */
        begin_loading(springs, decision, input, decision->side);
    }
    if (decision->new_step) {
        sea_reference_set_target(&springs->sea[decision->side], decision->load_m);
    }
    if (strike->happened) {
        begin_loading(springs, decision, input, strike->side);
    }
    if (lift_off->happened) {
        sea_reference_unload(&springs->sea[lift_off->side]);
    }
    if (first_stance && gait->phase == PHASE_SINGLE_SUPPORT &&
        springs->sea[gait->stance].phase == SEA_UNLOADED) {
        begin_loading(springs, decision, input, gait->stance);
    }
}

/* No push before the other foot can carry the person: their ankle can extend in midstance, too,
 * and an armed latch would take that for the push-off. */
static bool may_release(const struct gait_state *gait, enum side side)
{
    return gait->strike_near && gait->stance == side;
}

void springs_command(struct springs *springs, const struct control_params *params,
                     const struct controller_input *input, enum supervisor_state state,
                     const struct gait_state *gait, struct sea_request request[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_measurement *sea = &input->sea[side];
        request[side] = sea_reference_update(&springs->sea[side], params, sea->precompression_m);
        /* A drive that is not heard while it is to unload does it by itself. */
        const bool silent = state == SUPERVISOR_UNLOADING &&
                            sea->age_ticks > ticks_from_seconds(params->sensor_age_max_s);
        request[side].enable = !silent;
        request[side].latch_armed = request[side].latch_armed && may_release(gait, (enum side)side);
    }
}
