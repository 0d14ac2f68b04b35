/* Settings: the default ones, the check of each field, and what comes back from memory. */
#include "firmware/settings.h"

#include <math.h>
#include <string.h>

#include "sim_host/subjects/settings_image.h"
#include "tests/support/assert_close.h"
#include "tests/support/nv_memory.h"

static struct settings settings;
static struct nv_memory memory;

static void setup(void)
{
    settings_default(&settings);
    nv_memory_init(&memory);
}

START_TEST(the_default_ones_pass_the_check)
{
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    ck_assert_int_eq(control_params_validate(&settings.control), CONTROL_PARAMS_OK);
    ck_assert_uint_eq(settings.walk_at_start, 0);
}
END_TEST

START_TEST(each_field_is_checked)
{
    const struct settings good = settings;

    settings.control.leg_length_m = NAN;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_CONTROL);
    settings = good;
    settings.axis[SIDE_RIGHT].counts_per_m = 0.0f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_AXIS);
    settings = good;
    settings.setup.rated_force_N[SIDE_LEFT] = 35.0f; /* the axis's is another */
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings = good;
    settings.axis[SIDE_RIGHT].counts_per_m = INFINITY;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_AXIS);
    settings = good;
    settings.axis[SIDE_LEFT].direction = 0;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_AXIS);
    settings = good;
    settings.sensor[SIDE_LEFT].angle_direction = 2;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SENSOR);
    settings = good;
    settings.sensor[SIDE_RIGHT].angle_zero_rad = NAN;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SENSOR);
    settings = good;
    settings.sensor[SIDE_RIGHT].ankle_is_lever = true;
    settings.sensor[SIDE_RIGHT].ankle_lever_m = -0.1f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SENSOR);
    settings = good;
    settings.setup.counts_per_m[SIDE_LEFT]++; /* other than the axis's */
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings = good;
    settings.setup.limit_max_counts[SIDE_LEFT] = settings.setup.limit_min_counts[SIDE_LEFT];
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings = good;
    settings.sensor[SIDE_LEFT].ankle_is_lever = true; /* the node is told it is none */
    settings.sensor[SIDE_LEFT].ankle_lever_m = 0.1f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings = good;
    settings.desired_speed_rad_s = 0.0f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SPEED);
    settings = good;
    settings.desired_speed_rad_s = NAN;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SPEED);
    settings = good;
    settings.setup.counts_per_m[SIDE_RIGHT] = 0;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings = good;
    settings.setup.following_error_counts[SIDE_LEFT] = 0;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings = good;
    settings.walk_at_start = 2;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SPEED);
    settings = good;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
}
END_TEST

/* An absolute encoder may stand anywhere in its 32 bits, but a target must not leave them:
 * zero and stroke (0.3 m of 13,107,200 counts each) are held to 2^30 counts. */
START_TEST(no_target_leaves_the_range_of_counts)
{
    const struct settings good = settings;
    const int32_t zeros[] = {INT32_MAX, INT32_MIN, (1 << 30) + 1000, -(1 << 30) - 1000};

    for (size_t i = 0; i < sizeof zeros / sizeof zeros[0]; i++) {
        settings.axis[SIDE_LEFT].zero_counts = zeros[i];
        ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_AXIS);
        settings = good;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) { /* 0.3 m at this scale are 4.8e9 counts */
        settings.axis[leg].counts_per_m = 1.6e10f;
        ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_AXIS);
        settings = good;
        const int32_t most = (1 << 30) - 64; /* the largest float below half the range */
        settings.axis[leg].zero_counts = most;
        settings.setup.limit_min_counts[leg] = most;
        settings.setup.limit_max_counts[leg] = most + 4587520;
        ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
        settings = good;
    }
}
END_TEST

START_TEST(a_rated_force_is_a_number)
{
    const float forces[] = {NAN, INFINITY, -INFINITY, -1.0f};

    for (size_t i = 0; i < sizeof forces / sizeof forces[0]; i++) {
        settings.axis[SIDE_RIGHT].rated_force_N = forces[i];
        settings.setup.rated_force_N[SIDE_RIGHT] = forces[i];
        ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_AXIS);
    }
}
END_TEST

/* Software limits of the drive inside what the law may ask for would stop it short in silence. */
START_TEST(the_drive_s_limits_hold_the_whole_stroke)
{
    const int32_t stroke = 3932160; /* r0_max 0.3 m of 13,107,200 counts each */

    settings.setup.limit_max_counts[SIDE_LEFT] = stroke + 1;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    settings.setup.limit_max_counts[SIDE_LEFT] = stroke - 1;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings.setup.limit_max_counts[SIDE_LEFT] = stroke + 1;
    settings.setup.limit_min_counts[SIDE_LEFT] = 1;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
    settings.axis[SIDE_LEFT].direction = -1;
    settings.setup.limit_min_counts[SIDE_LEFT] = -stroke - 1;
    settings.setup.limit_max_counts[SIDE_LEFT] = 0;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    settings.setup.limit_min_counts[SIDE_LEFT] = -stroke + 1;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SETUP);
}
END_TEST

