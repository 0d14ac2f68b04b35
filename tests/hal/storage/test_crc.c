/* The checks against the published check values of the CRC catalogue
 * (CRC-32/ISO-HDLC and CRC-16/XMODEM), and against bitwise division. */
#include "hal/storage/crc.h"

#include "tests/support/assert_close.h"

static const char digits[] = "123456789";

START_TEST(crc32_has_the_catalogues_check_value)
{
    ck_assert_uint_eq(crc32_update(CRC32_INIT, digits, 9), 0xCBF43926U);
    ck_assert_uint_eq(crc32_update(CRC32_INIT, digits, 0), 0U);
}
END_TEST

START_TEST(crc16_has_the_catalogues_check_value)
{
    ck_assert_uint_eq(crc16_update(CRC16_INIT, digits, 9), 0x31C3U);
    ck_assert_uint_eq(crc16_update(CRC16_INIT, digits, 0), 0U);
}
END_TEST

static uint32_t crc32_by_division(const uint8_t *data, size_t length)
{
    uint32_t state = 0xFFFFFFFFU;

    for (size_t i = 0; i < 8 * length; i++) {
        uint32_t bit = (uint32_t)(data[i / 8] >> (i % 8)) & 1U;
        state = (state >> 1) ^ (((state ^ bit) & 1U) ? 0xEDB88320U : 0U);
    }
    return ~state;
}

static uint16_t crc16_by_division(const uint8_t *data, size_t length)
{
    uint32_t state = 0;

    for (size_t i = 0; i < 8 * length; i++) {
        uint32_t bit = (uint32_t)(data[i / 8] >> (7 - i % 8)) & 1U;
        state = (state << 1) ^ ((((state >> 15) ^ bit) & 1U) ? 0x1021U : 0U);
        state &= 0xFFFFU;
    }
    return (uint16_t)state;
}

START_TEST(tables_agree_with_division_and_pieces_with_the_whole)
{
    uint8_t data[256];

    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (uint8_t)(i * 167U + 13U);
    }
    for (size_t length = 0; length <= sizeof data; length++) {
        uint32_t whole32 = crc32_update(CRC32_INIT, data, length);
        uint16_t whole16 = crc16_update(CRC16_INIT, data, length);
        size_t cut = length / 3;
        ck_assert_uint_eq(whole32, crc32_by_division(data, length));
        ck_assert_uint_eq(whole16, crc16_by_division(data, length));
        ck_assert_uint_eq(
            whole32, crc32_update(crc32_update(CRC32_INIT, data, cut), data + cut, length - cut));
        ck_assert_uint_eq(
            whole16, crc16_update(crc16_update(CRC16_INIT, data, cut), data + cut, length - cut));
    }
}
END_TEST

/* Against the whole data read again. */
START_TEST(a_change_of_four_bytes_is_foretold)
{
    static uint8_t data[4096];

    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (uint8_t)(i * 167U + i / 251U);
    }
    for (size_t following = 0; following + 4 <= sizeof data; following += following < 40 ? 1 : 37) {
        uint8_t *at = data + sizeof data - 4 - following;
        const uint32_t before = crc32_by_division(data, sizeof data);
        const uint32_t change = 0x80000001U ^ (uint32_t)(following * 2654435761U);
        for (unsigned i = 0; i < 4; i++) {
            at[i] ^= (uint8_t)(change >> (8 * i));
        }
        ck_assert_uint_eq(crc32_by_division(data, sizeof data),
                          before ^ crc32_change(change, following));
    }
    ck_assert_uint_eq(crc32_change(0, 77), 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("crc");
    TCase *tcase = tcase_create("crc");

    tcase_add_test(tcase, crc32_has_the_catalogues_check_value);
    tcase_add_test(tcase, crc16_has_the_catalogues_check_value);
    tcase_add_test(tcase, tables_agree_with_division_and_pieces_with_the_whole);
    tcase_add_test(tcase, a_change_of_four_bytes_is_foretold);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
