/* Clocks, timer, watchdog, pins: what must hold whatever the order of accesses. */
#include <string.h>

#include "hal/port_stm32g474/board_io.h"
#include "hal/port_stm32g474/clock_tree.h"
#include "hal/port_stm32g474/idle.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "tests/support/assert_close.h"

/* ---- Clocks: a small RCC ---------------------------------------------------------- */

static struct {
    uint32_t rcc[0x100 / 4], pwr[0x100 / 4], flash[0x80 / 4];
    bool crystal_works, pll_locks, regulator_settles, boost_works;
    bool fresh_ahb2, fresh_apb1; /* a clock was switched on and its register not read since */
    int delay;                   /* polls until anything is ready */
    int wait;
} chip;

static bool ready(void)
{
    return chip.wait++ >= chip.delay;
}

static uint32_t rcc_read(void *context, uint32_t offset)
{
    uint32_t cr = chip.rcc[0];
    (void)context;

    if (offset == 0x00) {
        bool hse = (cr & (1u << 16)) && chip.crystal_works && ready();
        bool pll = (cr & (1u << 24)) && chip.pll_locks && ready();
        return cr | (hse ? 1u << 17 : 0) | (pll ? 1u << 25 : 0);
    }
    if (offset == 0x08) {
        return chip.rcc[2] | ((chip.rcc[2] & 3u) << 2); /* the switch is done at once */
    }
    chip.fresh_ahb2 = chip.fresh_ahb2 && offset != 0x4C;
    chip.fresh_apb1 = chip.fresh_apb1 && offset != 0x58;
    return chip.rcc[offset / 4];
}

/* RM0440, "Peripheral clock enable register": the clock takes two cycles to arrive. What is
 * accessed right behind the enabling is modelled as lost; a read of that register waits. */
static bool has_clock(uint32_t enable_offset, unsigned bit)
{
    ck_assert_msg(chip.rcc[enable_offset / 4] & (1u << bit), "no clock: %#x bit %u", enable_offset,
                  bit);
    return enable_offset == 0x4C ? !chip.fresh_ahb2 : !chip.fresh_apb1;
}

/* The system clock in Hz by RM0440's clock tree, 0 when the setting is not allowed. */
static uint32_t core_clock(void)
{
    uint32_t pll = chip.rcc[3], divider = 1;
    uint32_t m = ((pll >> 4) & 0xF) + 1, n = (pll >> 8) & 0x7F, r = 2 * (((pll >> 25) & 3) + 1);

    if ((chip.rcc[2] & 3) == 1) {
        return 16000000;
    }
    ck_assert_uint_eq(chip.rcc[2] & 3, 3);
    ck_assert_uint_eq(pll & 3, 3); /* from the crystal */
    ck_assert(pll & (1u << 24));
    ck_assert_uint_ge(24000000 / m, 2660000); /* DS12288: PLL input 2.66 .. 16 MHz */
    ck_assert_uint_le(24000000 / m, 16000000);
    ck_assert_uint_le(24000000 / m * n, 344000000); /* and VCO 96 .. 344 MHz */
    if (((chip.rcc[2] >> 4) & 0xF) == 8) {
        divider = 2;
    }
    return 24000000 / m * n / r / divider;
}

static void rcc_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    if (offset == 0x08 && (value & 3) == 3 && (chip.rcc[2] & 3) != 3) {
        /* At the moment of the switch: wait states, boost and half speed are there. */
        ck_assert_uint_eq(chip.flash[0] & 0xF, 4);
        ck_assert_uint_eq(chip.pwr[0x80 / 4] & (1u << 8), 0);
        ck_assert_uint_eq((value >> 4) & 0xF, 8);
    }
    chip.fresh_ahb2 = chip.fresh_ahb2 || (offset == 0x4C && (value & ~chip.rcc[offset / 4]) != 0);
    chip.fresh_apb1 = chip.fresh_apb1 || (offset == 0x58 && (value & ~chip.rcc[offset / 4]) != 0);
    chip.rcc[offset / 4] = value;
}

