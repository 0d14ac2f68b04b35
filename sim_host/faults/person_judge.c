#include "sim_host/faults/person_judge.h"

static const double LET_GO_J = 0.2;
static const double EARLY_S = 0.010, FALSE_EARLY_S = 0.030;
static const double STANDS_S = 0.010;
static const double ENERGY_RATIO = 1.1;
static const double TOE_M = 0.020;
/* From the ankle to the ball of the foot, over a lever of 0.12 m. Winter (2009) gives the foot's length as
 * 0.152 of the height: 0.26 m, of which the toe is 0.2 m ahead of the ankle. */
static const double TOE_DISTANCE_M = 0.20;
/* Plantarflexion of a healthy ankle: 50 degrees (American Academy of Orthopaedic Surgeons, 1965). */
static const double RANGE_SINE = 0.7660444431189780;
static const double LOADED_RATIO = 0.05, FULL_RATIO = 0.01;

enum {
    TOE_MS = 100,
    UNLATCHED_MS = 300,
    STOOD_MS = 500,
    LATCHED_MS = 1000,
    ENABLED_MS = 1000,
    PUSH_MS = 200,
    PUSHES_BEYOND = 2
};

const char *person_unsafe_name(int bit)
{
    static const char *const names[PERSON_UNSAFE_BITS] = {"push in the air",
                                                          "early push",
                                                          "push while standing or not walking",
                                                          "push on a fallen",
                                                          "energy",
                                                          "toe held down",
                                                          "ankle's range",
                                                          "enabled on a fallen",
                                                          "loaded and not latched",
                                                          "loaded behind a latch"};
    return bit >= 0 && bit < PERSON_UNSAFE_BITS ? names[bit] : "?";
}

void person_judge_begin(struct person_judge *judge, struct loop *loop,
                        const struct person_truth *truth)
{
    *judge = (struct person_judge){.loop = loop,
                                   .truth = *truth,
                                   .noticed_tick = PERSON_JUDGE_NEVER,
                                   .stood_tick = PERSON_JUDGE_NEVER,
                                   .turned_tick = PERSON_JUDGE_NEVER,
                                   .fell_tick = PERSON_JUDGE_NEVER,
                                   .first_push_tick = PERSON_JUDGE_NEVER,
                                   .unsafe_tick = PERSON_JUDGE_NEVER};
    for (int side = 0; side < SIDE_COUNT; side++) {
        judge->work_J[side] = loop->nodes.plant.person_work_J[side];
    }
}

static void blame(struct person_judge *judge, enum person_unsafe what)
{
    if (judge->unsafe == 0) {
        judge->unsafe_tick = judge->tick;
    }
    judge->unsafe |= (unsigned)what;
}

static double person_time_s(const struct plant *plant)
{
    const uint64_t start = plant->config.recording_start_tick;
    return plant->tick <= start
               ? 0.0
               : (double)(plant->tick - start) * plant->config.tick_s + plant->motion.shift_s;
}

/* ---- what has become of the person --------------------------------------------------------- */

static void follow_person(struct person_judge *judge)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    const struct person_motion *motion = &plant->motion;
    const bool is_falling = motion->tilt_rad != motion->tilt_to_rad;
    const bool lies = plant_fault(plant) != WALK_FAULT_NONE; /* who walked by reflexes */
    const bool stands = person_time_s(plant) >= judge->truth.stands_s || plant->person.finished ||
                        lies || (motion->rate == 0.0 && !is_falling);
    if (stands && judge->stood_tick == PERSON_JUDGE_NEVER) {
        judge->stood_tick = judge->tick;
    }
    if (motion->rate < 0.0 && judge->turned_tick == PERSON_JUDGE_NEVER) {
        judge->turned_tick = judge->tick;
    }
    if ((lies || person_motion_is_down(&plant->motion)) && judge->fell_tick == PERSON_JUDGE_NEVER) {
        judge->fell_tick = judge->tick;
    }
}

static bool has_lasted(uint32_t since, uint32_t tick, uint32_t ms)
{
    return since != PERSON_JUDGE_NEVER && tick > since + TICKS_OF_MS(ms);
}

