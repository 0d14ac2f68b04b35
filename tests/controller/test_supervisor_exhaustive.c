/* Every state under every combination of conditions, and what every mutation of every row
 * does: build/tests/controller/test_supervisor_exhaustive prints the table. */
#include "controller/supervisor.h"
#include "tests/support/assert_close.h"
#include "tests/support/supervisor_rules.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

START_TEST(the_table_has_every_property)
{
    unsigned pairs = 0;
    const char *wrong = supervisor_examine(supervisor_rows, SUPERVISOR_ROWS);
    ck_assert_msg(wrong == NULL, "%s", wrong);
    const unsigned reached = supervisor_reachable(supervisor_rows, SUPERVISOR_ROWS, &pairs);
    printf("  states reached %#x of %#x, %u pairs of state and input\n", reached,
           (1u << SUPERVISOR_STATES) - 1, pairs);
    ck_assert_uint_eq(reached, (1u << SUPERVISOR_STATES) - 1);
    ck_assert_uint_eq(pairs, (unsigned)SUPERVISOR_STATES * SUPERVISOR_INPUTS);
}
END_TEST

struct tally {
    int made, caught;
    int same;      /* no mutation at all: the same answer in every state under every input */
    char why[256]; /* what caught them, each once */
};

static bool is_same(const struct supervisor_row *rows, int count)
{
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (unsigned c = 0; c < SUPERVISOR_INPUTS; c++) {
            if (supervisor_next(rows, count, (enum supervisor_state)state, (uint16_t)c) !=
                supervisor_next(supervisor_rows, SUPERVISOR_ROWS, (enum supervisor_state)state,
                                (uint16_t)c)) {
                return false;
            }
        }
    }
    return true;
}

static void examine(const struct supervisor_row *rows, int count, struct tally *tally)
{
    const char *wrong = supervisor_examine(rows, count);
    tally->made++;
    if (wrong == NULL) {
        tally->same += is_same(rows, count) ? 1 : 0;
        return;
    }
    tally->caught++;
    if (strstr(tally->why, wrong) == NULL &&
        strlen(tally->why) + strlen(wrong) + 3 < sizeof tally->why) {
        strcat(tally->why, tally->why[0] != '\0' ? "; " : "");
        strcat(tally->why, wrong);
    }
}

/* The row left out (which never changes nothing); each bit of from, require and forbid flipped; each other target. */
static void mutate(int row, struct tally *tally)
{
    struct supervisor_row rows[SUPERVISOR_ROWS];
    memcpy(rows, supervisor_rows, sizeof rows);
    memmove(&rows[row], &rows[row + 1], (size_t)(SUPERVISOR_ROWS - row - 1) * sizeof rows[0]);
    examine(rows, SUPERVISOR_ROWS - 1, tally);
    ck_assert_int_eq(tally->caught, 1);
    memcpy(rows, supervisor_rows, sizeof rows);
    for (int bit = 0; bit < SUPERVISOR_STATES; bit++) {
        rows[row].from = (uint16_t)(supervisor_rows[row].from ^ (1u << bit));
        examine(rows, SUPERVISOR_ROWS, tally);
        rows[row].from = supervisor_rows[row].from;
    }
    for (int bit = 0; bit < SUPERVISOR_CONDITION_BITS; bit++) {
        rows[row].require = (uint16_t)(supervisor_rows[row].require ^ (1u << bit));
        examine(rows, SUPERVISOR_ROWS, tally);
        rows[row].require = supervisor_rows[row].require;
        rows[row].forbid = (uint16_t)(supervisor_rows[row].forbid ^ (1u << bit));
        examine(rows, SUPERVISOR_ROWS, tally);
        rows[row].forbid = supervisor_rows[row].forbid;
    }
    for (int to = 0; to < SUPERVISOR_STATES; to++) {
        if (to != (int)supervisor_rows[row].to) {
            rows[row].to = (enum supervisor_state)to;
            examine(rows, SUPERVISOR_ROWS, tally);
        }
    }
}

START_TEST(every_mutation_of_a_row_is_caught)
{
    struct tally tally = {0};
    mutate(_i, &tally);
    printf("  row %2d: %d mutations, %d change nothing, %d caught: %s\n", _i, tally.made,
           tally.same, tally.caught, tally.why);
    ck_assert_int_eq(tally.caught + tally.same, tally.made);
    ck_assert_int_le(tally.same, 4); /* rows before it decide those, or the state stays */
}
END_TEST

/* The values are in logs and on the bus. */
START_TEST(what_the_bits_mean_stays)
{
    ck_assert_int_eq(SUPERVISOR_INIT, 0);
    ck_assert_int_eq(SUPERVISOR_FAULT, 6);
    ck_assert_int_eq(SUPERVISOR_FAULT_PARAMETERS, 8);
    ck_assert_int_eq(SUPERVISOR_FAULT_UNLOAD, 16);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("supervisor exhaustive");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, the_table_has_every_property);
    tcase_add_loop_test(tests, every_mutation_of_a_row_is_caught, 0, SUPERVISOR_ROWS);
    tcase_add_test(tests, what_the_bits_mean_stays);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