static uint32_t pwr_read(void *context, uint32_t offset)
{
    (void)context;
    if (!has_clock(0x58, 28)) {
        return 0;
    }
    if (offset == 0x14) {
        return chip.regulator_settles && ready() ? 0 : 1u << 10;
    }
    return chip.pwr[offset / 4];
}

static void pwr_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    if (has_clock(0x58, 28)) {
        chip.pwr[offset / 4] = value | (offset == 0x80 && !chip.boost_works ? 1u << 8 : 0);
    }
}

static void clock_setup(void)
{
    mmio_model_reset();
    memset(&chip, 0, sizeof chip);
    chip.crystal_works = chip.pll_locks = chip.regulator_settles = chip.boost_works = true;
    chip.delay = 100;
    chip.rcc[0] = 0x00000500; /* reset values: the RC oscillator runs */
    chip.rcc[2] = 0x00000001;
    chip.rcc[3] = 0x00001000;
    chip.pwr[0x80 / 4] = 1u << 8;
    chip.flash[0] = 0x00040601;
    mmio_model_map(0x40021000, 0x100, rcc_read, rcc_write, NULL);
    mmio_model_map(0x40007000, 0x100, pwr_read, pwr_write, NULL);
    mmio_model_map_memory(0x40022000, 0x80, chip.flash);
}

START_TEST(the_core_runs_at_170_mhz_from_the_crystal)
{
    ck_assert_int_eq(clock_tree_init(), CLOCK_TREE_OK);
    ck_assert_uint_eq(core_clock(), 170000000);
    ck_assert_uint_eq((chip.rcc[2] >> 8) & 0x3F, 0);       /* both peripheral buses undivided */
    ck_assert(chip.rcc[0] & (1u << 19));                   /* clock security */
    ck_assert_uint_eq(chip.rcc[0x88 / 4] & (3u << 24), 0); /* FDCAN from the crystal */
    ck_assert_uint_eq(chip.flash[0] & 0x00000700u, 0x700); /* prefetch and caches */
}
END_TEST

START_TEST(without_crystal_pll_or_regulator_the_core_stays_on_the_rc_oscillator)
{
    chip.crystal_works = _i != 0;
    chip.pll_locks = _i != 1;
    chip.regulator_settles = _i != 2;
    static const enum clock_tree_result result[] = {CLOCK_TREE_NO_CRYSTAL, CLOCK_TREE_NO_PLL,
                                                    CLOCK_TREE_NO_BOOST};
    ck_assert_int_eq(clock_tree_init(), result[_i]);
    ck_assert_uint_eq(core_clock(), 16000000);
    ck_assert_uint_eq(chip.rcc[0] & (1u << 19), 0);
}
END_TEST

/* RM0440, "Dynamic voltage scaling": above 150 MHz the core needs the boost mode. */
START_TEST(without_boost_mode_the_core_stays_on_the_rc_oscillator)
{
    chip.boost_works = false;
    ck_assert_int_eq(clock_tree_init(), CLOCK_TREE_NO_BOOST);
    ck_assert_uint_eq(core_clock(), 16000000);
    ck_assert_uint_eq(chip.rcc[0] & (1u << 19), 0);
}
END_TEST

/* A poll of an empty volatile loop takes 7.6 cycles: 4,000,000 of them took 1.9 s at 16 MHz. */
START_TEST(a_wait_lasts_as_long_at_any_clock)
{
    ck_assert_uint_eq(clock_tree_hz(), 16000000);
    assert_close(7.6 * clock_tree_wait_polls(clock_tree_hz(), 1000) / 16e6, 1.0, 0.01, 0);
    ck_assert_int_eq(clock_tree_init(), CLOCK_TREE_OK);
    ck_assert_uint_eq(clock_tree_hz(), core_clock());
    assert_close(7.6 * clock_tree_wait_polls(clock_tree_hz(), 1000) / 170e6, 1.0, 0.01, 0);
}
END_TEST

/* Clock security and FDCAN's clock: nothing else would notice that they are not set. */
START_TEST(a_lost_write_to_the_clock_tree_is_told)
{
    static const uint32_t address[] = {0x40021000, 0x40021088};

    chip.rcc[0x88 / 4] = 3u << 24;
    mmio_model_lose(address[_i]);
    ck_assert_int_eq(clock_tree_init(), _i == 0 ? CLOCK_TREE_NO_CRYSTAL : CLOCK_TREE_LOST_WRITE);
}
END_TEST

