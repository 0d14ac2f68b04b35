/* The draws of a campaign: which faults a run has, from its seed and number. */
#include "sim_host/faults/campaign.h"

static void plan_shot(uint64_t *state, enum fault_kind kind, struct fault_shot *shot)
{
    const struct fault_kind_info *info = &fault_kinds[kind];
    const double span = (double)(info->longest_ms - info->shortest_ms);
    const double part = injector_random(state); /* cubed: short ones more often than long */
    shot->kind = kind;
    shot->node = (uint8_t)(injector_random(state) * 4.0);
    shot->duration_ticks =
        TICKS_OF_MS(info->shortest_ms + (uint32_t)(span * part * part * part + 0.5));
    shot->magnitude = info->least + (info->greatest - info->least) * injector_random(state);
    shot->seed = (uint64_t)(injector_random(state) * 0x1p53);
}

void campaign_plan(uint64_t seed, uint32_t index, struct campaign_plan *plan)
{
    uint64_t state = seed * UINT64_C(0xD1342543DE82EF95) + index;
    *plan = (struct campaign_plan){.index = index};
    (void)injector_random(&state);
    plan->scene = (uint8_t)(injector_random(&state) * CAMPAIGN_SCENES);
    plan->count = injector_random(&state) < 0.3 ? 2 : 1;
    plan_shot(&state, (enum fault_kind)(index % FAULT_KINDS), &plan->shot[0]);
    plan->shot[0].start_tick = (uint32_t)(injector_random(&state) * CAMPAIGN_PHASE_TICKS);
    if (plan->count == 2) {
        const double second = injector_random(&state) * FAULT_KINDS;
        plan_shot(&state, (enum fault_kind)second, &plan->shot[1]);
        plan->shot[1].start_tick =
            plan->shot[0].start_tick + (uint32_t)(injector_random(&state) * 500.0);
    }
}