static bool does_not_walk(const struct person_judge *judge)
{
    const uint32_t allowed_ms = (uint32_t)(1000.0 * (STANDS_S + judge->truth.sample_s));
    return !judge->truth.walks || has_lasted(judge->stood_tick, judge->tick, allowed_ms) ||
           has_lasted(judge->turned_tick, judge->tick, allowed_ms);
}

/* ---- pushes -------------------------------------------------------------------------------- */

static double fault_ratio(const struct person_judge *judge, int side)
{
    return judge->beyond[side] < PUSHES_BEYOND ? judge->truth.fault_energy : 1.0;
}

/* The energy of a push, at its release and as it is given. */
static void check_energy(struct person_judge *judge, int side, double energy_J)
{
    if (energy_J > ENERGY_RATIO * fault_ratio(judge, side) * judge->truth.prescribed_J) {
        blame(judge, PERSON_UNSAFE_ENERGY);
    }
}

/* Energy that reaches an ankle in this tick, or is let go there. */
static void give(struct person_judge *judge, int side, double energy_J)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    const bool own_down = plant->person.contact[side];
    const bool other_down = plant->person.contact[1 - side];
    const bool well = judge->tick < judge->well_until[side];
    judge->air_J[side] = own_down ? 0.0 : judge->air_J[side] + energy_J;
    judge->still_J[side] = does_not_walk(judge) && !well ? judge->still_J[side] + energy_J : 0.0;
    if (judge->air_J[side] > LET_GO_J) {
        blame(judge, PERSON_UNSAFE_AIR);
    }
    if (judge->still_J[side] > LET_GO_J) {
        blame(judge, judge->fell_tick != PERSON_JUDGE_NEVER ? PERSON_UNSAFE_FALLEN
                                                            : PERSON_UNSAFE_STANDING);
    }
    double *slot = &judge->lead_J[side][judge->tick % PERSON_JUDGE_LEAD_TICKS];
    if (other_down) {
        *slot = 0.0;
        judge->early_J[side] = 0.0;
    } else if (!well) {
        *slot += energy_J;
    }
}

/* What was given while the other foot was in the air, and longer ago than the lead that is allowed. */
static void check_early(struct person_judge *judge, int side)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    const double allowed_s = (judge->truth.false_contact ? FALSE_EARLY_S : EARLY_S) +
                             judge->truth.sample_s + plant->config.tick_s;
    const uint32_t lead = (uint32_t)(allowed_s / plant->config.tick_s + 0.5);
    if (plant->person.contact[1 - side]) {
        for (int i = 0; i < PERSON_JUDGE_LEAD_TICKS; i++) {
            judge->lead_J[side][i] = 0.0;
        }
        judge->early_J[side] = 0.0;
        return;
    }
    if (judge->tick >= lead) {
        double *old = &judge->lead_J[side][(judge->tick - lead) % PERSON_JUDGE_LEAD_TICKS];
        judge->early_J[side] += *old;
        *old = 0.0;
    }
    if (judge->early_J[side] > LET_GO_J && plant->person.contact[side] && judge->truth.exact) {
        blame(judge, PERSON_UNSAFE_EARLY);
    }
}

static void let_go(struct person_judge *judge, int side)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    const double energy_J =
        sea_spring_energy_now_J(&plant->sea[side], plant_spring_end_m(plant, (enum side)side));
    judge->push_J[side] = 0.0;
    if (energy_J <= LET_GO_J) {
        return;
    }
    judge->pushes++;
    if (judge->first_push_tick == PERSON_JUDGE_NEVER) {
        judge->first_push_tick = judge->tick;
    }
    check_energy(judge, side, energy_J);
    if (energy_J > ENERGY_RATIO * judge->truth.prescribed_J) {
        judge->beyond[side]++;
    }
    give(judge, side, energy_J);
    const bool right =
        plant->person.contact[side] && plant->person.contact[1 - side] && !does_not_walk(judge);
    judge->well_until[side] = right ? judge->tick + TICKS_OF_MS(PUSH_MS) : judge->tick;
}

