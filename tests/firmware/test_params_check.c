/* A changed bit in the parameters in force is found, wherever it is; none is found
 * where nothing changed. */
#include "firmware/controller_node.h"

#include <string.h>

#include "firmware/settings.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

enum {
    ROUND_TICKS = 2 * (int)(sizeof(struct control_params) + sizeof(struct gait_branch)) /
                  PARAMS_GUARD_SCAN_BYTES
};

static struct fake_bus fake;
static struct gait_branch branch = {.count = 7, .speed_min_rad_s = 0.2f};
static struct controller_node node;

static bool scan_params(void)
{
    params_guard_scan(&node.guard, &node.objects.params, node.objects.params_crc);
    return node.guard.corrupt;
}

static void start(const struct gait_branch *with)
{
    struct control_params params = {.leg_length_m = 1.0f, .kp_m_s_rad = 0.042f, .branch = with};
    params.table.count = SPEED_TABLE_MAX;
    fake_bus_init(&fake);
    ck_assert_int_eq(controller_node_init(&node, &params, 0.4f, true, fake_bus_interface(&fake)),
                     0);
}

/* Whether two whole rounds say so; the first may have begun before the change. */
static bool is_corrupt_after_a_round(void)
{
    bool corrupt = false;
    for (int i = 0; i < ROUND_TICKS; i++) {
        corrupt = scan_params();
    }
    return corrupt;
}

START_TEST(untouched_parameters_are_sound)
{
    start(&branch);
    ck_assert(!is_corrupt_after_a_round());
    start(NULL);
    ck_assert(!is_corrupt_after_a_round());
}
END_TEST

static void flip(void *bytes, size_t at)
{
    ((uint8_t *)bytes)[at] ^= 0x10;
}

START_TEST(one_bit_in_values_speed_table_or_branch_is_found)
{
    struct control_params *params = &node.objects.params;
    const struct {
        void *bytes;
        size_t at;
    } places[] = {
        {params, 0},
        {&params->kp_m_s_rad, 2},
        {&params->table.speed_rad_s[SPEED_TABLE_MAX - 1], 3},
        {&branch.count, 0},
        {&branch.point[GAIT_BRANCH_MAX - 1], sizeof branch.point[0] - 1},
    };
    for (unsigned i = 0; i < sizeof places / sizeof places[0]; i++) {
        start(&branch);
        ck_assert(!is_corrupt_after_a_round());
        flip(places[i].bytes, places[i].at);
        ck_assert_msg(is_corrupt_after_a_round(), "place %u", i);
        flip(places[i].bytes, places[i].at);
        ck_assert_msg(!is_corrupt_after_a_round(), "place %u, put right again", i);
    }
}
END_TEST

/* The same parameters elsewhere in memory have the same checksum. */
START_TEST(the_checksum_does_not_depend_on_where_tables_lie)
{
    static struct gait_branch elsewhere;
    start(&branch);
    const uint32_t crc = node.objects.params_crc;
    elsewhere = branch;
    start(&elsewhere);
    ck_assert_uint_eq(node.objects.params_crc, crc);
}
END_TEST

static void unlock(void)
{
    const uint32_t key = settings_lock_key_of(1);
    struct can_msg request = {.id = 0x610, .length = 8, .data = {0x23, 0x00, 0x20, 5}};
    memcpy(request.data + 4, &key, sizeof key);
    ck_assert(controller_node_receive(&node, &request, 0));
}

/* kp, over SDO: expedited, 4 bytes (CiA 301). */
static void write_kp(float value)
{
    struct can_msg request = {.id = 0x610, .length = 8, .data = {0x23, 0x10, 0x20, 0}};
    for (unsigned i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (control_param_descriptors[i].offset == offsetof(struct control_params, kp_m_s_rad)) {
            request.data[3] = (uint8_t)(i + 1);
        }
    }
    memcpy(request.data + 4, &value, sizeof value);
    ck_assert(controller_node_receive(&node, &request, 0));
}

START_TEST(a_parameter_written_meanwhile_hides_no_changed_bit)
{
    struct settings settings;
    settings_default(&settings);
    settings.control.kp_high_m_s_rad = 0.1f;
    for (int with_branch = 0; with_branch < 2; with_branch++) {
        settings.control.branch = with_branch ? &branch : NULL;
        fake_bus_init(&fake);
        ck_assert_int_eq(
            controller_node_init(&node, &settings.control, 0.4f, true, fake_bus_interface(&fake)),
            0);
        (void)scan_params();
        unlock();
        write_kp(0.05f);
        ck_assert(node.objects.params.kp_m_s_rad == 0.05f);
        ck_assert_uint_eq(node.objects.params_crc, params_guard_crc(&node.objects.params));
        ck_assert(!is_corrupt_after_a_round());
        flip(&node.objects.params.spring_stiffness_n_m, 1);
        ck_assert(is_corrupt_after_a_round());
        write_kp(0.06f);
        ck_assert(is_corrupt_after_a_round());
        flip(&node.objects.params.spring_stiffness_n_m, 1);
        ck_assert(!is_corrupt_after_a_round());
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("params_check");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, untouched_parameters_are_sound);
    tcase_add_test(tests, one_bit_in_values_speed_table_or_branch_is_found);
    tcase_add_test(tests, the_checksum_does_not_depend_on_where_tables_lie);
    tcase_add_test(tests, a_parameter_written_meanwhile_hides_no_changed_bit);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
