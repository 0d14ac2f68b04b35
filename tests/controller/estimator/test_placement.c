/* Sensors and latches that are not where they belong: an ideal walk of known geometry, with one thing wrong. */
#include "controller/estimator/placement.h"
#include "tests/support/assert_close.h"

enum { STEPS = 12 };
static const double STEP_RAD = 0.6, PUSHED_M = 0.03;

/* What the controller sees of the walk: after every wiring fault. */
struct walk {
    struct placement placement;
    double step_rad;              /* between both feet in double support; below 0: backwards */
    double pushed_m[SIDE_COUNT];  /* how far the ankle is extended as its foot leaves */
    double resting_m[SIDE_COUNT]; /* and in the rest of its stance */
    bool angles_swapped, ankles_swapped;
    bool reversed[SIDE_COUNT];
    bool stuck[SIDE_COUNT];
};

static struct walk healthy(void)
{
    return (struct walk){
        .step_rad = STEP_RAD, .pushed_m = {PUSHED_M, PUSHED_M}, .resting_m = {0.004, 0.004}};
}

static void see(struct walk *walk, const double angle_rad[SIDE_COUNT],
                const double extension_m[SIDE_COUNT], int lands, int leaves)
{
    struct placement_view view = {.lands = {lands == SIDE_LEFT, lands == SIDE_RIGHT},
                                  .leaves = {leaves == SIDE_LEFT, leaves == SIDE_RIGHT}};
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double angle = angle_rad[walk->angles_swapped ? 1 - side : side];
        const double extension = extension_m[walk->ankles_swapped ? 1 - side : side];
        view.angle_rad[side] = (real)(walk->reversed[side] ? -angle : angle);
        view.extension_m[side] = (real)(walk->stuck[side] ? 0.011 : extension);
    }
    placement_edges(&walk->placement, &view);
}

/* The foot of `side` leaves, swings, and lands ahead. A planted foot stays: over the single support the hip goes on
 * by 0.7 of a step, over double support by the rest. */
static void step(struct walk *walk, int side)
{
    const int other = 1 - side;
    const double half = 0.5 * walk->step_rad, single = 0.7 * walk->step_rad;
    double angle[SIDE_COUNT], extension[SIDE_COUNT];
    /* The foot in front landed 0.3 of a step ago. */
    angle[side] = -half - (walk->step_rad - single);
    angle[other] = half - (walk->step_rad - single);
    extension[side] = walk->pushed_m[side];
    extension[other] = walk->resting_m[other];
    see(walk, angle, extension, -1, side);
    angle[side] = half;
    angle[other] -= single;
    extension[side] = walk->resting_m[side];
    see(walk, angle, extension, side, -1);
}

static uint8_t found_after(struct walk *walk, int steps)
{
    for (int i = 0; i < steps; i++) {
        step(walk, i % 2);
    }
    return placement_found(&walk->placement);
}

START_TEST(a_healthy_walk_has_nothing)
{
    static const double steps_rad[] = {0.15, 0.3, 0.6, 1.0};
    struct walk walk = healthy();
    walk.step_rad = steps_rad[_i];
    ck_assert_uint_eq(found_after(&walk, 100), 0);
    /* A person who limps, with one foot that does not push much. */
    walk = healthy();
    walk.pushed_m[SIDE_LEFT] = 0.005;
    ck_assert_uint_eq(found_after(&walk, 100), 0);
    /* Small steps with both ankles still, as far as their sensors tell. */
    walk = healthy();
    walk.step_rad = 0.25;
    for (int side = 0; side < SIDE_COUNT; side++) {
        walk.pushed_m[side] = walk.resting_m[side] = 0.0;
    }
    ck_assert_uint_eq(found_after(&walk, 100), 0);
    walk.step_rad = STEP_RAD; /* full ones: both sensors are dead */
    ck_assert_uint_eq(found_after(&walk, 12), PLACEMENT_STUCK | PLACEMENT_STUCK << 1);
    /* Both ankles hardly move: slow walking, or a splint. */
    walk = healthy();
    walk.pushed_m[SIDE_LEFT] = walk.resting_m[SIDE_LEFT];
    walk.pushed_m[SIDE_RIGHT] = walk.resting_m[SIDE_RIGHT] + 0.005;
    ck_assert_uint_eq(found_after(&walk, 100), 0);
    /* A foot that lands with its toes first, as in spastic gait: within 2 mm as at toe-off. */
    walk = healthy();
    walk.resting_m[SIDE_RIGHT] = PUSHED_M + 0.0015;
    ck_assert_uint_eq(found_after(&walk, 100), 0);
}
END_TEST

START_TEST(legs_that_turn_the_wrong_way_are_found)
{
    struct walk walk = healthy();
    walk.angles_swapped = true;
    ck_assert_uint_eq(found_after(&walk, PLACEMENT_STEPS), 3 * PLACEMENT_ANGLE);
    walk = healthy();
    walk.reversed[SIDE_LEFT] = walk.reversed[SIDE_RIGHT] = true;
    ck_assert_uint_eq(found_after(&walk, PLACEMENT_STEPS), 3 * PLACEMENT_ANGLE);
    for (unsigned side = 0; side < SIDE_COUNT; side++) {
        walk = healthy();
        walk.reversed[side] = true;
        ck_assert_uint_eq(found_after(&walk, PLACEMENT_STEPS), PLACEMENT_ANGLE << side);
    }
    walk = healthy();
    walk.step_rad = -STEP_RAD; /* the person walks backwards */
    ck_assert_uint_ne(found_after(&walk, PLACEMENT_STEPS) & 3 * PLACEMENT_ANGLE, 0);
    /* Some steps backwards are none. */
    walk = healthy();
    walk.reversed[SIDE_LEFT] = walk.reversed[SIDE_RIGHT] = true;
    ck_assert_uint_eq(found_after(&walk, PLACEMENT_STEPS - 1), 0);
    walk.reversed[SIDE_LEFT] = walk.reversed[SIDE_RIGHT] = false;
    ck_assert_uint_eq(found_after(&walk, 50), 0);
}
END_TEST

