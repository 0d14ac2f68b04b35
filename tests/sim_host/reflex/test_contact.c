/* A point on the ground against statics and energy. */
#include "sim_host/reflex/contact.h"
#include "tests/support/assert_close.h"

#include <math.h>

static const struct contact_params params = {40000.0, 0.6, 30000.0, 480.0, 0.8};
static const struct ground_frame level = {{1.0, 0.0}, 0.0};

/* A mass that can move freely, under gravity and a force along the ground. */
struct block {
    struct vector2 at, speed;
    struct contact_point point;
};

static struct vector2 step(struct block *block, double mass_kg, double pull_N, double step_s)
{
    const struct vector2 force =
        contact_force(&params, &block->point, block->at, block->speed, &level, NULL);
    block->speed.x += step_s * (force.x + pull_N) / mass_kg;
    block->speed.y += step_s * (force.y / mass_kg - 9.80665);
    block->at.x += step_s * block->speed.x;
    block->at.y += step_s * block->speed.y;
    contact_update(&params, &block->point, block->at, block->speed, &level);
    return force;
}

START_TEST(a_weight_sinks_by_hooke)
{
    struct block block = {{0.3, 0.001}, {0.0, 0.0}, {false, 0.0}};
    for (int i = 0; i < 200000; i++) {
        (void)step(&block, 40.0, 0.0, 1e-5);
    }
    assert_close(block.at.y, -40.0 * 9.80665 / 40000.0, 1e-6, 0.0);
    assert_close(block.at.x, 0.3, 1e-12, 0.0);
}
END_TEST

START_TEST(a_bounce_only_loses_energy)
{
    struct block block = {{0.0, 0.05}, {0.0, 0.0}, {false, 0.0}};
    double before_J = 0.05 * 9.80665;
    for (int i = 0; i < 500000; i++) {
        (void)step(&block, 40.0, 0.0, 2e-6);
        if (block.at.y > 0.0) { /* of the ground's spring nothing is left then */
            const double energy_J = 0.5 * block.speed.y * block.speed.y + 9.80665 * block.at.y;
            ck_assert(energy_J < before_J + 1e-5);
            before_J = energy_J < before_J ? energy_J : before_J;
        }
    }
    assert_close(block.speed.y, 0.0, 1e-3, 0.0); /* it stays, after a second */
    assert_close(block.at.y, -40.0 * 9.80665 / 40000.0, 1e-4, 0.0);
}
END_TEST

START_TEST(it_holds_up_to_friction_and_slides_beyond)
{
    struct block block = {{0.0, -40.0 * 9.80665 / 40000.0}, {0.0, 0.0}, {true, 0.0}};
    for (int i = 0; i < 200000; i++) { /* slowly to 0.7 of the weight: held, a little moved */
        const double part = i < 100000 ? i / 100000.0 : 1.0;
        (void)step(&block, 40.0, part * 0.7 * 40.0 * 9.80665, 1e-5);
    }
    assert_close(block.at.x, 0.7 * 40.0 * 9.80665 / 30000.0, 1e-6, 0.0);
    for (int i = 0; i < 200000; i++) { /* let go slowly: it comes back */
        const double part = i < 100000 ? 1.0 - i / 100000.0 : 0.0;
        (void)step(&block, 40.0, part * 0.7 * 40.0 * 9.80665, 1e-5);
    }
    assert_close(block.at.x, 0.0, 1e-6, 0.0);
    const double pull_N = 1.0 * 40.0 * 9.80665;
    double begin_m_s = 0.0;
    for (int i = 0; i < 100000; i++) { /* beyond: it accelerates by what friction leaves */
        (void)step(&block, 40.0, pull_N, 1e-5);
        begin_m_s = i == 50000 - 1 ? block.speed.x : begin_m_s;
    }
    assert_close(block.speed.x - begin_m_s, 0.5 * 0.2 * 9.80665, 0.01, 0.0);
}
END_TEST

/* At rest on a slope: it sinks by its weight's part square to the ground, and hangs on the bristle by the part along it.
 * Turned by the slope the ground does what it does level. */
START_TEST(a_slope_holds_by_friction_or_slides)
{
    const double weight_N = 40.0 * 9.80665, slope = _i == 0 ? 0.3 : 1.2;
    const struct ground_line line = {0.7, slope};
    const struct ground_frame ground = ground_frame_of(&line);
    const double angle = atan(slope);
    const double sunk_m = weight_N * cos(angle) / params.stiffness_N_m;
    struct vector2 at = {2.0, ground_height_m(&line, 2.0) - sunk_m / cos(angle)};
    struct vector2 speed = {0.0, 0.0};
    const double held_m = at.x * cos(angle) + at.y * sin(angle);
    struct contact_point point = {true, held_m};
    double begin_m_s = 0.0;
    for (int i = 0; i < 200000; i++) {
        const struct vector2 force = contact_force(&params, &point, at, speed, &ground, NULL);
        speed.x += 1e-5 * force.x / 40.0;
        speed.y += 1e-5 * (force.y - weight_N) / 40.0;
        at.x += 1e-5 * speed.x;
        at.y += 1e-5 * speed.y;
        contact_update(&params, &point, at, speed, &ground);
        begin_m_s = i == 100000 - 1 ? speed.x : begin_m_s;
    }
    const double along_m = at.x * cos(angle) + at.y * sin(angle);
    const double depth_m = (ground_height_m(&line, at.x) - at.y) * cos(angle);
    assert_close(depth_m, sunk_m, 1e-6, 0.0);
    if (slope < params.friction) {
        assert_close(along_m, held_m - weight_N * sin(angle) / 30000.0, 1e-6, 0.0);
    } else {
        const double downhill = 9.80665 * (sin(angle) - params.friction * cos(angle));
        assert_close(speed.x - begin_m_s, -downhill * cos(angle), 0.01, 0.0);
    }
}
END_TEST

START_TEST(the_ground_never_pulls)
{
    const struct contact_point point = {true, 0.0};
    for (double y = -0.05; y <= 0.05; y += 0.001) {
        for (double speed = -3.0; speed <= 3.0; speed += 0.1) {
            const struct vector2 force =
                contact_force(&params, &point, (struct vector2){0.01, y},
                              (struct vector2){-speed, speed}, &level, NULL);
            ck_assert(force.y >= 0.0 && fabs(force.x) <= 0.8 * force.y + 1e-12);
            ck_assert(y < 0.0 || (force.x == 0.0 && force.y == 0.0));
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("contact");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_weight_sinks_by_hooke);
    tcase_add_test(tests, a_bounce_only_loses_energy);
    tcase_add_test(tests, it_holds_up_to_friction_and_slides_beyond);
    tcase_add_loop_test(tests, a_slope_holds_by_friction_or_slides, 0, 2);
    tcase_add_test(tests, the_ground_never_pulls);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