START_TEST(a_stopped_crystal_is_told_from_other_nmis)
{
    ck_assert(!clock_tree_crystal_failed());
    chip.rcc[0x1C / 4] = 1u << 8;
    ck_assert(clock_tree_crystal_failed());
    ck_assert_uint_eq(chip.rcc[0x20 / 4], 1u << 8);
}
END_TEST

START_TEST(the_reset_cause_is_taken_once)
{
    chip.rcc[0x94 / 4] = (1u << 29) | (1u << 26) | 3u; /* watchdog and pin; LSI on */
    ck_assert_uint_eq(clock_tree_take_reset_flags(), (1u << 29) | (1u << 26));
    ck_assert(chip.rcc[0x94 / 4] & (1u << 23));
}
END_TEST

/* ---- Timer -------------------------------------------------------------------------- */

enum { TIM_SR = 0x10 / 4, TIM_CNT = 0x24 / 4, TIM_CCR1 = 0x34 / 4 };

static uint32_t tim[0x60 / 4];
static uint32_t counter_at_read; /* what CNT shows the second time */
static bool overflow_between;
static uint32_t passes_at_read; /* microseconds that pass right behind the next read of CNT */
static struct tim2_clock timer;
static struct clock ticks;
static bool listening; /* FDCAN's interrupt comes as soon as it is let in */
static uint64_t heard_ns;

/* RM0440, TIM2: the compare flag is set when the counter gets to CCR1, not beyond it;
 * UIF when it wraps. */
static void time_passes(uint32_t microseconds)
{
    const uint32_t from = tim[TIM_CNT], to = from + microseconds;

    if (microseconds > 0 && tim[TIM_CCR1] - from - 1 < microseconds) {
        tim[TIM_SR] |= 2;
    }
    if (to < from) {
        tim[TIM_SR] |= 1;
    }
    tim[TIM_CNT] = to;
}

static uint32_t tim_read(void *context, uint32_t offset)
{
    uint32_t value = tim[offset / 4];
    (void)context;

    if (!has_clock(0x58, 0)) {
        return 0;
    }
    if (offset == 0x24 && overflow_between) { /* the counter wraps right behind this read */
        overflow_between = false;
        tim[0x24 / 4] = counter_at_read;
        tim[0x10 / 4] |= 1;
    }
    if (offset == 0x24 && passes_at_read > 0) {
        const uint32_t passes = passes_at_read;
        passes_at_read = 0;
        time_passes(passes);
    }
    return value;
}

static uint32_t modes[4], mode_count; /* written to CCMR1 */

static void tim_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    if (!has_clock(0x58, 0)) {
        return;
    }
    if (offset == 0x18) {
        modes[mode_count++ % 4] = value;
    }
    tim[offset / 4] = offset == 0x10 ? tim[offset / 4] & value : value;
    if (listening && mmio_model_locked() == 0) {
        heard_ns = tim2_clock_now_ns(&timer);
    }
}

static void timer_setup(void)
{
    clock_setup();
    memset(tim, 0, sizeof tim);
    listening = overflow_between = false;
    passes_at_read = 0;
    heard_ns = UINT64_MAX;
    mmio_model_map(0x40000000, sizeof tim, tim_read, tim_write, NULL);
    tim2_clock_init(&timer, 170000000);
    ticks = tim2_clock_interface(&timer);
}

START_TEST(the_timer_counts_microseconds_and_starts_clean)
{
    ck_assert_uint_eq(170000000 / (tim[0x28 / 4] + 1), 1000000);
    ck_assert_uint_eq(tim[0x2C / 4], UINT32_MAX);
    ck_assert_uint_eq(tim[0x34 / 4], 1000);
    ck_assert_uint_eq(tim[0x0C / 4], 3);
    ck_assert_uint_eq(tim[0x00] & 1, 1);
    ck_assert(chip.rcc[0x58 / 4] & 1);
    ck_assert(!clock_take_tick(&ticks));
}
END_TEST

