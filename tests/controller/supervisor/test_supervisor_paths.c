/* Every path of the supervisor with its conditions, its latch and its time-outs, through the object
 * code that is shipped: which ways lead to WALKING, what a latched fault obeys, and after how many
 * ticks a fault has switched the torque off. */
#include "controller/supervisor/conditions.h"
#include "tests/support/assert_close.h"

#include <stdbool.h>
#include <string.h>

#define FREE_CONDITIONS (1u << SUPERVISOR_CONDITION_BITS)
#define HAS(conditions, name) (((conditions)&SUPERVISOR_IF_##name) != 0)

/* Where the machine can be: state and whether a fault is latched. */
enum { PLACES = SUPERVISOR_STATES * 2 };

static struct supervisor machine_at(int state, bool latched)
{
    return (struct supervisor){.state = (enum supervisor_state)state,
                               .latched = latched ? SUPERVISOR_FAULT_FALL : SUPERVISOR_FAULT_NONE};
}

static int place_of(const struct supervisor *machine)
{
    return (int)machine->state * 2 + (machine->latched != SUPERVISOR_FAULT_NONE ? 1 : 0);
}

static void step(struct supervisor *machine, unsigned conditions)
{
    const enum supervisor_fault fault =
        HAS(conditions, FAULT) ? SUPERVISOR_FAULT_EMERGENCY_STOP : SUPERVISOR_FAULT_NONE;
    (void)supervisor_update(machine, 1000, (uint16_t)conditions, fault);
}

/* ---- one step from everywhere ------------------------------------------------------ */

/* What is wrong with one step, or NULL. */
static const char *judge(const struct supervisor *from, unsigned conditions)
{
    struct supervisor to = *from;
    step(&to, conditions);
    const bool was_latched = from->latched != SUPERVISOR_FAULT_NONE;
    const bool is_latched = to.latched != SUPERVISOR_FAULT_NONE;
    if (was_latched && to.state != SUPERVISOR_INIT && to.latched != from->latched) {
        return "the first fault is replaced";
    }
    if (from->state == SUPERVISOR_FAULT && to.state != SUPERVISOR_FAULT &&
        !(HAS(conditions, RESET) && HAS(conditions, STANDSTILL) && !HAS(conditions, FAULT) &&
          to.state == SUPERVISOR_INIT)) {
        return "a fault is left without a reset at standstill";
    }
    if (was_latched && !is_latched && from->state != SUPERVISOR_FAULT) {
        return "a fault is forgotten on another way";
    }
    if (to.state == SUPERVISOR_FAULT && !is_latched) {
        return "FAULT is entered without a reason";
    }
    if (HAS(conditions, FAULT) && supervisor_may_assist(to.state)) {
        return "a fault leaves the springs loaded";
    }
    if (HAS(conditions, FAULT) && from->state != SUPERVISOR_INIT && !is_latched) {
        return "a fault is not latched";
    }
    if (HAS(conditions, FAULT) && supervisor_may_enable(to.state) &&
        !supervisor_may_enable(from->state)) {
        return "a fault switches the torque on";
    }
    return NULL;
}

START_TEST(each_step_from_everywhere_keeps_the_latch)
{
    for (int place = 0; place < PLACES; place++) {
        const struct supervisor from = machine_at(place / 2, place % 2 != 0);
        if (from.state == SUPERVISOR_FAULT && from.latched == SUPERVISOR_FAULT_NONE) {
            continue; /* never entered: judged below */
        }
        for (unsigned conditions = 0; conditions < FREE_CONDITIONS; conditions++) {
            const char *wrong = judge(&from, conditions);
            if (wrong != NULL) {
                ck_abort_msg("state %d, conditions %#x: %s", place / 2, conditions, wrong);
            }
        }
    }
}
END_TEST

/* ---- ways to WALKING ---------------------------------------------------------------- */

/* All places that can be reached from INIT and FAULT when the conditions in `never` are never true
 * and the state `closed` is not left (SUPERVISOR_STATES: none is closed). */
