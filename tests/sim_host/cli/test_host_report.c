/* Which node is not well, in words: by heartbeats and emergencies as CiA 301 spells them. */
#include "sim_host/cli/host_report.h"
#include "tests/support/assert_close.h"

static struct network network;

static void hear(uint32_t id, uint8_t length, uint8_t first, uint8_t second, uint8_t third)
{
    const struct can_msg frame = {.id = id, .length = length, .data = {first, second, third}};
    ck_assert(network_receive(&network, &frame));
}

static void setup(void)
{
    network_init(&network);
    for (uint32_t node = 1; node <= 4; node++) {
        hear(0x700 + node, 1, 5, 0, 0);
    }
}

static const char *words(void)
{
    static char text[HOST_REPORT_NODES_MAX];
    host_report_nodes(&network, text);
    return text;
}

START_TEST(nothing_is_said_of_nodes_that_are_well)
{
    ck_assert_str_eq(words(), "");
}
END_TEST

START_TEST(each_node_is_named_with_its_state)
{
    hear(0x082, 8, 0x10, 0x23, 0x03); /* over-current in the right drive */
    hear(0x703, 1, 4, 0, 0);
    hear(0x704, 1, 127, 0, 0);
    ck_assert_str_eq(words(), "right drive (node 2) reports emergency 0x2310; left leg sensor "
                              "(node 3) is stopped; right leg sensor (node 4) is not started yet");
}
END_TEST

START_TEST(an_empty_bus_is_four_silent_nodes)
{
    network_init(&network);
    ck_assert_str_eq(words(),
                     "left drive (node 1) is silent; right drive (node 2) is silent; left leg "
                     "sensor (node 3) is silent; right leg sensor (node 4) is silent");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("host_report");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, nothing_is_said_of_nodes_that_are_well);
    tcase_add_test(tests, each_node_is_named_with_its_state);
    tcase_add_test(tests, an_empty_bus_is_four_silent_nodes);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