START_TEST(a_stuck_ankle_is_found)
{
    for (unsigned side = 0; side < SIDE_COUNT; side++) {
        struct walk walk = healthy();
        walk.stuck[side] = true;
        ck_assert_uint_eq(found_after(&walk, 2 * PLACEMENT_STANCES + 3), PLACEMENT_STUCK << side);
    }
    struct walk dead = healthy();
    dead.stuck[SIDE_LEFT] = dead.stuck[SIDE_RIGHT] = true;
    ck_assert_uint_eq(found_after(&dead, 2 * PLACEMENT_STANCES + 3), 3 * PLACEMENT_STUCK);
}
END_TEST

START_TEST(an_ankle_of_the_other_leg_is_found)
{
    struct walk walk = healthy();
    walk.ankles_swapped = true;
    ck_assert_uint_eq(found_after(&walk, 2 * PLACEMENT_STANCES + 3), 3 * PLACEMENT_ANKLE);
}
END_TEST

/* A spring that pushes extends the ankle as the other foot lands, and a late switch sees the foot leave when its toes are
 * up again: nothing of that tells where the sensor is. Before the first push, and in a stance without one, it does. */
START_TEST(an_ankle_that_the_device_pushes_is_nobody_elses)
{
    for (int assisted = 0; assisted < 2; assisted++) {
        struct walk walk = healthy();
        struct controller_input input = {0};
        ck_assert_uint_eq(found_after(&walk, 10), 0);
        for (int i = 0; i < 20; i++) {
            const int side = i % 2;
            /* The foot that the last step left behind: pushed at its end. */
            input.sea[side].latch = assisted ? LATCH_OPEN : LATCH_CLOSED;
            walk.resting_m[side] = PUSHED_M;
            walk.pushed_m[side] = 0.6 * PUSHED_M;
            placement_wires(&walk.placement, &input);
            step(&walk, side);
            input.sea[side].latch = LATCH_CLOSED;
        }
        ck_assert_uint_eq(placement_found(&walk.placement), assisted ? 0 : 3 * PLACEMENT_ANKLE);
    }
}
END_TEST

START_TEST(what_is_no_step_says_nothing)
{
    struct walk walk = healthy();
    walk.step_rad = 0.05; /* on the spot */
    walk.reversed[SIDE_LEFT] = walk.reversed[SIDE_RIGHT] = true;
    ck_assert_uint_eq(found_after(&walk, 100), 0);
}
END_TEST

static uint8_t found_by_wires(const enum foot_contact latch[SIDE_COUNT],
                              const enum foot_contact foot[SIDE_COUNT], int ticks)
{
    struct placement placement = {0};
    struct controller_input input = {0};
    for (int side = 0; side < SIDE_COUNT; side++) {
        input.sea[side].contact = latch[side];
        input.leg[side].foot = foot[side];
    }
    for (int i = 0; i < ticks; i++) {
        placement_wires(&placement, &input);
    }
    return placement_found(&placement);
}

START_TEST(a_latch_hears_the_other_foot)
{
    /* The left foot is in the air. The right leg's latch hears it. */
    static const enum foot_contact feet[SIDE_COUNT] = {FOOT_UP, FOOT_DOWN};
    static const enum foot_contact right[SIDE_COUNT] = {FOOT_DOWN, FOOT_UP};
    static const enum foot_contact crossed[SIDE_COUNT] = {FOOT_UP, FOOT_DOWN};
    static const enum foot_contact broken[SIDE_COUNT] = {FOOT_DOWN, FOOT_DOWN};
    static const enum foot_contact silent[SIDE_COUNT] = {FOOT_UNKNOWN, FOOT_UNKNOWN};
    ck_assert_uint_eq(found_by_wires(right, feet, 10000), 0);
    ck_assert_uint_eq(found_by_wires(crossed, feet, PLACEMENT_WIRE_TICKS), 3 * PLACEMENT_WIRE);
    ck_assert_uint_eq(found_by_wires(crossed, feet, PLACEMENT_WIRE_TICKS - 1), 0);
    ck_assert_uint_eq(found_by_wires(broken, feet, PLACEMENT_WIRE_TICKS), 2 * PLACEMENT_WIRE);
    ck_assert_uint_eq(found_by_wires(silent, feet, 10000), 0);
    ck_assert_uint_eq(found_by_wires(crossed, silent, 10000), 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("placement");
    TCase *tcase = tcase_create("placement");
    tcase_add_loop_test(tcase, a_healthy_walk_has_nothing, 0, 4);
    tcase_add_test(tcase, legs_that_turn_the_wrong_way_are_found);
    tcase_add_test(tcase, a_stuck_ankle_is_found);
    tcase_add_test(tcase, an_ankle_of_the_other_leg_is_found);
    tcase_add_test(tcase, an_ankle_that_the_device_pushes_is_nobody_elses);
    tcase_add_test(tcase, what_is_no_step_says_nothing);
    tcase_add_test(tcase, a_latch_hears_the_other_foot);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
