#include "sim_host/faults/people_plan.h"

#include "model/tick.h"
#include "sim_host/faults/fault_shot.h"

enum {
    WALK_TICKS = 1200,    /* a step lasts 0.5 to 0.9 s: every phase of a stride */
    START_TICKS = 4000,   /* power-on, set-up, and the first steps */
    APART_TICKS = 500,    /* of two faults */
    WHOLE_TICKS = 1000000 /* as long as the run */
};
static const double PAIRS = 0.2, AT_START = 0.12, ASSEMBLED_AT_START = 0.75;
static const double DOSE_LEAST = 0.2, DOSE_MOST = 0.8;

/* What copies of a walk there are, in turn: walking comes more often. */
static const enum copy_kind turns[] = {
    COPY_PLAIN,   COPY_STOP,      COPY_SLOW,     COPY_QUICK, COPY_PLAIN, COPY_TRIP,
    COPY_SHORT,   COPY_LIMP,      COPY_STOP,     COPY_GAP,   COPY_PLAIN, COPY_OFFSET,
    COPY_NEUTRAL, COPY_LIMP_40,   COPY_DRIFT,    COPY_STOP,  COPY_PLAIN, COPY_HARNESS,
    COPY_QUICK,   COPY_BACKWARDS, COPY_LEG_HELD, COPY_STOP,  COPY_PLAIN, COPY_TRIP};
/* What is made without a recording, now and then. */
static const enum copy_kind strange[] = {COPY_ROCKING, COPY_SCISSORING, COPY_ON_THE_SPOT};
enum {
    TURNS = sizeof turns / sizeof turns[0],
    STRANGE = sizeof strange / sizeof strange[0],
    STRANGE_EVERY = 40
};

static double between(uint64_t *state, double low, double high)
{
    return low + (high - low) * injector_random(state);
}

static void draw_made(uint64_t *state, struct made_person_params *made)
{
    made_person_usual(made);
    made->stride_s = between(state, 0.9, 1.6);
    made->size = between(state, 0.6, 1.15);
    made->asymmetry = injector_random(state) < 0.5 ? 0.0 : between(state, 0.0, 0.3);
    made->toe_off = between(state, 0.58, 0.68);
    made->stride_scatter = between(state, 0.005, 0.03);
    made->seconds = 22.0;
    made->seed = (uint64_t)(injector_random(state) * 0x1p53);
}

static enum foot_switch_preset_kind draw_switches(uint64_t *state)
{
    const double preset = injector_random(state);
    return preset < 0.7   ? FOOT_SWITCH_SEEDED
           : preset < 0.8 ? FOOT_SWITCH_10MS
           : preset < 0.9 ? FOOT_SWITCH_20MS
                          : FOOT_SWITCH_40MS;
}

static void draw_scene(uint64_t seed, uint32_t block, unsigned recordings,
                       struct people_scene_plan *scene)
{
    uint64_t state =
        seed * UINT64_C(0xD1342543DE82EF95) + UINT64_C(0x9E3779B97F4A7C15) * (block + 1u);
    const bool made = recordings == 0 || block % 2 == 1;
    const uint32_t turn = made ? block / 2 : block / (2 * (recordings > 0 ? recordings : 1u));
    *scene =
        (struct people_scene_plan){.block = block,
                                   .source = made ? PEOPLE_MADE : (int)(block / 2 % recordings),
                                   .copy = block % STRANGE_EVERY == STRANGE_EVERY - 1
                                               ? strange[block / STRANGE_EVERY % STRANGE]
                                               : turns[turn % TURNS]};
    draw_made(&state, &scene->made);
    scene->phase = injector_random(&state);
    scene->device = injector_random(&state) < 0.7 ? 0 : 1;
    scene->switches = draw_switches(&state);
    scene->sensors = injector_random(&state) < 0.8 ? SENSORS_17BIT : SENSORS_14BIT;
    scene->seed = (uint64_t)(injector_random(&state) * 0x1p53);
}