static unsigned reach(unsigned never, int closed)
{
    unsigned reached = 1u << (SUPERVISOR_INIT * 2) | 1u << (SUPERVISOR_FAULT * 2 + 1), before = 0;
    while (reached != before) {
        before = reached;
        for (int place = 0; place < PLACES; place++) {
            if ((before & (1u << place)) == 0 || place / 2 == closed) {
                continue;
            }
            for (unsigned conditions = 0; conditions < FREE_CONDITIONS; conditions++) {
                struct supervisor machine = machine_at(place / 2, place % 2 != 0);
                step(&machine, conditions & ~never);
                reached |= 1u << place_of(&machine);
            }
        }
    }
    return reached;
}

static bool walks(unsigned never, int closed)
{
    const unsigned walking = 3u << (SUPERVISOR_WALKING * 2);
    return (reach(never, closed) & walking) != 0;
}

START_TEST(no_way_to_walking_without_request_self_test_and_steady_steps)
{
    ck_assert(walks(0, SUPERVISOR_STATES));
    ck_assert(!walks(SUPERVISOR_IF_NODES, SUPERVISOR_STATES));
    ck_assert(!walks(SUPERVISOR_IF_PLAUSIBLE, SUPERVISOR_STATES));
    ck_assert(!walks(SUPERVISOR_IF_WALK_REQUESTED, SUPERVISOR_STATES));
    ck_assert(!walks(SUPERVISOR_IF_ENABLED, SUPERVISOR_STATES));
    ck_assert(!walks(SUPERVISOR_IF_STEADY, SUPERVISOR_STATES));
    ck_assert(!walks(0, SUPERVISOR_SELF_TEST));
    ck_assert(!walks(0, SUPERVISOR_STANDBY));
    ck_assert(!walks(0, SUPERVISOR_ENGAGING));
    /* A tool's motions lead to no walk that is not requested. */
    ck_assert(!walks(SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_TIMEOUT, SUPERVISOR_STATES));
}
END_TEST

START_TEST(walking_is_never_reached_with_a_latched_fault)
{
    ck_assert_uint_eq(reach(0, SUPERVISOR_STATES) & (1u << (SUPERVISOR_WALKING * 2 + 1)), 0);
    ck_assert_uint_eq(reach(0, SUPERVISOR_STATES) & (1u << (SUPERVISOR_ENGAGING * 2 + 1)), 0);
}
END_TEST

/* ---- what the conditions are made of ------------------------------------------------ */

struct bench {
    struct control_params params;
    struct controller_input input;
    struct checks checks;
    struct step_monitor steps;
    struct sea_reference sea[SIDE_COUNT];
    struct supervisor machine;
    struct conditions_view view;
};

static void bench_init(struct bench *bench)
{
    memset(bench, 0, sizeof *bench);
    bench->params.unload_timeout_s = REAL(0.5);
    bench->params.step_timeout_s = REAL(2.0);
    bench->params.sea_tolerance_m = REAL(0.001);
    bench->params.engage_steps = REAL(3.0);
    bench->view = (struct conditions_view){.params = &bench->params,
                                           .input = &bench->input,
                                           .checks = &bench->checks,
                                           .step_monitor = &bench->steps,
                                           .sea = bench->sea};
}

/* One bit of `choice` an input; the counts stand on both sides of their limits. */
static void choose(struct bench *bench, unsigned choice)
{
    struct controller_input *input = &bench->input;
    input->nodes_operational = (choice & 1u) != 0;
    input->node_error = (choice & 2u) != 0;
    input->walk_requested = (choice & 4u) != 0;
    bench->view.walk_wanted = input->walk_requested && (choice & 8u) == 0;
    input->sea[SIDE_LEFT].state = (choice & 16u) != 0 ? DRIVE_ENABLED : DRIVE_STARTING;
    input->sea[SIDE_RIGHT].state = (choice & 32u) != 0 ? DRIVE_ENABLED : DRIVE_FAULT;
    input->reset_requested = (choice & 64u) != 0;
    bench->checks.standstill_ticks = (choice & 128u) != 0 ? TICKS_OF_MS(500) : TICKS_OF_MS(500) - 1;
    input->sea[SIDE_LEFT].age_ticks = (choice & 256u) != 0 ? 0 : 1;
    input->sea[SIDE_RIGHT].precompression_m = (choice & 512u) != 0 ? REAL(0.001) : REAL(0.0011);
    bench->steps.steady = (choice & 1024u) != 0 ? 3 : 2;
    bench->steps.seen = (choice & 2048u) != 0;
    bench->steps.unsteady = (choice & 4096u) != 0 ? 1 : 2;
    bench->view.pushes_fail = (choice & 8192u) != 0;
    bench->view.motion_requested = (choice & 16384u) != 0;
}

