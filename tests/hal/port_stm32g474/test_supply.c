/* The supply's detector, RAM parity, the watchdog's oscillator and the option bytes, on models of their
 * registers. */
#include "hal/port_stm32g474/supply.h"

#include <string.h>

#include "hal/port_stm32g474/flash_store.h"
#include "hal/port_stm32g474/lsi_meter.h"
#include "hal/port_stm32g474/option_bytes.h"
#include "sim_host/emulator/g474/flash_model.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "tests/support/assert_close.h"

static uint32_t rcc[0x100 / 4], pwr[0x100 / 4], exti[0x40 / 4], syscfg[0x30 / 4];
static struct supply supply;

static uint32_t exti_read(void *context, uint32_t offset)
{
    (void)context;
    return exti[offset / 4];
}

static void exti_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    exti[offset / 4] = offset == 0x14 ? exti[offset / 4] & ~value : value;
}

static void syscfg_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    ck_assert_uint_eq(offset, 0x1C);
    syscfg[7] &= ~(value & 1u << 8); /* RM0440, SYSCFG_CFGR2: SPF is cleared by writing 1 */
}

static uint32_t syscfg_read(void *context, uint32_t offset)
{
    (void)context;
    return syscfg[offset / 4];
}

static void setup(void)
{
    mmio_model_reset();
    memset(rcc, 0, sizeof rcc);
    memset(pwr, 0, sizeof pwr);
    memset(exti, 0, sizeof exti);
    memset(syscfg, 0, sizeof syscfg);
    mmio_model_map_memory(0x40021000, sizeof rcc, rcc);
    mmio_model_map_memory(0x40007000, sizeof pwr, pwr);
    mmio_model_map(0x40010400, sizeof exti, exti_read, exti_write, NULL);
    mmio_model_map(0x40010000, sizeof syscfg, syscfg_read, syscfg_write, NULL);
}

static void supply_falls_below(bool low)
{
    pwr[0x14 / 4] = low ? 1u << 11 : 0; /* PWR_SR2.PVDO */
    exti[0x14 / 4] |= 1u << 16;
    supply_interrupt(&supply);
    ck_assert_uint_eq(exti[0x14 / 4], 0);
}

/* stm32g4xx-hal-driver: level 6 is 2.9 V, the detector is EXTI line 16. */
START_TEST(the_detector_interrupts_at_both_edges_of_2_9_v)
{
    ck_assert_uint_eq(supply_init(&supply), 0);
    ck_assert_uint_eq(pwr[0x04 / 4], 6u << 1 | 1u);
    ck_assert_uint_eq(exti[0x00 / 4] & exti[0x08 / 4] & exti[0x0C / 4], 1u << 16);
    ck_assert(!supply_is_low(&supply));
    supply_falls_below(true);
    ck_assert(supply_is_low(&supply) && supply_is_low(&supply));
    ck_assert_uint_eq(supply.dips, 1);
    supply_falls_below(false);
    ck_assert(!supply_is_low(&supply));
    ck_assert_uint_eq(supply.dips, 1);
}
END_TEST

START_TEST(a_dip_is_seen_once_however_short)
{
    ck_assert_uint_eq(supply_init(&supply), 0);
    supply_falls_below(true);
    supply_falls_below(false); /* before the loop looked */
    ck_assert(supply_is_low(&supply) && !supply_is_low(&supply));
    supply_falls_below(false); /* over before the register was read */
    ck_assert(supply_is_low(&supply) && !supply_is_low(&supply));
    ck_assert_uint_eq(supply.dips, 2);
}
END_TEST

START_TEST(a_supply_that_is_low_at_the_start_is_told)
{
    pwr[0x14 / 4] = 1u << 11;
    ck_assert_uint_eq(supply_init(&supply), 0);
    ck_assert(supply_is_low(&supply) && supply.dips == 1);
}
END_TEST

