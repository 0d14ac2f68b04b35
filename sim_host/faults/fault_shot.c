#include "sim_host/faults/fault_shot.h"

#include "model/tick.h"
#include "sim_host/faults/fault_kinds.h"

double fault_shot_draw(uint64_t *state, enum fault_kind kind, struct fault_shot *shot)
{
    const struct fault_kind_info *info = &fault_kinds[kind];
    const double span = (double)(info->longest_ms - info->shortest_ms);
    const double part = injector_random(state); /* cubed: short ones more often than long */
    shot->kind = kind;
    shot->node = (uint8_t)(injector_random(state) * 4.0);
    shot->duration_ticks =
        TICKS_OF_MS(info->shortest_ms + (uint32_t)(span * part * part * part + 0.5));
    const double strength = injector_random(state);
    shot->magnitude = info->least + (info->greatest - info->least) * strength;
    shot->seed = (uint64_t)(injector_random(state) * 0x1p53);
    return strength;
}

void fault_shot_tell(FILE *stream, const struct fault_shot *shot, bool another)
{
    const struct fault_kind_info *info = &fault_kinds[shot->kind];
    fprintf(stream, "%s %s", another ? " and" : "", info->name);
    if (info->least != info->greatest) {
        fprintf(stream, " %.4g%s%s", shot->magnitude, info->unit[0] != '\0' ? " " : "", info->unit);
    }
    fprintf(stream, ", node %u, from tick %u for %u;", shot->node, shot->start_tick,
            shot->duration_ticks);
}

void fault_tick_tell(FILE *stream, const char *what, uint32_t tick)
{
    if (tick != UINT32_MAX) {
        fprintf(stream, ", %s at %u", what, tick);
    }
}