START_TEST(a_lost_write_to_the_timer_is_told)
{
    static const uint32_t address[] = {0x40000000, 0x4000000C, 0x40000028,
                                       0x40000034, 0x40000018, 0x40000020};

    memset(tim, 0, sizeof tim);
    mmio_model_lose(address[_i]);
    ck_assert_uint_eq(tim2_clock_init(&timer, 170000000), address[_i]);
    mmio_model_lose(0);
    memset(tim, 0, sizeof tim);
    ck_assert_uint_eq(tim2_clock_init(&timer, 170000000), 0);
}
END_TEST

/* RM0440, TIMx_CCMR1, OC2M in bits 14 to 12: 101 forces the output high, 010 lets the match end it. */
START_TEST(a_pulse_begins_at_once_and_ends_by_the_match)
{
    ck_assert_uint_eq(tim[0x20 / 4] & 0x10, 0x10);
    tim[TIM_CNT] = UINT32_MAX - 5;
    mode_count = 0;
    sync_pulse_give(&pa1_sync_pulse);
    ck_assert_uint_eq(tim[0x38 / 4], 10000 - 6);
    ck_assert_uint_eq(mode_count, 2);
    ck_assert_uint_eq(modes[0] >> 12 & 7, 5);
    ck_assert_uint_eq(modes[1] >> 12 & 7, 2);
    ck_assert_uint_eq(tim[0x34 / 4], 1000); /* the tick goes on */
}
END_TEST

START_TEST(each_period_is_taken_once_and_none_is_forgotten)
{
    for (int i = 0; i < 5; i++) {
        tim[0x10 / 4] = 2;
        tim2_clock_interrupt(&timer);
        ck_assert_uint_eq(tim[0x10 / 4], 0);
        ck_assert_uint_eq(tim[0x34 / 4], 1000u * (unsigned)(i + 2));
        ck_assert(clock_take_tick(&ticks));
        ck_assert(!clock_take_tick(&ticks));
    }
    ck_assert_uint_eq(clock_missed_ticks(&ticks), 0);
    for (int i = 0; i < 3; i++) {
        tim[0x10 / 4] = 2;
        tim2_clock_interrupt(&timer);
    }
    ck_assert_uint_eq(clock_missed_ticks(&ticks), 2);
    for (int i = 0; i < 3; i++) {
        ck_assert(clock_take_tick(&ticks));
    }
    ck_assert(!clock_take_tick(&ticks));
}
END_TEST

START_TEST(time_never_runs_back_at_the_overflow)
{
    tim[0x24 / 4] = UINT32_MAX - 1;
    ck_assert_uint_eq(clock_now_ns(&ticks), (uint64_t)(UINT32_MAX - 1) * 1000);
    counter_at_read = 3;
    overflow_between = true; /* wraps between reading CNT and SR */
    ck_assert_uint_eq(clock_now_ns(&ticks), ((1ull << 32) + 3) * 1000);
    ck_assert_uint_eq(clock_now_ns(&ticks), ((1ull << 32) + 3) * 1000); /* still not counted */
    tim2_clock_interrupt(&timer);
    ck_assert_uint_eq(clock_now_ns(&ticks), ((1ull << 32) + 3) * 1000);
    ck_assert_uint_eq(tim2_clock_now_ms(&timer), ((1ull << 32) + 3) / 1000);
    timer.high = 1000;
    ck_assert_uint_eq(tim2_clock_now_ms(&timer), (uint32_t)(((1000ull << 32) + 3) / 1000));
    timer.high = 1;
    ck_assert(!clock_take_tick(&ticks)); /* an overflow is no period */
}
END_TEST

/* Runs the interrupt when its flag is set, as the core would. */
static void interrupt_if_due(void)
{
    if ((tim[TIM_SR] & 3) != 0) {
        tim2_clock_interrupt(&timer);
    }
}

/* Held up for up to 300 periods, at any place of a period: the next period is marked on
 * time again, and all that ended are counted. */