START_TEST(a_lost_write_to_the_detector_is_told)
{
    static const uint32_t address[] = {0x40007004, 0x40010408, 0x4001040C, 0x40010400, 0x40021060};

    mmio_model_lose(address[_i]);
    ck_assert_uint_eq(supply_init(&supply), address[_i]);
}
END_TEST

START_TEST(a_parity_error_is_told_once_and_needs_its_clock)
{
    syscfg[7] = 1u << 8;
    ck_assert(!supply_ram_parity_failed()); /* SYSCFG has no clock yet */
    ck_assert_uint_eq(supply_init(&supply), 0);
    ck_assert(supply_ram_parity_failed());
    ck_assert(!supply_ram_parity_failed());
}
END_TEST

/* ---- The watchdog's oscillator -------------------------------------------------------- */

static uint32_t lptim[9], changes; /* how often a read of the count gives another value yet */

static uint32_t lptim_read(void *context, uint32_t offset)
{
    (void)context;
    if (offset == 0x1C && changes > 0) {
        changes--;
        return lptim[7] ^ (changes + 1u);
    }
    return lptim[offset / 4];
}

static void lptim_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    ck_assert(offset != 0x18 || (lptim[4] & 1) != 0); /* RM0440: ARR only while enabled */
    ck_assert(offset != 0x0C || (lptim[4] & 1) == 0); /* and CFGR only while not */
    lptim[offset / 4] = value;
    lptim[0] |= offset == 0x18 ? 1u << 4 : 0;
}

static struct lsi_meter meter;

static void meter_setup(void)
{
    setup();
    memset(lptim, 0, sizeof lptim);
    changes = 0;
    mmio_model_map(0x40007C00, sizeof lptim, lptim_read, lptim_write, NULL);
    rcc[0x94 / 4] = 2; /* LSIRDY */
    ck_assert_uint_eq(lsi_meter_init(&meter), 0);
}

START_TEST(the_counter_runs_from_the_watchdogs_oscillator)
{
    ck_assert_uint_eq(rcc[0x88 / 4] >> 18 & 3, 1); /* RCC_CCIPR.LPTIM1SEL: LSI */
    ck_assert_uint_eq(rcc[0x58 / 4] >> 31, 1);
    ck_assert_uint_eq(rcc[0x94 / 4] & 1, 1);
    ck_assert_uint_eq(lptim[4], 5); /* enabled, continuous */
    ck_assert_uint_eq(lptim[6], 0xFFFF);
}
END_TEST

START_TEST(it_measures_over_the_wraps_and_judges)
{
    static const struct {
        double hz;
        bool good;
    } row[] = {{32000, true},  {29500, true},  {34000, true},
               {26000, false}, {38000, false}, {0, false}};
    uint32_t now_us = UINT32_MAX - 2000000;

    ck_assert(lsi_meter_is_good(&meter)); /* not yet measured */
    for (uint32_t i = 0; i < 8; i++, now_us += 700000) {
        lptim[7] = (uint32_t)(row[_i].hz * 0.7 * i) & 0xFFFF;
        changes = 2; /* read in the middle of a change */
        const bool fresh = lsi_meter_update(&meter, now_us);
        ck_assert(fresh == (i > 0));
        if (fresh) {
            assert_close(meter.hz, row[_i].hz, 3e-4, 2.0);
            ck_assert(row[_i].hz == 0 || lsi_meter_is_good(&meter) == row[_i].good);
        }
    }
}
END_TEST

START_TEST(what_cannot_be_measured_is_not)
{
    ck_assert(!lsi_meter_update(&meter, 1000000));
    ck_assert(!lsi_meter_update(&meter, 1000000 + 1600000)); /* too late: it may have wrapped */
    ck_assert(!lsi_meter_update(&meter, 2600000 + 400000));  /* too early */
    changes = 100;
    ck_assert(!lsi_meter_update(&meter, 2600000 + 600000)); /* no two reads agree */
    ck_assert_uint_eq(meter.hz, 0);
}
END_TEST

/* ---- Option bytes and flash errors ---------------------------------------------------------- */

static struct flash_model flash;

