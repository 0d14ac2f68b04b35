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

void fault_shots_describe(struct json_writer *json, const struct fault_shot *shot, unsigned count)
{
    json_open_list(json, "faults");
    for (unsigned i = 0; i < count; i++) {
        json_open_object(json, NULL);
        json_text(json, "name", fault_kinds[shot[i].kind].name);
        json_unsigned(json, "node", shot[i].node);
        json_unsigned(json, "start_tick", shot[i].start_tick);
        json_unsigned(json, "duration_ticks", shot[i].duration_ticks);
        json_number(json, "magnitude", shot[i].magnitude, 9);
        json_text(json, "unit", fault_kinds[shot[i].kind].unit);
        json_close_object(json);
    }
    json_close_list(json);
}