/* The spring's energy is known at its release only: a tick later some of it has been given. */
static void follow_pushes(struct person_judge *judge)
{
    struct plant *plant = &judge->loop->nodes.plant;
    struct walk_event event;
    while (plant_next_event(plant, &event)) {
        if (event.kind == WALK_EVENT_RELEASE) {
            let_go(judge, (int)event.side);
        }
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double given_J = plant->person_work_J[side] - judge->work_J[side];
        judge->work_J[side] = plant->person_work_J[side];
        judge->push_J[side] += given_J > 0.0 ? given_J : 0.0;
        give(judge, side, given_J > 0.0 ? given_J : 0.0);
        check_early(judge, side);
        check_energy(judge, side, judge->push_J[side]);
    }
}

/* ---- springs -------------------------------------------------------------------------------- */

static void check_foot(struct person_judge *judge, int side)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    const struct sea *sea = &plant->sea[side];
    const double lever_m = plant->config.recording_format.ankle[side].lever_m;
    const double end_m = plant_spring_end_m(plant, (enum side)side);
    const bool open = sea->latch != SEA_LATCH_CLOSED;
    const double down_m = (sea->position_m - end_m) * TOE_DISTANCE_M / lever_m;
    const bool held = open && !plant->person.contact[side] && down_m > TOE_M;
    judge->toe_ticks[side] = held ? (uint16_t)(judge->toe_ticks[side] + 1u) : 0;
    if (judge->toe_ticks[side] > TICKS_OF_MS(TOE_MS)) {
        blame(judge, PERSON_UNSAFE_TOE);
    }
    if (open && sea->position_m > lever_m * RANGE_SINE) {
        blame(judge, PERSON_UNSAFE_RANGE);
    }
}

static double force_N(const struct person_judge *judge, int side)
{
    struct sea_output output;
    plant_sea_output(&judge->loop->nodes.plant, (enum side)side, &output);
    return output.spring_force_N;
}

static bool is_loaded(const struct person_judge *judge, int side)
{
    const struct sea_params *sea = &judge->loop->config.plant.sea[side];
    const double floor_N = FULL_RATIO * sea->spring_N_per_m * sea->stroke_max_m;
    const double part_N = LOADED_RATIO * judge->noticed_force_N[side];
    return force_N(judge, side) > (part_N > floor_N ? part_N : floor_N);
}

static bool is_now(uint32_t since, uint32_t tick, uint32_t ms)
{
    return since != PERSON_JUDGE_NEVER && tick == since + TICKS_OF_MS(ms);
}

static void check_loaded(struct person_judge *judge, int side)
{
    const bool latched = judge->loop->nodes.plant.sea[side].latch == SEA_LATCH_CLOSED;
    const uint32_t tick = judge->tick;
    const bool open_due = is_now(judge->noticed_tick, tick, UNLATCHED_MS) ||
                          is_now(judge->stood_tick, tick, STOOD_MS);
    const bool latched_due = is_now(judge->noticed_tick, tick, LATCHED_MS) ||
                             is_now(judge->stood_tick, tick, LATCHED_MS);
    if (open_due && !latched && is_loaded(judge, side)) {
        blame(judge, PERSON_UNSAFE_LOADED);
    }
    if (latched_due && latched && is_loaded(judge, side)) {
        blame(judge, PERSON_UNSAFE_LATCHED);
    }
}

static void check_fallen(struct person_judge *judge, int side)
{
    const struct plant *plant = &judge->loop->nodes.plant;
    if (has_lasted(judge->fell_tick, judge->tick, ENABLED_MS) &&
        plant->sea[side].command.mode == SEA_POSITION) {
        blame(judge, PERSON_UNSAFE_ENABLED);
    }
}

void person_judge_tick(struct person_judge *judge, bool noticed)
{
    judge->tick++;
    if (noticed && judge->noticed_tick == PERSON_JUDGE_NEVER) {
        judge->noticed_tick = judge->tick;
        for (int side = 0; side < SIDE_COUNT; side++) {
            judge->noticed_force_N[side] = force_N(judge, side);
        }
    }
    follow_person(judge);
    follow_pushes(judge);
    for (int side = 0; side < SIDE_COUNT; side++) {
        check_foot(judge, side);
        check_loaded(judge, side);
        check_fallen(judge, side);
    }
}