static void draw_reflex_scene(uint64_t seed, uint32_t block, struct people_scene_plan *scene)
{
    uint64_t state =
        seed * UINT64_C(0x9FB21C651E98DF25) + UINT64_C(0x9E3779B97F4A7C15) * (block + 1u);
    *scene =
        (struct people_scene_plan){.block = block, .source = PEOPLE_REFLEX, .copy = COPY_PLAIN};
    (void)injector_random(&state);
    scene->dose = between(&state, DOSE_LEAST, DOSE_MOST);
    scene->device = injector_random(&state) < 0.7 ? 0 : 1;
    scene->switches = draw_switches(&state);
    scene->sensors = injector_random(&state) < 0.8 ? SENSORS_17BIT : SENSORS_14BIT;
    scene->seed = (uint64_t)(injector_random(&state) * 0x1p53);
}

bool people_plan_can(unsigned recordings, enum fault_kind kind)
{
    return recordings != PEOPLE_REFLEX_SCENES ||
           (kind != FAULT_PERSON_STOPS && kind != FAULT_PERSON_TURNS_BACK &&
            kind != FAULT_PERSON_HURRIES);
}

bool people_plan_befalls(enum fault_kind kind)
{
    return kind == FAULT_PUSH || kind == FAULT_SLIP || kind == FAULT_TRIP || kind == FAULT_STAIRS ||
           kind == FAULT_PERSON_FALLS;
}

bool people_plan_must_notice(enum fault_kind kind)
{
    return kind >= FAULT_LEGS_SWAPPED && kind <= FAULT_ANKLE_STUCK_AT_START;
}

/* Magnitudes that are one of few. */
static double one_of(enum fault_kind kind, double part, double magnitude)
{
    static const double slips_m[] = {-0.010, -0.005, 0.005, 0.010};
    static const double shares[] = {0.5, 0.25, 0.1};
    switch (kind) {
    case FAULT_LEGS_SWAPPED:
        return (double)(int)(part * 3.0);
    case FAULT_SENSORS_BACKWARDS:
        return (double)(int)(part * 4.0);
    case FAULT_ANKLE_SLIPPED:
        return slips_m[(int)(part * 4.0)];
    case FAULT_LEG_SCALE:
    case FAULT_ANKLE_SCALE:
    case FAULT_MOTOR_SCALE:
        return part < 0.7 ? 0.9 : 1.1;
    case FAULT_NEUTRAL_OFF:
        return part < 0.5 ? -5.0 : 5.0;
    case FAULT_FORCE_SHARE:
    case FAULT_SPEED_SHARE:
        return shares[(int)(part * 3.0)];
    default:
        return magnitude;
    }
}

static void draw_shot(uint64_t *state, enum fault_kind kind, struct fault_shot *shot)
{
    const double strength = fault_shot_draw(state, kind, shot);
    shot->magnitude = one_of(kind, strength, shot->magnitude);
}

void people_plan(uint64_t seed, uint32_t index, unsigned recordings, struct people_plan *plan)
{
    uint64_t state = seed * UINT64_C(0xA24BAED4963EE407) + index;
    const enum fault_kind kind = (enum fault_kind)(index % FAULT_ALL_KINDS);
    const bool assembled = fault_kinds[kind].group == FAULT_GROUP_ASSEMBLY;
    *plan = (struct people_plan){.index = index};
    (void)injector_random(&state);
    if (recordings == PEOPLE_REFLEX_SCENES) {
        draw_reflex_scene(seed, index / PEOPLE_BLOCK, &plan->scene);
    } else {
        draw_scene(seed, index / PEOPLE_BLOCK, recordings, &plan->scene);
    }
    plan->count = injector_random(&state) < PAIRS && kind != FAULT_NOTHING ? 2 : 1;
    plan->from_power_on = injector_random(&state) < (assembled ? ASSEMBLED_AT_START : AT_START);
    draw_shot(&state, kind, &plan->shot[0]);
    const double start = injector_random(&state);
    if (plan->from_power_on && assembled) {
        plan->count = 1;
        plan->shot[0].start_tick = 0;
        plan->shot[0].duration_ticks = WHOLE_TICKS;
    } else {
        plan->shot[0].start_tick =
            (uint32_t)(start * (plan->from_power_on ? START_TICKS : WALK_TICKS));
    }
    if (plan->count == 2) {
        const enum fault_kind second = (enum fault_kind)(injector_random(&state) * FAULT_ALL_KINDS);
        plan->count = people_plan_can(recordings, second) ? 2 : 1;
        draw_shot(&state, second, &plan->shot[1]);
        plan->shot[1].start_tick =
            plan->shot[0].start_tick + (uint32_t)(injector_random(&state) * APART_TICKS);
    }
}
