/* The draws of a campaign: which faults a run has, from its seed and number. */
#include "sim_host/faults/campaign.h"
#include "sim_host/faults/fault_shot.h"

void campaign_plan(uint64_t seed, uint32_t index, struct campaign_plan *plan)
{
    uint64_t state = seed * UINT64_C(0xD1342543DE82EF95) + index;
    *plan = (struct campaign_plan){.index = index};
    (void)injector_random(&state);
    plan->scene = (uint8_t)(injector_random(&state) * CAMPAIGN_SCENES);
    plan->count = injector_random(&state) < 0.3 ? 2 : 1;
    (void)fault_shot_draw(&state, (enum fault_kind)(index % FAULT_KINDS), &plan->shot[0]);
    plan->shot[0].start_tick = (uint32_t)(injector_random(&state) * CAMPAIGN_PHASE_TICKS);
    if (plan->count == 2) {
        const double second = injector_random(&state) * FAULT_KINDS;
        (void)fault_shot_draw(&state, (enum fault_kind)second, &plan->shot[1]);
        plan->shot[1].start_tick =
            plan->shot[0].start_tick + (uint32_t)(injector_random(&state) * 500.0);
    }
}