/* A joint that is mounted the other way round, and a lever with all that it needs. */
START_TEST(every_mounting_is_possible)
{
    settings.sensor[SIDE_LEFT].angle_direction = -1;
    settings.sensor[SIDE_LEFT].ankle_is_lever = true;
    settings.setup.ankle_is_lever[SIDE_LEFT] = true;
    settings.sensor[SIDE_LEFT].ankle_lever_m = 0.1f;
    settings.sensor[SIDE_LEFT].ankle_neutral_rad = 0.2f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    settings.sensor[SIDE_LEFT].ankle_neutral_rad = INFINITY;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SENSOR);
    settings.sensor[SIDE_LEFT].ankle_neutral_rad = 0.2f;
    settings.sensor[SIDE_LEFT].ankle_lever_m = NAN;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SENSOR);
    settings.sensor[SIDE_LEFT].ankle_lever_m = 0.0f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SENSOR);
}
END_TEST

/* What is kept with a branch comes back with it, read where it lies, from the newer copy. */
START_TEST(a_branch_is_kept_and_read_in_place)
{
    const struct nv_store nv = nv_memory_store(&memory);
    static struct gait_branch branch;
    struct settings loaded;
    struct param_store store;

    for (uint32_t i = 0; i < sizeof branch; i++) {
        ((uint8_t *)&branch)[i] = (uint8_t)(37u * i + 11u);
    }
    branch.count = 7;
    ck_assert_int_eq(settings_load(&loaded, &store, &nv), PARAM_STORE_EMPTY);
    ck_assert_ptr_null(settings_branch(&store)); /* nothing is kept yet */
    for (int copy = 0; copy < 3; copy++) {
        settings.control.branch = copy == 0 ? &branch : settings.control.branch;
        ck_assert_int_eq(settings_save(&settings, &store, true), PARAM_STORE_OK);
        ck_assert_ptr_ne(settings.control.branch, &branch); /* of the memory from now on */
        ck_assert_ptr_eq(settings.control.branch, settings_branch(&store));
        ck_assert_int_eq(settings_load(&loaded, &store, &nv), PARAM_STORE_OK);
        ck_assert_ptr_eq(loaded.control.branch, settings.control.branch);
        ck_assert_mem_eq(loaded.control.branch, &branch, sizeof branch);
    }
    const struct gait_branch *const kept = settings.control.branch;
    memory.power_fails_at = memory.operations;
    ck_assert_int_eq(settings_save(&settings, &store, true), PARAM_STORE_FAILED);
    ck_assert_ptr_eq(settings.control.branch, kept); /* nothing new was kept */
    nv_memory_power_up(&memory);
    settings.control.branch = NULL;
    ck_assert_int_eq(settings_save(&settings, &store, true), PARAM_STORE_OK);
    ck_assert_ptr_null(settings.control.branch);
    ck_assert_int_eq(settings_load(&loaded, &store, &nv), PARAM_STORE_OK);
    ck_assert_ptr_null(loaded.control.branch);
}
END_TEST

START_TEST(what_a_file_holds_is_what_was_set)
{
    static uint8_t image[SETTINGS_IMAGE_BYTES];
    static struct gait_branch branch;

    branch.count = 7;
    branch.speed_min_rad_s = 0.25f;
    settings.control.branch = &branch;
    settings.control.kp_m_s_rad = 0.0123f;
    settings.desired_speed_rad_s = 0.77f;
    ck_assert_int_eq(settings_image(&settings, image), 0);

    struct settings_record record;
    memcpy(&record, image + 2 * NV_WORD_BYTES, sizeof record); /* behind commit and header */
    ck_assert_mem_eq(record.values.control, &settings.control, sizeof record.values.control);
    ck_assert_mem_eq(&record.branch, &branch, sizeof branch);
    assert_close(record.values.desired_speed_rad_s, 0.77, 1e-7, 0);
}
END_TEST

START_TEST(an_empty_or_too_small_memory_gives_the_default_ones)
{
    const struct nv_store nv = nv_memory_store(&memory);
    struct settings loaded;
    struct param_store store;

    memset(&loaded, 0xA5, sizeof loaded);
    ck_assert_int_ne(settings_load(&loaded, &store, &nv), PARAM_STORE_OK);
    ck_assert_int_eq(settings_check(&loaded), SETTINGS_OK);
    ck_assert_ptr_null(loaded.control.branch);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("settings");
    TCase *tcase = tcase_create("settings");

    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, the_default_ones_pass_the_check);
    tcase_add_test(tcase, each_field_is_checked);
    tcase_add_test(tcase, no_target_leaves_the_range_of_counts);
    tcase_add_test(tcase, a_rated_force_is_a_number);
    tcase_add_test(tcase, the_drive_s_limits_hold_the_whole_stroke);
    tcase_add_test(tcase, every_mounting_is_possible);
    tcase_add_test(tcase, a_branch_is_kept_and_read_in_place);
    tcase_add_test(tcase, what_a_file_holds_is_what_was_set);
    tcase_add_test(tcase, an_empty_or_too_small_memory_gives_the_default_ones);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
