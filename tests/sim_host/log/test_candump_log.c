/* The log against lines as can-utils prints them, and refusal of everything else. */
#include <check.h>
#include <string.h>

#include "sim_host/log/candump_log.h"
#include "tests/support/assert_close.h"

static bool parse(const char *line, struct candump_record *record, struct candump_error *error)
{
    return candump_parse(line, strlen(line), record, error);
}

START_TEST(lines_of_can_utils_are_read_and_written_back_unchanged)
{
    static const char *const lines[] = {
        "(1436509052.249713) vcan0 044#2A366C2BBA\n",
        "(1436509052.449847) can1 0F6#7ADFE07BD2\n",
        "(0000000000.000000) vcan0 080#\n",
        "(0000000012.000345) vcan0 7FF#0011223344556677\n",
        "(1436509053.850870) vcan0 00000123#DEADBEEF\n",
        "(1436509053.850870) vcan0 1FFFFFFF#\n",
        "(1436509053.850870) vcan0 123#R\n",
        "(1436509053.850870) vcan0 123#R5\n",
        "(1436509053.850870) slcan0 20000004#0004000000000000\n",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct candump_record record;
        struct candump_error error;
        ck_assert_msg(parse(lines[i], &record, &error), "%s: %s", lines[i], error.reason);
        char back[CANDUMP_LINE_MAX + 1];
        const size_t length =
            candump_format(back, record.time_us, record.interface_name, &record.message);
        back[length] = '\0';
        ck_assert_str_eq(back, lines[i]);
    }
}
END_TEST

START_TEST(fields_are_read_right)
{
    struct candump_record record;
    struct candump_error error;
    ck_assert(parse("(0000000012.000345) vcan0 181#37160000E803", &record, &error));
    ck_assert_uint_eq(record.time_us, 12000345);
    ck_assert_str_eq(record.interface_name, "vcan0");
    ck_assert_uint_eq(record.message.id, 0x181);
    ck_assert_uint_eq(record.message.length, 6);
    ck_assert_uint_eq(record.message.data[0], 0x37);
    ck_assert_uint_eq(record.message.data[5], 0x03);
    ck_assert_uint_eq(record.message.flags, 0);
    ck_assert(parse("(0000000012.000345) vcan0 20000040#0000000000000000", &record, &error));
    ck_assert_uint_eq(record.message.flags, CAN_FRAME_ERROR);
    ck_assert_uint_eq(record.message.id, 0x40);
}
END_TEST

START_TEST(anything_else_is_refused_with_its_column)
{
    static const struct {
        const char *line;
        unsigned column;
    } bad[] = {
        {"", 1},
        {"0000000012.000345) vcan0 181#", 1},
        {"(.000345) vcan0 181#", 2},
        {"(0000000012,000345) vcan0 181#", 12},
        {"(0000000012.00345) vcan0 181#", 18},
        {"(0000000012.000345 vcan0 181#", 19},
        {"(0000000012.000345)vcan0 181#", 20},
        {"(0000000012.000345) averyveryverylongname 181#", 36},
        {"(0000000012.000345) vcan0 181", 30},
        {"(0000000012.000345) vcan0 0181#", 31},
        {"(0000000012.000345) vcan0 800#", 27},
        {"(0000000012.000345) vcan0 40000000#", 27},
        {"(0000000012.000345) vcan0 81#", 29},
        {"(0000000012.000345) vcan0 18g#", 29},
        {"(0000000012.000345) vcan0 181#1", 32},
        {"(0000000012.000345) vcan0 181#1x", 32},
        {"(0000000012.000345) vcan0 181#aa", 31},
        {"(0000000012.000345) vcan0 181#11 X", 33},
        {"(0000000012.000345) vcan0 181#11 R T", 33},
        {"(0000000012.000345) vcan0 181#1122334455667788_8", 48},
        {"(0000000012.000345) vcan0 181#11223344_9", 39},
        {"(2015-07-10 08:17:32.249713)  vcan0  181   [1]  11", 6},
        {"  vcan0  181   [1]  11", 3},
        {"DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)", 1},
        {"(0000000012.000345)  vcan0  181   [9]  11", 37},
        {"(0000000012.000345)  vcan0  181   [02]  11 22", 38},
        {"(0000000012.000345)  vcan0  181   [2]  11", 42},
        {"(0000000012.000345)  vcan0  181   [1]  11 22", 43},
        {"(0000000012.000345)  vcan0  181   [1]  1122", 42},
        {"(0000000012.000345)  vcan0  181   [2] `22`11", 39},
        {"(0000000012.000345) vcan0 181#112233445566778899", 47},
        {"(0000000012.000345) vcan0 181##0112233", 31},
        {"(0000000012.000345) vcan0 181#R9", 32},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct candump_record record;
        struct candump_error error = {0};
        ck_assert_msg(!parse(bad[i].line, &record, &error), "accepted: %s", bad[i].line);
        ck_assert_msg(error.column == bad[i].column, "%s: column %u (%s), expected %u", bad[i].line,
                      error.column, error.reason, bad[i].column);
    }
}
END_TEST

