#include "sim_host/plant/foot_switch.h"

#include <stddef.h>

#include "sim_host/plant/range.h"

static const double BIAS_MOST_S = 0.040;
static const double JITTER_S = 0.003;
static const double BOUNCE_S = 0.004;
/* The fault "false": at a time drawn from these after the foot has left the ground, for so long. */
static const double FALSE_FIRST_S = 0.100;
static const double FALSE_LAST_S = 0.500;
static const double FALSE_FOR_S = 0.030;

const char *const foot_switch_preset_names[FOOT_SWITCH_PRESET_COUNT] = {"none", "seeded", "exact",
                                                                        "10ms", "20ms",   "40ms"};
const char *const foot_switch_fault_names[FOOT_SWITCH_FAULT_COUNT] = {
    "well", "stuck-up", "stuck-down", "missing", "chatter", "false"};

void foot_switch_preset(enum foot_switch_preset_kind kind, uint64_t seed, uint64_t stream,
                        struct foot_switch_params *params)
{
    static const double fixed_s[FOOT_SWITCH_PRESET_COUNT] = {0.0, 0.0, 0.0, 0.01, 0.02, 0.04};
    struct rng rng;
    *params = (struct foot_switch_params){.present = kind != FOOT_SWITCH_NONE};
    params->close_bias_s = params->open_bias_s = fixed_s[kind];
    if (kind == FOOT_SWITCH_SEEDED) {
        rng_init(&rng, seed, stream);
        params->close_bias_s = BIAS_MOST_S * rng_uniform(&rng);
        params->open_bias_s = BIAS_MOST_S * rng_uniform(&rng);
    }
    if (kind != FOOT_SWITCH_NONE && kind != FOOT_SWITCH_EXACT) {
        params->jitter_s = JITTER_S;
        params->bounce_s = BOUNCE_S;
    }
}

const char *foot_switch_params_check(const struct foot_switch_params *params)
{
    const struct range ranges[] = {
        {"close_bias_s", params->close_bias_s, 0.0, 0.1},
        {"open_bias_s", params->open_bias_s, 0.0, 0.1},
        {"jitter_s", params->jitter_s, 0.0, 0.05},
        {"bounce_s", params->bounce_s, 0.0, 0.02},
    };
    if ((unsigned)params->fault >= FOOT_SWITCH_FAULT_COUNT) {
        return "fault";
    }
    return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
}

void foot_switch_init(struct foot_switch *foot, const struct foot_switch_params *params, bool down,
                      uint64_t seed, uint64_t stream)
{
    *foot = (struct foot_switch){
        .params = *params, .foot_down = down, .down = down, .bounce_until_s = -1.0};
    rng_init(&foot->rng, seed, stream);
}

/* An edge of the foot is on its way to the signal; edges keep their order. */
static void send_edge(struct foot_switch *foot, bool down, double now_s)
{
    const double bias_s = down ? foot->params.close_bias_s : foot->params.open_bias_s;
    double time_s = now_s + bias_s + foot->params.jitter_s * rng_uniform(&foot->rng);
    if (foot->edges > 0 && time_s < foot->edge[foot->edges - 1].time_s) {
        time_s = foot->edge[foot->edges - 1].time_s;
    }
    if (foot->edges < FOOT_SWITCH_EDGES) {
        foot->edge[foot->edges].time_s = time_s;
        foot->edge[foot->edges].down = down;
        foot->edges++;
    } else {
        foot->edge[FOOT_SWITCH_EDGES - 1].down = down;
    }
}

static void deliver_edges(struct foot_switch *foot, double now_s)
{
    while (foot->edges > 0 && foot->edge[0].time_s <= now_s) {
        foot->down = foot->edge[0].down;
        foot->bounce_until_s = now_s + foot->params.bounce_s;
        foot->false_s =
            now_s + FALSE_FIRST_S + (FALSE_LAST_S - FALSE_FIRST_S) * rng_uniform(&foot->rng);
        foot->edges--;
        for (unsigned i = 0; i < foot->edges; i++) {
            foot->edge[i] = foot->edge[i + 1];
        }
    }
}

static enum foot_contact contact_of(bool down)
{
    return down ? FOOT_DOWN : FOOT_UP;
}

static enum foot_contact faulty(struct foot_switch *foot, double now_s)
{
    switch (foot->params.fault) {
    case FOOT_SWITCH_STUCK_UP:
        return FOOT_UP;
    case FOOT_SWITCH_STUCK_DOWN:
        return FOOT_DOWN;
    case FOOT_SWITCH_MISSING:
        return FOOT_UNKNOWN;
    case FOOT_SWITCH_CHATTER:
        return contact_of(rng_uniform(&foot->rng) < 0.5);
    case FOOT_SWITCH_FALSE:
        return contact_of(foot->down ||
                          (now_s >= foot->false_s && now_s < foot->false_s + FALSE_FOR_S));
    default:
        return contact_of(foot->down);
    }
}

enum foot_contact foot_switch_update(struct foot_switch *foot, bool down, bool known, double now_s)
{
    if (!foot->params.present || !known) {
        return FOOT_UNKNOWN;
    }
    if (down != foot->foot_down) {
        foot->foot_down = down;
        send_edge(foot, down, now_s);
    }
    deliver_edges(foot, now_s);
    if (foot->params.fault != FOOT_SWITCH_WELL && now_s >= foot->params.fault_from_s) {
        return faulty(foot, now_s);
    }
    if (now_s < foot->bounce_until_s) {
        return contact_of(rng_uniform(&foot->rng) < 0.5);
    }
    return contact_of(foot->down);
}
