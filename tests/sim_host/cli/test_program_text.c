/* A command as people read it: whole letters, whatever the room. */
#include "sim_host/cli/program.h"
#include "tests/support/assert_close.h"

#include <string.h>

START_TEST(a_command_is_cut_between_letters)
{
    char *const words[] = {"afo", "gr\xC3\xB6\xC3\x9F"
                                  "e"}; /* two letters of two bytes each */
    char text[16];
    static const struct {
        size_t size;
        const char *kept;
    } cases[] = {{16, "afo gr\xC3\xB6\xC3\x9F"
                      "e"},
                 {11, "afo gr\xC3\xB6\xC3\x9F"},
                 {10, "afo gr\xC3\xB6"},
                 {9, "afo gr\xC3\xB6"},
                 {8, "afo gr"},
                 {7, "afo gr"},
                 {1, ""}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        program_command_text(2, words, text, cases[i].size);
        ck_assert_str_eq(text, cases[i].kept);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("program_text");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_command_is_cut_between_letters);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
