/* Modified condition/decision coverage of the supervisor (DO-178C: each condition is shown to
 * affect its decision's outcome alone), measured on executed vectors: every state under every
 * input goes through the code, and for each condition a pair of vectors is looked for that
 * differs in it alone and in the outcome. A row of the table is one decision: its state, and
 * each bit it requires or forbids, is a condition. */
#include "controller/supervisor/supervisor.h"
#include "tests/support/assert_close.h"
#include "tests/support/supervisor_rules.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* ---- The table ------------------------------------------------------------------------- */

/* A table under examination, and the inputs it is examined with: bits of `fixed` never vary
 * (they are what `held` says), which is how the measurement itself is tested. */
struct subject {
    const struct supervisor_row *rows;
    int count;
    unsigned fixed, held;
};

static bool is_tried(const struct subject *subject, unsigned inputs)
{
    return (inputs & subject->fixed) == subject->held;
}

static int next(const struct subject *subject, int count, int state, unsigned inputs)
{
    return (int)supervisor_next(subject->rows, count, (enum supervisor_state)state,
                                (uint16_t)inputs);
}

/* Rows before it leave the state alone and this one does not: it is the one that decides. */
static bool decides(const struct subject *subject, int row, int state, unsigned inputs)
{
    return next(subject, row, state, inputs) == state &&
           next(subject, row + 1, state, inputs) != state;
}

/* The row's own outcome: does it match? No row leads to a state it starts from. */
static bool matches(const struct subject *subject, int row, int state, unsigned inputs)
{
    return supervisor_next(&subject->rows[row], 1, (enum supervisor_state)state,
                           (uint16_t)inputs) != (enum supervisor_state)state;
}

/* Two vectors are a pair for this row when its outcome differs between them, and with it what
 * the whole table answers: rows before it do not hide it. */
static bool is_pair(const struct subject *subject, int row, int state, unsigned inputs,
                    int other_state, unsigned other_inputs)
{
    return matches(subject, row, state, inputs) && decides(subject, row, state, inputs) &&
           !matches(subject, row, other_state, other_inputs) &&
           next(subject, subject->count, state, inputs) !=
               next(subject, subject->count, other_state, other_inputs);
}

static bool bit_has_pair(const struct subject *subject, int row, unsigned bit)
{
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (unsigned inputs = 0; inputs < SUPERVISOR_INPUTS; inputs++) {
            if (is_tried(subject, inputs) && is_tried(subject, inputs ^ bit) &&
                is_pair(subject, row, state, inputs, state, inputs ^ bit)) {
                return true;
            }
        }
    }
    return false;
}

/* The state is one condition of the row: in one of its states it matches, in another not. */
static bool state_has_pair(const struct subject *subject, int row, int state)
{
    for (unsigned inputs = 0; inputs < SUPERVISOR_INPUTS; inputs++) {
        for (int other = 0; other < SUPERVISOR_STATES; other++) {
            if (is_tried(subject, inputs) && is_pair(subject, row, state, inputs, other, inputs)) {
                return true;
            }
        }
    }
    return false;
}

struct measured {
    int conditions, paired;
    unsigned unpaired_bits; /* conditions of the row without a pair */
};

static struct measured measure_row(const struct subject *subject, int row)
{
    const struct supervisor_row *r = &subject->rows[row];
    struct measured measured = {0, 0, 0};
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        if ((r->from & (1u << state)) != 0) {
            measured.conditions++;
            measured.paired += state_has_pair(subject, row, state) ? 1 : 0;
        }
    }
    for (unsigned bit = 1; bit < SUPERVISOR_INPUTS; bit <<= 1) {
        if (((r->require | r->forbid) & bit) != 0) {
            const bool paired = bit_has_pair(subject, row, bit);
            measured.conditions++;
            measured.paired += paired ? 1 : 0;
            measured.unpaired_bits |= paired ? 0 : bit;
        }
    }
    return measured;
}

static const struct subject all_vectors = {supervisor_rows, SUPERVISOR_ROWS, 0, 0};

START_TEST(every_condition_of_a_row_has_its_pair)
{
    ck_assert_uint_eq(supervisor_rows[_i].from & (1u << supervisor_rows[_i].to), 0);
    const struct measured measured = measure_row(&all_vectors, _i);
    printf("  row %2d: %d conditions, %d with an independence pair\n", _i, measured.conditions,
           measured.paired);
    ck_assert_int_ge(measured.conditions, 2);
    ck_assert_int_eq(measured.paired, measured.conditions);
}
END_TEST

/* The measurement's own test: without the vectors in which a bit changes, this bit has no pair
 * in any row that asks for it, and the other bits keep theirs unless that row can no longer match. */