static void is_read_as(const char *line, uint64_t time_us, uint32_t id, unsigned flags,
                       unsigned length)
{
    struct candump_record record;
    struct candump_error error = {0};
    ck_assert_msg(parse(line, &record, &error), "%s: column %u: %s", line, error.column,
                  error.reason);
    ck_assert_uint_eq(record.time_us, time_us);
    ck_assert_uint_eq(record.message.id, id);
    ck_assert_uint_eq(record.message.flags, flags);
    ck_assert_uint_eq(record.message.length, length);
    for (unsigned i = 0; i < length && (flags & CAN_FRAME_REMOTE) == 0; i++) {
        ck_assert_uint_eq(record.message.data[i], 0x11 * (i + 1));
    }
}

/* can/io/canutils.py, CanutilsLogWriter: seconds without leading zeros, the direction behind the frame,
 * error frames without data. */
START_TEST(lines_of_python_can_are_read)
{
    is_read_as("(0.000000) can0 080# T\n", 0, 0x080, 0, 0);
    is_read_as("(12.000345) vcan0 181#112233 R\n", 12000345, 0x181, 0, 3);
    is_read_as("(1700000000.123457) can0 00000181#11 R\n", 1700000000123457, 0x181,
               CAN_FRAME_EXTENDED, 1);
    is_read_as("(1.000000) can0 181#R R\n", 1000000, 0x181, CAN_FRAME_REMOTE, 0);
    is_read_as("(1.000000) can0 20000080#\n", 1000000, 0x80, CAN_FRAME_ERROR, 0);
}
END_TEST

/* candump -L -x, and files that passed through Windows or an editor. */
START_TEST(directions_and_line_ends_are_read)
{
    is_read_as("(0000000012.000345) vcan0 181#1122 R\n", 12000345, 0x181, 0, 2);
    is_read_as("(0000000012.000345) vcan0 181#1122 T\r\n", 12000345, 0x181, 0, 2);
    is_read_as("(0000000012.000345) vcan0 181#1122\r\n", 12000345, 0x181, 0, 2);
    is_read_as("(0000000012.000345) vcan0 181#1122  \n", 12000345, 0x181, 0, 2);
    is_read_as("(0000000012.000345) vcan0 181#R2 R\n", 12000345, 0x181, CAN_FRAME_REMOTE, 2);
    is_read_as("(0000000012.000345678) vcan0 181#11\n", 12000345, 0x181, 0, 1);
    is_read_as("(0000000012.000345) vcan0 181#1122334455667788_9\n", 12000345, 0x181, 0, 8);
}
END_TEST

