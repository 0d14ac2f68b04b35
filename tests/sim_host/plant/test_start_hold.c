/* The hand: lets go at ticks that can be compared, takes hold after a fall. */
#include "sim_host/plant/start_hold.h"
#include "tests/support/assert_close.h"

static const struct start_hold_view LOADED = {
    .drives_enabled = true, .stance_position_m = 0.05, .stance_target_m = 0.05};
static const struct start_hold_view FALLEN = {.drives_enabled = true, .fault = true};

static struct start_hold make(bool hold_after_fall)
{
    struct start_hold_params params;
    struct start_hold start_hold;
    start_hold_params_default(1.0, &params);
    ck_assert_ptr_null(start_hold_params_check(&params));
    params.hold_after_fall = hold_after_fall;
    start_hold_init(&start_hold, &params);
    return start_hold;
}

/* The first tick at which the hand lets go when the view is good from ready_tick on. */
static uint64_t let_go_tick(struct start_hold *start_hold, uint64_t from, uint64_t ready_tick)
{
    const struct start_hold_view waiting = {.drives_enabled = false};
    for (uint64_t tick = from; tick < from + 10000; tick++) {
        if (start_hold_tick(start_hold, tick, tick >= ready_tick ? &LOADED : &waiting) ==
            START_HOLD_LET_GO) {
            return tick;
        }
    }
    return 0;
}

START_TEST(lets_go_at_the_fixed_tick_or_on_its_grid)
{
    static const struct {
        uint64_t ready, let_go;
    } CASES[] = {{0, 1000},    {500, 1000},  {979, 1000},  {980, 1000}, {981, 1100},
                 {1050, 1100}, {1080, 1100}, {1081, 1200}, {4321, 4400}};
    for (int i = 0; i < 9; i++) {
        struct start_hold start_hold = make(false);
        ck_assert_uint_eq(let_go_tick(&start_hold, 0, CASES[i].ready), CASES[i].let_go);
    }
}
END_TEST

START_TEST(holds_until_everything_is_ready)
{
    static const struct start_hold_view NOT_YET[] = {
        {.drives_enabled = false, .stance_position_m = 0.05, .stance_target_m = 0.05},
        {.drives_enabled = true, .stance_position_m = 0.04, .stance_target_m = 0.05},
        {.drives_enabled = true,
         .stance_position_m = 0.05,
         .stance_target_m = 0.05,
         .stance_speed_m_s = 0.1},
        {.drives_enabled = true, .stance_position_m = 0.0, .stance_target_m = 0.0},
    };
    for (int i = 0; i < 4; i++) {
        struct start_hold start_hold = make(false);
        for (uint64_t tick = 0; tick < 3000; tick++) {
            ck_assert_int_eq(start_hold_tick(&start_hold, tick, &NOT_YET[i]), START_HOLD_NONE);
        }
        ck_assert(start_hold.holding);
    }
}
END_TEST

START_TEST(a_flicker_starts_the_wait_again)
{
    struct start_hold start_hold = make(false);
    const struct start_hold_view off = {.drives_enabled = false};
    for (uint64_t tick = 0; tick <= 1000; tick++) {
        ck_assert_int_eq(start_hold_tick(&start_hold, tick, tick == 990 ? &off : &LOADED),
                         START_HOLD_NONE);
    }
    ck_assert_uint_eq(let_go_tick(&start_hold, 1001, 0), 1100);
}
END_TEST

START_TEST(a_fall_is_the_end_unless_asked_otherwise)
{
    struct start_hold start_hold = make(false);
    ck_assert_uint_eq(let_go_tick(&start_hold, 0, 0), 1000);
    for (uint64_t tick = 1001; tick < 5000; tick++) {
        ck_assert_int_eq(start_hold_tick(&start_hold, tick, &FALLEN), START_HOLD_NONE);
    }
    start_hold = make(true);
    ck_assert_uint_eq(let_go_tick(&start_hold, 0, 0), 1000);
    ck_assert_int_eq(start_hold_tick(&start_hold, 1001, &LOADED), START_HOLD_NONE);
    uint64_t tick = 2000;
    while (start_hold_tick(&start_hold, tick, &FALLEN) == START_HOLD_NONE) {
        tick++;
    }
    ck_assert_uint_eq(tick, 2500);
    ck_assert(start_hold.holding);
    ck_assert_uint_eq(let_go_tick(&start_hold, 2501, 0), 2600);
}
END_TEST

START_TEST(bad_parameters_are_named)
{
    struct start_hold_params params;
    start_hold_params_default(1.0, &params);
    params.release_grid_ticks = 0;
    ck_assert_str_eq(start_hold_params_check(&params), "release_grid_ticks");
    start_hold_params_default(1.0, &params);
    params.position_tolerance_m = 0.0;
    ck_assert_str_eq(start_hold_params_check(&params), "position_tolerance_m");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("start_hold");
    TCase *tcase = tcase_create("start_hold");
    tcase_add_test(tcase, lets_go_at_the_fixed_tick_or_on_its_grid);
    tcase_add_test(tcase, holds_until_everything_is_ready);
    tcase_add_test(tcase, a_flicker_starts_the_wait_again);
    tcase_add_test(tcase, a_fall_is_the_end_unless_asked_otherwise);
    tcase_add_test(tcase, bad_parameters_are_named);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
