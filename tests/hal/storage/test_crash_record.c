/* The record a fault leaves: seen once, counted over resets, gone at power-up. */
#include "hal/storage/crash_record.h"

#include <string.h>

#include "tests/support/assert_close.h"

static struct crash_record record;

static void crash(uint32_t cause)
{
    uint32_t before = crash_record_count(&record);

    memset(&record, 0, sizeof record);
    record.cause = cause;
    record.pc = 0x08001234;
    record.build_id = 0x1234;
    record.count = before;
    crash_record_seal(&record);
}

START_TEST(memory_after_power_up_is_no_record)
{
    memset(&record, 0x5A, sizeof record);
    ck_assert(!crash_record_is_valid(&record));
    ck_assert_uint_eq(crash_record_count(&record), 0);
    crash_record_acknowledge(&record); /* has nothing to do */
    ck_assert_uint_eq(record.cause, 0x5A5A5A5A);
}
END_TEST

START_TEST(a_sealed_record_is_found_and_counted)
{
    memset(&record, 0x5A, sizeof record);
    crash(CRASH_BUS_FAULT);
    ck_assert(crash_record_is_valid(&record));
    ck_assert_uint_eq(crash_record_count(&record), 1);
    crash(CRASH_WATCHDOG);
    ck_assert_uint_eq(crash_record_count(&record), 2);
    ck_assert_uint_eq(record.cause, CRASH_WATCHDOG);
    record.count = UINT32_MAX; /* the count stays at its end */
    crash_record_seal(&record);
    ck_assert(crash_record_is_valid(&record));
    ck_assert_uint_eq(crash_record_count(&record), UINT32_MAX);
}
END_TEST

START_TEST(an_acknowledged_record_counts_but_is_not_reported_again)
{
    memset(&record, 0, sizeof record);
    crash(CRASH_HARD_FAULT);
    crash_record_acknowledge(&record);
    ck_assert(!crash_record_is_valid(&record));
    ck_assert_uint_eq(crash_record_count(&record), 1);
    crash(CRASH_HARD_FAULT);
    ck_assert_uint_eq(crash_record_count(&record), 2);
}
END_TEST

/* RM0440, reset flags: power-on sets the brown-out flag, too. Only memory that was kept tells a dip
 * of the supply from a start in the morning. */
START_TEST(a_dip_of_the_supply_is_told_from_power_on)
{
    static const struct {
        bool watchdog, supply, kept;
        enum crash_cause cause;
    } cases[] = {{false, true, false, CRASH_NONE},    {false, true, true, CRASH_SUPPLY},
                 {false, false, true, CRASH_NONE},    {false, false, false, CRASH_NONE},
                 {true, false, true, CRASH_WATCHDOG}, {true, true, true, CRASH_WATCHDOG},
                 {true, false, false, CRASH_WATCHDOG}};
    ck_assert_int_eq(crash_cause_of_reset(cases[_i].watchdog, cases[_i].supply, cases[_i].kept),
                     cases[_i].cause);
}
END_TEST

START_TEST(memory_is_known_to_be_kept)
{
    struct crash_streak streak;
    memset(&streak, 0x5A, sizeof streak);
    ck_assert(!crash_streak_is_kept(&streak));
    crash_streak_end(&streak);
    ck_assert(crash_streak_is_kept(&streak));
    crash_streak_add(&streak);
    ck_assert(crash_streak_is_kept(&streak));
    streak.length ^= 0x10u;
    ck_assert(!crash_streak_is_kept(&streak));
}
END_TEST

START_TEST(any_flipped_bit_spoils_the_record)
{
    memset(&record, 0, sizeof record);
    crash(CRASH_ASSERTION);
    for (size_t bit = 0; bit < 8 * sizeof record; bit++) {
        uint8_t *byte = (uint8_t *)&record + bit / 8;
        *byte = (uint8_t)(*byte ^ (1U << (bit % 8)));
        ck_assert(!crash_record_is_valid(&record));
        *byte = (uint8_t)(*byte ^ (1U << (bit % 8)));
    }
    ck_assert(crash_record_is_valid(&record));
}
END_TEST

START_TEST(a_streak_counts_until_it_ends)
{
    struct crash_streak streak;

    memset(&streak, 0x5A, sizeof streak); /* memory after power-up */
    ck_assert_uint_eq(crash_streak_length(&streak), 0);
    for (uint32_t crashes = 1; crashes <= 4; crashes++) {
        crash_streak_add(&streak);
        ck_assert_uint_eq(crash_streak_length(&streak), crashes);
    }
    crash_streak_end(&streak);
    ck_assert_uint_eq(crash_streak_length(&streak), 0);
    crash_streak_add(&streak);
    streak.length ^= 6;
    ck_assert_uint_eq(crash_streak_length(&streak), 0);
    streak.length = UINT32_MAX;
    streak.inverted = 0;
    crash_streak_add(&streak); /* stays at its end */
    ck_assert_uint_eq(crash_streak_length(&streak), UINT32_MAX);
}
END_TEST

START_TEST(a_new_record_begins_empty_but_for_what_it_counts)
{
    memset(&record, 0x5A, sizeof record);
    crash_record_begin(&record);
    ck_assert_uint_eq(record.count, 0);
    ck_assert_uint_eq(record.build_id, 0);
    crash(CRASH_HARD_FAULT);
    ck_assert_uint_eq(record.build_id, 0x1234);
    crash_record_begin(&record);
    ck_assert_uint_eq(record.count, 1);
    ck_assert_uint_eq(record.pc, 0);
    ck_assert(!crash_record_is_valid(&record));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("crash_record");
    TCase *tcase = tcase_create("crash_record");

    tcase_add_test(tcase, memory_after_power_up_is_no_record);
    tcase_add_test(tcase, a_sealed_record_is_found_and_counted);
    tcase_add_test(tcase, an_acknowledged_record_counts_but_is_not_reported_again);
    tcase_add_test(tcase, any_flipped_bit_spoils_the_record);
    tcase_add_test(tcase, a_streak_counts_until_it_ends);
    tcase_add_test(tcase, a_new_record_begins_empty_but_for_what_it_counts);
    tcase_add_loop_test(tcase, a_dip_of_the_supply_is_told_from_power_on, 0, 7);
    tcase_add_test(tcase, memory_is_known_to_be_kept);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