/* candump -t a, d and z on the screen, with and without -x and -a. */
START_TEST(columns_of_the_screen_are_read)
{
    is_read_as(" (1436509052.249713)  vcan0  181   [2]  11 22\n", 1436509052249713, 0x181, 0, 2);
    is_read_as(" (000.000123)  vcan0  080   [0] \n", 123, 0x080, 0, 0);
    is_read_as(" (012.000345)  vcan0  12345678   [1]  11\n", 12000345, 0x12345678,
               CAN_FRAME_EXTENDED, 1);
    is_read_as(" (000.000123)  vcan0  181   [0]  remote request\n", 123, 0x181, CAN_FRAME_REMOTE,
               0);
    is_read_as(" (000.000123)  vcan0  20000004   [2]  11 22   ERRORFRAME\n", 123, 0x4,
               CAN_FRAME_ERROR, 2);
    is_read_as(" (000.000123)  vcan0  RX - -  181   [2]  11 22\n", 123, 0x181, 0, 2);
    is_read_as(" (000.000123)  vcan0  TX - -  181   [2]  11 22\n", 123, 0x181, 0, 2);
    is_read_as(" (000.000123)  vcan0  181   [2]  11 22   '.\"'\n", 123, 0x181, 0, 2);
}
END_TEST

START_TEST(can_fd_is_refused_by_its_name)
{
    static const char *const lines[] = {"(0000000012.000345) vcan0 181##0112233",
                                        "(12.000345) can0 181##3112233 R",
                                        " (000.000123)  vcan0  181  [12]  11 22"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct candump_record record;
        struct candump_error error = {0};
        ck_assert(!parse(lines[i], &record, &error));
        ck_assert_msg(strstr(error.reason, "CAN FD") != NULL, "%s: %s", lines[i], error.reason);
    }
}
END_TEST

START_TEST(blank_lines_are_passed_by_and_counted)
{
    FILE *file = tmpfile();
    ck_assert_ptr_nonnull(file);
    fputs("\n\r\n(12.000345) can0 181#11\r\n  \n(1", file);
    rewind(file);
    unsigned long line = 0;
    struct candump_record record;
    struct candump_error error;
    ck_assert_int_eq(candump_read(file, &line, &record, &error), CANDUMP_RECORD);
    ck_assert_uint_eq(line, 3);
    ck_assert_int_eq(candump_read(file, &line, &record, &error), CANDUMP_BAD);
    ck_assert_uint_eq(error.line, 5);
    fclose(file);
}
END_TEST

START_TEST(a_file_is_read_to_its_end_and_errors_name_the_line)
{
    FILE *file = tmpfile();
    ck_assert_ptr_nonnull(file);
    const struct can_msg message = {.id = 0x283, .length = 5, .data = {1, 2, 3, 4, 5}};
    for (uint64_t i = 0; i < 100; i++) {
        ck_assert(candump_write(file, i * 1000, "vcan0", &message));
    }
    fputs("(0000000012.000345) vcan0 181#1\n(0000000012.0003", file);
    rewind(file);
    unsigned long line = 0;
    struct candump_record record;
    struct candump_error error;
    for (uint64_t i = 0; i < 100; i++) {
        ck_assert_int_eq(candump_read(file, &line, &record, &error), CANDUMP_RECORD);
        ck_assert_uint_eq(record.time_us, i * 1000);
        ck_assert_mem_eq(record.message.data, message.data, 8);
    }
    ck_assert_int_eq(candump_read(file, &line, &record, &error), CANDUMP_BAD);
    ck_assert_uint_eq(error.line, 101);
    ck_assert_uint_eq(error.column, 32);
    ck_assert_int_eq(candump_read(file, &line, &record, &error), CANDUMP_BAD);
    ck_assert_uint_eq(error.line, 102);
    ck_assert_int_eq(candump_read(file, &line, &record, &error), CANDUMP_END);
    fclose(file);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("candump_log");
    TCase *tcase = tcase_create("all");
    tcase_add_test(tcase, lines_of_can_utils_are_read_and_written_back_unchanged);
    tcase_add_test(tcase, fields_are_read_right);
    tcase_add_test(tcase, anything_else_is_refused_with_its_column);
    tcase_add_test(tcase, lines_of_python_can_are_read);
    tcase_add_test(tcase, directions_and_line_ends_are_read);
    tcase_add_test(tcase, columns_of_the_screen_are_read);
    tcase_add_test(tcase, can_fd_is_refused_by_its_name);
    tcase_add_test(tcase, blank_lines_are_passed_by_and_counted);
    tcase_add_test(tcase, a_file_is_read_to_its_end_and_errors_name_the_line);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