static unsigned expected(unsigned choice, bool fault, bool rested, bool late, bool back, bool young)
{
    const bool standstill = (choice & 128u) != 0;
    const bool slack = (choice & 256u) != 0 && (choice & 512u) != 0;
    const bool stepping = (choice & 2048u) != 0 && young && !standstill;
    unsigned bits = 0;
    bits |= fault ? SUPERVISOR_IF_FAULT : 0u;
    bits |= (choice & 3u) != 0 ? SUPERVISOR_IF_NODES : 0u;
    bits |= !fault && slack && rested ? SUPERVISOR_IF_PLAUSIBLE : 0u;
    bits |= (choice & 12u) == 4u ? SUPERVISOR_IF_WALK_REQUESTED : 0u;
    bits |= (choice & 48u) == 48u ? SUPERVISOR_IF_ENABLED : 0u;
    bits |= stepping ? SUPERVISOR_IF_STEPPING : 0u;
    bits |= stepping && (choice & 1024u) != 0 ? SUPERVISOR_IF_STEADY : 0u;
    bits |= (choice & 4096u) != 0 && (choice & 8192u) == 0 ? SUPERVISOR_IF_REGULAR : 0u;
    bits |= (choice & 16384u) != 0 ? SUPERVISOR_IF_MOTION_REQUESTED : 0u;
    bits |= slack && back ? SUPERVISOR_IF_UNLOADED : 0u;
    bits |= late ? SUPERVISOR_IF_TIMEOUT : 0u;
    bits |= (choice & 64u) != 0 ? SUPERVISOR_IF_RESET : 0u;
    bits |= standstill ? SUPERVISOR_IF_STANDSTILL : 0u;
    return bits;
}

/* Ticks since a state began, on both sides of every limit: 50 ms in STANDBY, 200 ms of unloading,
 * unload_timeout_s, five times that in SELF_TEST, a minute in ENGAGING; and a tick count that wraps. */
static const uint32_t since[] = {0,
                                 TICKS_OF_MS(50) - 1,
                                 TICKS_OF_MS(50),
                                 TICKS_OF_MS(200) - 1,
                                 TICKS_OF_MS(200),
                                 TICKS_OF_MS(500) - 1,
                                 TICKS_OF_MS(500) + 1,
                                 TICKS_OF_MS(500),
                                 TICKS_OF_MS(2500) - 1,
                                 TICKS_OF_MS(2500),
                                 TICKS_OF_MS(60000) - 1,
                                 TICKS_OF_MS(60000)};

static void compare_conditions(struct bench *bench, int state, uint32_t age, bool back, bool fault)
{
    const uint32_t limit = state == SUPERVISOR_SELF_TEST  ? TICKS_OF_MS(2500)
                           : state == SUPERVISOR_ENGAGING ? TICKS_OF_MS(60000)
                                                          : TICKS_OF_MS(500);
    bench->machine = machine_at(state, fault);
    bench->machine.since_tick = UINT32_MAX - 100; /* the tick count wraps on the way */
    bench->input.tick = bench->machine.since_tick + age;
    bench->steps.known_tick = bench->input.tick - age;
    bench->sea[SIDE_LEFT].position_m = back ? REAL(0.001) : REAL(0.0011);
    const enum supervisor_fault found = fault ? SUPERVISOR_FAULT_FALL : SUPERVISOR_FAULT_NONE;
    for (unsigned choice = 0; choice < 1u << 15; choice++) {
        choose(bench, choice);
        const unsigned want =
            expected(choice, fault, state != SUPERVISOR_STANDBY || age >= TICKS_OF_MS(50),
                     age >= limit, back && age >= TICKS_OF_MS(200), age <= TICKS_OF_MS(2000));
        const unsigned got = conditions_find(&bench->machine, &bench->view, found);
        if (got != want) {
            ck_abort_msg("state %d, age %u, choice %#x: %#x, not %#x", state, (unsigned)age, choice,
                         got, want);
        }
    }
}