START_TEST(an_interrupt_that_comes_late_does_not_stop_the_clock)
{
    static const uint32_t late_us[] = {0, 1, 998, 999, 1000, 1001, 1999, 2000, 80000, 299999};
    const uint32_t start_us = _i == 0 ? 0 : UINT32_MAX - 1500; /* also over the wrap */

    for (size_t i = 0; i < sizeof late_us / sizeof late_us[0]; i++) {
        timer_setup();
        tim[TIM_CNT] = start_us;
        tim[TIM_CCR1] = start_us + 1000;
        time_passes(1000 + late_us[i]);
        interrupt_if_due();
        ck_assert(clock_take_tick(&ticks));
        ck_assert(!clock_take_tick(&ticks)); /* no burst afterwards */
        ck_assert_uint_eq(clock_missed_ticks(&ticks), late_us[i] / 1000);
        for (int period = 0; period < 3; period++) {
            time_passes(1000 - (tim[TIM_CNT] - start_us) % 1000);
            interrupt_if_due();
            ck_assert(clock_take_tick(&ticks));
        }
        ck_assert_uint_eq(clock_missed_ticks(&ticks), late_us[i] / 1000);
    }
}
END_TEST

/* The period ends between looking at the counter and setting the compare: whatever
 * microsecond it is, no match is lost and none is counted twice. */
START_TEST(a_period_that_ends_while_the_compare_is_set_is_counted_once)
{
    for (uint32_t at_us = 990; at_us <= 1010; at_us++) {
        for (uint32_t passes = 0; passes <= 20; passes++) {
            timer_setup();
            time_passes(1000);
            time_passes(at_us);
            passes_at_read = passes;
            interrupt_if_due();
            uint32_t taken = clock_take_tick(&ticks);
            passes_at_read = 0;
            interrupt_if_due(); /* if the next match came meanwhile */
            taken += clock_take_tick(&ticks);
            ck_assert_uint_eq(taken + clock_missed_ticks(&ticks), tim[TIM_CNT] / 1000);
            ck_assert_uint_eq(tim[TIM_CCR1], (tim[TIM_CNT] / 1000 + 1) * 1000);
        }
    }
}
END_TEST

START_TEST(an_interrupt_within_the_timers_reads_the_right_time)
{
    tim[TIM_CNT] = UINT32_MAX - 1;
    time_passes(4);
    listening = true; /* from the first access at which the lock is open */
    tim2_clock_interrupt(&timer);
    if (heard_ns == UINT64_MAX) {
        heard_ns = tim2_clock_now_ns(&timer);
    }
    ck_assert_uint_eq(heard_ns, ((1ull << 32) + 2) * 1000);
    ck_assert_int_eq(mmio_model_locked(), 0);
}
END_TEST

/* ---- Sleep --------------------------------------------------------------------------- */

static struct fdcan can;
static int sleeps, locked_asleep;
static uint32_t counter[2]; /* DWT: control, cycles */

static void asleep(void)
{
    sleeps++;
    counter[1] += 1000;
    locked_asleep += mmio_model_locked() ? 1 : 0;
    can.ring_in++; /* a frame that can wait, and then a period */
    timer.waiting = sleeps == 2 ? 1 : 0;
}

START_TEST(the_loop_does_not_sleep_over_what_has_come)
{
    memset(&can, 0, sizeof can);
    sleeps = locked_asleep = 0;
    mmio_model_on_sleep(asleep);
    mmio_model_map_memory(0xE0001000, sizeof counter, counter);
    counter[1] = 0xFFFFFFF0;
    can.ring_in = can.ring_due = 1; /* an interrupt between the poll and here */
    idle_until_interrupt(&can, &timer);
    ck_assert_int_eq(sleeps, 0);
    can.ring_out = 1;
    timer.waiting = 1;
    ck_assert_uint_eq(idle_until_interrupt(&can, &timer), 0);
    ck_assert_int_eq(sleeps, 0);
    timer.waiting = 0;
    ck_assert_uint_eq(idle_until_interrupt(&can, &timer), 2000); /* over the wrap */
    ck_assert_int_eq(sleeps, 2);
    ck_assert_int_eq(locked_asleep, 2); /* from the look on no interrupt is handled */
    ck_assert_int_eq(mmio_model_locked(), 0);
}
END_TEST

/* ---- Watchdog and pins ----------------------------------------------------------------- */

static uint32_t iwdg[5];
static uint32_t feeds, unlocked, started;

