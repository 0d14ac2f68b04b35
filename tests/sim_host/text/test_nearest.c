/* Distances of the textbook's pairs, and which name a mistyped one is taken for. */
#include <check.h>
#include <string.h>

#include "sim_host/persons/law_name.h"
#include "sim_host/text/nearest.h"
#include "tests/support/assert_close.h"

START_TEST(distances_are_those_of_the_textbook)
{
    static const struct {
        const char *a, *b;
        unsigned distance;
    } pairs[] = {
        {"", "", 0},
        {"abc", "abc", 0},
        {"", "abc", 3},
        {"abc", "", 3},
        {"kitten", "sitting", 3},
        {"saturday", "sunday", 3},
        {"smi", "sim", 1},
        {"ab", "ba", 1},
        {"ca", "abc", 3}, /* optimal string alignment; unrestricted it would be 2 */
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        ck_assert_msg(nearest_distance(pairs[i].a, pairs[i].b) == pairs[i].distance, "%s, %s: %u",
                      pairs[i].a, pairs[i].b, nearest_distance(pairs[i].a, pairs[i].b));
        ck_assert_uint_eq(nearest_distance(pairs[i].b, pairs[i].a), pairs[i].distance);
    }
}
END_TEST

START_TEST(a_long_word_stays_within_its_room)
{
    char text[300];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    ck_assert_uint_eq(nearest_distance(text, text), 0);
    ck_assert_uint_eq(nearest_distance(text, "x"), 62);
}
END_TEST

START_TEST(the_nearest_is_named_and_nothing_where_none_is_near)
{
    static const char *const names[] = {"sim", "study", "soak", "slcan"};
    ck_assert_str_eq(nearest_name("smi", names, 4, sizeof names[0]), "sim");
    ck_assert_str_eq(nearest_name("stuyd", names, 4, sizeof names[0]), "study");
    ck_assert_str_eq(nearest_name("slacn", names, 4, sizeof names[0]), "slcan");
    ck_assert_ptr_null(nearest_name("pq", names, 4, sizeof names[0]));
    ck_assert_ptr_null(nearest_name("", names, 4, sizeof names[0]));
    ck_assert_ptr_null(nearest_name("sim", names, 0, sizeof names[0]));
}
END_TEST

START_TEST(every_law_is_read_back_from_its_own_name)
{
    for (int i = 0; i < LAW_NAMES; i++) {
        enum law_mode law;
        ck_assert_int_eq(law_from_name(law_names[i].name, &law), 0);
        ck_assert_int_eq(law, law_names[i].law);
        ck_assert_str_eq(law_name_of(law), law_names[i].name);
    }
    enum law_mode law;
    ck_assert_int_eq(law_from_name("person", &law), 0);
    ck_assert_int_eq(law, LAW_PERSON);
}
END_TEST

START_TEST(a_law_that_is_none_is_answered_by_the_list_and_the_nearest)
{
    char message[256], small[24], wanted[256] = "\"predictve\" is unknown, allowed is ";
    for (int i = 0; i < LAW_NAMES; i++) {
        strcat(wanted, i == 0 ? "" : i < LAW_NAMES - 1 ? ", " : " or ");
        strcat(wanted, law_names[i].name);
    }
    strcat(wanted, "; nearest: predictive");
    law_name_refuse("predictve", message, sizeof message);
    ck_assert_str_eq(message, wanted);
    law_name_refuse("predictve", small, sizeof small);
    ck_assert_str_eq(small, "\"predictve\" is unknown,");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("nearest");
    TCase *tcase = tcase_create("all");
    tcase_add_test(tcase, distances_are_those_of_the_textbook);
    tcase_add_test(tcase, a_long_word_stays_within_its_room);
    tcase_add_test(tcase, the_nearest_is_named_and_nothing_where_none_is_near);
    tcase_add_test(tcase, every_law_is_read_back_from_its_own_name);
    tcase_add_test(tcase, a_law_that_is_none_is_answered_by_the_list_and_the_nearest);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