START_TEST(each_condition_is_made_of_what_it_says)
{
    static struct bench bench;
    bench_init(&bench);
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (size_t i = 0; i < sizeof since / sizeof since[0]; i++) {
            for (int how = 0; how < 4; how++) {
                compare_conditions(&bench, state, since[i], (how & 1) != 0, (how & 2) != 0);
            }
        }
    }
}
END_TEST

/* ---- how long torque lasts after a fault -------------------------------------------- */

/* The step under these conditions and any others, with which torque lasts if it can. With a fault
 * there is one state only in which it does. */
static struct supervisor worst_step(const struct supervisor *from, uint32_t tick, unsigned certain)
{
    struct supervisor worst = *from;
    bool first = true;
    for (unsigned others = 0; others < FREE_CONDITIONS; others++) {
        const unsigned conditions = others | certain;
        struct supervisor next = *from;
        if ((others & (SUPERVISOR_IF_FAULT | SUPERVISOR_IF_TIMEOUT)) != 0) {
            continue; /* the same again */
        }
        (void)supervisor_update(&next, tick, (uint16_t)conditions, SUPERVISOR_FAULT_EMERGENCY_STOP);
        if (first || (supervisor_may_enable(next.state) && !supervisor_may_enable(worst.state))) {
            worst = next;
            first = false;
        }
        if (supervisor_may_assist(next.state)) {
            ck_abort_msg("springs stay loaded in state %d", (int)next.state);
        }
    }
    return worst;
}

/* All conditions but the time-out are the adversary's choice, anew in each tick; the fault lasts.
 * Returns the ticks until no choice leaves the torque on. */
static uint32_t longest_torque(real unload_timeout_s, int from)
{
    static struct bench bench;
    bench_init(&bench);
    bench.params.unload_timeout_s = unload_timeout_s;
    struct supervisor machine = machine_at(from, false);
    uint32_t tick = 5000;
    machine.since_tick = tick;
    for (uint32_t ticks = 0; ticks < 100000; ticks++, tick++) {
        if (!supervisor_may_enable(machine.state)) {
            return ticks;
        }
        bench.input.tick = tick;
        const unsigned timing =
            SUPERVISOR_IF_FAULT |
            (conditions_find(&machine, &bench.view, SUPERVISOR_FAULT_EMERGENCY_STOP) &
             SUPERVISOR_IF_TIMEOUT);
        machine = worst_step(&machine, tick, timing);
    }
    return UINT32_MAX;
}

START_TEST(a_fault_switches_the_torque_off_within_the_unload_time_and_two_ticks)
{
    static const real timeouts_s[] = {REAL(0.01), REAL(0.3), REAL(2.0)};
    for (size_t i = 0; i < sizeof timeouts_s / sizeof timeouts_s[0]; i++) {
        const uint32_t most = ticks_from_seconds(timeouts_s[i]) + 2;
        for (int state = 0; state < SUPERVISOR_STATES; state++) {
            ck_assert_uint_le(longest_torque(timeouts_s[i], state), most);
        }
        ck_assert_uint_ge(longest_torque(timeouts_s[i], SUPERVISOR_WALKING), most - 2);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("supervisor paths");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, each_step_from_everywhere_keeps_the_latch);
    tcase_add_test(tests, no_way_to_walking_without_request_self_test_and_steady_steps);
    tcase_add_test(tests, walking_is_never_reached_with_a_latched_fault);
    tcase_add_test(tests, each_condition_is_made_of_what_it_says);
    tcase_add_test(tests, a_fault_switches_the_torque_off_within_the_unload_time_and_two_ticks);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