static uint32_t iwdg_read(void *context, uint32_t offset)
{
    (void)context;
    if (offset == 0x0C) {
        return feeds == 0 && iwdg[3] > 0 ? iwdg[3]-- && 1u : 0u;
    }
    return offset == 0 ? 0u : iwdg[offset / 4];
}

static void iwdg_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    if (offset == 0) {
        feeds += value == 0xAAAA;
        unlocked = value == 0x5555;
        started += value == 0xCCCC;
        return;
    }
    ck_assert_msg(unlocked, "register %#x is write-protected", offset);
    iwdg[offset / 4] = value;
}

/* RM0440: the counter runs at 32 kHz / (4 * 2^PR), from RLR down; it must not be fed above WINR. */
START_TEST(the_watchdog_bites_after_120_ms_and_within_10)
{
    mmio_model_reset();
    mmio_model_map(0x40003000, sizeof iwdg, iwdg_read, iwdg_write, NULL);
    iwdg[3] = 50; /* busy for some polls */
    iwdg[4] = 0xFFF;
    ck_assert_uint_eq(iwdg_start(), 0);
    ck_assert_uint_eq(started, 1);
    ck_assert_uint_eq(feeds, 0); /* writing WINR does it */
    const double hz = 32000.0 / (4.0 * (1u << iwdg[1]));
    assert_close((double)iwdg[2] / hz, 0.120, 1e-3, 0);
    ck_assert_uint_le(iwdg[2], 0xFFF);
    assert_close((double)(iwdg[2] - iwdg[4]) / hz, 0.010, 1e-3, 0);
    /* DS12288: LSI is 29.5 to 34 kHz. What the loop feeds falls into the window at both ends, even if the
     * two pages of a store took 40 ms each, which public drivers allow for (DS12288 has 24.47). */
    ck_assert(1e-3 * WATCHDOG_FEED_MS > (double)(iwdg[2] - iwdg[4]) / (hz * 29.5 / 32));
    ck_assert(1e-3 * (WATCHDOG_FEED_MS + 2 * 40) < (double)iwdg[2] / (hz * 34 / 32));
}
END_TEST

/* At most one feed in 20 ms, over the wrap of the timer, too. */
START_TEST(the_loop_feeds_the_watchdog_now_and_then)
{
    struct iwdg dog = {.fed_us = UINT32_MAX - 5000};
    const struct watchdog interface = iwdg_interface(&dog);
    uint32_t last_us = dog.fed_us;

    timer_setup();
    mmio_model_map(0x40003000, sizeof iwdg, iwdg_read, iwdg_write, NULL);
    for (uint32_t i = 0; i < 100; i++) {
        tim[TIM_CNT] = UINT32_MAX - 5000 + 1000 * i;
        interface.ops->feed(interface.context);
        if (feeds > 0) {
            ck_assert_uint_ge(tim[TIM_CNT] - last_us, 20000);
            last_us = tim[TIM_CNT];
            feeds = 0;
        }
        ck_assert_uint_le(tim[TIM_CNT] - last_us, 21000);
    }
}
END_TEST

/* Its reset values: 512 ms with the first divisor. */
START_TEST(a_lost_write_to_the_watchdog_is_told)
{
    mmio_model_reset();
    mmio_model_map(0x40003000, sizeof iwdg, iwdg_read, iwdg_write, NULL);
    memset(iwdg, 0, sizeof iwdg);
    iwdg[2] = 0xFFF;
    iwdg[4] = 0xFFF;
    const uint32_t lost = _i == 0 ? 0x40003008 : 0x40003010;
    mmio_model_lose(lost);
    ck_assert_uint_eq(iwdg_start(), lost);
}
END_TEST

static uint32_t port_a[0x2C / 4], port_c[0x2C / 4];

static uint32_t gpio_read(void *context, uint32_t offset)
{
    return has_clock(0x4C, context == port_a ? 0 : 2) ? ((uint32_t *)context)[offset / 4] : 0;
}

static void gpio_write(void *context, uint32_t offset, uint32_t value)
{
    if (has_clock(0x4C, context == port_a ? 0 : 2)) {
        ((uint32_t *)context)[offset / 4] = value;
    }
}

