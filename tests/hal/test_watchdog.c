/* The gate in front of the watchdog: a feed needs every sign of progress. */
#include "hal/watchdog.h"

#include "tests/support/assert_close.h"

static int feeds;

static void count_feed(void *context)
{
    (*(int *)context)++;
}

static const struct watchdog_ops ops = {count_feed};
static const struct watchdog watchdog = {&ops, &feeds};
static struct watchdog_gate gate;

static void setup(void)
{
    feeds = 0;
    watchdog_gate_init(&gate, &watchdog);
}

START_TEST(no_part_of_the_signs_feeds)
{
    uint32_t part = (uint32_t)_i;

    for (int i = 0; i < 1000; i++) {
        ck_assert(!watchdog_gate_report(&gate, part));
        ck_assert(
            !watchdog_gate_report(&gate, part | 0xFFFFFFF8U)); /* nor bits that mean nothing */
    }
    ck_assert_int_eq(feeds, 0);
}
END_TEST

START_TEST(all_signs_in_any_order_feed_once)
{
    ck_assert(!watchdog_gate_report(&gate, WATCHDOG_SUPERVISOR));
    ck_assert(!watchdog_gate_report(&gate, WATCHDOG_BUS));
    ck_assert(watchdog_gate_report(&gate, WATCHDOG_CONTROL));
    ck_assert_int_eq(feeds, 1);
    ck_assert(!watchdog_gate_report(&gate, WATCHDOG_CONTROL | WATCHDOG_BUS));
    ck_assert_int_eq(feeds, 1);
    ck_assert(watchdog_gate_report(&gate, WATCHDOG_ALL));
    ck_assert_int_eq(feeds, 2);
    ck_assert_uint_eq(gate.feeds, 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("watchdog");
    TCase *tcase = tcase_create("watchdog");

    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_loop_test(tcase, no_part_of_the_signs_feeds, 0, WATCHDOG_ALL);
    tcase_add_test(tcase, all_signs_in_any_order_feed_once);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