static void flash_setup(void)
{
    mmio_model_reset();
    flash_model_init(&flash);
}

START_TEST(the_option_bytes_are_set_once_and_loaded)
{
    ck_assert_uint_eq(flash.optr, 0xFFEFF8AA); /* as delivered */
    ck_assert(!option_bytes_are_set());
    ck_assert(option_bytes_set(false));
    ck_assert(flash.options_wanted);
    flash_model_power_up(&flash);
    flash_model_load_options(&flash);
    ck_assert(option_bytes_are_set());
    /* Level 3: 2.5 V; SRAM_PE 0: parity on; nothing else moves. */
    ck_assert_uint_eq(flash.optr, (0xFFEFF8AAu & ~(1u << 24)) | 3u << 8);
    ck_assert_uint_eq(flash.operations, 1);
}
END_TEST

START_TEST(they_are_left_alone_when_protected_or_tried_before)
{
    ck_assert(!option_bytes_set(true));
    flash.optr_stored = MODEL_OPTIONS_TORN;
    flash_model_load_options(&flash);
    ck_assert(!option_bytes_are_set());
    ck_assert(!option_bytes_set(false));
    ck_assert_uint_eq(flash.operations, 0);
}
END_TEST

START_TEST(power_that_fails_meanwhile_leaves_them_torn_and_no_more_is_written)
{
    flash.power_fails_at = 0;
    (void)option_bytes_set(false);
    flash_model_power_up(&flash);
    flash_model_load_options(&flash);
    ck_assert_uint_eq(flash.optr, MODEL_OPTIONS_TORN);
    ck_assert(!option_bytes_set(false));
    ck_assert_uint_eq(flash.operations, 1);
}
END_TEST

START_TEST(an_error_that_was_mended_is_told_once)
{
    struct flash_store store;
    uint8_t word[8];
    const uint32_t at = 0x08000000 + MODEL_STORE_PAGE * 2048;

    flash_store_init(&store);
    flash.state[MODEL_STORE_PAGE][0] = WORD_WEAK;
    ck_assert(!flash_store_take_corrected());
    ck_assert_int_eq(flash_store_read_at(&store, at, word), NV_OK);
    ck_assert(flash_store_take_corrected());
    ck_assert(!flash_store_take_corrected());
    ck_assert_int_eq(flash_store_read_at(&store, at + 8, word), NV_OK);
    ck_assert(!flash_store_take_corrected());
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("supply");
    TCase *detector = tcase_create("detector"), *oscillator = tcase_create("oscillator");
    TCase *options = tcase_create("options");

    tcase_add_checked_fixture(detector, setup, NULL);
    tcase_add_test(detector, the_detector_interrupts_at_both_edges_of_2_9_v);
    tcase_add_test(detector, a_dip_is_seen_once_however_short);
    tcase_add_test(detector, a_supply_that_is_low_at_the_start_is_told);
    tcase_add_loop_test(detector, a_lost_write_to_the_detector_is_told, 0, 5);
    tcase_add_test(detector, a_parity_error_is_told_once_and_needs_its_clock);
    tcase_add_checked_fixture(oscillator, meter_setup, NULL);
    tcase_add_test(oscillator, the_counter_runs_from_the_watchdogs_oscillator);
    tcase_add_loop_test(oscillator, it_measures_over_the_wraps_and_judges, 0, 6);
    tcase_add_test(oscillator, what_cannot_be_measured_is_not);
    tcase_add_checked_fixture(options, flash_setup, NULL);
    tcase_add_test(options, the_option_bytes_are_set_once_and_loaded);
    tcase_add_test(options, they_are_left_alone_when_protected_or_tried_before);
    tcase_add_test(options, power_that_fails_meanwhile_leaves_them_torn_and_no_more_is_written);
    tcase_add_test(options, an_error_that_was_mended_is_told_once);
    suite_add_tcase(suite, detector);
    suite_add_tcase(suite, oscillator);
    suite_add_tcase(suite, options);
    return run_suite(suite);
}