static void pins_at_reset(void)
{
    memset(port_a, 0, sizeof port_a);
    memset(port_c, 0, sizeof port_c);
    port_a[0] = 0xABFFFFFF; /* the debug port is on PA13 and PA14 */
    port_c[0] = 0xFFFFFFFF;
}

START_TEST(a_lost_write_to_the_pins_is_told)
{
    static const uint32_t address[] = {0x48000000, 0x4800000C, 0x48000024, 0x48000800, 0x4800080C};

    clock_setup();
    mmio_model_map(0x48000000, sizeof port_a, gpio_read, gpio_write, port_a);
    mmio_model_map(0x48000800, sizeof port_c, gpio_read, gpio_write, port_c);
    pins_at_reset();
    mmio_model_lose(address[_i]);
    ck_assert_uint_eq(board_io_init(), address[_i]);
}
END_TEST

START_TEST(the_pins_are_can_on_pa11_pa12_and_the_stop_on_pc0)
{
    clock_setup();
    mmio_model_map(0x48000000, sizeof port_a, gpio_read, gpio_write, port_a);
    mmio_model_map(0x48000800, sizeof port_c, gpio_read, gpio_write, port_c);
    pins_at_reset();
    ck_assert_uint_eq(board_io_init(), 0);
    /* 11 -> 10, three times: the pulse on PA1, and the bus */
    ck_assert_uint_eq(port_a[0], 0xABFFFFFF - (1u << 2) - (1u << 22) - (1u << 24));
    ck_assert_uint_eq(port_a[0x20 / 4], 0x00000010); /* TIM2 */
    ck_assert_uint_eq(port_a[0x24 / 4], 0x00099000);
    ck_assert_uint_eq(port_c[0], 0xFFFFF744);        /* 0, 2: input, 1, 3, 5: output */
    ck_assert_uint_eq(port_c[0x0C / 4] & 3, 2);      /* pulled down */
    ck_assert_uint_eq(port_c[0x0C / 4] >> 4 & 3, 1); /* pulled up */
    ck_assert(chip.rcc[0x58 / 4] & (1u << 25));
    ck_assert_uint_eq(chip.rcc[0x38 / 4] & (1u << 25), 0); /* reset released */

    port_c[0x10 / 4] = 0; /* open contact or broken wire */
    ck_assert(emergency_stop_is_pressed(&pc0_emergency_stop));
    port_c[0x10 / 4] = 0xFFFE;
    ck_assert(emergency_stop_is_pressed(&pc0_emergency_stop));
    port_c[0x10 / 4] = 1;
    ck_assert(!emergency_stop_is_pressed(&pc0_emergency_stop));

    for (uint32_t feed = 1; feed <= 6; feed++) { /* and nothing else of the port moves */
        port_c[0x14 / 4] |= 0xF0;
        drive_power_enable_toggle(&pc1_pc5_drive_power_enable);
        ck_assert_uint_eq(port_c[0x14 / 4], 0xF0 | (feed % 2 << 1));
    }
}
END_TEST

/* Low from the start on, high while the torque is to go; a pin that something holds is told as it is. */
START_TEST(the_line_that_takes_the_torque_is_pc5)
{
    clock_setup();
    mmio_model_map(0x48000000, sizeof port_a, gpio_read, gpio_write, port_a);
    mmio_model_map(0x48000800, sizeof port_c, gpio_read, gpio_write, port_c);
    pins_at_reset();
    ck_assert_uint_eq(board_io_init(), 0);
    ck_assert_uint_eq(port_c[0] >> 10 & 3, 1);
    ck_assert_uint_eq(port_c[0x14 / 4], 0);
    port_c[0x14 / 4] = 0xC2;
    drive_power_enable_cut(&pc1_pc5_drive_power_enable, true);
    ck_assert_uint_eq(port_c[0x14 / 4], 0xE2); /* and nothing else of the port moves */
    drive_power_enable_toggle(&pc1_pc5_drive_power_enable);
    ck_assert_uint_eq(port_c[0x14 / 4], 0xE0);
    drive_power_enable_cut(&pc1_pc5_drive_power_enable, false);
    ck_assert_uint_eq(port_c[0x14 / 4], 0xC0);
    port_c[0x10 / 4] = 0xFFDF;
    ck_assert(!board_io_cut_is_high());
    port_c[0x10 / 4] = 0x0020;
    ck_assert(board_io_cut_is_high());
}
END_TEST

