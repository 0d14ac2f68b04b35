/* What the writer writes against RFC 8259, read by eye here and by Python's json in tests/system/test_afo.py. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/json_writer.h"
#include "tests/support/assert_close.h"

static struct json_writer json;
static char *text;
static size_t length;

static void begin(void)
{
    json_begin(&json, open_memstream(&text, &length));
}

static void expect(const char *wanted)
{
    fclose(json.stream);
    ck_assert_str_eq(text, wanted);
    free(text);
}

START_TEST(members_are_parted_by_commas_at_every_depth)
{
    begin();
    json_open_object(&json, NULL);
    json_unsigned(&json, "a", UINT64_MAX);
    json_open_list(&json, "b");
    json_integer(&json, NULL, -3);
    json_open_object(&json, NULL);
    json_close_object(&json);
    json_open_list(&json, NULL);
    json_bool(&json, NULL, true);
    json_bool(&json, NULL, false);
    json_close_list(&json);
    json_close_list(&json);
    json_null(&json, "c");
    json_close_object(&json);
    json_end(&json);
    expect("{\"a\": 18446744073709551615, \"b\": [-3, {}, [true, false]], \"c\": null}\n");
}
END_TEST

START_TEST(what_is_no_number_is_null)
{
    begin();
    json_open_list(&json, NULL);
    json_number(&json, NULL, (double)NAN, 9);
    json_number(&json, NULL, -(double)NAN, 17);
    json_number(&json, NULL, (double)INFINITY, 9);
    json_fixed(&json, NULL, -(double)INFINITY, 3);
    json_fixed(&json, NULL, (double)NAN, 0);
    json_close_list(&json);
    expect("[null, null, null, null, null]");
}
END_TEST

START_TEST(numbers_have_the_digits_that_were_asked_for)
{
    begin();
    json_open_list(&json, NULL);
    json_number(&json, NULL, 0.1, 17);
    json_number(&json, NULL, 0.1, 9);
    json_number(&json, NULL, 1e-300, 3);
    json_number(&json, NULL, -0.0, 9);
    json_fixed(&json, NULL, 1234.5678, 1);
    json_fixed(&json, NULL, 2.5e6, 0);
    json_close_list(&json);
    expect("[0.10000000000000001, 0.1, 1e-300, -0, 1234.6, 2500000]");
}
END_TEST

START_TEST(texts_are_escaped)
{
    begin();
    json_open_object(&json, NULL);
    json_text(&json, "a \"key\"", "quote \" backslash \\ tab \t end\n\x01 \xC3\xBC");
    json_text(&json, "none", NULL);
    json_text(&json, "empty", "");
    json_close_object(&json);
    expect(
        "{\"a \\\"key\\\"\": \"quote \\\" backslash \\\\ tab \\u0009 end\\u000a\\u0001 \xC3\xBC\", "
        "\"none\": null, \"empty\": \"\"}");
}
END_TEST

START_TEST(lines_break_where_they_are_told_to)
{
    begin();
    json_open_object(&json, NULL);
    json_unsigned(&json, "a", 1);
    json_break(&json, "\n");
    json_open_list(&json, "rows");
    json_break(&json, "\n ");
    json_unsigned(&json, NULL, 2);
    json_break(&json, "\n ");
    json_unsigned(&json, NULL, 3);
    json_unsigned(&json, NULL, 4);
    json_break(&json, "\n");
    json_close_list(&json);
    json_close_object(&json);
    expect("{\"a\": 1,\n\"rows\": [\n 2,\n 3, 4\n]}");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("json_writer");
    TCase *tcase = tcase_create("all");
    tcase_add_test(tcase, members_are_parted_by_commas_at_every_depth);
    tcase_add_test(tcase, what_is_no_number_is_null);
    tcase_add_test(tcase, numbers_have_the_digits_that_were_asked_for);
    tcase_add_test(tcase, texts_are_escaped);
    tcase_add_test(tcase, lines_break_where_they_are_told_to);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