START_TEST(a_bit_that_never_varies_has_no_pair)
{
    const unsigned bit = 1u << _i;
    int rows_with_it = 0;
    for (int row = 0; row < SUPERVISOR_ROWS; row++) {
        const struct supervisor_row *r = &supervisor_rows[row];
        if (((r->require | r->forbid) & bit) == 0) {
            continue;
        }
        const struct subject constant = {supervisor_rows, SUPERVISOR_ROWS, bit,
                                         (r->require & bit) != 0 ? bit : 0};
        const struct measured measured = measure_row(&constant, row);
        ck_assert_uint_eq(measured.unpaired_bits, bit);
        rows_with_it++;
    }
    ck_assert_int_ge(rows_with_it, 1); /* a condition that no row asks for would be no condition */
}
END_TEST

/* ... and a row that a row before it hides, or that contradicts itself, has none at all. */
START_TEST(a_hidden_or_impossible_row_has_no_pair)
{
    struct supervisor_row rows[SUPERVISOR_ROWS + 1];
    const struct subject doubled = {rows, SUPERVISOR_ROWS + 1, 0, 0};
    memcpy(rows + 1, supervisor_rows, sizeof supervisor_rows);
    rows[0] = supervisor_rows[_i];
    ck_assert_int_eq(measure_row(&doubled, _i + 1).paired, 0);

    const struct subject impossible = {rows, SUPERVISOR_ROWS, 0, 0};
    memcpy(rows, supervisor_rows, sizeof supervisor_rows);
    rows[_i].forbid |= rows[_i].require;
    rows[_i].require |= rows[_i].forbid;
    ck_assert_int_eq(measure_row(&impossible, _i).paired, 0);
}
END_TEST

/* ---- The decisions around the table ------------------------------------------------------ */

enum { DECISION_CONDITIONS_MAX = 3, DECISION_COMBINATIONS = 1 << DECISION_CONDITIONS_MAX };

/* What was seen of one decision: by combination of its conditions, each outcome. */
struct decision {
    int conditions;
    bool seen[DECISION_COMBINATIONS][2];
};

static void see(struct decision *decision, unsigned combination, bool outcome)
{
    decision->seen[combination][outcome ? 1 : 0] = true;
}

/* Conditions that change the outcome alone; -1 where one combination had both outcomes. */
static int count_pairs(const struct decision *decision)
{
    int paired = 0;
    for (int c = 0; c < DECISION_COMBINATIONS; c++) {
        if (decision->seen[c][0] && decision->seen[c][1]) {
            return -1;
        }
    }
    for (int k = 0; k < decision->conditions; k++) {
        bool found = false;
        for (int c = 0; c < DECISION_COMBINATIONS; c++) {
            const int other = c ^ (1 << k);
            found = found || (decision->seen[c][0] && decision->seen[other][1]);
        }
        paired += found ? 1 : 0;
    }
    return paired;
}

/* Outcomes are told apart by which reason is latched afterwards: another than any given. */
#define GIVEN SUPERVISOR_FAULT_DRIVE
#define BEFORE SUPERVISOR_FAULT_FALL

struct update_decisions {
    struct decision latch, table_is_told, stays, waits, reason_missing, is_given, clears, which;
};

static void run_one(struct update_decisions *d, int from, unsigned inputs,
                    enum supervisor_fault latched)
{
    struct supervisor supervisor = {.state = (enum supervisor_state)from, .latched = latched};
    const bool changed = supervisor_update(&supervisor, 7, (uint16_t)inputs, GIVEN);
    const int to = (int)supervisor.state;
    const bool fault = (inputs & SUPERVISOR_IF_FAULT) != 0;
    const bool none = latched == SUPERVISOR_FAULT_NONE;
    const bool taken = supervisor.latched == GIVEN;
    const bool out_of_init = from == SUPERVISOR_INIT && to == SUPERVISOR_FAULT;
    if (!out_of_init) { /* there a later decision latches the same reason */
        see(&d->latch, (fault ? 1u : 0u) | (from != SUPERVISOR_INIT ? 2u : 0u) | (none ? 4u : 0u),
            taken);
    }
    const bool in_init = from == SUPERVISOR_INIT, missing = (inputs & SUPERVISOR_IF_NODES) == 0;
    see(&d->stays, to == from ? 1u : 0u,
        !changed && (supervisor.since_tick == 0 || (in_init && missing)));
    if (to == from) { /* else the new state's time begins anyway */
        see(&d->waits, (in_init ? 1u : 0u) | (missing ? 2u : 0u), supervisor.since_tick == 7);
    }
    if (from == SUPERVISOR_UNLOADING && (inputs & SUPERVISOR_IF_UNLOADED) != 0) {
        see(&d->table_is_told, !none || taken ? 1u : 0u, to == SUPERVISOR_FAULT);
    }
    if (to != from) {
        const bool late = supervisor.latched == SUPERVISOR_FAULT_SELF_TEST ||
                          supervisor.latched == SUPERVISOR_FAULT_UNLOAD;
        if (!none) { /* else there is nothing to see */
            see(&d->clears, to == SUPERVISOR_INIT ? 1u : 0u,
                supervisor.latched == SUPERVISOR_FAULT_NONE);
        }
        const bool entered = late || (out_of_init && taken);
        see(&d->reason_missing,
            (to == SUPERVISOR_FAULT ? 1u : 0u) | (none && !(taken && !out_of_init) ? 2u : 0u),
            entered);
        if (entered) {
            see(&d->is_given, fault ? 1u : 0u, taken);
        }
        if (late) {
            see(&d->which, from == SUPERVISOR_SELF_TEST ? 1u : 0u,
                supervisor.latched == SUPERVISOR_FAULT_SELF_TEST);
        }
    }
}

