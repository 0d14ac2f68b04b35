/* What the bus tells of the predictive law's hand-over to eq. (16), in the loop with the simulated
 * walker, heard by a tool on the same bus. */
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

#include <math.h>

enum { STEPS = 40, BEFORE = 6 };

/* A step as TPDO1 tells it. */
struct told {
    double measured_rad_s, commanded_rad_s, r0_m;
    unsigned number;
    bool used_fallback;
};

static struct loop loop;
static struct loop_config config;
static struct control_params params;
static struct told told[STEPS + 1]; /* by number */

static void start(void)
{
    char message[LOOP_MESSAGE_MAX] = "";
    struct subject subject;
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    params.law = (real)LAW_PREDICTIVE;
    params.r0_change_max_m = REAL(0.004);
    ck_assert_int_eq(loop_configure(&config, &subject, &params, 0.41, SENSORS_17BIT, 1, message),
                     0);
    ck_assert_int_eq(loop_init(&loop, &config, NULL, message), 0);
}

static void deliver(const struct can_msg *message)
{
    const uint8_t *data = message->data;
    if (message->id == FRAME_TELEMETRY && data[6] <= STEPS) {
        told[data[6]] = (struct told){.measured_rad_s = 1e-4 * (double)bytes_get_u16(data),
                                      .commanded_rad_s = 1e-4 * (double)bytes_get_u16(data + 2),
                                      .r0_m = 1e-5 * (double)bytes_get_u16(data + 4),
                                      .number = data[6],
                                      .used_fallback = (data[7] & 0x40u) != 0};
        ck_assert_uint_eq(data[7] & 0x3Fu, 0); /* no fault */
        ck_assert_uint_eq(data[7] >> 7, loop.rig.task.controller.last_step.side == SIDE_RIGHT);
    }
}

static void tick(const struct can_bus *tool)
{
    struct can_msg message;
    loop_tick(&loop);
    while (can_bus_receive(tool, &message, NULL) == CAN_OK) {
        deliver(&message);
    }
}

/* Walks until so many steps have been told. */
static void walk(const struct can_bus *tool, unsigned steps)
{
    for (int i = 0; i < 100000 && told[steps].number == 0; i++) {
        tick(tool);
    }
    ck_assert_uint_eq(told[steps].number, steps);
}

/* Eq. (16) on the told speeds, with the told push-off before. */
static double equation_16(const struct told *step, double before_m)
{
    const double wanted_m =
        (double)speed_table_inverse(&params.table, (real)step->commanded_rad_s) -
        (double)params.kp_m_s_rad * (step->commanded_rad_s - step->measured_rad_s);
    const double most_m = (double)params.r0_change_max_m;
    return before_m + fmin(fmax(wanted_m - before_m, -most_m), most_m);
}

/* The law has learned a walker whose apexes come 1.4 rad/s slower than the model's; this one does as the model
 * says. What it learned wears off by 0.35 an apex: 1.4, 0.91, 0.59, 0.38 rad/s too much are each beyond the
 * 0.1 sqrt(g/l) = 0.31 rad/s that count 3 of the 12 which end the trust; the fifth, 0.25, is not. */
START_TEST(the_bus_tells_of_the_hand_over_and_of_its_end)
{
    start();
    const struct can_bus tool =
        sim_bus_port(&loop.bus, sim_bus_attach(&loop.bus, "tool", NULL, NULL));
    walk(&tool, BEFORE);
    loop.rig.task.controller.plan.law.predictive.bias[0] = REAL(1.4);
    walk(&tool, STEPS);
    unsigned handed_over = 0;
    for (unsigned k = 2; k <= STEPS; k++) {
        if (told[k].used_fallback) {
            handed_over++;
            assert_close(told[k].r0_m, equation_16(&told[k], told[k - 1].r0_m), 1.5e-5, 0);
        }
    }
    for (unsigned k = 1; k <= BEFORE + 3; k++) {
        ck_assert(!told[k].used_fallback);
    }
    ck_assert(told[BEFORE + 4].used_fallback);
    ck_assert_uint_le(handed_over, 10);
    for (unsigned k = BEFORE + 14; k <= STEPS; k++) {
        ck_assert(!told[k].used_fallback);
    }
    assert_close(told[STEPS].measured_rad_s, 0.41, 0, 0.01); /* and it walks on as it did */
    loop_free(&loop);
}
END_TEST

/* The foot lands while the search is still under way (150 ms after a crossing that no spring answered):
 * the step is given then and there, by eq. (16), whose answer the search began with. */
START_TEST(a_foot_that_lands_early_ends_the_search)
{
    start();
    const struct can_bus tool =
        sim_bus_port(&loop.bus, sim_bus_attach(&loop.bus, "tool", NULL, NULL));
    struct controller *controller = &loop.rig.task.controller;
    walk(&tool, BEFORE);
    for (int i = 0; i < 2000 && controller->plan.law.is_final; i++) {
        tick(&tool);
    }
    ck_assert(!controller->plan.law.is_final);
    ck_assert_uint_eq(controller->last_step.number, BEFORE); /* the next is not given yet */
    controller->observer.body.compass.crossed = true;
    controller->observer.body.compass.crossing_tick = loop.rig.task.tick - 151;
    tick(&tool);
    ck_assert(controller->observer.state.event[GAIT_HEEL_STRIKE].happened);
    ck_assert(controller->plan.law.is_final);
    ck_assert_uint_eq(controller->last_step.number, BEFORE + 1);
    walk(&tool, BEFORE + 1);
    ck_assert(told[BEFORE + 1].used_fallback);
    assert_close(told[BEFORE + 1].r0_m, equation_16(&told[BEFORE + 1], told[BEFORE].r0_m), 1.5e-5,
                 0);
    loop_free(&loop);
}
END_TEST

/* No other law has anything to fall back from. */
START_TEST(equation_16_itself_tells_of_none)
{
    start();
    loop_free(&loop);
    config.params.law = (real)LAW_PROPORTIONAL;
    char message[LOOP_MESSAGE_MAX] = "";
    ck_assert_int_eq(loop_init(&loop, &config, NULL, message), 0);
    const struct can_bus tool =
        sim_bus_port(&loop.bus, sim_bus_attach(&loop.bus, "tool", NULL, NULL));
    walk(&tool, 10);
    for (unsigned k = 1; k <= 10; k++) {
        ck_assert(!told[k].used_fallback);
    }
    loop_free(&loop);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fallback");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, the_bus_tells_of_the_hand_over_and_of_its_end);
    tcase_add_test(tests, a_foot_that_lands_early_ends_the_search);
    tcase_add_test(tests, equation_16_itself_tells_of_none);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
