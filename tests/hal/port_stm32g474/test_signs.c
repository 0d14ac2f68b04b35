/* LD2 and the virtual COM port on a model of LPUART1 and of the pins. */
#include <string.h>

#include "hal/port_stm32g474/signs.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "tests/support/assert_close.h"

static uint32_t rcc[0x100 / 4], port_a[0x2C / 4], uart[0x30 / 4];
static char said[256];
static unsigned said_count, busy_polls, busy_after_each;

static uint32_t uart_read(void *context, uint32_t offset)
{
    (void)context;
    if (offset == 0x1C) {
        return busy_polls > 0 && busy_polls-- > 0 ? 0 : 1u << 7;
    }
    return uart[offset / 4];
}

static void uart_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    uart[offset / 4] = value;
    if (offset == 0x28) {
        ck_assert_uint_eq(busy_polls, 0);
        said[said_count++] = (char)value;
        busy_polls = busy_after_each;
    }
}

static void setup(void)
{
    mmio_model_reset();
    memset(rcc, 0, sizeof rcc);
    memset(port_a, 0, sizeof port_a);
    memset(uart, 0, sizeof uart);
    memset(said, 0, sizeof said);
    said_count = busy_polls = 0;
    busy_after_each = 5;
    port_a[0] = 0xABFFFFFF;
    rcc[0x88 / 4] = 3u << 10;
    mmio_model_map_memory(0x40021000, sizeof rcc, rcc);
    mmio_model_map_memory(0x48000000, sizeof port_a, port_a);
    mmio_model_map(0x40008000, sizeof uart, uart_read, uart_write, NULL);
}

/* RM0440, LPUART: baud = 256 * clock / BRR, and BRR is at least 0x300, below 2^20. */
START_TEST(the_port_is_lpuart1_on_pa2_at_115200_baud)
{
    static const uint32_t clock_hz[] = {16000000, 170000000};

    signs_init(clock_hz[_i]);
    assert_close(256.0 * clock_hz[_i] / uart[0x0C / 4], 115200.0, 0, 1e-4);
    ck_assert_uint_ge(uart[0x0C / 4], 0x300);
    ck_assert_uint_lt(uart[0x0C / 4], 1u << 20);
    ck_assert_uint_eq(uart[0], 9);                           /* on, and sends */
    ck_assert_uint_eq(rcc[0x5C / 4], 1);                     /* LPUART1's clock */
    ck_assert_uint_eq(rcc[0x88 / 4], 0);                     /* the bus's */
    ck_assert_uint_eq(port_a[0x20 / 4], 0xCC00);             /* PA2, PA3: function 12 */
    ck_assert_uint_eq(port_a[0] & 0xCF0, 0x400 | 0xA0);      /* PA5 out, PA2 and PA3 alternate */
    ck_assert_uint_eq(port_a[0] & 0xFC000000u, 0xA8000000u); /* the debug port stays */
}
END_TEST

START_TEST(each_character_waits_for_the_one_before)
{
    signs_init(16000000);
    signs_write("afo ");
    signs_write_hex(0x1234ABCD);
    ck_assert_str_eq(said, "afo 1234ABCD");
}
END_TEST

static uint32_t port_read(void *context, uint32_t offset)
{
    (void)context;
    return port_a[offset / 4];
}

static void port_write_lost(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    (void)offset;
    (void)value;
}

/* Whose pins did not become its own: it stays off, and nobody waits for it. */
START_TEST(a_port_without_its_pin_says_nothing)
{
    mmio_model_reset();
    mmio_model_map_memory(0x40021000, sizeof rcc, rcc);
    mmio_model_map(0x48000000, sizeof port_a, port_read, port_write_lost, NULL);
    mmio_model_map(0x40008000, sizeof uart, uart_read, uart_write, NULL);
    signs_init(16000000);
    ck_assert_uint_eq(uart[0], 0);
    ck_assert(signs_try_put('x'));
    signs_write("fault");
    ck_assert_uint_eq(said_count, 0);
}
END_TEST

START_TEST(a_port_that_never_takes_anything_holds_nobody_up)
{
    signs_init(16000000);
    busy_polls = UINT32_MAX;
    signs_write("ab");
    ck_assert_uint_eq(said_count, 0);
}
END_TEST

START_TEST(a_line_goes_out_while_other_things_go_on)
{
    struct signs_line line = {.length = 0};

    signs_init(16000000);
    signs_line_go_on(&line);
    ck_assert_uint_eq(said_count, 0);
    signs_line_begin(&line, "afo fault", 17);
    for (int i = 0; i < 1000; i++) {
        signs_line_go_on(&line);
    }
    ck_assert_str_eq(said, "afo fault 0017\r\n");
    signs_line_begin(&line, "a name that is far too long", 9999);
    for (int i = 0; i < 1000; i++) {
        signs_line_go_on(&line);
    }
    ck_assert_str_eq(said + 16, "a name tha 9999\r\n");
}
END_TEST

START_TEST(ld2_flashes_as_often_as_the_number_says)
{
    for (uint32_t flashes = 0; flashes <= 7; flashes++) {
        uint32_t edges = 0, lit_ms = 0;
        for (uint32_t ms = 0; ms < 2000; ms++) {
            const bool lit = signs_flash(40000 + ms, flashes);
            edges += lit && !(ms > 0 && signs_flash(40000 + ms - 1, flashes));
            lit_ms += lit;
        }
        ck_assert_uint_eq(edges, flashes);
        ck_assert_uint_eq(lit_ms, 100 * flashes);
    }
    signs_light(true);
    ck_assert_uint_eq(port_a[0x18 / 4], 1u << 5);
    signs_light(false);
    ck_assert_uint_eq(port_a[0x18 / 4], 1u << 21);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("signs");
    TCase *tcase = tcase_create("signs");

    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_loop_test(tcase, the_port_is_lpuart1_on_pa2_at_115200_baud, 0, 2);
    tcase_add_test(tcase, each_character_waits_for_the_one_before);
    tcase_add_test(tcase, a_port_without_its_pin_says_nothing);
    tcase_add_test(tcase, a_port_that_never_takes_anything_holds_nobody_up);
    tcase_add_test(tcase, a_line_goes_out_while_other_things_go_on);
    tcase_add_test(tcase, ld2_flashes_as_often_as_the_number_says);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
