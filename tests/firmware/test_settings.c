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

/* A device without settings has a table from its smallest push-off to beyond its largest. */
START_TEST(the_default_table_holds_every_push_off)
{
    const struct control_params *control = &settings.control;
    const struct speed_table *table = &control->table;
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_OK);
    assert_close((double)table->r0_min_m, (double)control->r0_min_m, 0.0, 0.0);
    ck_assert(table->r0_min_m + table->r0_step_m * (float)(table->count - 1) >= control->r0_max_m);
    ck_assert(table->speed_rad_s[0] < settings.desired_speed_rad_s &&
              table->speed_rad_s[table->count - 1] > settings.desired_speed_rad_s);
}
END_TEST

START_TEST(each_field_is_checked)
{
    const struct settings good = settings;

    settings.control.leg_length_m = NAN;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_CONTROL);
    settings = good;
    settings.device.leg[SIDE_RIGHT].counts_per_m = INFINITY;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_DEVICE);
    settings = good;
    settings.device.leg[SIDE_LEFT].leg_direction = 0;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_DEVICE);
    settings = good;
    settings.device.leg[SIDE_LEFT].latch = DEVICE_LATCH_NONE; /* on a bench */
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    settings.control.body = (float)BODY_PERSON;
    settings.control.engage_steps = 4.0f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_DEVICE);
    settings.device.leg[SIDE_LEFT].latch = DEVICE_LATCH_DRIVE;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    settings = good;
    settings.desired_speed_rad_s = 0.0f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SPEED);
    settings = good;
    settings.desired_speed_rad_s = NAN;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SPEED);
    settings = good;
    settings.walk_at_start = 2;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_SPEED);
    settings = good;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
}
END_TEST

/* Less stroke than what the law may ask for would stop a motor short in silence; a leg without a motor
 * has none. */
START_TEST(every_stroke_holds_what_the_law_may_ask)
{
    settings.device.leg[SIDE_RIGHT].stroke_max_m = settings.control.r0_max_m;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    settings.device.leg[SIDE_RIGHT].stroke_max_m = 0.29f;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_BAD_STROKE);
    settings.device.leg[SIDE_RIGHT].protocol = DEVICE_NO_DRIVE_PROTOCOL;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
}
END_TEST

/* Mirror images with unlike zeros come back from the memory as they were. */
START_TEST(the_device_comes_back_as_it_was)
{
    const struct nv_store nv = nv_memory_store(&memory);
    struct settings loaded;
    struct param_store store;

    settings.device.leg[SIDE_RIGHT].direction = -1;
    settings.device.leg[SIDE_RIGHT].zero_counts = -123456789;
    settings.device.leg[SIDE_RIGHT].drive_node = 9;
    settings.device.leg[SIDE_LEFT].leg_zero_rad = 1.25f;
    settings.device.leg[SIDE_LEFT].ankle = DEVICE_ANKLE_LEVER;
    ck_assert_int_eq(settings_check(&settings), SETTINGS_OK);
    (void)settings_load(&loaded, &store, &nv);
    ck_assert_int_eq(settings_save(&settings, &store, true), PARAM_STORE_OK);
    ck_assert_int_eq(settings_load(&loaded, &store, &nv), PARAM_STORE_OK);
    ck_assert_mem_eq(&loaded.device, &settings.device, sizeof settings.device);
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
    tcase_add_test(tcase, the_default_table_holds_every_push_off);
    tcase_add_test(tcase, each_field_is_checked);
    tcase_add_test(tcase, every_stroke_holds_what_the_law_may_ask);
    tcase_add_test(tcase, the_device_comes_back_as_it_was);
    tcase_add_test(tcase, a_branch_is_kept_and_read_in_place);
    tcase_add_test(tcase, what_a_file_holds_is_what_was_set);
    tcase_add_test(tcase, an_empty_or_too_small_memory_gives_the_default_ones);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
