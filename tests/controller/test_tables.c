/* The tables of the laws and of the bodies: the numbers that files and the bus hold never change
 * (written from the object dictionary's history, not from the tables). */
#include "controller/control_params.h"
#include "controller/estimator/body_table.h"
#include "controller/laws/law_table.h"
#include "sim_host/persons/law_name.h"
#include "tests/support/assert_close.h"

#include <stdio.h>
#include <string.h>

static const struct {
    int number;
    const char *name;
    bool needs_branch;
} laws[] = {{0, "proportional", false}, {1, "open-loop", false}, {2, "dlqr", true},
            {3, "deadbeat", true},      {4, "predictive", true}, {8, "person", false}};
enum { LAWS = sizeof laws / sizeof laws[0] };

START_TEST(every_law_has_its_number_and_name)
{
    enum law_mode law = LAW_PROPORTIONAL;
    ck_assert_int_eq(law_from_name(laws[_i].name, &law), 0);
    ck_assert_int_eq((int)law, laws[_i].number);
    ck_assert_str_eq(law_name_of(law), laws[_i].name);
    ck_assert_int_ge(LAW_NAMES, LAWS); /* one more is welcome, none may go */
    ck_assert_ptr_nonnull(strstr(LAW_NAMES_TEXT, laws[_i].name));
    const struct law *row = law_of((real)laws[_i].number);
    ck_assert_ptr_nonnull(row);
    ck_assert(row->step != NULL);
    ck_assert_int_eq(row->needs_branch, laws[_i].needs_branch);
    ck_assert_int_eq(row->work != NULL, row->finish != NULL);
}
END_TEST

START_TEST(no_other_number_is_a_law)
{
    for (int n = -2; n <= 40; n++) { /* quarters */
        bool is_law = false;
        for (int i = 0; i < LAW_NAMES; i++) {
            is_law = is_law || 4 * (int)law_names[i].law == n;
        }
        ck_assert_int_eq(law_of((real)n * REAL(0.25)) != NULL, is_law);
    }
    ck_assert_ptr_null(law_of((real)__builtin_nanf("")));
    enum law_mode law;
    ck_assert_int_eq(law_from_name("predictve", &law), -1);
    ck_assert_str_eq(law_name_of((enum law_mode)77), "unknown");
}
END_TEST

START_TEST(bodies_keep_their_numbers)
{
    ck_assert_int_eq(BODY_COMPASS, 0);
    ck_assert_int_eq(BODY_PERSON, 1);
    ck_assert(body_of(REAL(0.0))->legs_take_turns && body_of(REAL(0.0))->ankle_is_held);
    ck_assert(!body_of(REAL(1.0))->legs_take_turns && !body_of(REAL(1.0))->ankle_is_held);
    ck_assert_ptr_ne(body_of(REAL(0.0)), body_of(REAL(1.0)));
    ck_assert_ptr_eq(body_of(REAL(0.5)), body_of(REAL(0.0))); /* a memory that fails */
}
END_TEST

/* The list in the parameter's description is the table's. */
START_TEST(the_description_lists_every_law)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *d = &control_param_descriptors[i];
        if (strcmp(d->name, "law") == 0) {
            char entry[40];
            snprintf(entry, sizeof entry, "; %d %s", laws[_i].number, laws[_i].name);
            ck_assert_msg(strstr(d->meaning, entry) != NULL, "%s: %s", entry, d->meaning);
            return;
        }
    }
    ck_abort_msg("no parameter law");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("tables");
    TCase *tests = tcase_create("all");
    tcase_add_loop_test(tests, every_law_has_its_number_and_name, 0, LAWS);
    tcase_add_test(tests, no_other_number_is_a_law);
    tcase_add_test(tests, bodies_keep_their_numbers);
    tcase_add_loop_test(tests, the_description_lists_every_law, 0, LAWS);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
