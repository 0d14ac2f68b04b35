/* Every state under every combination of conditions, and what every mutation of every row
 * does: build/tests/controller/test_supervisor_exhaustive prints the table. */
#include "controller/supervisor/supervisor.h"
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

/* Whether this row by itself applies. */
static bool matches(const struct supervisor_row *row, int state, unsigned c)
{
    return (row->from & (1u << state)) != 0 && (c & row->require) == row->require &&
           (c & row->forbid) == 0;
}

/* Why a mutation of one row is none: of all pairs of state and input, those in which the
 * row's own answer has changed, by what decides them instead. The machine's output is its
 * state, so equal answers in every state under every input are equal behaviour for ever. */
struct proof {
    unsigned differ;   /* pairs in which the next state is another: 0, or it is a mutation */
    unsigned shadowed; /* the row's answer changed, but a row before it decides */
    unsigned fallen;   /* ... but where it no longer decides, a later row or none leads there */
};

static struct proof compare(const struct supervisor_row *rows, int row)
{
    struct proof proof = {0, 0, 0};
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (unsigned c = 0; c < SUPERVISOR_INPUTS; c++) {
            const enum supervisor_state now =
                supervisor_next(rows, SUPERVISOR_ROWS, (enum supervisor_state)state, (uint16_t)c);
            const enum supervisor_state before = supervisor_next(
                supervisor_rows, SUPERVISOR_ROWS, (enum supervisor_state)state, (uint16_t)c);
            const bool changed =
                matches(&rows[row], state, c) != matches(&supervisor_rows[row], state, c) ||
                (matches(&rows[row], state, c) && rows[row].to != supervisor_rows[row].to);
            int first = 0;
            while (first < row && !matches(&supervisor_rows[first], state, c)) {
                first++;
            }
            proof.differ += now != before ? 1u : 0u;
            proof.shadowed += changed && first < row ? 1u : 0u;
            proof.fallen += changed && first == row ? 1u : 0u;
        }
    }
    return proof;
}

/* row < 0: not a mutation of one row in place. */
static void examine(const struct supervisor_row *rows, int count, struct tally *tally, int row,
                    const char *field, int bit)
{
    const char *wrong = supervisor_examine(rows, count);
    tally->made++;
    if (wrong == NULL) {
        ck_assert_msg(row >= 0, "a row that can be left out");
        const struct proof proof = compare(rows, row);
        ck_assert_msg(proof.differ == 0, "row %d, %s %d: not caught, and it changes %u pairs", row,
                      field, bit, proof.differ);
        printf("  row %2d, %s %d changes nothing: of %u pairs, %u are decided by rows before it, "
               "%u lead to the same state\n",
               row, field, bit, proof.shadowed + proof.fallen, proof.shadowed, proof.fallen);
        tally->same++;
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
    examine(rows, SUPERVISOR_ROWS - 1, tally, -1, "left out", 0);
    ck_assert_int_eq(tally->caught, 1);
    memcpy(rows, supervisor_rows, sizeof rows);
    for (int bit = 0; bit < SUPERVISOR_STATES; bit++) {
        rows[row].from = (uint16_t)(supervisor_rows[row].from ^ (1u << bit));
        examine(rows, SUPERVISOR_ROWS, tally, row, "from state", bit);
        rows[row].from = supervisor_rows[row].from;
    }
    for (int bit = 0; bit < SUPERVISOR_CONDITION_BITS; bit++) {
        rows[row].require = (uint16_t)(supervisor_rows[row].require ^ (1u << bit));
        examine(rows, SUPERVISOR_ROWS, tally, row, "require bit", bit);
        rows[row].require = supervisor_rows[row].require;
        rows[row].forbid = (uint16_t)(supervisor_rows[row].forbid ^ (1u << bit));
        examine(rows, SUPERVISOR_ROWS, tally, row, "forbid bit", bit);
        rows[row].forbid = supervisor_rows[row].forbid;
    }
    for (int to = 0; to < SUPERVISOR_STATES; to++) {
        if (to != (int)supervisor_rows[row].to) {
            rows[row].to = (enum supervisor_state)to;
            examine(rows, SUPERVISOR_ROWS, tally, row, "to state", to);
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
    ck_assert_int_le(tally.same, 5); /* rows before it decide those, or the state stays */
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