START_TEST(the_wearer_s_button_is_on_pc2_and_the_cue_on_pc3)
{
    clock_setup();
    mmio_model_map(0x48000000, sizeof port_a, gpio_read, gpio_write, port_a);
    mmio_model_map(0x48000800, sizeof port_c, gpio_read, gpio_write, port_c);
    pins_at_reset();
    ck_assert_uint_eq(board_io_init(), 0);
    port_c[0x10 / 4] = 0xFFFF; /* nobody presses, or there is no panel: the pull-up holds it */
    ck_assert(!wearer_panel_is_pressed(&pc2_pc3_wearer_panel));
    port_c[0x10 / 4] = 0xFFFF & ~4u;
    ck_assert(wearer_panel_is_pressed(&pc2_pc3_wearer_panel));
    port_c[0x14 / 4] = 0xF2;
    wearer_panel_set_cue(&pc2_pc3_wearer_panel, true);
    ck_assert_uint_eq(port_c[0x14 / 4], 0xFA); /* and nothing else of the port moves */
    wearer_panel_set_cue(&pc2_pc3_wearer_panel, false);
    ck_assert_uint_eq(port_c[0x14 / 4], 0xF2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("system");
    TCase *clocks = tcase_create("clocks"), *timers = tcase_create("timer");
    TCase *rest = tcase_create("rest");

    tcase_add_checked_fixture(clocks, clock_setup, NULL);
    tcase_add_test(clocks, the_core_runs_at_170_mhz_from_the_crystal);
    tcase_add_loop_test(clocks,
                        without_crystal_pll_or_regulator_the_core_stays_on_the_rc_oscillator, 0, 3);
    tcase_add_test(clocks, without_boost_mode_the_core_stays_on_the_rc_oscillator);
    tcase_add_test(clocks, a_wait_lasts_as_long_at_any_clock);
    tcase_add_loop_test(clocks, a_lost_write_to_the_clock_tree_is_told, 0, 2);
    tcase_add_test(clocks, a_stopped_crystal_is_told_from_other_nmis);
    tcase_add_test(clocks, the_reset_cause_is_taken_once);
    tcase_add_checked_fixture(timers, timer_setup, NULL);
    tcase_add_test(timers, the_timer_counts_microseconds_and_starts_clean);
    tcase_add_loop_test(timers, a_lost_write_to_the_timer_is_told, 0, 6);
    tcase_add_test(timers, a_pulse_begins_at_once_and_ends_by_the_match);
    tcase_add_test(timers, each_period_is_taken_once_and_none_is_forgotten);
    tcase_add_test(timers, time_never_runs_back_at_the_overflow);
    tcase_add_loop_test(timers, an_interrupt_that_comes_late_does_not_stop_the_clock, 0, 2);
    tcase_add_test(timers, a_period_that_ends_while_the_compare_is_set_is_counted_once);
    tcase_add_test(timers, an_interrupt_within_the_timers_reads_the_right_time);
    tcase_add_test(timers, the_loop_does_not_sleep_over_what_has_come);
    tcase_add_test(rest, the_watchdog_bites_after_120_ms_and_within_10);
    tcase_add_test(rest, the_loop_feeds_the_watchdog_now_and_then);
    tcase_add_loop_test(rest, a_lost_write_to_the_watchdog_is_told, 0, 2);
    tcase_add_loop_test(rest, a_lost_write_to_the_pins_is_told, 0, 5);
    tcase_add_test(rest, the_pins_are_can_on_pa11_pa12_and_the_stop_on_pc0);
    tcase_add_test(rest, the_line_that_takes_the_torque_is_pc5);
    tcase_add_test(rest, the_wearer_s_button_is_on_pc2_and_the_cue_on_pc3);
    suite_add_tcase(suite, clocks);
    suite_add_tcase(suite, timers);
    suite_add_tcase(suite, rest);
    return run_suite(suite);
}