#define ALL_DECISIONS                                                       \
    {                                                                       \
        .latch = {.conditions = 3}, .table_is_told = {.conditions = 1},     \
        .stays = {.conditions = 1}, .waits = {.conditions = 2},             \
        .reason_missing = {.conditions = 2}, .is_given = {.conditions = 1}, \
        .clears = {.conditions = 1}, .which = {                             \
            .conditions = 1                                                 \
        }                                                                   \
    }

START_TEST(every_condition_of_an_update_has_its_pair)
{
    struct update_decisions d = ALL_DECISIONS;
    for (int from = 0; from < SUPERVISOR_STATES; from++) {
        for (unsigned inputs = 0; inputs < SUPERVISOR_INPUTS; inputs++) {
            run_one(&d, from, inputs, SUPERVISOR_FAULT_NONE);
            run_one(&d, from, inputs, BEFORE);
        }
    }
    ck_assert_int_eq(count_pairs(&d.latch), 3);
    ck_assert_int_eq(count_pairs(&d.table_is_told), 1);
    ck_assert_int_eq(count_pairs(&d.stays), 1);
    ck_assert_int_eq(count_pairs(&d.waits), 2);
    ck_assert_int_eq(count_pairs(&d.reason_missing), 2);
    ck_assert_int_eq(count_pairs(&d.is_given), 1);
    ck_assert_int_eq(count_pairs(&d.clears), 1);
    ck_assert_int_eq(count_pairs(&d.which), 1);
}
END_TEST

/* Where only inputs without a fault are tried, the first decision's conditions show nothing. */
START_TEST(a_decision_without_its_vectors_has_no_pairs)
{
    struct update_decisions d = ALL_DECISIONS;
    for (int from = 0; from < SUPERVISOR_STATES; from++) {
        for (unsigned inputs = 0; inputs < SUPERVISOR_INPUTS; inputs++) {
            run_one(&d, from, inputs & ~(unsigned)SUPERVISOR_IF_FAULT, SUPERVISOR_FAULT_NONE);
        }
    }
    ck_assert_int_eq(count_pairs(&d.latch), 0);
    ck_assert_int_eq(count_pairs(&d.reason_missing), 1); /* nothing was latched before */
}
END_TEST

START_TEST(torque_and_assistance_by_state)
{
    struct decision enable = {.conditions = 1}, assist = {.conditions = 1};
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        const bool assisting = state == SUPERVISOR_ENGAGING || state == SUPERVISOR_WALKING;
        see(&assist, assisting ? 1u : 0u, supervisor_may_assist((enum supervisor_state)state));
        const bool moves = state == SUPERVISOR_UNLOADING || state == SUPERVISOR_COMMISSIONING;
        see(&enable, assisting || moves ? 1u : 0u,
            supervisor_may_enable((enum supervisor_state)state));
    }
    ck_assert_int_eq(count_pairs(&enable), 1);
    ck_assert_int_eq(count_pairs(&assist), 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("supervisor mcdc");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, every_condition_of_a_row_has_its_pair, 0, SUPERVISOR_ROWS);
    tcase_add_loop_test(tests, a_bit_that_never_varies_has_no_pair, 0, SUPERVISOR_CONDITION_BITS);
    tcase_add_loop_test(tests, a_hidden_or_impossible_row_has_no_pair, 0, SUPERVISOR_ROWS);
    tcase_add_test(tests, every_condition_of_an_update_has_its_pair);
    tcase_add_test(tests, a_decision_without_its_vectors_has_no_pairs);
    tcase_add_test(tests, torque_and_assistance_by_state);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
